#pragma once
// How many contacts the grains of a region have, and how many of the grains carry nothing.
//
//   coordination  Z   = mean over grains of the number of grains that press on them
//   rattler           : a grain with fewer than `fewest` contacts, with grains and with walls
//   mechanical    Z_m = mean of the same number over the grains that are no rattlers
// Source: Thornton 2000, Geotechnique 50:43 (doi:10.1680/geot.2000.50.1.43): Z_m = (2 C - N1) / (N - N0 - N1), with N0
// and N1 the numbers of grains with no and with one contact, hence fewest = 2. That is the bound for grains with
// friction, which two contacts can hold; without friction a sphere needs four.
// Where we differ: contacts with walls make a grain no rattler but are not among the contacts of Z_m, as in Z. Clumps
// that touch at several spheres are one contact. Rattlers are looked for once, not again after they are gone.
#include <span>

#include "dem/dem.hpp"
#include "dem/measure/region.hpp"

namespace dem {

struct ContactNumbers {
  std::size_t grains = 0, rattlers = 0;  // whose centre lies in the region
  double coordination = 0;               // Z; 0 without grains
  double mechanical = 0;                 // Z_m; 0 without grains that carry
  double rattler_share() const { return grains > 0 ? static_cast<double>(rattlers) / static_cast<double>(grains) : 0; }
};

/// Partners outside the region count.
ContactNumbers contact_numbers(const Region&, std::span<const Grain>, std::span<const GrainContact>,
                               std::span<const WallContact>, int fewest = 2);

}  // namespace dem
