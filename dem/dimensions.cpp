#include "dem/dimensions.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "dem/grading.hpp"
#include "dem/kernels/rotation.hpp"

namespace dem {
namespace {
using kernels::Quaternion;

double extent(std::span<const Sphere> corners, const Vec3& direction) {
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (const Sphere& corner : corners) {
    const double along = dot(corner.position, direction);
    low = std::min(low, along - corner.radius);
    high = std::max(high, along + corner.radius);
  }
  return high - low;
}

/// Extents of the body along the axes of a turned frame.
Vec3 extents(std::span<const Sphere> corners, const Quaternion& turn) {
  return {extent(corners, to_space(turn, {1, 0, 0})), extent(corners, to_space(turn, {0, 1, 0})),
          extent(corners, to_space(turn, {0, 0, 1}))};
}

Vec3 in_cube(Random& random) {
  const double x = random.uniform(-1, 1), y = random.uniform(-1, 1), z = random.uniform(-1, 1);
  return {x, y, z};
}

struct Found {
  double value = HUGE_VAL;
  Quaternion turn;
};

/// Extents in the frame in which value(extents) is least. What is sought has kinks where two corners change places, so
/// that no gradient is used: random small turns, shorter whenever many in a row are of no use. All starts are followed
/// some way, since several valleys are nearly as deep as the deepest; the best are followed to the end.
template <class Value>
Vec3 least(std::span<const Sphere> corners, const Value& value) {
  constexpr std::size_t starts = 120, finalists = 5;
  Random random(1);
  const auto at = [&](const Quaternion& turn) { return Found{value(extents(corners, turn)), turn}; };
  const auto follow = [&](Found& here, double step, double last_step, int patience) {
    int misses = 0;
    while (step > last_step) {
      const Found there = at(kernels::normalised(kernels::turn_by(step * in_cube(random)) * here.turn));
      if (there.value < here.value) {
        here = there;
        misses = 0;
        step *= 1.5;
      } else if (++misses == patience) {
        step *= 0.5;
        misses = 0;
      }
    }
  };
  std::vector<Found> found;
  for (std::size_t i = 0; i < starts; ++i) {
    const Vec3 v = in_cube(random);
    found.push_back(at(kernels::normalised({random.uniform(-1, 1), v.x, v.y, v.z})));
    follow(found.back(), 0.3, 0.01, 16);
  }
  const auto better = [](const Found& a, const Found& b) { return a.value < b.value; };
  std::partial_sort(found.begin(), found.begin() + finalists, found.end(), better);
  for (std::size_t i = 0; i < finalists; ++i) follow(found[i], 0.01, 1e-6, 40);
  return extents(corners, std::min_element(found.begin(), found.end(), better)->turn);
}

}  // namespace

Dimensions dimensions(std::span<const Sphere> corners) {
  Dimensions d;
  d.longest = least(corners, [](const Vec3& e) { return -e.x; }).x;
  d.thinnest = least(corners, [](const Vec3& e) { return e.x; }).x;
  const Vec3 box = least(corners, [](const Vec3& e) { return e.x * e.y * e.z; });
  std::array<double, 3> edges{box.x, box.y, box.z};
  std::sort(edges.begin(), edges.end());
  d.thickness = edges[0];
  d.width = edges[1];
  d.length = edges[2];
  d.sieve = sieve_size(corners);
  return d;
}

double sieve_size(std::span<const Sphere> corners) {
  const Vec3 shadow = least(corners, [](const Vec3& e) { return std::max(e.x, e.y); });
  return std::max(shadow.x, shadow.y);
}

double fraction_top(double sieve) {
  constexpr std::array<double, 15> sieves{0.004, 0.005,  0.0063, 0.008, 0.010, 0.0125, 0.016, 0.020,
                                          0.025, 0.0315, 0.040,  0.050, 0.063, 0.080,  0.100};
  if (sieve <= sieves.front() || sieve > sieves.back()) return 0;
  return *std::lower_bound(sieves.begin(), sieves.end(), sieve);
}

bool is_flaky(const Dimensions& d) { return d.thinnest <= 0.5 * fraction_top(d.sieve); }

bool is_elongated(const Dimensions& d) { return d.longest > 3 * d.thinnest; }

}  // namespace dem
