#pragma once
// Forces between grains, one call per candidate pair: how a GPU does it. Everything a pair leaves behind goes to its
// own rows, so the pass needs no atomics and its result does not depend on the number of threads. Processors use the
// sweep (dem/sweep.hpp) instead; both call the same law.
#include "dem/core/rows.hpp"
#include "dem/laws.hpp"

namespace dem::TRACKBED_DEM_SYSTEM {

/// What two spheres are to each other, apart from their law.
struct Meeting {
  kernels::Touch<double> touch;
  double arm_i = 0, arm_j = 0;  // [m] from the centres to the contact point
  Vec3 turning;                 // [rad/s] angular velocity of i relative to j
  double rolling_inertia = 0;   // [kg m2]
};

/// Rolling moment on i of the models that act in a contact.
template <bool Ledger>
TRACKBED_HD kernels::Moment<double> resist_rolling(const kernels::PairParameters& pair, const Meeting& m,
                                                   double normal_force, double shear_stiffness,
                                                   const kernels::Interval& time, double* numbers) {
  const kernels::RollingContact<double> contact{m.turning, normal_force, shear_stiffness, m.rolling_inertia};
  if (pair.rolling == rolling_a) return kernels::RollingA::resist<Ledger>(pair, m.touch, contact, time, numbers);
  if (pair.rolling == rolling_c) return kernels::RollingC::resist<Ledger>(pair, m.touch, contact, time, numbers);
  return {};
}
/// How many numbers at the end of a row are the rolling model's, whatever the law.
TRACKBED_HD inline int rolling_numbers(bool ledger) { return kernels::RollingC::history + (ledger ? 1 : 0); }

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
    if (motion.parts == 2) {
      const Vec3 &wi = motion.rotation(i).vector, &wj = motion.rotation(j).vector;
      m.touch.velocity -= cross(m.arm_i * wi + m.arm_j * wj, m.touch.normal);
      m.turning = wi - wj;
      m.rolling_inertia = kernels::rolling_inertia(ti.number, a.radius, tj.number, b.radius);
    }
    m.touch.effective_radius = a.radius * b.radius / reach;
    m.touch.effective_mass = ti.number * tj.number / (ti.number + tj.number);
    return true;
  }
};

template <class Law>
struct ContactPass {
  PairGeometry geometry;
  const int *first, *second;  // rows
  const int* pair;            // index into parameters; null: one material
  const kernels::PairParameters* parameters;
  double* history;  // history_stride numbers per pair
  int history_stride;
  PairForce* result;
  Vec3* couple;           // [N m] on i besides its force's; null: no model makes one
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
  TRACKBED_ONE_FUNCTION TRACKBED_HD void press(int c) const {
    const int i = first[c], j = second[c];
    Meeting meeting;
    if (!geometry.meet(i, j, meeting)) {
      if (result[c].half_overlap > 0) leave<Ledger>(c);
      return;
    }
    const auto& touch = meeting.touch;
    const double smaller = std::fmin(geometry.place[i].radius, geometry.place[j].radius);
    if (touch.overlap > maximum_overlap * smaller) *unstable = overlap_too_large;
    const kernels::PairParameters& material = parameters[pair ? pair[c] : 0];
    double local[maximum_numbers] = {};
    for (int k = 0; k < history_stride; ++k) local[k] = history[c * history_stride + k];
    const auto contact = Law::template press<Ledger>(material, touch, time, local);
    kernels::Moment<double> turned;
    if (couple) {
      double* numbers = local + history_stride - rolling_numbers(Ledger);
      const double k_t = shear_stiffness_of(material, local);
      turned = resist_rolling<Ledger>(material, meeting, contact.normal_force, k_t, time, numbers);
      couple[c] = turned.moment;
    }
    for (int k = 0; k < history_stride; ++k) history[c * history_stride + k] = local[k];

    PairForce& row = result[c];
    row.force = contact.force;
    row.rolling = material.rolling == rolling_brof ? material.rolling_friction * smaller * contact.normal_force : 0;
    row.moment = cross(touch.normal, contact.force);
    row.half_overlap = 0.5 * touch.overlap;
    if constexpr (Ledger) {
      ContactLedger& l = ledger[c];
      l.loss_friction += contact.loss_friction;
      l.loss_damping += contact.loss_damping;
      l.elastic_normal = contact.elastic_normal;
      l.elastic_shear = contact.elastic_shear + turned.elastic;
      l.loss_rolling += turned.loss;
    }
  }

  /// The pair has come apart: its springs let go of what they stored.
  template <bool Ledger>
  TRACKBED_ONE_FUNCTION TRACKBED_HD void leave(int c) const {
    result[c] = {};
    if (couple) couple[c] = {};
    if constexpr (Ledger) {
      double local[maximum_numbers] = {};
      for (int k = 0; k < history_stride; ++k) local[k] = history[c * history_stride + k];
      const kernels::PairParameters& material = parameters[pair ? pair[c] : 0];
      ledger[c].loss_friction += Law::template press<true>(material, {}, time, local).loss_friction;
      if (couple) ledger[c].loss_rolling += local[history_stride - 1];
      ledger[c].elastic_normal = 0;
      ledger[c].elastic_shear = 0;
    }
    for (int k = 0; k < history_stride; ++k) history[c * history_stride + k] = 0;
  }
};

}  // namespace dem::TRACKBED_DEM_SYSTEM
