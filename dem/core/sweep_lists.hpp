#pragma once
// The pairs that the sweep (dem/sweep.hpp) runs over; OpenMP system only.
//
// Two lists. The skin list holds all pairs nearer than the skin and is made from the cell grid, rarely. The tight list
// holds those of them nearer than a much thinner skin, so that nearly every pair that the step looks at does touch; it
// is made from the skin list, with the histories, whenever grains have moved by half its skin.
//
// Grains are cut into ranges, one per thread. A range has every pair that one of its grains is in and adds forces to
// its own grains only: no atomics, and the same bits for the same number of ranges. A pair across a border is in two
// ranges, which compute the same; its energies count half in each.
#include <algorithm>
#include <memory>

#include "dem/core/body_search.hpp"
#include "dem/core/columns.hpp"
#include "dem/core/grains.hpp"
#include "dem/core/pair_search.hpp"
#include "dem/laws.hpp"
#include "dem/leap.hpp"
#include "dem/sweep.hpp"

namespace dem::TRACKBED_DEM_SYSTEM {

/// Pairs of one range and one pair of materials, inside the range or across its border.
struct SweepPairs {
  Vector<int> start;          // per grain of the range: its first pair
  Vector<int> first, second;  // grains, first < second, or the second's image
  // Where the forces go. Border: the grains, or the spare row for one of another range. Inside: empty, or where space
  // is periodic the grains whose images are read.
  Vector<int> to_first, to_second;
  Vector<double> history;
  Vector<float> short_history;  // in mixed precision, instead of the former
  int pairs = 0;

  std::size_t bytes() const {
    return bytes_of(start) + bytes_of(first) + bytes_of(second) + bytes_of(to_first) + bytes_of(to_second) +
           bytes_of(history) + bytes_of(short_history);
  }
};

struct SweepRange {
  int begin = 0, end = 0;
  Vector<int> near_start, near;           // skin list: partners j > i, or j < begin
  std::vector<SweepPairs> inner, border;  // per pair of materials

  bool holds(int g) const { return g >= begin && g < end; }
};

/// What the rows of pairs look like; one kind per pair of materials.
struct SweepLayout {
  int lanes = 2;  // pairs at once
  bool mixed = false;
  int materials = 1;
  std::vector<HistoryLayout> histories;  // per kind
  std::vector<Sweep> sweeps;             // per kind
};

class SweepLists {
 public:
  const SweepLayout& layout() const { return layout_; }

  /// Cuts the grains, sorted by bucket, into ranges and lists what is near. `bodies`: null where each grain is one.
  void find_near(const PairSearch& search, const Bodies* bodies, int grains, const Images& images, int threads) {
    old_ = std::move(ranges_);
    old_images_ = std::move(images_);
    images_ = images;
    periods_ = search.periods;
    ranges_.assign(std::max(1, threads), {});
    const int number = static_cast<int>(ranges_.size());
    const auto clumps = bodies ? std::make_unique<BodySearch>(search, *bodies) : nullptr;
#pragma omp parallel for schedule(static, 1)
    for (int t = 0; t < number; ++t) {
      SweepRange& range = ranges_[t];
      std::vector<BodySearch::Near> near_bodies;
      range.begin = static_cast<int>(static_cast<long long>(grains) * t / number);
      range.end = static_cast<int>(static_cast<long long>(grains) * (t + 1) / number);
      for (int i = range.begin; i < range.end; ++i) {
        range.near_start.push_back(static_cast<int>(range.near.size()));
        const auto list = [&](int j) {
          if (j > i || j < range.begin) range.near.push_back(j);
        };
        if (clumps) {
          if (i == range.begin || search.body[i] != search.body[i - 1])
            clumps->near_bodies(search.body[i], near_bodies);
          clumps->neighbours(i, near_bodies, list);
        } else {
          search.neighbours(i, list);
        }
        std::sort(range.near.begin() + range.near_start.back(), range.near.end());
      }
      range.near_start.push_back(static_cast<int>(range.near.size()));
    }
  }

