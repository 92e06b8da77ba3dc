#pragma once
// The list of candidate pairs with everything that belongs to a pair.
#include "dem/core/contact_pass.hpp"
#include "dem/core/grains.hpp"
#include "dem/core/pair_search.hpp"
#include "dem/dem.hpp"

namespace dem::TRACKBED_DEM_SYSTEM {

/// What the law leaves with the pairs, in the numbers that it is computed in.
template <class Real>
struct PairNumbers {
  Vector<Real> history;  // history_stride numbers per pair
  Vector<PairForce<Real>> result;
  Vector<Vector3<Real>> couple;  // empty: none

  std::size_t bytes() const { return bytes_of(history) + bytes_of(result) + bytes_of(couple); }
};

struct PairColumns {
  Vector<int> own_start, other_start, other;  // per grain
  Vector<int> first, second;                  // per pair
  Vector<int> second_row;                     // image that stands for the second; empty: no periods
  Vector<int> pair;                           // empty: one material
  int history_stride = 0;
  PairNumbers<double> full;      // the one or the other, by the precision
  PairNumbers<float> mixed;      //
  Vector<ContactLedger> ledger;  // of group_size pairs each; empty: not tracked

  template <class Real>
  PairNumbers<Real>& numbers() {
    if constexpr (std::is_same_v<Real, float>)
      return mixed;
    else
      return full;
  }
  template <class Real>
  const PairNumbers<Real>& numbers() const {
    return const_cast<PairColumns*>(this)->numbers<Real>();
  }

  int size() const { return static_cast<int>(second.size()); }
  std::size_t bytes() const {
    return bytes_of(own_start) + bytes_of(other_start) + bytes_of(other) + bytes_of(first) + bytes_of(second) +
           bytes_of(second_row) + bytes_of(pair) + full.bytes() + mixed.bytes() + bytes_of(ledger);
  }

  /// Leaves what a new list takes over: touching pairs, with their histories. So the columns of two whole lists never
  /// exist at the same time, and the memory that a run needs is that of its steps.
  template <class Real>
  void keep_touching() {
    auto& kept = numbers<Real>();
    release(other_start);
    release(second_row);
    release(pair);
    release(ledger);
    release(kept.couple);
    if (kept.result.empty()) return;  // done already
    Vector<int> staying;
    staying.swap(other);  // as long as the list
    launch(size(), IsTouching<Real>{pointer(kept.result), pointer(staying)});
    release(kept.result);
    thrust::inclusive_scan(policy(), staying.begin(), staying.end(), staying.begin());
    launch(static_cast<int>(own_start.size()), MoveStarts{pointer(staying), pointer(own_start)});
    const int left = staying.back();
    keep_staying(kept.history, staying, left, history_stride);
    keep_staying(first, staying, left);
    keep_staying(second, staying, left);
  }

  /// Host copy of the histories.
  std::vector<double> kept_numbers() const {
    if (mixed.history.empty()) return download(full.history);
    const auto kept = download(mixed.history);
    return {kept.begin(), kept.end()};
  }
  /// Puts histories back, in the precision that the list has.
  void keep_numbers(const std::vector<double>& kept) {
    if (mixed.history.empty())
      upload(kept, full.history);
    else
      upload(std::vector<float>(kept.begin(), kept.end()), mixed.history);
  }
};

/// Calls visit.operator()<Real>() with the numbers that contacts between grains are computed in.
template <class Visit>
decltype(auto) with_numbers(Precision precision, Visit&& visit) {
  if (precision == Precision::mixed) return visit.template operator()<float>();
  return visit.template operator()<double>();
}

template <class To, class From>
void convert(PairNumbers<From>& from, PairNumbers<To>& to) {
  const auto history = download(from.history);
  upload(std::vector<To>(history.begin(), history.end()), to.history);
  std::vector<PairForce<To>> results;
  for (const auto& r : download(from.result))
    results.push_back({as<To>(r.force), static_cast<To>(r.rolling), as<To>(r.moment), static_cast<To>(r.half_overlap)});
  upload(results, to.result);
  std::vector<Vector3<To>> couples;
  for (const auto& c : download(from.couple)) couples.push_back(as<To>(c));
  upload(couples, to.couple);
  from = {};
}
/// A list that was kept in another precision.
inline void convert(PairColumns& list, Precision precision) {
  if (precision == Precision::mixed && !list.full.result.empty()) convert(list.full, list.mixed);
  if (precision == Precision::full && !list.mixed.result.empty()) convert(list.mixed, list.full);
}

struct PairOptions {
  int materials = 1;
  int history = 4;                                      // numbers per pair
  const kernels::PairParameters* parameters = nullptr;  // on the backend, materials × materials
  bool couples = false;                                 // some rolling model acts in the contact
  bool ledger = true;
  Precision precision = Precision::full;
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

/// What the pairs of the new list had in the old one, which is gone after that.
template <class Real>
void carry_pairs(const Grains& grains, PairColumns& old, const PairOptions& options, PairColumns& list) {
  auto& numbers = list.numbers<Real>();
  const auto& had = old.numbers<Real>();
  const int pairs = list.size();
  Vector<char> touching(pairs);
  numbers.history.resize(static_cast<std::size_t>(pairs) * options.history);
  launch(pairs, CarryPairs<Real>{.first = pointer(list.first),
                                 .second = pointer(list.second),
                                 .material = pointer(grains.material),
                                 .materials = options.materials,
                                 .pair = pointer(list.pair),
                                 .old_of_new = pointer(grains.old_of_new),
                                 .old_start = pointer(old.own_start),
                                 .old_second = pointer(old.second),
                                 .old_rows = static_cast<int>(old.own_start.size()) - 1,
                                 .old_history = pointer(had.history),
                                 .history = pointer(numbers.history),
                                 .old_stride = old.history_stride,
                                 .stride = list.history_stride,
                                 .parameters = options.parameters,
                                 .touching = pointer(touching)});
  old = {};
  numbers.result.resize(pairs);
  if (options.couples) numbers.couple.resize(pairs);
  launch(pairs, StartResults<Real>{pointer(touching), pointer(numbers.result)});
}

/// A new list for grains sorted by bucket; histories come from `old` after keep_touching(), whose numbering
/// grains.old_of_new refers to.
inline PairColumns build_pairs(const Grains& grains, const PairSearch& search, PairColumns old,
                               const PairOptions& options) {
  const int n = grains.size();
  PairColumns list;
  list.own_start.resize(n + 1);
  list.other_start.resize(n + 1);
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
  if (options.materials > 1) list.pair.resize(pairs);
  list.history_stride = options.history;
  if (options.ledger) list.ledger.resize(groups_of(pairs));
  with_numbers(options.precision, [&]<class Real>() { carry_pairs<Real>(grains, old, options, list); });
  return list;
}

}  // namespace dem::TRACKBED_DEM_SYSTEM
