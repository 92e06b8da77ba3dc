#include "dem/clump_builder.hpp"

#include <algorithm>
#include <climits>
#include <cmath>
#include <string>

#include "base/error.hpp"
#include "dem/kernels/wall_geometry.hpp"
#include "dem/sphere_union.hpp"

namespace dem {
namespace {

using Triangle = std::array<Vec3, 3>;

std::vector<Triangle> triangles_of(const Stone& stone) {
  std::vector<Triangle> triangles;
  for (const auto& t : stone.triangles) {
    Triangle corners;
    for (std::size_t i = 0; i < 3; ++i) corners[i] = stone.corners[static_cast<std::size_t>(t[i])];
    triangles.push_back(corners);
  }
  return triangles;
}

/// Point of the surface that is nearest to `from`, if nearer than `reach`; `from` plus infinity otherwise.
Vec3 nearest_point(const std::vector<Triangle>& triangles, const Vec3& from, double reach) {
  Vec3 nearest{HUGE_VAL, 0, 0};
  for (const Triangle& triangle : triangles) {
    const auto contact = kernels::closest_on_facet(triangle.data(), 3, from, reach);
    if (contact.feature == kernels::Feature::none) continue;
    nearest = contact.point;
    reach = norm(nearest - from);
  }
  return nearest;
}

/// The largest sphere inside the surface that touches it at `point`; `inward` is the unit normal there.
Sphere largest_touching(const std::vector<Triangle>& triangles, const Vec3& point, const Vec3& inward, double start) {
  constexpr int most_rounds = 60;
  double radius = start;
  for (int round = 0; round < most_rounds; ++round) {
    const Vec3 centre = point + radius * inward;
    const Vec3 nearest = nearest_point(triangles, centre, radius * (1 - 1e-7));
    const Vec3 way = nearest - point;
    const double along = dot(way, inward);
    if (!std::isfinite(nearest.x) || !(along > 0)) break;
    radius = norm2(way) / (2 * along);  // through both points, tangent at the first
  }
  return {point + radius * inward, radius};
}

struct Candidate {
  Sphere sphere;
  long most;  // open points that it may cover: as counted last, which can only have become fewer
};

/// Inscribed spheres that touch the surface at points spread evenly over it.
std::vector<Candidate> inscribed_spheres(const std::vector<Triangle>& triangles, double size) {
  constexpr int wanted = 3000;
  double area = 0;
  const auto normal_of = [](const Triangle& t) { return cross(t[1] - t[0], t[2] - t[0]); };
  for (const Triangle& t : triangles) area += 0.5 * norm(normal_of(t));
  std::vector<Candidate> candidates;
  for (const Triangle& t : triangles) {
    const Vec3 normal = normal_of(t);
    const double twice = norm(normal);
    if (!(twice > 0)) continue;
    const Vec3 inward = (-1 / twice) * normal;
    const int rows = std::max(1, static_cast<int>(std::lround(std::sqrt(0.5 * twice / area * wanted))));
    for (int i = 0; i < rows; ++i) {
      for (int j = 0; j < rows - i; ++j) {
        const double a = (i + 1.0 / 3.0) / rows, b = (j + 1.0 / 3.0) / rows;
        const Vec3 point = t[0] + a * (t[1] - t[0]) + b * (t[2] - t[0]);
        candidates.push_back({largest_touching(triangles, point, inward, size), LONG_MAX});
      }
    }
  }
  return candidates;
}

/// Points of a cubic grid inside the surface: along rays in x, crossings switch between outside and inside.
std::vector<Vec3> grid_inside(const std::vector<Triangle>& triangles, const Vec3& low, double spacing, int cells) {
  std::vector<Vec3> points;
  std::vector<double> crossings;
  for (int row = 0; row < cells * cells; ++row) {
    // Off the rational places where corners of hand-made surfaces lie.
    const double y = low.y + (row / cells + 0.4871) * spacing, z = low.z + (row % cells + 0.5137) * spacing;
    crossings.clear();
    for (const Triangle& t : triangles) {
      std::array<double, 3> side{};
      for (std::size_t i = 0; i < 3; ++i) {
        const Vec3 &p = t[i], &q = t[(i + 1) % 3];
        side[i] = (q.y - p.y) * (z - p.z) - (q.z - p.z) * (y - p.y);
      }
      const bool left = side[0] > 0 && side[1] > 0 && side[2] > 0, right = side[0] < 0 && side[1] < 0 && side[2] < 0;
      if (!left && !right) continue;
      crossings.push_back((side[1] * t[0].x + side[2] * t[1].x + side[0] * t[2].x) / (side[0] + side[1] + side[2]));
    }
    std::sort(crossings.begin(), crossings.end());
    for (std::size_t k = 0; k + 1 < crossings.size(); k += 2) {
      for (double i = std::ceil((crossings[k] - low.x) / spacing); low.x + i * spacing < crossings[k + 1]; ++i) {
        points.push_back({low.x + i * spacing, y, z});
      }
    }
  }
  return points;
}

bool covers(const Sphere& sphere, const Vec3& point) {
  return norm2(point - sphere.position) < sphere.radius * sphere.radius;
}

bool joins(const Sphere& sphere, const std::vector<Sphere>& taken) {
  constexpr double least_overlap = 0.05;  // of the smaller radius
  return taken.empty() || std::any_of(taken.begin(), taken.end(), [&](const Sphere& s) {
           const double overlap = s.radius + sphere.radius - norm(s.position - sphere.position);
           return overlap > least_overlap * std::min(s.radius, sphere.radius);
         });
}

/// Takes the candidate that covers most of the open points, which it removes. False when no candidate covers any.
bool take_best(std::vector<Candidate>& candidates, std::vector<Vec3>& open, std::vector<Sphere>& taken) {
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.most > b.most; });
  const Candidate* best = nullptr;
  for (Candidate& candidate : candidates) {
    if (best != nullptr && candidate.most <= best->most) break;
    if (!joins(candidate.sphere, taken)) continue;
    candidate.most =
        std::count_if(open.begin(), open.end(), [&](const Vec3& p) { return covers(candidate.sphere, p); });
    if (candidate.most > (best == nullptr ? 0 : best->most)) best = &candidate;
  }
  if (best == nullptr) return false;
  const Sphere sphere = best->sphere;
  taken.push_back(sphere);
  std::erase_if(open, [&](const Vec3& p) { return covers(sphere, p); });
  return true;
}

}  // namespace

