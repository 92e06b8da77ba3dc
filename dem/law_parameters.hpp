#pragma once
// What two materials make of a contact, law by law: the constants of kernels/pair_parameters.hpp from Young modulus,
// Poisson ratio, restitution and the like. Source: Irazabal Gonzalez 2017 (PhD thesis, UPC Barcelona), eqs. 3.17,
// 6.7-6.9; Talebiahooie2021 eq. 16; Nishiura2017 Table 1.
// Where we differ: the first branch of 3.17 is printed with 2 gamma^2 - 1 where 1 - 2 gamma^2 is meant.
// Everything here throws base::UserError on a value that no material has; the message names the value and the rule.
#include "dem/dem.hpp"
#include "dem/kernels/pair_parameters.hpp"

namespace dem {

// ---- Hertz contacts: hertz_mindlin, stress_friction; with one more constant hysteretic, viscoelastic
/// Two grains: pair_parameters() (dem/pair_parameters.hpp) on values that make sense.
kernels::PairParameters hertz_pair(const Material& a, const Material& b, const Interaction&);
/// A grain and a wall: wall_parameters().
kernels::PairParameters hertz_wall(const Material& grain, const Material& wall, const Interaction&);

// ---- linear springs: linear
struct LinearContact {
  double normal_stiffness = 0;  // [N/m] > 0
  double shear_stiffness = 0;   // [N/m] >= 0
  double friction = 0;          // [-]
  double restitution = 1;       // [-] in (0, 1]; 1: no dashpot
};
/// Without tangential damping, as Talebiahooie2021.
kernels::PairParameters linear_pair(const LinearContact&);
/// beta of a linear contact that cannot pull, for a restitution in (0, 1]; the inverse of linear_restitution().
double linear_damping_ratio(double restitution);
/// e = exp(-2 beta acos(beta) / sqrt(1 - beta^2)), beta > 1: acosh(beta) / sqrt(beta^2 - 1). Eq. 3.17.
double linear_restitution(double damping_ratio);

// ---- voigt_slider
struct VoigtContact {
  double normal_stiffness = 0;  // [N/m] > 0
  double shear_stiffness = 0;   // [N/m] >= 0; voigt_shear_stiffness()
  double normal_viscosity = 0;  // [N s/m] >= 0
  double shear_viscosity = 0;   // [N s/m] >= 0
  double friction = 0;          // [-]
};
kernels::PairParameters voigt_pair(const VoigtContact&);
/// k_t = k_n / 2 (1 + nu) [N/m]: both columns of Table 1 obey it.
double voigt_shear_stiffness(double normal_stiffness, double poisson_ratio);

// ---- hysteretic
/// D of eq. 16 for mode 0 (Gonthier), 1 (Lankarani-Nikravesh), 2 (Zhiying-Qishao); restitution in [0, 1], mode 0: > 0.
double hysteretic_damping(int mode, double restitution);
/// The restitution e' that a contact with this D returns: D (1 + e') = ln((1 + D) / (1 - D e')).
double hysteretic_restitution(double damping);

// ---- stress_friction
struct RestingStone {
  double weight = 0;                   // [N]
  double effective_radius = 0;         // [m] R* of its spheres' contacts, mean
  double effective_young_modulus = 0;  // [Pa] E*
};
/// sigma_cmax [Pa]: peak stress in one contact that carries a whole stone (6.8, 6.9).
double critical_stress(const RestingStone&);

// ---- rolling of type C
/// k_r / (k_t R*^2) = 2.25 eta_r^2 k_n / k_t (Ai et al. 2011).
double rolling_stiffness(double rolling_friction, double normal_to_shear_stiffness);
/// k_n / k_t of Hertz-Mindlin: E* / 4 G*.
double normal_to_shear_stiffness(const kernels::PairParameters&);

/// All constants of a pair of materials by the law and rolling model that the interaction names; `wall`: b is a wall's.
/// Without friction hertz_mindlin becomes smooth_law.
kernels::PairParameters interaction_parameters(const Material& a, const Material& b, const Interaction&, bool wall);

/// Throws unless every number is finite and in its range, whatever the law.
void check_parameters(const kernels::PairParameters&);

}  // namespace dem
