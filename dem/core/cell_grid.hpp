#pragma once
// Cells of one size on a torus: space is cut into cubes, and cubes that lie a whole number of grid lengths apart share
// a bucket. So there is no bounding box: one grain that has flown a kilometre off costs nothing and is still found. At
// least four buckets along each axis keep the 27 neighbours of a cell in 27 different buckets.
#include "dem/core/list_length.hpp"
#include "dem/core/rows.hpp"

namespace dem::TRACKBED_DEM_SYSTEM {

struct CellGrid {
  double inverse_size = 1;  // [1/m]
  int count[3] = {4, 4, 4};

  /// What is not finite, or beyond all counting, is in cell 0: the run stops for it elsewhere.
  TRACKBED_HD long long cell(double x) const {
    const double place = std::floor(x * inverse_size);
    return place > -1e15 && place < 1e15 ? static_cast<long long>(place) : 0;
  }
  TRACKBED_HD int wrap(long long cell, int axis) const {
    const long long rest = cell % count[axis];
    return static_cast<int>(rest < 0 ? rest + count[axis] : rest);
  }
  TRACKBED_HD int bucket(int bx, int by, int bz) const { return bx + count[0] * (by + count[1] * bz); }
  TRACKBED_HD int bucket_of(const Vec3& p) const {
    return bucket(wrap(cell(p.x), 0), wrap(cell(p.y), 1), wrap(cell(p.z), 2));
  }
  int buckets() const { return count[0] * count[1] * count[2]; }
};

struct Box {
  Vec3 low{HUGE_VAL, HUGE_VAL, HUGE_VAL}, high{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
};
struct BoxOf {
  const Place* place;
  TRACKBED_HD Box operator()(int g) const { return {place[g].position, place[g].position}; }
};
struct JoinBoxes {
  TRACKBED_HD Box operator()(const Box& a, const Box& b) const {
    return {{std::fmin(a.low.x, b.low.x), std::fmin(a.low.y, b.low.y), std::fmin(a.low.z, b.low.z)},
            {std::fmax(a.high.x, b.high.x), std::fmax(a.high.y, b.high.y), std::fmax(a.high.z, b.high.z)}};
  }
};

/// A grid of about as many buckets as grains, at most, shaped like the box.
inline CellGrid make_grid(const Box& box, double cell_size, int grains) {
  CellGrid grid;
  grid.inverse_size = 1 / cell_size;
  double wanted[3];
  for (int axis = 0; axis < 3; ++axis)
    wanted[axis] = std::fmin(1e6, std::fmax(4, std::ceil((box.high[axis] - box.low[axis]) / cell_size) + 1));
  const double most = grains > 64 ? 2.0 * grains : 128;
  while (wanted[0] * wanted[1] * wanted[2] > most) {
    double* longest = wanted;
    for (int axis = 1; axis < 3; ++axis)
      if (wanted[axis] > *longest) longest = wanted + axis;
    if (*longest <= 4) break;
    *longest = std::fmax(4, std::floor(0.5 * *longest));
  }
  for (int axis = 0; axis < 3; ++axis) grid.count[axis] = static_cast<int>(wanted[axis]);
  return grid;
}

struct BucketOf {
  CellGrid grid;
  const Place* place;
  int* bucket;
  TRACKBED_HD void operator()(int g) const { bucket[g] = grid.bucket_of(place[g].position); }
};

/// start[b] = first position of bucket b in the sorted list of buckets, for b = 0 … buckets.
inline void bucket_starts(const Vector<int>& sorted, int buckets, Vector<int>& start) {
  start.resize(buckets + 1);
  const thrust::counting_iterator<int> first(0);
  thrust::lower_bound(policy(), sorted.begin(), sorted.end(), first, first + buckets + 1, start.begin());
}

struct CountAt {
  const int* count;
  TRACKBED_HD std::int64_t operator()(int index) const { return count[index]; }
};

/// In place: counts become starts; behind the counts is one entry more, which becomes the total. Returns the total.
/// Throws base::MachineError where indices could not count as far.
inline int counts_to_starts(Vector<int>& counts) {
  const int total = list_length(reduce(static_cast<int>(counts.size()) - 1, CountAt{pointer(counts)}, std::int64_t{0},
                                       thrust::plus<std::int64_t>()));
  thrust::exclusive_scan(policy(), counts.begin(), counts.end(), counts.begin());
  return total;
}

}  // namespace dem::TRACKBED_DEM_SYSTEM
