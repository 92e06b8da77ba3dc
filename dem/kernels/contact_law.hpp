#pragma once
// Force between two grains, or a grain and a wall, that press on each other: Hertz normal force, Mindlin's incremental
// tangential force in Thornton's no-slip form, viscous damping in both directions, Coulomb friction.
//
//   a = sqrt(R* overlap)                     radius of the contact patch
//   k_n = 2 E* a,  k_t = 8 G* a              tangent stiffnesses                                    (3.25)
//   c_n = 2 gamma sqrt(m* k_n),  c_t = 2 gamma sqrt(m* k_t)                                         (3.26)
//   F_n = max(0, 2/3 k_n overlap + c_n d(overlap)/dt)                                               (3.12-3.14)
//   F_te = (k_t < last k_t ? k_t / last k_t : 1) F_te(last) - k_t (tangential displacement)         (3.20)
//   |F_te + F_td| <= mu F_n                                                                         (3.23, 3.24)
// Source: Irazabal Gonzalez 2017 (PhD thesis, UPC Barcelona), section 3.2.3; Thornton, Cummins, Cleary 2013
// (doi:10.1016/j.powtec.2012.08.012).
//
// Where we differ from the source:
// - 3.12 lets the dashpot pull grains together at the end of a contact. Dry stones do not attract: the total normal
//   force is clamped at zero. damping_ratio.hpp gives the gamma that returns the wanted restitution under this rule.
// - 3.20 asks whether the normal force falls; with a dashpot that is ambiguous. We ask whether k_t falls: k_t is
//   monotone in the overlap, so this is unloading of the contact patch, which is what Thornton's argument is about.
// - 3.22 takes k_n for c_t and 3.26b takes k_t; 3.26b is used.
// - 3.24 scales spring and dashpot together. Here the spring is held on the cone first and the dashpot gets what the
//   cone leaves: |F_te + lambda F_td| = mu F_n with lambda in [0, 1]. The total obeys 3.24 all the same, in full
//   sliding the two are equal, and neither part ever feeds energy back (scaling both can reverse the spring at high
//   slip speed).
//
// Why the energy sum closes. Velocity Verlet changes the kinetic energy by exactly the trapezoid work
// 1/2 (F_n + F_n+1) . displacement of the step. Summed over the steps:
// - normal spring: the trapezoid of F_ne is the difference of 8/15 E* a overlap^2 to second order in the step;
// - dashpots: sum 1/2 (F_n + F_n+1) . d_n+1 = sum F_n . 1/2 (d_n + d_n+1) = sum F_n . v_n dt, because Verlet's v_n is
// the
//   mean of the two half-step velocities and the force is zero before and after: so loss = - F_d . v dt at the instant;
// - tangential spring, with f0 the last force, f1 = f0 k_t / last k_t (or f0), f2 the new one, s the slip:
//   trapezoid work taken from the motion  - 1/2 (f0 + f2) . d
//     = change of |f|^2 / 2 k_t  +  what the change of k_t gives up, |f0|^2 / 2 k_t(last) - |f1|^2 / 2 k_t
//     + the work in the part of the force that was given up within the step, - 1/2 (f0 - f1) . d
//     + slip work, - 1/2 (f1 + f2) . s.
//   This is an identity; the last three are the friction loss. (A patch that grows under a held force stores less: that
//   is a loss of the incremental law too, not of the integrator.)
//
// Validity: overlap well below the radius (Hertz to about 10 % of it); history follows the tilt of the contact plane,
// not the spin of a pair about its common normal. Called once per contact: j gets the opposite force, so action =
// reaction.
#include "base/vec3.hpp"

