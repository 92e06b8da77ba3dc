#pragma once
// Velocity Verlet as one pass per step: the second half of the step that ends and the first half of the next.
//   v = hold (v_half + e a_free),  hold = 1 / (1 + alpha e),  a = a_free - alpha v,  a_free = F / m + g
//   v_half = v + s a,  x += dt v_half,  v_seen = v_half + s a        e, s: half a step, or 0 where a run ends or starts
// Rotation likewise, without an orientation: spheres. v_seen is what contacts see at the new positions: the velocity of
// that instant but for the change of the acceleration within the step. Source: Irazabal2017 3.44-3.53. The artificial
// damping alpha [1/s] (for relaxation) is taken implicitly, so that it never drives a grain whatever alpha.
//
// Symplectic Euler in the same pass: nothing of a step's impulse is given at its end and all of it at its start; the
// velocity of the instant is that of the step before it, and contacts see it. Source: Irazabal2017 3.36-3.39. Its
// energy ledger closes to first order in the step only.
//
// Rows between two calls of advance(): `state` has the velocities of the instant, `pull` the accelerations. Within one:
// `state` has v_half, `pull` the forces of the contacts.
#include "dem/core/rows.hpp"
#include "dem/kernels/rolling.hpp"

namespace dem::TRACKBED_DEM_SYSTEM {

/// What the contacts ask of one grain.
struct Pull {
  Vec3 force, torque;  // [N], [N m]
  double rolling = 0;  // [N m] resistance limit
};

struct Integrator {
  Place* place;
  Rows<Quad> state;   // .number: inverse mass, inverse inertia
  Rows<Quad> motion;  // velocities seen by contacts
  Rows<Quad> pull;
  const int* wall_slot;  // null: no walls; -1: none near this grain
  const WallSum* wall_sum;
  GrainLedger* ledger;  // null: nothing of it in use
  Vec3 gravity;
  double alpha;                         // [1/s]
  bool rolling;                         // some pair of materials resists rolling
  double dt;                            // [s] step of the run
  double at_start = 0.5, at_end = 0.5;  // shares of a step's impulse that the forces at its start and end give

  /// Impulse [N s] per force [N] with which a step starts.
  TRACKBED_HD double kick() const { return at_start * dt / (1 + alpha * (at_start - at_end) * dt); }

  /// Takes the forces at the end of a step (ended = dt; 0 for the forces at the start of a run): afterwards `state` has
  /// the velocities of the instant, and the accelerations are in `p`.
  TRACKBED_HD void end_step(int g, double ended, Pull& p) const {
    add_walls(g, p);
    const double half = at_end * ended, hold = 1 / (1 + alpha * half);
    Quad t = state.translation(g);
    const Vec3 free = t.number * p.force + gravity;
    t.vector = hold * (t.vector + half * free);
    state.translation(g) = t;
    p.force = free - alpha * t.vector;
    GrainLedger lost;
    if (ledger && alpha > 0) lost.loss_damping = alpha * ended / t.number * norm2(t.vector);
    if (state.parts == 2) turn(g, ended, half, hold, p, lost);
    if (ledger) {
      ledger[g].loss_damping += lost.loss_damping;
      ledger[g].loss_rolling += lost.loss_rolling;
    }
  }

  TRACKBED_HD void add_walls(int g, Pull& p) const {
    if (!wall_slot || wall_slot[g] < 0) return;
    const WallSum w = wall_sum[wall_slot[g]];
    p.force += w.force;
    p.torque += w.torque;
    p.rolling += w.rolling;
  }

  TRACKBED_HD void turn(int g, double ended, double half, double hold, Pull& p, GrainLedger& lost) const {
    Quad r = state.rotation(g);
    Vec3 braking;
    if (rolling && p.rolling > 0) {
      braking = kernels::bounded_rolling_friction({r.vector, p.torque, 1 / r.number, p.rolling, dt}).torque;
      p.torque += braking;
    }
    const Vec3 free = r.number * p.torque;
    r.vector = hold * (r.vector + half * free);
    state.rotation(g) = r;
    p.torque = free - alpha * r.vector;
    if (!ledger) return;
    lost.loss_rolling = -ended * dot(braking, r.vector);
    if (alpha > 0) lost.loss_damping += alpha * ended / r.number * norm2(r.vector);
  }

