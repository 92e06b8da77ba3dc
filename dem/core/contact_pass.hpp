#pragma once
// Forces between grains, one call per candidate pair: how a GPU does it. Everything a pair leaves behind goes to its
// own rows, so the pass needs no atomics and its result does not depend on the number of threads. Processors use the
// sweep (dem/sweep.hpp) instead; both call the same law.
#include "dem/core/queue.hpp"
#include "dem/core/rows.hpp"
#include "dem/laws.hpp"

namespace dem::TRACKBED_DEM_SYSTEM {

/// What one contact keeps from step to step, out of its row in a column of such.
template <class Real, int numbers>
struct Kept {
  /// What is moved at once: 16 bytes, where rows are whole ones of these.
  static constexpr int together = numbers * sizeof(Real) % 16 == 0 && numbers > 0 ? 16 / sizeof(Real) : 1;
  struct alignas(together * sizeof(Real)) Piece {
    Real number[together];
  };
  Real number[numbers > 0 ? numbers : 1] = {};

  Kept() = default;
  TRACKBED_HD Kept(const Real* column, int c) {
    const auto* from = reinterpret_cast<const Piece*>(column + static_cast<std::size_t>(c) * numbers);
    for (int p = 0; p < numbers / together; ++p) {
      const Piece piece = from[p];
      for (int k = 0; k < together; ++k) number[p * together + k] = piece.number[k];
    }
  }
  TRACKBED_HD void write(Real* column, int c) const {
    auto* to = reinterpret_cast<Piece*>(column + static_cast<std::size_t>(c) * numbers);
    for (int p = 0; p < numbers / together; ++p) {
      Piece piece;
      for (int k = 0; k < together; ++k) piece.number[k] = number[p * together + k];
      to[p] = piece;
    }
  }
};

/// k_t [N/m] of a contact after press(): shear_stiffness_of(), where the law is known.
template <class Law, class Real, int numbers>
TRACKBED_HD Real shear_stiffness_after(const kernels::PairParameters& pair, const Kept<Real, numbers>& kept) {
  if constexpr (std::is_same_v<Law, AnyLaw>)
    return shear_stiffness_of(pair, kept.number);
  else if constexpr (Law::history > 0)
    return pair.law == smooth_law ? Real{} : kept.number[Law::history - 1];
  else
    return {};
}

/// What two spheres are to each other, apart from their law. Real: what the law is computed in.
template <class Real>
struct Meeting {
  kernels::Touch<Real> touch;
  Real arm_i = 0, arm_j = 0;  // [m] from the centres to the contact point
  Vector3<Real> turning;      // [rad/s] angular velocity of i relative to j
  double smaller = 0;         // [m] of the radii
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
    m.smaller = std::fmin(a.radius, b.radius);
    const Real radius_i = static_cast<Real>(a.radius), radius_j = static_cast<Real>(b.radius);
    const Real reach = static_cast<Real>(both), distance = kernels::square_root(static_cast<Real>(squared));
    if constexpr (std::is_same_v<Real, float>)
      m.touch.overlap = static_cast<float>(gap) / (reach + distance);  // without loss (dem/sweep_access.hpp)
    else
      m.touch.overlap = reach - distance;
    m.touch.normal = distance > 0 ? (1 / distance) * as<Real>(between) : Vector3<Real>{0, 0, 1};
    m.arm_i = radius_i - Real(0.5) * m.touch.overlap;
    m.arm_j = radius_j - Real(0.5) * m.touch.overlap;
    const Quad ti = motion.translation(i), tj = motion.translation(j);
    const Real mass_i = static_cast<Real>(ti.number), mass_j = static_cast<Real>(tj.number);
    m.touch.velocity = as<Real>(ti.vector - tj.vector);
    if (motion.parts == 2) {
      const Quad ri = motion.rotation(i), rj = motion.rotation(j);
      const Vec3 wi = ri.vector, wj = rj.vector;
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
/// the ledger among them, stay double. What a pair keeps is of a length that the compiler knows, so that it lies in
/// registers: Ledger: energies are tracked; Couples: some rolling model acts in the contact.
template <class Law, class Real, bool Ledger, bool Couples>
struct ContactPass {
  static constexpr int numbers = history_layout(Law::history, Ledger, Couples ? rolling_c : no_rolling).total;

  PairGeometry geometry;
  const int *first, *second;  // rows
  const int* pair;            // index into parameters; null: one material
  const kernels::PairParameters* parameters;
  Real* history;  // `numbers` of each pair
  PairForce<Real>* result;
  Vector3<Real>* couple;  // [N m] on i besides its force's; null: no model makes one
  ContactLedger* ledger;  // of group_size pairs each; null: not tracked
  const int* partner;     // as `second`, but never an image
  int first_ghost;        // the other half of a pair with a ghost counts elsewhere
  int* unstable;
  double maximum_overlap;  // share of the smaller radius
  kernels::Interval time;

  TRACKBED_FLATTEN TRACKBED_HD void operator()(int c) const {
    Sums<5> unused;
    press(c, unused);
  }
  /// Adds to loss_friction, loss_damping, elastic_normal, elastic_shear, loss_rolling.
  TRACKBED_FLATTEN TRACKBED_HD void operator()(int c, Sums<5>& noted) const { press(c, noted); }

  TRACKBED_HD void book(int group, const Sums<5>& noted) const {
    ContactLedger& l = ledger[group];
    l.loss_friction += noted.value[0];
    l.loss_damping += noted.value[1];
    l.elastic_normal = noted.value[2];
    l.elastic_shear = noted.value[3];
    l.loss_rolling += noted.value[4];
  }

 private:
  using Kept = dem::TRACKBED_DEM_SYSTEM::Kept<Real, numbers>;

  TRACKBED_HD double share(int c) const { return second[c] < first_ghost || partner[c] < first_ghost ? 1 : 0.5; }

  TRACKBED_HD void press(int c, Sums<5>& noted) const {
    const int i = first[c], j = second[c];
    Meeting<Real> meeting;
    if (!geometry.meet(i, j, meeting)) {
      if (result[c].half_overlap > 0) leave(c, noted);
      return;
    }
    const auto& touch = meeting.touch;
    const double smaller = meeting.smaller;
    if (touch.overlap > maximum_overlap * smaller) *unstable = overlap_too_large;
    const kernels::PairParameters& material = parameters[pair ? pair[c] : 0];
    Kept kept(history, c);
    const auto contact = Law::template press<Ledger>(material, touch, time, kept.number);
    kernels::Moment<Real> turned;
    if constexpr (Couples) {
      const Real k_t = shear_stiffness_after<Law>(material, kept);
      turned = resist_rolling<Ledger>(material, meeting, contact.normal_force, k_t, time,
                                      kept.number + numbers - rolling_numbers(Ledger));
      couple[c] = turned.moment;
    }
    kept.write(history, c);

    PairForce<Real> answer;
    answer.force = contact.force;
    if (material.rolling == rolling_brof)
      answer.rolling = Real(material.rolling_friction * smaller) * contact.normal_force;
    answer.moment = cross(touch.normal, contact.force);
    answer.half_overlap = Real(0.5) * touch.overlap;
    result[c] = answer;
    if constexpr (Ledger) {
      const double part = share(c);
      noted.value[0] += part * contact.loss_friction;
      noted.value[1] += part * contact.loss_damping;
      noted.value[2] += part * contact.elastic_normal;
      noted.value[3] += part * (contact.elastic_shear + turned.elastic);
      noted.value[4] += part * turned.loss;
    }
  }

  /// The pair has come apart: its springs let go of what they stored.
  TRACKBED_HD void leave(int c, Sums<5>& noted) const {
    result[c] = {};
    if constexpr (Couples) couple[c] = {};
    if constexpr (Ledger) {
      Kept kept(history, c);
      const kernels::PairParameters& material = parameters[pair ? pair[c] : 0];
      const double part = share(c);
      noted.value[0] += part * Law::template press<true>(material, {}, time, kept.number).loss_friction;
      if constexpr (Couples) noted.value[4] += part * kept.number[numbers - 1];
    }
    Kept{}.write(history, c);
  }
};

}  // namespace dem::TRACKBED_DEM_SYSTEM