  /// Lists the pairs nearer than `tight`, with the histories they had.
  void tighten(const Grains& grains, double tight, const SweepLayout& layout, bool renumbered) {
    if (!renumbered) {
      old_.clear();
      for (SweepRange& range : ranges_)
        old_.push_back({.begin = range.begin,
                        .end = range.end,
                        .near_start = {},
                        .near = {},
                        .inner = std::move(range.inner),
                        .border = std::move(range.border)});
    }
    const SweepLayout old_layout = layout_;
    layout_ = layout;
    const int number = static_cast<int>(ranges_.size());
#pragma omp parallel for schedule(static, 1)
    for (int t = 0; t < number; ++t)
      fill(ranges_[t], images_.first + images_.size() + t, grains, tight, old_layout, renumbered);
    old_.clear();
  }

  /// Adds the forces to `pull` and returns the sums over all pairs. Every thread also calls beside(its number, how
  /// many).
  template <class Beside>
  SweepSums run(const SweepInput& rows, const kernels::PairParameters* parameters, const Beside& beside) {
    const int number = static_cast<int>(ranges_.size());
    std::vector<SweepSums> sums(2 * number);
#pragma omp parallel for schedule(static, 1)
    for (int t = 0; t < number; ++t) {
      for (bool border : {false, true}) {
        auto& lists = border ? ranges_[t].border : ranges_[t].inner;
        for (std::size_t k = 0; k < lists.size(); ++k) {
          SweepPairs& list = lists[k];
          if (list.pairs == 0) continue;
          SweepInput input = rows;
          input.first = pointer(list.first);
          input.second = pointer(list.second);
          input.to_first = list.to_first.empty() ? input.first : pointer(list.to_first);
          input.to_second = list.to_second.empty() ? input.second : pointer(list.to_second);
          if (layout_.mixed)
            input.history = pointer(list.short_history);
          else
            input.history = pointer(list.history);
          input.blocks = (list.pairs + layout_.lanes - 1) / layout_.lanes;
          input.parameters = parameters + k;
          layout_.sweeps[k](input, sums[2 * t + border]);
        }
      }
      beside(t, number);
    }
    SweepSums total;
    for (std::size_t k = 0; k < sums.size(); ++k) {
      const double share = k % 2 ? 0.5 : 1;
      total.elastic_normal += share * sums[k].elastic_normal;
      total.elastic_shear += share * sums[k].elastic_shear;
      total.loss_friction += share * sums[k].loss_friction;
      total.loss_damping += share * sums[k].loss_damping;
      total.loss_rolling += share * sums[k].loss_rolling;
      total.overlap_too_large = total.overlap_too_large || sums[k].overlap_too_large;
    }
    return total;
  }

  /// Calls visit(i, j, history, numbers) for every listed pair once; j may be the row of an image.
  template <class Visit>
  void each(Visit&& visit) const {
    double history[maximum_numbers];
    for (const SweepRange& range : ranges_)
      for (bool border : {false, true}) {
        const auto& lists = border ? range.border : range.inner;
        for (std::size_t k = 0; k < lists.size(); ++k)
          for (int c = 0; c < lists[k].pairs; ++c) {
            if (border && !range.holds(lists[k].first[c])) continue;
            copy_history(lists[k], c, layout_, layout_.histories[k].total, history);
            visit(lists[k].first[c], lists[k].second[c], history, layout_.histories[k].total);
          }
      }
  }

  /// The pair of grains a and b, if it is listed, remembers this from now on.
  void recall(int a, int b, int kind, int numbers, const double* history) {
    const int low = std::min(a, b), high = std::max(a, b), row = layout_.histories[kind].total;
    for (SweepRange& range : ranges_) {
      if (!range.holds(low) && !range.holds(high)) continue;
      SweepPairs& list = (range.holds(low) && range.holds(high) ? range.inner : range.border)[kind];
      const int of = (range.holds(low) ? low : high) - range.begin;
      for (int c = list.start[of]; c < list.start[of + 1]; ++c)
        if (list.first[c] == low && images_.grain(list.second[c]) == high)
          for (int k = 0; k < std::min(row, numbers); ++k)
            write_history(list, c, k, row,
                          a > b && (layout_.histories[kind].flips >> k & 1) ? -history[k] : history[k]);
    }
  }

  std::int64_t near_pairs() const {
    std::int64_t pairs = 0;
    for (const SweepRange& range : ranges_)
      for (int i = range.begin; i < range.end; ++i)
        for (int k = range.near_start[i - range.begin]; k < range.near_start[i - range.begin + 1]; ++k)
          pairs += range.near[k] > i;
    return pairs;
  }

