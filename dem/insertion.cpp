#include "dem/insertion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "base/error.hpp"
#include "dem/grading.hpp"

namespace dem {
namespace {

/// Spheres by cell; columns of cells grow upwards as the box does. What lies outside the box is filed at its border.
class CellGrid {
 public:
  CellGrid(const Vec3& lower, const Vec3& upper, double cell) : lower_(lower), cell_(cell) {
    nx_ = 1 + static_cast<int>((upper.x - lower.x) / cell);
    ny_ = 1 + static_cast<int>((upper.y - lower.y) / cell);
  }
  void add(const Sphere& sphere) {
    const auto index = cell_of(sphere.position);
    const std::size_t number = flat(index[0], index[1], index[2]);
    if (number >= cells_.size()) cells_.resize(number + static_cast<std::size_t>(nx_ * ny_));
    cells_[number].push_back(sphere);
  }
  bool is_free(const Sphere& sphere, double gap) const {
    const auto index = cell_of(sphere.position);
    for (int k = std::max(0, index[2] - 1); k <= index[2] + 1; ++k) {
      for (int j = std::max(0, index[1] - 1); j <= std::min(ny_ - 1, index[1] + 1); ++j) {
        for (int i = std::max(0, index[0] - 1); i <= std::min(nx_ - 1, index[0] + 1); ++i) {
          const std::size_t number = flat(i, j, k);
          if (number >= cells_.size()) continue;
          for (const Sphere& other : cells_[number]) {
            const double reach = other.radius + sphere.radius + gap;
            if (base::norm2(other.position - sphere.position) < reach * reach) return false;
          }
        }
      }
    }
    return true;
  }

 private:
  std::array<int, 3> cell_of(const Vec3& p) const {
    return {std::clamp(static_cast<int>((p.x - lower_.x) / cell_), 0, nx_ - 1),
            std::clamp(static_cast<int>((p.y - lower_.y) / cell_), 0, ny_ - 1),
            std::max(static_cast<int>((p.z - lower_.z) / cell_), 0)};
  }
  std::size_t flat(int i, int j, int k) const { return static_cast<std::size_t>((k * ny_ + j) * nx_ + i); }

  Vec3 lower_;
  double cell_;
  int nx_, ny_;
  std::vector<std::vector<Sphere>> cells_;
};

}  // namespace

Inserted insert_spheres(std::span<const double> radii, const Insertion& insertion) {
  constexpr int attempts = 200;     // per sphere before the box grows
  constexpr int most_growths = 50;  // for one sphere, before there is no room at all
  double largest = 0;
  for (const double radius : radii) largest = std::max(largest, radius);
  for (const Sphere& sphere : insertion.existing) largest = std::max(largest, sphere.radius);

  Inserted result;
  result.positions.resize(radii.size());
  result.top = insertion.upper.z;
  if (radii.empty()) return result;
  const Vec3 &lower = insertion.lower, &upper = insertion.upper;
  base::require_user(std::min(upper.x - lower.x, upper.y - lower.y) > 2 * largest,
                     "the box to pour grains into is narrower than the largest grain");

  CellGrid grid(lower, upper, 2 * largest + insertion.gap);
  for (const Sphere& sphere : insertion.existing) grid.add(sphere);
  std::vector<std::size_t> order(radii.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return radii[a] > radii[b]; });

  Random random(insertion.seed);
  for (const std::size_t number : order) {
    const double radius = radii[number];
    bool placed = false;
    for (int growth = 0; growth <= most_growths && !placed; ++growth) {
      if (growth > 0 || result.top < lower.z + 2 * radius) result.top += 2 * radius;
      for (int attempt = 0; attempt < attempts && !placed; ++attempt) {
        const Sphere sphere{
            {random.uniform(lower.x + radius, upper.x - radius), random.uniform(lower.y + radius, upper.y - radius),
             random.uniform(lower.z + radius, result.top - radius)},
            radius};
        if (!grid.is_free(sphere, insertion.gap) || (insertion.room && !insertion.room(sphere))) continue;
        grid.add(sphere);
        result.positions[number] = sphere.position;
        placed = true;
      }
    }
    base::require_user(placed, "there is no room to pour grains: bodies and walls leave nothing free of the box");
  }
  return result;
}

}  // namespace dem
