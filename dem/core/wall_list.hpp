#pragma once
// The list of (grain, facet) candidates with everything that belongs to one.
#include "dem/core/wall_search.hpp"
#include "dem/core/walls.hpp"

namespace dem::TRACKBED_DEM_SYSTEM {

struct WallColumns {
  Vector<int> slot;          // per grain: its place in `grain`, or -1
  Vector<int> grain, start;  // grains with candidates
  Vector<WallSum> sum;
  Vector<int> candidate;  // facet
  Vector<int> grain_of;   // grain of each candidate; empty while no wall is a body
  Vector<WallState> state;
  Vector<WallFound> found;
  Vector<double> history;  // history_stride numbers per candidate
  int history_stride = 0;
  Vector<Vec3> impulse;
  Vector<NodalImpulse> nodal;          // empty: no coupled mesh
  Vector<WallLedger> ledger;           // empty: not tracked
  Vector<Passed> passed;               // empty: not tracked, or no coupled mesh
  Vector<int> node_start, node_entry;  // coupled nodes -> candidates

  int size() const { return static_cast<int>(candidate.size()); }
  int near_grains() const { return static_cast<int>(grain.size()); }
  std::size_t bytes() const {
    return bytes_of(slot) + bytes_of(grain) + bytes_of(start) + bytes_of(sum) + bytes_of(candidate) +
           bytes_of(grain_of) + bytes_of(state) + bytes_of(found) + bytes_of(history) + bytes_of(impulse) +
           bytes_of(nodal) + bytes_of(ledger) + bytes_of(passed) + bytes_of(node_start) + bytes_of(node_entry);
  }
};

struct WallOptions {
  bool ledger = true;
  int history = 4;  // numbers per candidate
  double skin = 0;
  double largest_radius = 0;
};

struct FacetTable {
  Vector<int> bucket_start, entry;
};

inline FacetTable tabulate_facets(const Walls& walls, const CellGrid& grid, double reach) {
  FacetTable table;
  const int n = static_cast<int>(walls.facets.size());
  const FacetBuckets buckets{grid, walls.geometry(), reach};
  Vector<int> start(n + 1);
  launch(n, CountBuckets{buckets, pointer(start)});
  const int entries = counts_to_starts(start);
  if (entries == 0) return table;
  Vector<int> bucket(entries);
  table.entry.resize(entries);
  launch(n, FillBuckets{buckets, pointer(start), pointer(bucket), pointer(table.entry)});
  thrust::stable_sort_by_key(policy(), bucket.begin(), bucket.end(), table.entry.begin());
  bucket_starts(bucket, grid.buckets(), table.bucket_start);
  return table;
}

inline void link_nodes(const Walls& walls, WallColumns& list) {
  const int nodes = static_cast<int>(walls.position.size()), corners = 4 * walls.nodal_rows();
  const int entries = corners * list.size();
  Vector<int> node(entries);
  list.node_entry.resize(entries);
  launch(entries, CandidateNode{pointer(list.candidate), walls.geometry(), corners, nodes, pointer(node),
                                pointer(list.node_entry)});
  thrust::stable_sort_by_key(policy(), node.begin(), node.end(), list.node_entry.begin());
  bucket_starts(node, nodes, list.node_start);
}

struct NameGrains {
  const int *grain, *start;
  int* grain_of;
  TRACKBED_HD void operator()(int w) const {
    for (int c = start[w]; c < start[w + 1]; ++c) grain_of[c] = grain[w];
  }
};

inline WallColumns build_walls(const Grains& grains, const Walls& walls, const CellGrid& grid, const WallColumns& old,
                               const WallOptions& options) {
  WallColumns list;
  const int n = grains.size();
  const FacetTable table = tabulate_facets(walls, grid, options.largest_radius + options.skin);
  const WallSearch search{grid,
                          pointer(table.bucket_start),
                          pointer(table.entry),
                          pointer(walls.planes),
                          static_cast<int>(walls.planes.size()),
                          walls.geometry(),
                          pointer(grains.place),
                          options.skin};
  Vector<int> all_start(n + 1), near(n);
  launch(n, CountWalls{search, pointer(all_start)});
  const thrust::counting_iterator<int> first(0);
  const auto last = thrust::copy_if(policy(), first, first + n, near.begin(), IsPositive{pointer(all_start)});
  list.grain.assign(near.begin(), last);
  release(near);
  const int candidates = counts_to_starts(all_start);

  list.slot.resize(n, -1);
  list.start.resize(list.grain.size() + 1, candidates);
  launch(list.near_grains(),
         SetSlots{pointer(list.grain), pointer(all_start), pointer(list.slot), pointer(list.start)});
  list.sum.resize(list.grain.size());
  list.candidate.resize(candidates);
  list.state.resize(candidates);
  list.found.resize(candidates);
  list.history_stride = options.history;
  list.history.resize(static_cast<std::size_t>(candidates) * options.history);
  list.impulse.resize(candidates);
  if (options.ledger) list.ledger.resize(candidates);
  const bool had = !old.slot.empty();
  launch(list.near_grains(),
         FillWalls{search, pointer(list.grain), pointer(list.start), pointer(list.candidate), pointer(list.state),
                   pointer(grains.old_of_new), had ? pointer(old.slot) : nullptr, pointer(old.start),
                   pointer(old.candidate), static_cast<int>(old.slot.size()), pointer(old.state), pointer(old.history),
                   pointer(list.history), old.history_stride, list.history_stride});
  if (walls.bodies()) {
    list.grain_of.resize(candidates);
    launch(list.near_grains(), NameGrains{pointer(list.grain), pointer(list.start), pointer(list.grain_of)});
  }
  if (walls.nodal()) {
    list.nodal.resize(static_cast<std::size_t>(candidates) * walls.nodal_rows());
    if (options.ledger) list.passed.resize(candidates);
    link_nodes(walls, list);
  }
  return list;
}

}  // namespace dem::TRACKBED_DEM_SYSTEM
