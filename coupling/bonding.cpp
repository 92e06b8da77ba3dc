#include "coupling/bonding.hpp"

#include <algorithm>
#include <set>
#include <unordered_map>

namespace coupling {

std::vector<dem::Bond> make_bonds(const Bonding& bonding, std::span<const dem::Grain> grains) {
  std::vector<dem::Bond> bonds;
  if (!bonding.any()) return bonds;
  std::unordered_map<std::int64_t, double> radius;
  for (const auto& grain : grains) radius[grain.id] = grain.radius;
  const auto add = [&](std::int64_t i, std::int64_t j, const Cement& cement) {
    bonds.push_back({i, j, cement.is});
    bonds.back().is.radius = cement.radius_ratio * std::min(radius.at(i), radius.at(j));
  };
  std::set<std::array<std::int64_t, 2>> listed;
  for (const auto& bond : bonding.list) {
    add(bond.i, bond.j, bond.cement);
    listed.insert({std::min(bond.i, bond.j), std::max(bond.i, bond.j)});
  }
  if (!bonding.gap) return bonds;
  for (const auto& pair : dem::pairs_within(grains, *bonding.gap))
    if (!listed.contains(pair)) add(pair[0], pair[1], bonding.cement);
  return bonds;
}

}  // namespace coupling