  /// Starts a step with the accelerations in `p`. False when the state is not finite.
  TRACKBED_HD bool begin_step(int g, const Pull& p) const {
    Quad t = state.translation(g);
    const double first = kick(), last = at_end * dt;
    t.vector += first * p.force;
    state.translation(g) = t;
    Place at = place[g];
    at.position += dt * t.vector;
    place[g] = at;
    motion.translation(g).vector = t.vector + last * p.force;
    if (state.parts == 1) return true;
    Quad r = state.rotation(g);
    r.vector += first * p.torque;
    state.rotation(g) = r;
    motion.rotation(g).vector = r.vector + last * p.torque;
    return norm2(r.vector) < 1e200;
  }

  TRACKBED_HD Pull read(int g) const {
    Pull p;
    const Quad t = pull.translation(g);
    p.force = t.vector;
    p.rolling = t.number;
    if (pull.parts == 2) p.torque = pull.rotation(g).vector;
    return p;
  }
  TRACKBED_HD void write(int g, const Pull& p) const {
    pull.translation(g) = {p.force, 0};
    if (pull.parts == 2) pull.rotation(g) = {p.torque, 0};
  }
};

/// What one call does.
struct Phase {
  bool ends;     // `pull` holds forces: take them; otherwise it holds accelerations
  double ended;  // [s] the step that they end; 0: the start of a run
  bool begins;   // start the next step; otherwise leave the accelerations in `pull`
};

/// Forces already summed per grain (the sweep does that).
struct SummedForces {
  TRACKBED_HD void add(int, Pull&) const {}
};

/// Sums the forces of a grain's contacts in a fixed order, in double.
template <class Real>
struct GatheredForces {
  const Place* place;
  const int *own_start, *other_start, *other;  // contacts in which the grain is i: a range; is j: listed in `other`
  const PairForce<Real>* pair_force;
  const Vector3<Real>* couple;  // null: none

  TRACKBED_HD void add(int g, Pull& p) const {
    const double radius = place[g].radius;
    for (int c = own_start[g]; c < own_start[g + 1]; ++c) {
      const PairForce<Real> f = pair_force[c];
      p.force += as<double>(f.force);
      p.torque -= (radius - f.half_overlap) * as<double>(f.moment);
      if (couple) p.torque += as<double>(couple[c]);
      p.rolling += f.rolling;
    }
    for (int k = other_start[g]; k < other_start[g + 1]; ++k) {
      const PairForce<Real> f = pair_force[other[k]];
      p.force -= as<double>(f.force);
      p.torque -= (radius - f.half_overlap) * as<double>(f.moment);
      if (couple) p.torque -= as<double>(couple[other[k]]);
      p.rolling += f.rolling;
    }
  }
};

/// Returns the squared displacement since the neighbour list was built, infinite when the state is not finite.
template <class Forces>
struct Leapfrog {
  Integrator integrator;
  Forces forces;
  const Vec3* listed;  // positions at which the list was built
  Phase phase;
  bool pulled;  // `pull` takes part in the forces; otherwise it holds accelerations only

  TRACKBED_FLATTEN TRACKBED_HD double operator()(int g) const { return pass(g, phase); }
  TRACKBED_HD double pass(int g, const Phase& phase) const {
    Pull p;
    if (pulled || !phase.ends) p = integrator.read(g);
    if (phase.ends) {
      forces.add(g, p);
      integrator.end_step(g, phase.ended, p);
    }
    if (!phase.begins) {
      integrator.write(g, p);
      return 0;
    }
    const bool finite = integrator.begin_step(g, p);
    if (pulled) integrator.write(g, {});
    const double squared = norm2(integrator.place[g].position - listed[g]);
    return finite && squared < 1e100 ? squared : HUGE_VAL;
  }
};

}  // namespace dem::TRACKBED_DEM_SYSTEM
