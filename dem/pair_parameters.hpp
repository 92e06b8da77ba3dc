#pragma once
// What two materials make of a contact: the constants of kernels/pair_parameters.hpp from Young modulus, Poisson ratio
// and restitution. Source: Irazabal Gonzalez 2017 (PhD thesis, UPC Barcelona), eqs. 3.27, 3.28 (two grains), 4.1
// (grain, wall).
//   1/E* = (1 - nu_i^2) / E_i + (1 - nu_j^2) / E_j,   1/G* = (2 - nu_i) / G_i + (2 - nu_j) / G_j,   G = E / 2 (1 + nu)
// Where we differ: damping belongs to the pair (its restitution), not to a material (3.27e, 4.1e).
#include "dem/damping_ratio.hpp"
#include "dem/dem.hpp"
#include "dem/kernels/pair_parameters.hpp"

namespace dem {

/// Compliance of one side [1/Pa], to be added to the other side's.
inline double normal_compliance(const Material& m) { return (1 - m.poisson_ratio * m.poisson_ratio) / m.young_modulus; }
inline double shear_compliance(const Material& m) {
  return (2 - m.poisson_ratio) * 2 * (1 + m.poisson_ratio) / m.young_modulus;
}

/// c_t / c_n = sqrt(k_t / k_n) (3.26)
inline double shear_damping(const kernels::PairParameters& pair) {
  return std::sqrt(4 * pair.effective_shear_modulus / pair.effective_young_modulus);
}

/// Two grains.
inline kernels::PairParameters pair_parameters(const Material& a, const Material& b, const Interaction& interaction) {
  kernels::PairParameters pair;
  pair.effective_young_modulus = 1 / (normal_compliance(a) + normal_compliance(b));
  pair.effective_shear_modulus = 1 / (shear_compliance(a) + shear_compliance(b));
  pair.damping_ratio = damping_ratio(interaction.restitution);
  pair.shear_damping = shear_damping(pair);
  pair.friction = interaction.friction;
  pair.rolling_friction = interaction.rolling_friction;
  return pair;
}

/// A grain and a wall: the wall yields in the normal direction (its Young modulus) but not tangentially (4.1d).
inline kernels::PairParameters wall_parameters(const Material& grain, const Material& wall,
                                               const Interaction& interaction) {
  auto parameters = pair_parameters(grain, wall, interaction);
  parameters.effective_shear_modulus = 1 / shear_compliance(grain);
  parameters.shear_damping = shear_damping(parameters);
  return parameters;
}

}  // namespace dem
