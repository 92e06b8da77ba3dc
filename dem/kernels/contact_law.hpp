#pragma once
// (interface agreed; the implementation follows)
#include "base/vec3.hpp"

namespace dem::kernels {
using base::Vec3;

/// What the law needs to know of a pair of materials; computed once on the host.
struct PairParameters {
  double effective_young_modulus;  // [Pa] eq. 3.27c
  double effective_shear_modulus;  // [Pa] eq. 3.27d (walls: 4.1d)
  double friction;                 // [-]
  double damping_ratio;            // gamma [-], from the restitution (damping_ratio.hpp)
  double rolling_friction;         // [-]
};
struct ContactGeometry {
  double overlap;           // [m] > 0 when touching
  double effective_radius;  // [m]
  double effective_mass;    // [kg]
  Vec3 normal;              // from j to i
};
struct ContactMotion {
  Vec3 velocity;      // [m/s] of i relative to j at the contact point, at the instant of the positions
  Vec3 displacement;  // [m] of i relative to j at the contact point over the step that ends now
};
struct ContactHistory {
  Vec3 shear_force;            // [N] elastic tangential force on i after the last step, zero when the contact is new
  double shear_stiffness = 0;  // [N/m] of the last step; 0: the contact is new
};
struct ContactForce {
  Vec3 force;                   // [N] on i (j gets the opposite)
  double normal_force;          // [N] >= 0, elastic + damping, clamped
  double elastic_normal;        // [J] stored now
  double elastic_shear;         // [J] stored now
  double loss_friction;         // [J] in this step
  double loss_damping;          // [J] in this step
};
}  // namespace dem::kernels
