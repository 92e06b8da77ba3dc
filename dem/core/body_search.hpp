#pragma once
// Neighbours of the spheres of clumps, on a processor: first which clumps are near each other, by the balls around
// them, then which of their spheres. Cells must be as wide as the largest sphere, and a clump of thirty spheres has
// most of them in one cell: looking through 27 cells sphere by sphere (pair_search.hpp) finds the same pairs with
// several times the work.
#include "dem/core/bodies.hpp"
#include "dem/core/pair_search.hpp"

namespace dem::TRACKBED_DEM_SYSTEM {

class BodySearch {
 public:
  /// Bodies where they are now; what `spheres` points to must outlive this.
  BodySearch(const PairSearch& spheres, const Bodies& bodies)
      : spheres_(spheres), place_(pointer(bodies.place)), start_(pointer(bodies.start)) {
    const int n = bodies.size();
    const Box box = reduce(n, BoxOf{place_}, Box{}, JoinBoxes{});
    const Radii reach = reduce(n, RadiiOf{place_}, Radii{}, JoinRadii{});
    grid_ = make_grid(box, 2 * reach.largest + spheres.skin, n);
    Vector<int> bucket(n);
    launch(n, BucketOf{grid_, place_, pointer(bucket)});
    entry_.resize(n);
    thrust::sequence(policy(), entry_.begin(), entry_.end());
    thrust::stable_sort_by_key(policy(), bucket.begin(), bucket.end(), entry_.begin());
    bucket_starts(bucket, grid_.buckets(), bucket_start_);
  }

  /// A clump near another one, shifted by periods.
  struct Near {
    int body, shift;
  };

  /// Clumps that a sphere of `body` may have neighbours in.
  void near_bodies(int body, std::vector<Near>& near) const {
    near.clear();
    for (int shift = 0; shift < 27; ++shift) {
      if (shift != no_shift && !spheres_.periods.exists(shift)) continue;
      const Vec3 c = moved(place_[body].position, shift);
      const long long cx = grid_.cell(c.x), cy = grid_.cell(c.y), cz = grid_.cell(c.z);
      for (int k = 0; k < 27; ++k) {
        const int b = grid_.bucket(grid_.wrap(cx + k % 3 - 1, 0), grid_.wrap(cy + k / 3 % 3 - 1, 1),
                                   grid_.wrap(cz + k / 9 - 1, 2));
        for (int e = bucket_start_[b]; e < bucket_start_[b + 1]; ++e) {
          const int other = entry_[e];
          const double reach = place_[body].radius + place_[other].radius + spheres_.skin;
          if (other != body && norm2(c - place_[other].position) < reach * reach) near.push_back({other, shift});
        }
      }
    }
  }

  /// Calls visit(j) for every neighbour of sphere g among the spheres of these clumps.
  template <class Visit>
  void neighbours(int g, const std::vector<Near>& near, const Visit& visit) const {
    const Place* sphere = spheres_.place;
    const double radius = sphere[g].radius;
    for (const Near& n : near) {
      const Vec3 p = moved(sphere[g].position, n.shift);
      const double ball = radius + place_[n.body].radius + spheres_.skin;
      if (!(norm2(p - place_[n.body].position) < ball * ball)) continue;
      if (n.shift != no_shift && !spheres_.periods.near_domain(p)) continue;
      for (int j = start_[n.body]; j < start_[n.body + 1]; ++j) {
        const double reach = radius + sphere[j].radius + spheres_.skin;
        if (norm2(p - sphere[j].position) < reach * reach) visit(j);
      }
    }
  }

 private:
  Vec3 moved(const Vec3& p, int shift) const { return shift == no_shift ? p : p - spheres_.periods.vector(shift); }

  const PairSearch& spheres_;
  const Place* place_;
  const int* start_;
  CellGrid grid_;
  Vector<int> entry_, bucket_start_;
};

}  // namespace dem::TRACKBED_DEM_SYSTEM