namespace dem::kernels {
using base::Vec3;

/// What the law needs to know of a pair of materials; computed once on the host (dem/pair_parameters.hpp).
struct PairParameters {
  double effective_young_modulus;  // [Pa] E*, eq. 3.27c
  double effective_shear_modulus;  // [Pa] G*, eq. 3.27d (walls: 4.1d)
  double friction;                 // [-] mu
  double damping_ratio;            // [-] gamma, from the restitution (damping_ratio.hpp)
  double rolling_friction;         // [-] eta_r, eq. 5.3
};

struct ContactGeometry {
  double overlap;           // [m] > 0 when touching
  double effective_radius;  // [m] R*, eq. 3.27a (walls: radius of the grain)
  double effective_mass;    // [kg] m*, eq. 3.27b (walls: mass of the grain)
  Vec3 normal;              // [-] unit vector from j to i
};

struct ContactMotion {
  Vec3 velocity;      // [m/s] of i relative to j at the contact point, at the instant of the positions
  Vec3 displacement;  // [m] of i relative to j at the contact point over the step that ends now
  double time_step;   // [s] of the step that ends now; only the damping loss needs it
};

/// Kept from step to step. A new contact starts from zeros.
struct ContactHistory {
  Vec3 shear_force;            // [N] elastic tangential force on i after the last step
  double shear_stiffness = 0;  // [N/m] of the last step; 0: the contact is new
};

struct ContactForce {
  Vec3 force;             // [N] on i (j gets the opposite)
  double normal_force;    // [N] >= 0, elastic + damping, clamped
  double elastic_normal;  // [J] stored now
  double elastic_shear;   // [J] stored now
  double loss_friction;   // [J] in this step: slip and the shear energy given up by changes of k_t
  double loss_damping;    // [J] in this step: both dashpots
};

/// Turns a tangential force into the plane normal to `normal`, keeping its magnitude. A force that has come to point
/// along the normal (the contact has turned by 90 degrees in one step) has no direction left and is dropped.
TRACKBED_HD inline Vec3 turn_into_plane(const Vec3& force, const Vec3& normal) {
  const Vec3 tangential = force - dot(force, normal) * normal;
  const double before = norm2(force), after = norm2(tangential);
  return after > 1e-12 * before ? std::sqrt(before / after) * tangential : Vec3{};
}

/// Share lambda in [0, 1] of `dashpot` that keeps |spring + lambda dashpot| <= limit, given |spring| <= limit.
TRACKBED_HD inline double dashpot_share(const Vec3& spring, const Vec3& dashpot, double limit) {
  if (norm2(spring + dashpot) <= limit * limit) return 1;
  const double a = norm2(dashpot), b = dot(spring, dashpot);
  const double room = limit * limit - norm2(spring);
  if (room <= 0 && b >= 0) return 0;
  const double root = std::sqrt(b * b + a * (room > 0 ? room : 0));
  const double share = b > 0 ? room / (b + root) : (root - b) / a;  // the form without cancellation; a > 0 here
  return share < 1 ? share : 1;
}

/// Force on i now. `history` is the state after the last step on entry and after this step on return.
TRACKBED_HD inline ContactForce hertz_mindlin(const PairParameters& pair, const ContactGeometry& geometry,
                                              const ContactMotion& motion, ContactHistory& history) {
  const double stored_before =
      history.shear_stiffness > 0 ? norm2(history.shear_force) / (2 * history.shear_stiffness) : 0;
  if (!(geometry.overlap > 0)) {
    history = {};
    return {{}, 0, 0, 0, stored_before, 0};
  }
  const Vec3& n = geometry.normal;
  const double patch_radius = std::sqrt(geometry.effective_radius * geometry.overlap);
  const double k_n = 2 * pair.effective_young_modulus * patch_radius;
  const double k_t = 8 * pair.effective_shear_modulus * patch_radius;
  const double c_n = 2 * pair.damping_ratio * std::sqrt(geometry.effective_mass * k_n);
  const double c_t = 2 * pair.damping_ratio * std::sqrt(geometry.effective_mass * k_t);

  const double separation_speed = dot(motion.velocity, n);
  const double elastic_force = 2.0 / 3.0 * k_n * geometry.overlap;
  const double trial_force = elastic_force - c_n * separation_speed;
  const double normal_force = trial_force > 0 ? trial_force : 0;

  const Vec3 tangential_velocity = motion.velocity - separation_speed * n;
  const Vec3 step = motion.displacement - dot(motion.displacement, n) * n;
  const Vec3 last = turn_into_plane(history.shear_force, n);
  const Vec3 rescaled = k_t < history.shear_stiffness ? (k_t / history.shear_stiffness) * last : last;
  const Vec3 trial = rescaled - k_t * step;

  const double limit = pair.friction * normal_force;
  const double trial_norm = norm(trial);
  const bool slips = trial_norm > limit;
  const Vec3 spring = slips ? (limit / trial_norm) * trial : trial;
  const Vec3 slip = slips && k_t > 0 ? (1 / k_t) * (spring - trial) : Vec3{};
  const Vec3 dashpot = -c_t * tangential_velocity;
  const double share = dashpot_share(spring, dashpot, limit);

  ContactForce result;
  result.force = normal_force * n + spring + share * dashpot;
  result.normal_force = normal_force;
  result.elastic_normal =
      8.0 / 15.0 * pair.effective_young_modulus * patch_radius * geometry.overlap * geometry.overlap;
  result.elastic_shear = k_t > 0 ? norm2(spring) / (2 * k_t) : 0;
  const double stored_rescaled = k_t > 0 ? norm2(rescaled) / (2 * k_t) : 0;
  result.loss_friction =
      stored_before - stored_rescaled - 0.5 * dot(last - rescaled, step) - 0.5 * dot(rescaled + spring, slip);
  result.loss_damping =
      ((elastic_force - normal_force) * separation_speed + share * c_t * norm2(tangential_velocity)) * motion.time_step;
  history = {spring, k_t};
  return result;
}

/// Largest rolling resistance of one contact on one grain, e_c |F_n| [N m], e_c = eta_r R* (eqs. 5.2, 5.3; walls: R* =
/// R_i). rolling.hpp sums it over the contacts of a grain.
TRACKBED_HD inline double rolling_resistance_limit(const PairParameters& pair, const ContactGeometry& geometry,
                                                   double normal_force) {
  return pair.rolling_friction * geometry.effective_radius * normal_force;
}

}  // namespace dem::kernels