Filling fill_with_spheres(const Stone& stone, int spheres) {
  base::require_user(spheres >= 1 && spheres <= 1000,
                     "a clump of " + std::to_string(spheres) + " spheres was asked for; must be in [1, 1000]");
  Vec3 low = stone.corners.front(), high = low;
  for (const Vec3& corner : stone.corners) {
    for (int a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], corner[a]);
      high[a] = std::max(high[a], corner[a]);
    }
  }
  const Vec3 extent = high - low;
  const double size = std::max({extent.x, extent.y, extent.z});
  const double volume = mass_properties(stone).volume;
  const double spacing = std::cbrt(volume / 6000);  // 6000 points inside
  const std::vector<Triangle> triangles = triangles_of(stone);
  std::vector<Candidate> candidates = inscribed_spheres(triangles, size);
  std::vector<Vec3> open = grid_inside(triangles, low, spacing, static_cast<int>(std::ceil(size / spacing)));
  Filling filling;
  while (static_cast<int>(filling.spheres.size()) < spheres) {
    if (take_best(candidates, open, filling.spheres)) continue;
    throw base::UserError("the stone was full after " + std::to_string(filling.spheres.size()) +
                          " spheres; ask for no more");
  }
  filling.error_volume = 1 - union_properties(filling.spheres).volume / volume;
  return filling;
}

}  // namespace dem
