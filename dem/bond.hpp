#pragma once
// Façade of bonds: discs of cement that hold two spheres together until they break (kernels/parallel_bond.hpp).
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "dem/kernels/parallel_bond.hpp"

namespace dem {

struct Grain;

/// Between two grains that are spheres; made where they are, free of stress. Their contact law acts beside it: the bond
/// takes tension, shear, bending and twist, and compression with the contact.
struct Bond {
  std::int64_t i = 0, j = 0;  // ids
  kernels::BondParameters is;
};

/// A bond as it is now.
struct BondNow {
  std::int64_t i = 0, j = 0;
  bool broken = false;
  base::Vec3 force, moment;  // [N], [N m] on i at the bond
  double elastic = 0;        // [J]; without the ledger 0
};

/// Throws base::UserError unless radius and stiffness are > 0, the shear stiffness not negative, the strengths > 0
/// (infinite: it never breaks so); the message names the value.
void check_bond(const kernels::BondParameters&);

/// Every two of the grains whose surfaces are not farther apart than `gap` [m], by rising ids.
/// Throws base::UserError when one of them is a clump.
std::vector<std::array<std::int64_t, 2>> pairs_within(std::span<const Grain>, double gap);

}  // namespace dem