  /// The lists for a checkpoint, or from one.
  template <class Self, class Walk>
  static void walk(Self& self, Walk& walk) {
    int ranges = static_cast<int>(self.ranges_.size()), kinds = ranges ? self.layout_.materials : 0;
    kinds *= kinds;
    walk.numbers("sweep/layout", ranges, kinds, self.layout_.lanes, self.layout_.mixed, self.layout_.materials);
    if constexpr (Walk::loads) {
      self.ranges_.assign(ranges, {});
      for (SweepRange& range : self.ranges_)
        for (auto* lists : {&range.inner, &range.border}) lists->assign(kinds, {});
    }
    std::vector<decltype(self.ranges_.data())> cuts;
    std::vector<decltype(self.ranges_[0].inner.data())> lists;
    for (auto& range : self.ranges_) {
      walk.numbers("sweep/range_" + std::to_string(cuts.size()), range.begin, range.end);
      cuts.push_back(&range);
      for (auto& list : range.inner) lists.push_back(&list);
      for (auto& list : range.border) lists.push_back(&list);
    }
    walk_ragged(
        walk, "sweep/near_start", cuts, [](auto& range) -> auto& { return range.near_start; });
    walk_ragged(
        walk, "sweep/near", cuts, [](auto& range) -> auto& { return range.near; });
    walk_ragged(
        walk, "sweep/start", lists, [](auto& list) -> auto& { return list.start; });
    walk_ragged(
        walk, "sweep/first", lists, [](auto& list) -> auto& { return list.first; });
    walk_ragged(
        walk, "sweep/second", lists, [](auto& list) -> auto& { return list.second; });
    walk_ragged(
        walk, "sweep/to_first", lists, [](auto& list) -> auto& { return list.to_first; });
    walk_ragged(
        walk, "sweep/to_second", lists, [](auto& list) -> auto& { return list.to_second; });
    walk_ragged(
        walk, "sweep/history", lists, [](auto& list) -> auto& { return list.history; });
    walk_ragged(
        walk, "sweep/short_history", lists, [](auto& list) -> auto& { return list.short_history; });
    if constexpr (Walk::loads)
      for (SweepPairs* list : lists) list->pairs = list->start.empty() ? 0 : list->start.back();
  }

  /// After walk() from a checkpoint. False when rows look otherwise on this machine: new lists must be made, which
  /// take the histories over.
  bool go_on(const SweepLayout& layout, const Images& images, const Periods& periods) {
    images_ = images;
    periods_ = periods;
    const bool same = layout_.lanes == layout.lanes && layout_.mixed == layout.mixed;
    layout_.histories = layout.histories;
    layout_.sweeps = layout.sweeps;
    return same;
  }

  std::size_t bytes() const {
    std::size_t total = 0;
    for (const SweepRange& range : ranges_) {
      total += bytes_of(range.near_start) + bytes_of(range.near);
      for (const auto* lists : {&range.inner, &range.border})
        for (const SweepPairs& list : *lists) total += list.bytes();
    }
    return total;
  }

 private:
  static std::size_t place_of(int pair, int lanes, int numbers) {
    return static_cast<std::size_t>(pair / lanes) * lanes * numbers + pair % lanes;
  }
  static void copy_history(const SweepPairs& list, int pair, const SweepLayout& layout, int numbers, double* to) {
    const std::size_t first = place_of(pair, layout.lanes, numbers);
    for (int k = 0; k < numbers; ++k) {
      const std::size_t at = first + static_cast<std::size_t>(k * layout.lanes);
      to[k] = layout.mixed ? list.short_history[at] : list.history[at];
    }
  }

  void write_history(SweepPairs& list, int pair, int number, int numbers, double value) const {
    const std::size_t at = place_of(pair, layout_.lanes, numbers) + static_cast<std::size_t>(number * layout_.lanes);
    if (layout_.mixed)
      list.short_history[at] = static_cast<float>(value);
    else
      list.history[at] = value;
  }

