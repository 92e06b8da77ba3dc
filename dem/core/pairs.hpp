#pragma once
// The list of candidate pairs with everything that belongs to a pair.
#include "dem/core/contact_pass.hpp"
#include "dem/core/grains.hpp"
#include "dem/core/pair_search.hpp"

namespace dem::TRACKBED_DEM_SYSTEM {

struct PairColumns {
  Vector<int> own_start, other_start, other;  // per grain
  Vector<int> first, second;                  // per pair
  Vector<int> second_row;                     // image that stands for the second; empty: no periods
  Vector<int> pair;                           // empty: one material
  Vector<double> history;                     // history_stride numbers per pair
  int history_stride = 0;
  Vector<PairForce> result;
  Vector<Vec3> couple;           // empty: none
  Vector<ContactLedger> ledger;  // empty: not tracked

  int size() const { return static_cast<int>(second.size()); }
  std::size_t bytes() const {
    return bytes_of(own_start) + bytes_of(other_start) + bytes_of(other) + bytes_of(first) + bytes_of(second) +
           bytes_of(second_row) + bytes_of(pair) + bytes_of(history) + bytes_of(result) + bytes_of(couple) +
           bytes_of(ledger);
  }
};

struct PairOptions {
  int materials = 1;
  int history = 4;                                      // numbers per pair
  const kernels::PairParameters* parameters = nullptr;  // on the backend, materials × materials
  bool couples = false;                                 // some rolling model acts in the contact
  bool ledger = true;
  ImageRows images{};
};

/// The row of the second grain that a pair reads.
struct FindImages {
  Periods periods;
  ImageRows images;
  const Place* place;
  const int *first, *second;
  int* row;
  TRACKBED_HD void operator()(int c) const {
    row[c] = images.row(second[c], periods.nearest(place[first[c]].position - place[second[c]].position));
  }
};

/// A new list for grains sorted by bucket; histories come from `old`, whose numbering grains.old_of_new refers to.
inline PairColumns build_pairs(const Grains& grains, const PairSearch& search, const PairColumns& old,
                               const PairOptions& options) {
  const int n = grains.size();
  PairColumns list;
  list.own_start.resize(n);
  list.other_start.resize(n);
  launch(n, CountPairs{search, pointer(list.own_start), pointer(list.other_start)});
  const int pairs = counts_to_starts(list.own_start);
  counts_to_starts(list.other_start);
  list.first.resize(pairs);
  list.second.resize(pairs);
  list.other.resize(pairs);
  const int *own_start = pointer(list.own_start), *other_start = pointer(list.other_start);
  launch(n, FillPairs{search, own_start, other_start, pointer(list.first), pointer(list.second), pointer(list.other)});
  launch(n, LinkOthers{own_start, pointer(list.second), other_start, pointer(list.other)});

  if (search.periods.any()) {
    list.second_row.resize(pairs);
    launch(pairs, FindImages{search.periods, options.images, pointer(grains.place), pointer(list.first),
                             pointer(list.second), pointer(list.second_row)});
  }
  list.result.resize(pairs);
  if (options.couples) list.couple.resize(pairs);
  if (options.materials > 1) list.pair.resize(pairs);
  list.history_stride = options.history;
  list.history.resize(static_cast<std::size_t>(pairs) * options.history);
  if (options.ledger) list.ledger.resize(pairs);
  launch(pairs, CarryPairs{.first = pointer(list.first),
                           .second = pointer(list.second),
                           .material = pointer(grains.material),
                           .materials = options.materials,
                           .pair = pointer(list.pair),
                           .old_of_new = pointer(grains.old_of_new),
                           .old_start = pointer(old.own_start),
                           .old_second = pointer(old.second),
                           .old_rows = static_cast<int>(old.own_start.size()) - 1,
                           .old_history = pointer(old.history),
                           .history = pointer(list.history),
                           .old_stride = old.history_stride,
                           .stride = list.history_stride,
                           .parameters = options.parameters,
                           .old_ledger = pointer(old.ledger),
                           .ledger = pointer(list.ledger),
                           .old_result = pointer(old.result),
                           .result = pointer(list.result)});
  return list;
}

}  // namespace dem::TRACKBED_DEM_SYSTEM
