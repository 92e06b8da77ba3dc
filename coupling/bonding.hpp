#pragma once
// Bonds of a scene: which grains are cemented together at the start, and with what.
#include <optional>
#include <span>
#include <vector>

#include "dem/dem.hpp"

namespace coupling {

/// What a bond is made of; its radius follows from the grains.
struct Cement {
  dem::kernels::BondParameters is;  // all but the radius
  double radius_ratio = 1;          // [-] bond radius over the smaller grain's
};

struct ListedBond {
  std::int64_t i = 0, j = 0;  // numbers of the [[grain]]
  Cement cement;
};

struct Bonding {
  std::vector<ListedBond> list;  // [[bond]]
  std::optional<double> gap;     // [m] all other grains nearer than that are bonded with `cement`
  Cement cement;

  bool any() const { return gap || !list.empty(); }
};

/// The bonds of these grains, with the listed ones first. Throws base::UserError when a grain to be bonded by its gap
/// is a clump.
std::vector<dem::Bond> make_bonds(const Bonding&, std::span<const dem::Grain>);

}  // namespace coupling
