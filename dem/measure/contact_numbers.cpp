#include "dem/measure/contact_numbers.hpp"

#include <algorithm>
#include <unordered_map>
#include <vector>

namespace dem {

ContactNumbers contact_numbers(const Region& region, std::span<const Grain> grains,
                               std::span<const GrainContact> grain_contacts, std::span<const WallContact> wall_contacts,
                               int fewest) {
  struct Count {
    int grains = 0, walls = 0;
  };
  std::unordered_map<std::int64_t, Count> inside;
  for (const Grain& grain : grains) {
    if (contains(region, grain.position)) inside.emplace(grain.id, Count{});
  }
  std::vector<std::pair<std::int64_t, std::int64_t>> neighbours;
  for (const GrainContact& contact : grain_contacts) neighbours.push_back(std::minmax(contact.id_i, contact.id_j));
  std::sort(neighbours.begin(), neighbours.end());
  neighbours.erase(std::unique(neighbours.begin(), neighbours.end()), neighbours.end());
  const auto count = [&](std::int64_t id, int Count::*member) {
    if (const auto found = inside.find(id); found != inside.end()) ++(found->second.*member);
  };
  for (const auto& [one, other] : neighbours) {
    count(one, &Count::grains);
    count(other, &Count::grains);
  }
  for (const WallContact& contact : wall_contacts) count(contact.id, &Count::walls);

  ContactNumbers numbers;
  numbers.grains = inside.size();
  double all = 0, carrying = 0;
  for (const auto& [id, contacts] : inside) {
    all += contacts.grains;
    if (contacts.grains + contacts.walls < fewest)
      ++numbers.rattlers;
    else
      carrying += contacts.grains;
  }
  if (numbers.grains > 0) numbers.coordination = all / static_cast<double>(numbers.grains);
  if (numbers.grains > numbers.rattlers)
    numbers.mechanical = carrying / static_cast<double>(numbers.grains - numbers.rattlers);
  return numbers;
}

}  // namespace dem
