#pragma once
// Half list of candidate pairs: every two grains whose surfaces are nearer than the skin, once, in the row of the grain
// with the lower index, sorted. `other` lists for each grain the pairs in which it is the second one.
#include "dem/core/cell_grid.hpp"
#include "dem/core/periodic.hpp"

namespace dem::TRACKBED_DEM_SYSTEM {

struct PairSearch {
  CellGrid grid;
  const int* bucket_start;
  const int* entry;  // spheres by bucket; null: they are numbered so
  const int* body;   // of each sphere; null: each is its own
  const Place* place;
  double skin;
  Periods periods{};

  /// Calls visit(j) for every neighbour of grain g.
  template <class Visit>
  TRACKBED_HD void neighbours(int g, Visit&& visit) const {
    const Place p = place[g];
    neighbours_at(g, p, {}, visit);
    if (!periods.any()) return;
    for (int shift = 0; shift < 27; ++shift) {
      if (shift == no_shift || !periods.exists(shift)) continue;
      const Vec3 back = periods.vector(shift);
      const Place moved{p.position - back, p.radius};
      if (periods.near_domain(moved.position)) neighbours_at(g, moved, back, visit);
    }
  }

  /// The same if it were at p, `back` from where it is. The distance of a pair is the same to the last bit from either
  /// side, for the lists of both must agree: it is the grain of the lower number that is moved.
  template <class Visit>
  TRACKBED_HD void neighbours_at(int g, const Place& p, const Vec3& back, Visit&& visit) const {
    const long long cx = grid.cell(p.position.x), cy = grid.cell(p.position.y), cz = grid.cell(p.position.z);
    for (int dz = -1; dz <= 1; ++dz)
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
          const int b = grid.bucket(grid.wrap(cx + dx, 0), grid.wrap(cy + dy, 1), grid.wrap(cz + dz, 2));
          for (int k = bucket_start[b]; k < bucket_start[b + 1]; ++k) {
            const int j = entry ? entry[k] : k;
            const double reach = p.radius + place[j].radius + skin;
            if (body ? body[j] == body[g] : j == g) continue;
            const Vec3 between =
                g < j ? p.position - place[j].position : place[g].position - (place[j].position + back);
            if (norm2(between) < reach * reach) visit(j);
          }
        }
  }
};

struct CountPairs {
  PairSearch search;
  int *own, *others;
  struct Visit {
    int g, own, others;
    TRACKBED_HD void operator()(int j) { ++(j > g ? own : others); }
  };
  TRACKBED_HD void operator()(int g) const {
    Visit visit{g, 0, 0};
    search.neighbours(g, visit);
    own[g] = visit.own;
    others[g] = visit.others;
  }
};

struct FillPairs {
  PairSearch search;
  const int *own_start, *other_start;
  int *first, *second, *other;  // `other` first gets the partner's index
  struct Visit {
    int g, *own, *others;
    int own_count, other_count;
    TRACKBED_HD static void insert(int* list, int& count, int value) {
      int k = count++;
      for (; k > 0 && list[k - 1] > value; --k) list[k] = list[k - 1];
      list[k] = value;
    }
    TRACKBED_HD void operator()(int j) {
      if (j > g)
        insert(own, own_count, j);
      else
        insert(others, other_count, j);
    }
  };
  TRACKBED_HD void operator()(int g) const {
    search.neighbours(g, Visit{g, second + own_start[g], other + other_start[g], 0, 0});
    for (int c = own_start[g]; c < own_start[g + 1]; ++c) first[c] = g;
  }
};

/// Position of `value` in the sorted list[begin … end), or -1.
TRACKBED_HD inline int find_sorted(const int* list, int begin, int end, int value) {
  while (begin < end) {
    const int middle = begin + (end - begin) / 2;
    if (list[middle] < value)
      begin = middle + 1;
    else if (list[middle] > value)
      end = middle;
    else
      return middle;
  }
  return -1;
}

