#pragma once
// Bonds on the backend. A bond names its grains by id and keeps its own row for good; where the grains are numbered
// anew, it looks them up. Each bond is computed once, into its own row; then every bonded grain adds up its bonds in
// the order in which they were made: no atomics, and the same bits for any number of threads and any numbering.
// A scene without bonds has none of this.
#include <algorithm>

#include "dem/bond.hpp"
#include "dem/core/grains.hpp"
#include "dem/core/periodic.hpp"

namespace dem::TRACKBED_DEM_SYSTEM {

struct BondRow {
  kernels::BondParameters is;  // radius 0: no longer there
  kernels::BondState state;
  int broken = 0;
};
/// Force on i, torques of force and moment about the centres.
struct BondPull {
  Vec3 force, torque_i, torque_j;  // [N], [N m]
  Vec3 moment;                     // [N m] on i; for output
};
struct BondLedger {
  double elastic = 0, loss = 0;  // [J] stored now; since the last flush
};

struct BondPass {
  const Place* place;
  Rows<const Quad> state;  // velocities of the step that ends; of bodies where there are any
  const int* body;         // of each sphere; null: each is its own
  const int* end;          // two spheres per bond
  BondRow* row;
  BondPull* pull;
  BondLedger* ledger;  // null: not tracked
  double ended;        // [s] step that ends; 0: none does
  Periods periods;

  TRACKBED_FLATTEN TRACKBED_HD void operator()(int b) const {
    pull[b] = {};
    BondRow& bond = row[b];
    if (!(bond.is.radius > 0)) return;
    const int i = end[2 * b], j = end[2 * b + 1], of_i = body ? body[i] : i, of_j = body ? body[j] : j;
    const Vec3 between = periods.shortest(place[i].position - place[j].position);
    const double distance = norm(between);
    kernels::BondMotion motion;
    motion.overlap = place[i].radius + place[j].radius - distance;
    motion.normal = distance > 0 ? (1 / distance) * between : bond.state.normal;
    motion.arm_i = place[i].radius - 0.5 * motion.overlap;
    motion.arm_j = place[j].radius - 0.5 * motion.overlap;
    motion.displacement = ended * (state.translation(of_i).vector - state.translation(of_j).vector);
    if (state.parts == 2) {
      motion.turn_i = ended * state.rotation(of_i).vector;
      motion.turn_j = ended * state.rotation(of_j).vector;
    }
    const auto answer = kernels::ParallelBond::press(bond.is, motion, bond.state);
    if (!answer.holds) {
      bond.broken = 1;
      bond.is.radius = 0;
    }
    const Vec3 turning = cross(motion.normal, answer.force);
    pull[b] = {answer.force, answer.moment - motion.arm_i * turning, -answer.moment - motion.arm_j * turning,
               answer.moment};
    if (ledger) {
      ledger[b].elastic = answer.elastic;
      ledger[b].loss += answer.loss;
    }
  }
};

/// Adds to the pulls of a grain what its bonds ask; called for every end of a bond, acts for a grain's first.
struct GatherBonds {
  const int *grain, *entry;  // ends by grain: the grain, 2 bond + side
  int ends;
  const BondPull* from;
  Rows<Quad> pull;

  TRACKBED_HD void operator()(int e) const {
    const int g = grain[e];
    if (g < 0 || (e > 0 && grain[e - 1] == g)) return;
    Vec3 force, torque;
    for (int k = e; k < ends && grain[k] == g; ++k) {
      const BondPull& p = from[entry[k] / 2];
      const bool is_j = entry[k] % 2;
      force += is_j ? -p.force : p.force;
      torque += is_j ? p.torque_j : p.torque_i;
    }
    pull.translation(g).vector += force;
    if (pull.parts == 2) pull.rotation(g).vector += torque;
  }
};

/// From where the ids lie among the sorted ones to the grains; a bond whose grain is gone is gone.
struct FindEnds {
  const std::int64_t *id, *sorted;
  const int* order;
  int grains;
  const int* at;  // first of the sorted ids not below the end's
  int *end, *grain;
  BondRow* row;
  BondLedger* ledger;

