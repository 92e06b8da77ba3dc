#pragma once
// Candidates (grain, facet): facets nearer to a grain's surface than the skin. Every facet is entered into all buckets
// that its box, widened by the largest reach, can touch; a grain then looks into its own bucket only. Planes are tested
// by every grain.
#include "dem/core/cell_grid.hpp"
#include "dem/core/wall_pass.hpp"

namespace dem::TRACKBED_DEM_SYSTEM {

struct FacetBuckets {
  CellGrid grid;
  WallGeometry geometry;
  double reach;  // [m] largest radius + skin

  struct Range {
    long long first[3];
    int number[3] = {0, 0, 0};
  };
  TRACKBED_HD Range range(int f) const {
    Range r;
    const Facet& t = geometry.facet[f];
    if (!t.live || t.node[1] < 0) return r;
    const Vec3* position = geometry.position;
    const double far = reach + geometry.margin(f);
    for (int axis = 0; axis < 3; ++axis) {
      double low = position[t.node[0]][axis], high = low;
      for (int k = 1; k < 4 && t.node[k] >= 0; ++k) {
        low = std::fmin(low, position[t.node[k]][axis]);
        high = std::fmax(high, position[t.node[k]][axis]);
      }
      r.first[axis] = grid.cell(low - far);
      const long long number = grid.cell(high + far) - r.first[axis] + 1;
      r.number[axis] = number < grid.count[axis] ? static_cast<int>(number) : grid.count[axis];
    }
    return r;
  }
};

struct CountBuckets {
  FacetBuckets buckets;
  int* count;
  TRACKBED_HD void operator()(int f) const {
    const auto r = buckets.range(f);
    count[f] = r.number[0] * r.number[1] * r.number[2];
  }
};

struct FillBuckets {
  FacetBuckets buckets;
  const int* start;
  int *bucket, *facet;
  TRACKBED_HD void operator()(int f) const {
    const auto r = buckets.range(f);
    const CellGrid& grid = buckets.grid;
    int k = start[f];
    for (int z = 0; z < r.number[2]; ++z)
      for (int y = 0; y < r.number[1]; ++y)
        for (int x = 0; x < r.number[0]; ++x, ++k) {
          bucket[k] =
              grid.bucket(grid.wrap(r.first[0] + x, 0), grid.wrap(r.first[1] + y, 1), grid.wrap(r.first[2] + z, 2));
          facet[k] = f;
        }
  }
};

struct WallSearch {
  CellGrid grid;
  const int *bucket_start, *entry;  // facets by bucket
  const int* plane;                 // facets that are planes
  int planes;
  WallGeometry geometry;
  const Place* place;
  double skin;

  template <class Visit>
  TRACKBED_HD void neighbours(int g, Visit&& visit) const {
    const Place p = place[g];
    for (int k = 0; k < planes; ++k)
      if (geometry.nearest(plane[k], p.position, p.radius + skin).feature != kernels::Feature::none) visit(plane[k]);
    if (!entry) return;
    const int b = grid.bucket_of(p.position);
    for (int k = bucket_start[b]; k < bucket_start[b + 1]; ++k)
      if (near(entry[k], p)) visit(entry[k]);
  }
  TRACKBED_HD bool near(int f, const Place& p) const {
    const Facet& t = geometry.facet[f];
    const int count = t.node[3] < 0 ? 3 : 4;
    Vec3 corners[4];
    for (int k = 0; k < count; ++k) corners[k] = geometry.position[t.node[k]];
    const double reach = p.radius + skin + geometry.margin(f);
    return kernels::closest_on_facet(corners, count, p.position, reach).feature != kernels::Feature::none;
  }
};

struct CountWalls {
  WallSearch search;
  int* count;
  struct Visit {
    int number;
    TRACKBED_HD void operator()(int) { ++number; }
  };
  TRACKBED_HD void operator()(int g) const {
    Visit visit{0};
    search.neighbours(g, visit);
    count[g] = visit.number;
  }
};

struct IsPositive {
  const int* count;
  TRACKBED_HD bool operator()(int g) const { return count[g] > 0; }
};
struct SetSlots {
  const int *grain, *all_start;
  int *slot, *start;
  TRACKBED_HD void operator()(int w) const {
    slot[grain[w]] = w;
    start[w] = all_start[grain[w]];
  }
};

/// Fills the candidates of near grain w and carries over their states from the old list.
struct FillWalls {
  WallSearch search;
  const int *grain, *start;
  int* candidate;
  WallState* state;
  const int* old_of_new;
  const int *old_slot, *old_start, *old_candidate;  // null: there was no list
  int old_rows;                                     // in the old list
  const WallState* old_state;
  const double* old_history;
  double* history;
  int old_stride, stride;  // numbers per candidate
  struct Visit {
    int* list;
    int count;
    TRACKBED_HD void operator()(int f) {
      int k = count++;
      for (; k > 0 && list[k - 1] > f; --k) list[k] = list[k - 1];
      list[k] = f;
    }
  };
  TRACKBED_HD void operator()(int w) const {
    const int g = grain[w];
    search.neighbours(g, Visit{candidate + start[w], 0});
    const int old_grain = old_of_new[g];
    const int old = old_slot && old_grain >= 0 && old_grain < old_rows ? old_slot[old_grain] : -1;
    for (int c = start[w]; c < start[w + 1]; ++c) {
      state[c] = {};
      for (int k = old < 0 ? 0 : old_start[old]; old >= 0 && k < old_start[old + 1]; ++k)
        if (old_candidate[k] == candidate[c]) {
          state[c] = old_state[k];
          for (int n = 0; n < stride && n < old_stride; ++n) history[c * stride + n] = old_history[k * old_stride + n];
        }
    }
  }
};

/// Node of corner k % corners of candidate k / corners (of its face, where it is a part of one) when its wall keeps
/// nodal impulses, else a number past all nodes.
struct CandidateNode {
  const int* candidate;
  WallGeometry geometry;
  int corners;
  int past;
  int *node, *entry;
  TRACKBED_HD void operator()(int k) const {
    const int f = candidate[k / corners], corner = k % corners;
    const Facet& facet = geometry.facet[f];
    int at = -1;
    if (geometry.is_part(f))
      at = geometry.face[geometry.part[f].face].node[corner];
    else if (corner < 4)
      at = facet.node[corner];
    node[k] = geometry.wall[facet.wall].nodal && at >= 0 ? at : past;
    entry[k] = k;
  }
};

}  // namespace dem::TRACKBED_DEM_SYSTEM
