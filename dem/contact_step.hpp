#pragma once
// Stable step of a set of spheres in contact: a rigorous bound of the highest frequency from the contacts and bonds
// alive now.
//
//   Pair of grains:  x' K x = sum_c k_c |p_c . (x_i - x_j)|^2 <= sum_c 2 k_c (|p_c . x_i|^2 + |p_c . x_j|^2),
//   wall that moves as prescribed: the same without the factor 2. So omega^2 <= max over grains of the largest
//   eigenvalue of the 6 x 6 matrix  M^-1/2 [sum_c f_c k_c p_c p_c'] M^-1/2,  f_c = 2 or 1, over translation and
//   rotation, with k_n along the normal and k_t along both tangents at the contact point (arm × rotation included);
//   bonds likewise, and against turning. The largest eigenvalue itself is bounded by (trace A^64)^(1/64), at most 2.8 %
//   above it. The same bound of the dashpots gives xi = lambda_c / (2 omega);  dt <= 2 / omega (sqrt(1 + xi^2) - xi),
//   that is dt^2 omega^2 / 4 + dt lambda_c / 2 <= 1. As a mode's omega^2 and damping are means over the grains with the
//   same weights, and this is linear in both, it holds for the whole when it holds for every grain.
// Source: Belytschko, Liu, Moran, Nonlinear Finite Elements, ch. 6 (element eigenvalue inequality, damped central
// difference). Validity: the contacts of this instant, linearised; a coupled wall node's own mass is not seen here.
#include <vector>

#include "dem/dem.hpp"

namespace dem {

/// One contact, or one bond, as one of its grains sees it.
struct GrainSpring {
  int grain = 0;                                      // index into the masses
  Vec3 normal;                                        // unit
  Vec3 lever;                                         // [m] from the grain's centre to the contact point
  double normal_stiffness = 0, shear_stiffness = 0;   // [N/m]
  double normal_damping = 0, shear_damping = 0;       // [N s/m]
  bool other_is_free = true;                          // a grain or a body, not a wall that moves as it is told
  double bending_stiffness = 0, twist_stiffness = 0;  // [N m] of a bond, against turning across and about the normal
  bool bond = false;
};
struct GrainInertia {
  double mass = 0, inertia = 0;  // [kg m2] smallest moment; 0: the grain does not rotate
  std::int64_t id = 0;           // -1: a wall that moves as a body
};

/// limit = infinity when nothing touches.
StableStep contact_step(const std::vector<GrainInertia>& grains, const std::vector<GrainSpring>& springs);

}  // namespace dem
