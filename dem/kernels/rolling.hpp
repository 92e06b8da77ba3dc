#pragma once
// Bounded rolling friction (BROF): per grain, a torque against its rotation, never more than what stops the rotation
// within one step, so that a grain at rest stays at rest instead of trembling.
//
//   T_stop = -(I omega / dt + sum of the contact torques)
//   T_r    = T_stop                                     if |T_stop| <= sum e_c |F_n|
//          = T_stop / |T_stop| * sum e_c |F_n|          otherwise,          e_c = eta_r min(R_i, R_j)
// Source: Irazabal Gonzalez 2017 (PhD thesis, UPC Barcelona), eqs. 5.2-5.5.
//
// Where we differ from the source: 5.4 is printed as I omega dt, which is no torque (it must be I omega / dt), and with
// a sign that makes 5.5 drive the rotation in its second branch and brake it in its first; T_stop above brakes in both.
// e_c: 5.2, 5.3 print eta_r R_i R_j / (R_i + R_j), the arm of the classical model A; the thesis' own program (Kratos,
// DEM application) takes eta_r times the smaller radius, twice as much between equal grains. With the printed arm a
// heap at eta_r = 0.2 lies at 32 degrees, far from the 40 of Fig. 6.4: the figures were made with the smaller radius,
// so it is taken here. Against a wall both are eta_r R. omega is the velocity half a step ago, the one that the
// leapfrog step is about to change.
//
// Limits: BROF acts on each grain by its own rotation. It is not action = reaction for moments: the torque on i has no
// counterpart on j, so the angular momentum of a group of grains is not conserved by it.
#include "base/vec3.hpp"

namespace dem::kernels {
using base::Vec3;

struct RollingState {
  Vec3 angular_velocity;  // [rad/s] half a step ago
  Vec3 contact_torque;    // [N m] sum over the contacts, now
  double inertia;         // [kg m2] > 0
  double limit;           // [N m] sum of rolling_resistance_limit() over the contacts, now
  double time_step;       // [s] > 0
};

struct RollingResistance {
  Vec3 torque;  // [N m] to be added to the contact torque
  double loss;  // [J] in this step
};

/// Loss: -T_r . omega dt with omega at this instant, the mean of the half-step velocities before and after, which is
/// what the trapezoid work of velocity Verlet sums to (see shear.hpp).
TRACKBED_HD inline RollingResistance bounded_rolling_friction(const RollingState& state) {
  const Vec3 stop = -(state.inertia / state.time_step) * state.angular_velocity - state.contact_torque;
  const double needed = norm(stop);
  const Vec3 torque = needed > state.limit ? (state.limit / needed) * stop : stop;
  const Vec3 now = state.angular_velocity + (0.5 * state.time_step / state.inertia) * (state.contact_torque + torque);
  return {torque, -dot(torque, now) * state.time_step};
}

/// The same for a body whose inertia is a tensor: I omega is its angular momentum [kg m2/s]. Torque [N m] to be added.
TRACKBED_HD inline Vec3 bounded_rolling_torque(const Vec3& angular_momentum, const Vec3& contact_torque, double limit,
                                               double time_step) {
  const Vec3 stop = -(1 / time_step) * angular_momentum - contact_torque;
  const double needed = norm(stop);
  return needed > limit ? (limit / needed) * stop : stop;
}

}  // namespace dem::kernels
