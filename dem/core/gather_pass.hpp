#pragma once
// Second half of velocity Verlet: every grain gathers the forces of its contacts in a fixed order.
//   m a = sum F + m g - alpha m v,   I domega/dt = sum T + T_rolling - alpha I omega,   v = v_half + dt/2 a
// The artificial damping (alpha [1/s], for relaxation) is taken implicitly, v (1 + alpha dt/2) = v_half + dt/2 (a +
// alpha v), so that it never drives a grain whatever alpha.
#include "dem/core/rows.hpp"
#include "dem/kernels/rolling.hpp"

namespace dem::TRACKBED_DEM_SYSTEM {

struct GatherPass {
  const Place* place;
  Translation* translation;
  Rotation* rotation;                          // null: no rotation
  const int *own_start, *other_start, *other;  // contacts in which the grain is i: a range; is j: listed in `other`
  const PairForce* pair_force;
  const int* wall_slot;  // null: no walls; -1: none near this grain
  const WallSum* wall_sum;
  GrainLedger* ledger;  // null: nothing of it in use
  Vec3 gravity;
  double alpha;    // [1/s]
  bool rolling;    // some pair of materials resists rolling
  double dt;       // [s] step of the run
  double advance;  // [s] dt, or 0 when only the forces at the start are wanted

  TRACKBED_HD void operator()(int g) const {
    Vec3 force, torque;
    double resistance = 0;
    const double radius = place[g].radius;
    for (int c = own_start[g]; c < own_start[g + 1]; ++c) {
      const PairForce& p = pair_force[c];
      force += p.force;
      torque -= (radius - p.half_overlap) * p.moment;
      resistance += p.rolling;
    }
    for (int k = other_start[g]; k < other_start[g + 1]; ++k) {
      const PairForce& p = pair_force[other[k]];
      force -= p.force;
      torque -= (radius - p.half_overlap) * p.moment;
      resistance += p.rolling;
    }
    if (wall_slot && wall_slot[g] >= 0) {
      const WallSum& w = wall_sum[wall_slot[g]];
      force += w.force;
      torque += w.torque;
      resistance += w.rolling;
    }
    const double hold = 1 / (1 + 0.5 * alpha * advance);
    GrainLedger lost;
    Translation& t = translation[g];
    const Vec3 free = t.inverse_mass * force + gravity;
    const Vec3 velocity = hold * (t.velocity + (0.5 * advance) * free);
    t.acceleration = free - alpha * velocity;
    t.velocity = velocity;
    lost.loss_damping = alpha * t.mass * norm2(velocity) * advance;
    if (rotation) turn(rotation[g], torque, resistance, hold, lost);
    if (ledger) {
      ledger[g].loss_damping += lost.loss_damping;
      ledger[g].loss_rolling += lost.loss_rolling;
    }
  }

  TRACKBED_HD void turn(Rotation& r, Vec3 torque, double resistance, double hold, GrainLedger& lost) const {
    Vec3 braking;
    if (rolling && resistance > 0) {
      braking = kernels::bounded_rolling_friction({r.velocity, torque, r.inertia, resistance, dt}).torque;
      torque += braking;
    }
    const Vec3 free = r.inverse_inertia * torque;
    r.velocity = hold * (r.velocity + (0.5 * advance) * free);
    r.acceleration = free - alpha * r.velocity;
    lost.loss_rolling -= dot(braking, r.velocity) * advance;
    lost.loss_damping += alpha * r.inertia * norm2(r.velocity) * advance;
  }
};

}  // namespace dem::TRACKBED_DEM_SYSTEM