  /// Copies the history of the old pair {a, b} to `to`; false when there was none.
  bool find_old(int a, int b, int kind, const SweepLayout& layout, const Images& images, double* to) const {
    if (a < 0 || b < 0) return false;
    const int low = std::min(a, b), high = std::max(a, b);
    for (const SweepRange& range : old_) {
      if (!range.holds(low)) continue;
      const auto& lists = range.holds(high) ? range.inner : range.border;
      if (static_cast<int>(lists.size()) <= kind) return false;
      const SweepPairs& list = lists[kind];
      for (int c = list.start[low - range.begin]; c < list.start[low - range.begin + 1]; ++c)
        if (list.first[c] == low && images.grain(list.second[c]) == high) {
          const HistoryLayout& history = layout.histories[kind];
          copy_history(list, c, layout, history.total, to);
          if (a > b)
            for (int k = 0; k < history.total; ++k)
              if (history.flips >> k & 1) to[k] = -to[k];
          return true;
        }
      return false;
    }
    return false;
  }

  void fill(SweepRange& range, int spare, const Grains& grains, double tight, const SweepLayout& old_layout,
            bool renumbered) const {
    const int kinds = layout_.materials * layout_.materials, own = range.end - range.begin;
    range.inner.assign(kinds, {});
    range.border.assign(kinds, {});
    for (auto* lists : {&range.inner, &range.border})
      for (SweepPairs& list : *lists) list.start.resize(own + 1);
    const Place* place = pointer(grains.place);
    const bool periodic = periods_.any();
    const ImageRows images = images_.rows();
    for (int i = range.begin; i < range.end; ++i) {
      const Place p = place[i];
      for (int k = range.near_start[i - range.begin]; k < range.near_start[i - range.begin + 1]; ++k) {
        const int j = range.near[k];
        const double reach = p.radius + place[j].radius + tight;
        Vec3 between = p.position - place[j].position;
        int shift = no_shift;  // of j
        if (periodic) {
          shift = periods_.nearest(between);
          between -= periods_.vector(shift);
        }
        if (!(norm2(between) < reach * reach)) continue;
        const bool border = !range.holds(j);
        int a = grains.material[i], b = grains.material[j];
        if (a > b) std::swap(a, b);
        SweepPairs& list = (border ? range.border : range.inner)[a * layout_.materials + b];
        list.first.push_back(std::min(i, j));
        list.second.push_back(periodic ? images.row(std::max(i, j), i < j ? shift : opposite(shift)) : std::max(i, j));
        if (border) {
          list.to_first.push_back(i < j ? i : spare);
          list.to_second.push_back(i < j ? spare : i);
        } else if (periodic) {
          list.to_first.push_back(std::min(i, j));
          list.to_second.push_back(std::max(i, j));
        }
      }
      for (auto* lists : {&range.inner, &range.border})
        for (SweepPairs& list : *lists) list.start[i - range.begin + 1] = static_cast<int>(list.first.size());
    }
    for (int kind = 0; kind < kinds; ++kind)
      for (SweepPairs* list : {&range.inner[kind], &range.border[kind]})
        carry(*list, kind, spare, grains, old_layout, renumbered);
  }

  void carry(SweepPairs& list, int kind, int spare, const Grains& grains, const SweepLayout& old_layout,
             bool renumbered) const {
    list.pairs = static_cast<int>(list.first.size());
    if (list.pairs == 0) return;
    const int lanes = layout_.lanes, blocks = (list.pairs + lanes - 1) / lanes;
    for (auto* rows : {&list.first, &list.second, &list.to_first, &list.to_second})
      if (!rows->empty()) rows->resize(blocks * lanes + sweep_looks_ahead, spare);
    const int row = layout_.histories[kind].total;
    const std::size_t kept_numbers = static_cast<std::size_t>(blocks) * lanes * row;
    if (layout_.mixed)
      list.short_history.resize(kept_numbers);
    else
      list.history.resize(kept_numbers);
    if (old_.empty()) return;
    double kept[maximum_numbers];
    const int numbers = std::min(row, old_layout.histories[kind].total);
    for (int c = 0; c < list.pairs; ++c) {
      const int i = list.first[c], j = images_.grain(list.second[c]);
      const int a = renumbered ? grains.old_of_new[i] : i, b = renumbered ? grains.old_of_new[j] : j;
      if (!find_old(a, b, kind, old_layout, renumbered ? old_images_ : images_, kept)) continue;
      for (int k = 0; k < numbers; ++k) write_history(list, c, k, row, kept[k]);
    }
  }

  SweepLayout layout_;
  std::vector<SweepRange> ranges_, old_;
  Periods periods_;
  Images images_, old_images_;
};

}  // namespace dem::TRACKBED_DEM_SYSTEM
