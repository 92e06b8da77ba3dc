#pragma once
// Forces between grains: one call per candidate pair. Everything a pair leaves behind goes to its own rows, so the pass
// needs no atomics and its result does not depend on the number of threads.
#include "dem/core/rows.hpp"

namespace dem::TRACKBED_DEM_SYSTEM {

struct ContactPass {
  const Place* place;
  const Translation* translation;
  const Rotation* rotation;  // null: no rotation
  const int *first, *second;
  const Reduced* reduced;
  const int* pair;  // index into parameters; null: one material
  const kernels::PairParameters* parameters;
  kernels::ContactHistory* history;  // null: no friction anywhere
  PairForce* result;
  ContactLedger* ledger;  // null: not tracked
  int* unstable;
  double maximum_overlap;  // share of the smaller radius
  double dt;               // [s] of the step that ends now; 0: forces at the start
  int number;              // of pairs

  TRACKBED_FLATTEN TRACKBED_HD void operator()(int c) const {
    fetch_ahead(c + 8);
    const int i = first[c], j = second[c];
    const Place a = place[i], b = place[j];
    const Vec3 between = a.position - b.position;
    const double reach = a.radius + b.radius, squared = norm2(between);
    if (!(squared < reach * reach)) {
      if (result[c].half_overlap > 0) leave(c);
      return;
    }
    const double distance = std::sqrt(squared);
    const double overlap = reach - distance;
    const double smaller = a.radius < b.radius ? a.radius : b.radius;
    if (overlap > maximum_overlap * smaller) *unstable = 1;
    const Vec3 normal = distance > 0 ? (1 / distance) * between : Vec3{0, 0, 1};

    kernels::ContactMotion motion;
    motion.time_step = dt;
    relative_motion(i, j, normal, a.radius - 0.5 * overlap, b.radius - 0.5 * overlap, motion);
    const kernels::PairParameters& material = parameters[pair ? pair[c] : 0];
    const kernels::ContactGeometry geometry{overlap, reduced[c].radius, reduced[c].mass, normal};
    kernels::ContactHistory none;
    const auto contact = kernels::hertz_mindlin(material, geometry, motion, history ? history[c] : none);

    PairForce& row = result[c];
    row.force = contact.force;
    row.rolling = kernels::rolling_resistance_limit(material, geometry, contact.normal_force);
    row.moment = cross(normal, contact.force);
    row.half_overlap = 0.5 * overlap;
    if (ledger) {
      ContactLedger& l = ledger[c];
      l.loss_friction += contact.loss_friction;
      l.loss_damping += contact.loss_damping;
      l.elastic_normal = contact.elastic_normal;
      l.elastic_shear = contact.elastic_shear;
    }
  }

  /// The partner's rows lie anywhere: a processor is told early which it will need; a GPU hides it with other threads.
  TRACKBED_HD void fetch_ahead([[maybe_unused]] int c) const {
#if !defined(__CUDACC__)
    if (c >= number) return;
    const int j = second[c];
    __builtin_prefetch(place + j);
    __builtin_prefetch(translation + j);
    if (rotation) __builtin_prefetch(rotation + j);
#endif
  }

  /// Of i relative to j at the contact point: the velocity at the end of the step (predicted from the last
  /// acceleration) and the displacement over the step (of the half-step velocity).
  TRACKBED_HD void relative_motion(int i, int j, const Vec3& normal, double arm_i, double arm_j,
                                   kernels::ContactMotion& motion) const {
    const Translation &ti = translation[i], &tj = translation[j];
    Vec3 half = ti.velocity - tj.velocity;
    Vec3 change = ti.acceleration - tj.acceleration;
    if (rotation) {
      const Rotation &ri = rotation[i], &rj = rotation[j];
      half -= cross(arm_i * ri.velocity + arm_j * rj.velocity, normal);
      change -= cross(arm_i * ri.acceleration + arm_j * rj.acceleration, normal);
    }
    motion.velocity = half + (0.5 * dt) * change;
    motion.displacement = dt * half;
  }

  /// The pair has come apart: its shear spring lets go of what it stored.
  TRACKBED_HD void leave(int c) const {
    result[c] = {};
    if (ledger) {
      if (history) {
        const auto& h = history[c];
        if (h.shear_stiffness > 0) ledger[c].loss_friction += norm2(h.shear_force) / (2 * h.shear_stiffness);
      }
      ledger[c].elastic_normal = 0;
      ledger[c].elastic_shear = 0;
    }
    if (history) history[c] = {};
  }
};

}  // namespace dem::TRACKBED_DEM_SYSTEM