  TRACKBED_HD void operator()(int b) const {
    bool there = row[b].is.radius > 0;
    for (int e = 2 * b; e < 2 * b + 2; ++e) {
      const bool found = at[e] < grains && sorted[at[e]] == id[e];
      there = there && found;
      end[e] = found ? order[at[e]] : -1;
    }
    for (int e = 2 * b; e < 2 * b + 2; ++e) grain[e] = there ? end[e] : -1;
    if (there) return;
    row[b].is.radius = 0;
    if (ledger) ledger[b].elastic = 0;
  }
};

struct SumBonds {  // elastic, loss
  const BondLedger* ledger;
  TRACKBED_HD void operator()(int b, Sums<2>& s) const {
    s.value[0] += ledger[b].elastic;
    s.value[1] += ledger[b].loss;
  }
};
struct ClearBondLosses {
  BondLedger* ledger;
  TRACKBED_HD void operator()(int b) const { ledger[b].loss = 0; }
};
struct IsBroken {
  const BondRow* row;
  TRACKBED_HD int operator()(int b) const { return row[b].broken; }
};

struct Bonds {
  Vector<std::int64_t> id;   // two per bond
  Vector<int> end;           // spheres, two per bond
  Vector<int> grain, entry;  // ends by grain
  Vector<BondRow> row;
  Vector<BondPull> pull;
  Vector<BondLedger> ledger;  // empty: not tracked

  int size() const { return static_cast<int>(row.size()); }
  bool any() const { return !row.empty(); }

  void add(const std::vector<std::int64_t>& ids, const std::vector<BondRow>& rows, bool track_energy) {
    append(id, ids);
    append(row, rows);
    append(pull, std::vector<BondPull>(rows.size()));
    if (track_energy) append(ledger, std::vector<BondLedger>(rows.size()));
  }

  /// Finds the grains after they have been numbered anew.
  void find(const Grains& grains) {
    Vector<std::int64_t> sorted = grains.id;
    Vector<int> order(grains.size()), at(id.size());
    thrust::sequence(policy(), order.begin(), order.end());
    thrust::stable_sort_by_key(policy(), sorted.begin(), sorted.end(), order.begin());
    thrust::lower_bound(policy(), sorted.begin(), sorted.end(), id.begin(), id.end(), at.begin());
    end.resize(id.size());
    grain.resize(id.size());
    entry.resize(id.size());
    launch(size(), FindEnds{pointer(id), pointer(sorted), pointer(order), grains.size(), pointer(at), pointer(end),
                            pointer(grain), pointer(row), pointer(ledger)});
    thrust::sequence(policy(), entry.begin(), entry.end());
    thrust::stable_sort_by_key(policy(), grain.begin(), grain.end(), entry.begin());
  }

  /// Forces at the present positions, added to the grains' pulls; each pass is started by launch(n, functor).
  template <class Launch>
  void press(const Launch& launch, Grains& grains, const Rows<const Quad>& state, const Vector<int>& body_of_sphere,
             double ended, const Periods& periods) {
    launch(size(), BondPass{pointer(grains.place), state, pointer(body_of_sphere), pointer(end), pointer(row),
                            pointer(pull), pointer(ledger), ended, periods});
    launch(static_cast<int>(entry.size()),
           GatherBonds{pointer(grain), pointer(entry), static_cast<int>(entry.size()), pointer(pull), grains.pulls()});
  }

  Sums<2> energies() const { return ordered_sum<2>(static_cast<int>(ledger.size()), SumBonds{pointer(ledger)}); }
  void clear_losses() { launch(static_cast<int>(ledger.size()), ClearBondLosses{pointer(ledger)}); }
  int broken() const { return reduce(size(), IsBroken{pointer(row)}, 0, thrust::plus<int>()); }

  std::size_t bytes() const {
    return bytes_of(id) + bytes_of(end) + bytes_of(grain) + bytes_of(entry) + bytes_of(row) + bytes_of(pull) +
           bytes_of(ledger);
  }
};

}  // namespace dem::TRACKBED_DEM_SYSTEM
