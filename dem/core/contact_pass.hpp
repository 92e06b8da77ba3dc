#pragma once
// Forces between grains, one call per candidate pair: how a GPU does it. Everything a pair leaves behind goes to its
// own rows, so the pass needs no atomics and its result does not depend on the number of threads. Processors use the
// sweep (dem/sweep.hpp) instead; both call the same law.
#include "dem/core/rows.hpp"
#include "dem/kernels/touch.hpp"

namespace dem::TRACKBED_DEM_SYSTEM {

/// What two spheres are to each other, apart from their law.
struct Meeting {
  kernels::Touch<double> touch;
  double arm_i = 0, arm_j = 0;  // [m] from the centres to the contact point
};

struct PairGeometry {
  const Place* place;
  Rows<const Quad> motion;  // velocities of this instant and masses

  /// False when i and j are apart.
  TRACKBED_HD bool meet(int i, int j, Meeting& m) const {
    const Place a = place[i], b = place[j];
    const Vec3 between = a.position - b.position;
    const double reach = a.radius + b.radius, squared = norm2(between);
    if (!(squared < reach * reach)) return false;
    const double distance = std::sqrt(squared);
    m.touch.overlap = reach - distance;
    m.touch.normal = distance > 0 ? (1 / distance) * between : Vec3{0, 0, 1};
    m.arm_i = a.radius - 0.5 * m.touch.overlap;
    m.arm_j = b.radius - 0.5 * m.touch.overlap;
    const Quad &ti = motion.translation(i), &tj = motion.translation(j);
    m.touch.velocity = ti.vector - tj.vector;
    if (motion.parts == 2)
      m.touch.velocity -=
          cross(m.arm_i * motion.rotation(i).vector + m.arm_j * motion.rotation(j).vector, m.touch.normal);
    m.touch.effective_radius = a.radius * b.radius / reach;
    m.touch.effective_mass = ti.number * tj.number / (ti.number + tj.number);
    return true;
  }
};

template <class Law>
struct ContactPass {
  PairGeometry geometry;
  const int *first, *second;
  const int* pair;  // index into parameters; null: one material
  const kernels::PairParameters* parameters;
  double* history;  // history_stride numbers per pair
  int history_stride;
  PairForce* result;
  ContactLedger* ledger;  // null: not tracked
  int* unstable;
  double maximum_overlap;  // share of the smaller radius
  kernels::Interval time;

  TRACKBED_FLATTEN TRACKBED_HD void operator()(int c) const {
    if (ledger)
      press<true>(c);
    else
      press<false>(c);
  }

  template <bool Ledger>
  TRACKBED_HD void press(int c) const {
    const int i = first[c], j = second[c];
    Meeting meeting;
    if (!geometry.meet(i, j, meeting)) {
      if (result[c].half_overlap > 0) leave<Ledger>(c);
      return;
    }
    const auto& touch = meeting.touch;
    const double smaller = std::fmin(geometry.place[i].radius, geometry.place[j].radius);
    if (touch.overlap > maximum_overlap * smaller) *unstable = 1;
    const kernels::PairParameters& material = parameters[pair ? pair[c] : 0];
    double local[Law::history + 1] = {};
    for (int k = 0; k < history_stride; ++k) local[k] = history[c * history_stride + k];
    const auto contact = Law::template press<Ledger>(material, touch, time, local);
    for (int k = 0; k < history_stride; ++k) history[c * history_stride + k] = local[k];

    PairForce& row = result[c];
    row.force = contact.force;
    row.rolling = material.rolling_friction * touch.effective_radius * contact.normal_force;
    row.moment = cross(touch.normal, contact.force);
    row.half_overlap = 0.5 * touch.overlap;
    if constexpr (Ledger) {
      ContactLedger& l = ledger[c];
      l.loss_friction += contact.loss_friction;
      l.loss_damping += contact.loss_damping;
      l.elastic_normal = contact.elastic_normal;
      l.elastic_shear = contact.elastic_shear;
    }
  }

  /// The pair has come apart: its shear spring lets go of what it stored.
  template <bool Ledger>
  TRACKBED_HD void leave(int c) const {
    result[c] = {};
    if constexpr (Ledger) {
      ledger[c].loss_friction += history[c * history_stride + Law::history];
      ledger[c].elastic_normal = 0;
      ledger[c].elastic_shear = 0;
    }
    for (int k = 0; k < history_stride; ++k) history[c * history_stride + k] = 0;
  }
};

}  // namespace dem::TRACKBED_DEM_SYSTEM
