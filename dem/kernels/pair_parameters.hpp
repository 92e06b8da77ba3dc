#pragma once
// What a pair of materials makes of a contact: computed once on the host (dem/law_parameters.hpp), read by the laws.
// One flat struct for every law; what a law does not read stays zero. dem/laws.hpp says which law reads what.
namespace dem::kernels {

struct PairParameters {
  // What the pair does: rows of the tables in dem/laws.hpp
  int law = 0;         // smooth_law: hertz_mindlin without friction
  int rolling = 0;     // rolling model
  unsigned flips = 0;  // which of the numbers that a contact keeps change sign when i and j are exchanged, bit by bit
  // Elastic contacts (Hertz): Irazabal2017 3.27c, 3.27d; walls 4.1d
  double effective_young_modulus = 0;  // [Pa] E*
  double effective_shear_modulus = 0;  // [Pa] G*
  // Dashpots of the Hertz and the linear law, c_n = 2 gamma sqrt(m* k_n); the two laws take a different gamma for one e
  double damping_ratio = 0;  // [-] gamma, from the restitution
  double shear_damping = 0;  // [-] c_t / c_n
  // Friction
  double friction = 0;          // [-] mu
  double rolling_friction = 0;  // [-] eta_r
  // Linear springs: linear, Voigt with slider
  double normal_stiffness = 0;  // [N/m] k_n
  double shear_stiffness = 0;   // [N/m] k_s
  // Dashpots of the Voigt law
  double normal_viscosity = 0;  // [N s/m] c_n
  double shear_viscosity = 0;   // [N s/m] c_t
  // Hysteretic
  double hysteretic_damping = 0;  // [-] D, Talebiahooie2021 eq. 16
  // Viscoelastic Hertz
  double dissipative_coefficient = 0;  // [s] A, Schwager2002 eq. 5
  // Stress-dependent friction: Irazabal2017 6.4, 6.6
  double critical_stress = 0;    // [Pa] sigma_cmax; only that law reads it
  double friction_exponent = 0;  // [-] gamma of 6.6, <= 0
  // Rolling of type C (rolling_models.hpp)
  double rolling_stiffness = 0;  // [-] k_r / (k_t R*^2)
  double rolling_damping = 0;    // [-] share of the critical damping
};

}  // namespace dem::kernels
