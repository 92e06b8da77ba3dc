#pragma once
// Forces between grains, one call per candidate pair: how a GPU does it. Everything a pair leaves behind goes to its
// own rows, so the pass needs no atomics and its result does not depend on the number of threads. Processors use the
// sweep (dem/sweep.hpp) instead; both call the same law.
#include "dem/core/rows.hpp"
#include "dem/laws.hpp"

namespace dem::TRACKBED_DEM_SYSTEM {

/// What two spheres are to each other, apart from their law. Real: what the law is computed in.
template <class Real>
struct Meeting {
  kernels::Touch<Real> touch;
  Real arm_i = 0, arm_j = 0;  // [m] from the centres to the contact point
  Vector3<Real> turning;      // [rad/s] angular velocity of i relative to j
  Real rolling_inertia = 0;   // [kg m2]
};

/// Rolling moment on i of the models that act in a contact.
template <bool Ledger, class Real>
TRACKBED_HD kernels::Moment<Real> resist_rolling(const kernels::PairParameters& pair, const Meeting<Real>& m,
                                                 Real normal_force, Real shear_stiffness, const kernels::Interval& time,
                                                 Real* numbers) {
  const kernels::RollingContact<Real> contact{m.turning, normal_force, shear_stiffness, m.rolling_inertia};
  if (pair.rolling == rolling_a) return kernels::RollingA::resist<Ledger>(pair, m.touch, contact, time, numbers);
  if (pair.rolling == rolling_c) return kernels::RollingC::resist<Ledger>(pair, m.touch, contact, time, numbers);
  return {};
}
/// How many numbers at the end of a row are the rolling model's, whatever the law.
TRACKBED_HD inline int rolling_numbers(bool ledger) { return kernels::RollingC::history + (ledger ? 1 : 0); }

struct PairGeometry {
  const Place* place;
  Rows<const Quad> motion;  // velocities of this instant and masses

  /// False when i and j are apart. Places and velocities are subtracted in double, wherever the pair is.
  template <class Real>
  TRACKBED_HD bool meet(int i, int j, Meeting<Real>& m) const {
    const Place a = place[i], b = place[j];
    const Vec3 between = a.position - b.position;
    const double both = a.radius + b.radius, squared = norm2(between), gap = both * both - squared;
    if (!(gap > 0)) return false;
    const Real radius_i = static_cast<Real>(a.radius), radius_j = static_cast<Real>(b.radius);
    const Real reach = static_cast<Real>(both), distance = kernels::square_root(static_cast<Real>(squared));
    if constexpr (std::is_same_v<Real, float>)
      m.touch.overlap = static_cast<float>(gap) / (reach + distance);  // without loss (dem/sweep_access.hpp)
    else
      m.touch.overlap = reach - distance;
    m.touch.normal = distance > 0 ? (1 / distance) * as<Real>(between) : Vector3<Real>{0, 0, 1};
    m.arm_i = radius_i - Real(0.5) * m.touch.overlap;
    m.arm_j = radius_j - Real(0.5) * m.touch.overlap;
    const Quad &ti = motion.translation(i), &tj = motion.translation(j);
    const Real mass_i = static_cast<Real>(ti.number), mass_j = static_cast<Real>(tj.number);
    m.touch.velocity = as<Real>(ti.vector - tj.vector);
    if (motion.parts == 2) {
      const Vec3 &wi = motion.rotation(i).vector, &wj = motion.rotation(j).vector;
      m.touch.velocity -= cross(m.arm_i * as<Real>(wi) + m.arm_j * as<Real>(wj), m.touch.normal);
      m.turning = as<Real>(wi - wj);
      m.rolling_inertia = kernels::rolling_inertia(mass_i, radius_i, mass_j, radius_j);
    }
    m.touch.effective_radius = radius_i * radius_j / reach;
    m.touch.effective_mass = mass_i * mass_j / (mass_i + mass_j);
    return true;
  }
};

/// In mixed precision Real is float: the law, the numbers that a pair keeps and its result. Sums over pairs, those of
/// the ledger among them, stay double.
template <class Law, class Real>
struct ContactPass {
  PairGeometry geometry;
  const int *first, *second;  // rows
  const int* pair;            // index into parameters; null: one material
  const kernels::PairParameters* parameters;
  Real* history;  // history_stride numbers per pair
  int history_stride;
  PairForce<Real>* result;
  Vector3<Real>* couple;  // [N m] on i besides its force's; null: no model makes one
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
    Meeting<Real> meeting;
    if (!geometry.meet(i, j, meeting)) {
      if (result[c].half_overlap > 0) leave<Ledger>(c);
      return;
    }
    const auto& touch = meeting.touch;
    const double smaller = std::fmin(geometry.place[i].radius, geometry.place[j].radius);
    if (touch.overlap > maximum_overlap * smaller) *unstable = overlap_too_large;
    const kernels::PairParameters& material = parameters[pair ? pair[c] : 0];
    Real local[maximum_numbers] = {};
    for (int k = 0; k < history_stride; ++k) local[k] = history[c * history_stride + k];
    const auto contact = Law::template press<Ledger>(material, touch, time, local);
    kernels::Moment<Real> turned;
    if (couple) {
      Real* numbers = local + history_stride - rolling_numbers(Ledger);
      const Real k_t = shear_stiffness_of(material, local);
      turned = resist_rolling<Ledger>(material, meeting, contact.normal_force, k_t, time, numbers);
      couple[c] = turned.moment;
    }
    for (int k = 0; k < history_stride; ++k) history[c * history_stride + k] = local[k];

    PairForce<Real>& row = result[c];
    row.force = contact.force;
    row.rolling =
        material.rolling == rolling_brof ? Real(material.rolling_friction * smaller) * contact.normal_force : Real{};
    row.moment = cross(touch.normal, contact.force);
    row.half_overlap = Real(0.5) * touch.overlap;
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
      Real local[maximum_numbers] = {};
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