/// Turns partners into pair numbers: in row g, partner k owns the pair (k, g).
struct LinkOthers {
  const int *own_start, *second, *other_start;
  int* other;
  TRACKBED_HD void operator()(int g) const {
    for (int k = other_start[g]; k < other_start[g + 1]; ++k)
      other[k] = find_sorted(second, own_start[other[k]], own_start[other[k] + 1], g);
  }
};

/// The materials of a pair, and the history it had under the old list and numbering, which names touching pairs only.
template <class Real>
struct CarryPairs {
  const int *first, *second;
  const int* material;
  int materials;
  int* pair;  // null: one material
  const int* old_of_new;
  const int *old_start, *old_second;  // null: there was no list
  int old_rows;                       // own ones
  const Real* old_history;
  Real* history;
  int old_stride, stride;                     // numbers per pair
  const kernels::PairParameters* parameters;  // .flips
  char* touching;                             // 1: the pair touched

  TRACKBED_HD void operator()(int c) const {
    const int i = first[c], j = second[c];
    if (pair) pair[c] = material[i] * materials + material[j];
    touching[c] = 0;
    Real* const now = history + static_cast<std::size_t>(c) * stride;
    for (int k = 0; k < stride; ++k) now[k] = 0;
    const int a = old_of_new[i], b = old_of_new[j];
    if (!old_start || a < 0 || b < 0) return;
    const int low = a < b ? a : b, high = a < b ? b : a;
    if (low >= old_rows) return;
    const int old = find_sorted(old_second, old_start[low], old_start[low + 1], high);
    if (old < 0) return;
    touching[c] = 1;
    const Real* const before = old_history + static_cast<std::size_t>(old) * old_stride;
    const unsigned flips = parameters[material[i] * materials + material[j]].flips;
    for (int k = 0; k < stride && k < old_stride; ++k) now[k] = a > b && (flips >> k & 1) ? -before[k] : before[k];
  }
};

/// That pairs touched is all that the next forces need of the last ones.
template <class Real>
struct StartResults {
  const char* touching;
  PairForce<Real>* result;
  TRACKBED_HD void operator()(int c) const {
    result[c] = {};
    result[c].half_overlap = touching[c];
  }
};
/// The same for the pairs of a list.
template <class Real>
struct MarkTouching {
  const int* pair;
  PairForce<Real>* result;
  TRACKBED_HD void operator()(int k) const {
    if (!(result[pair[k]].half_overlap > 0)) result[pair[k]].half_overlap = 1;
  }
};

// ---- touching pairs alone
template <class Real>
struct IsTouching {
  const PairForce<Real>* result;
  int* is;
  TRACKBED_HD void operator()(int c) const { is[c] = result[c].half_overlap > 0; }
};
/// Starts of rows, when of all pairs up to each only so many stay.
struct MoveStarts {
  const int* staying;  // of the pairs up to this one, itself included
  int* start;
  TRACKBED_HD void operator()(int g) const { start[g] = start[g] > 0 ? staying[start[g] - 1] : 0; }
};
/// Rows of `parts` numbers of those that stay.
template <class T>
struct KeepStaying {
  const int* staying;
  const T* from;
  T* to;
  int parts;
  TRACKBED_HD void operator()(int c) const {
    const int at = c > 0 ? staying[c - 1] : 0;
    if (staying[c] == at) return;
    for (int k = 0; k < parts; ++k)
      to[static_cast<std::size_t>(at) * parts + k] = from[static_cast<std::size_t>(c) * parts + k];
  }
};
template <class T>
void keep_staying(Vector<T>& v, const Vector<int>& staying, int kept, int parts = 1) {
  if (v.empty()) return;
  Vector<T> left(static_cast<std::size_t>(kept) * parts);
  launch(static_cast<int>(staying.size()), KeepStaying<T>{pointer(staying), pointer(v), pointer(left), parts});
  v.swap(left);
}

}  // namespace dem::TRACKBED_DEM_SYSTEM
