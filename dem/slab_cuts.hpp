#pragma once
// Where to cut a line of grains into slabs that have the same work.
#include <vector>

namespace dem {

/// Work along x: what lies in each of bins.size() equal pieces of [low, high], in any unit.
struct SlabWork {
  double low = 0, high = 0;  // [m]
  std::vector<double> bins;

  void add(double x, double work);  // outside: into the nearest bin
};

/// The narrowest a slab may be [m]: neither may a sphere be near both faces of its slab, nor touch past a neighbour.
/// `reach`: the largest grain's, centre to farthest point.
double least_slab(double reach, double skin);

/// parts - 1 places in rising order that share the work evenly, none of the slabs (those at the ends are counted from
/// low and to high) narrower than `least`. Work is taken as even within a bin. Empty when parts * least > high - low.
std::vector<double> slab_cuts(const SlabWork&, int parts, double least);

}  // namespace dem
