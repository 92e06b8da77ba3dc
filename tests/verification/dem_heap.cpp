// Angle of repose of heaps whose slope is known: spheres at random places inside cones and slopes.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "dem/grading.hpp"
#include "dem/measure/heap.hpp"

namespace {

using dem::Vec3;

constexpr double degree = std::numbers::pi / 180;
constexpr double tolerance = 1 * degree;

/// Spheres of radius 0.4 to 0.6 at random places (they may overlap), wherever the whole sphere lies under the surface
/// z = height - slope * distance and above z = 0. 1.1 per unit volume: the solid share of a loose packing.
std::vector<dem::GrainSphere> filled(double angle, double height, const Vec3& lower, const Vec3& upper,
                                     const std::function<double(const Vec3&)>& distance, std::uint64_t seed) {
  dem::Random random(seed);
  std::vector<dem::GrainSphere> spheres;
  const Vec3 size = upper - lower;
  const auto tries = static_cast<std::size_t>(1.1 * size.x * size.y * height);
  for (std::size_t i = 0; i < tries; ++i) {
    dem::GrainSphere sphere;
    sphere.position.x = random.uniform(lower.x, upper.x);
    sphere.position.y = random.uniform(lower.y, upper.y);
    sphere.position.z = random.uniform(0, height);
    sphere.radius = random.uniform(0.4, 0.6);
    sphere.id = static_cast<std::int64_t>(spheres.size());
    const double below = (height - sphere.position.z) * std::cos(angle) - distance(sphere.position) * std::sin(angle);
    if (below >= sphere.radius && sphere.position.z >= sphere.radius) spheres.push_back(sphere);
  }
  return spheres;
}

const Vec3 axis{3, -2, 0};

std::vector<dem::GrainSphere> cone(double angle, double height, std::uint64_t seed = 1) {
  const double reach = height / std::tan(angle);
  const auto distance = [](const Vec3& p) { return std::hypot(p.x - axis.x, p.y - axis.y); };
  return filled(angle, height, axis - Vec3{reach, reach, 0}, axis + Vec3{reach, reach, 0}, distance, seed);
}

/// A ridge along y with its crest at x = 3, 8 wide; or its right half, against a wall at the crest.
std::vector<dem::GrainSphere> slope(double angle, double height, bool whole, std::uint64_t seed = 1) {
  const double reach = height / std::tan(angle);
  const auto distance = [](const Vec3& p) { return std::abs(p.x - axis.x); };
  return filled(angle, height, {axis.x - (whole ? reach : 0), -4, 0}, {axis.x + reach, 4, 0}, distance, seed);
}

// The straight flank of a cone is recovered whatever its angle; a line through apex and foot, or cells by azimuth alone
// (fewer grains near the axis, hence lower tops), would be some degrees too flat.
TEST(Heap, ConesOfKnownAngle) {
  for (const double degrees : {25.0, 33.0, 40.0, 45.0}) {
    for (const std::uint64_t seed : {1, 2, 3}) {
      const auto heap = dem::heap_angle(cone(degrees * degree, 20, seed));
      EXPECT_NEAR(heap.angle / degree, degrees, tolerance / degree) << "seed " << seed;
      EXPECT_EQ(heap.flanks, 8);
      EXPECT_NEAR(heap.height, 20, 2);
      EXPECT_GT(heap.scatter, 0);
      EXPECT_LT(heap.scatter, 3 * degree);
    }
  }
}

// A ridge has two sides, a slope that leans against a wall one; the crest is found.
TEST(Heap, SlopesOfKnownAngle) {
  for (const double degrees : {25.0, 33.0, 40.0, 45.0}) {
    for (const bool whole : {true, false}) {
      for (const std::uint64_t seed : {1, 2, 3}) {
        const auto heap = dem::heap_angle(slope(degrees * degree, 20, whole, seed), {dem::HeapView::x, {}, {}});
        EXPECT_NEAR(heap.angle / degree, degrees, tolerance / degree) << "seed " << seed << (whole ? "" : " half");
        EXPECT_EQ(heap.flanks, whole ? 8 : 4);
        EXPECT_NEAR(heap.height, 20, 2);
      }
    }
  }
}

// 2 % of the grains lie on the floor up to four heap radii away, one flies above the apex, one has fallen off the
// table.
TEST(Heap, StonesThatRolledAwayDoNotCount) {
  const double angle = 33 * degree;
  auto spheres = cone(angle, 20);
  const double alone = dem::heap_angle(spheres).angle;
  dem::Random random(5);
  const auto add = [&](const Vec3& position) {
    spheres.push_back({position, 0.5, static_cast<std::int64_t>(spheres.size())});
  };
  for (std::size_t i = 0, stray = spheres.size() / 50; i < stray; ++i)
    add(axis + Vec3{random.uniform(30, 120), random.uniform(-60, 60), 0.5});
  add(axis + Vec3{1, 0, 60});
  add(axis + Vec3{40, 0, -500});
  const auto heap = dem::heap_angle(spheres);
  EXPECT_NEAR(heap.angle, alone, 0.3 * degree);
  EXPECT_EQ(heap.flanks, 8);
  EXPECT_NEAR(heap.height, 20, 2);
}

// An axis that is off by a tenth of the radius turns a flank's slope by the second order of that only.
TEST(Heap, GivenAxisNeedNotBeExact) {
  const auto spheres = cone(33 * degree, 20);
  const Vec3 off = axis + Vec3{3, 0, 0};
  EXPECT_NEAR(dem::heap_angle(spheres, {dem::HeapView::vertical, off, 0.0}).angle, 33 * degree, 0.5 * degree);
}

// The same ridge turned by a right angle.
TEST(Heap, SlopeAlongY) {
  auto spheres = slope(33 * degree, 20, true);
  for (auto& sphere : spheres) std::swap(sphere.position.x, sphere.position.y);
  EXPECT_NEAR(dem::heap_angle(spheres, {dem::HeapView::y, {}, {}}).angle, 33 * degree, tolerance);
}

TEST(Heap, FlatBedsAreNone) {
  EXPECT_EQ(dem::heap_angle({}).flanks, 0);
  dem::Random random(1);
  std::vector<dem::GrainSphere> bed;
  for (int i = 0; i < 4000; ++i)
    bed.push_back({{random.uniform(0, 30), random.uniform(0, 30), random.uniform(0.5, 3.5)}, 0.5, i});
  const auto heap = dem::heap_angle(bed);
  EXPECT_EQ(heap.flanks, 0);
  EXPECT_EQ(heap.angle, 0);
  EXPECT_NEAR(heap.height, 4, 0.3);
}

}  // namespace
