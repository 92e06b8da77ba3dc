// Random insertion: nothing overlaps, everything stays inside, the same everywhere.
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "dem/grading.hpp"
#include "dem/insertion.hpp"

namespace {

using base::Vec3;

std::vector<double> some_radii(std::size_t count) {
  dem::Random random(5);
  std::vector<double> radii(count);
  for (double& radius : radii) radius = random.uniform(0.01, 0.03);
  return radii;
}

// Brute force over all pairs: a grid that misses a neighbouring cell shows as an overlap.
TEST(Insertion, NoOverlapAndInside) {
  const auto radii = some_radii(400);
  const std::vector<dem::Sphere> existing{{{0.2, 0.2, 0.05}, 0.05}, {{0.05, 0.3, 0.1}, 0.03}};
  const auto room = [](const dem::Sphere& s) { return s.position.x + s.radius < 0.3 || s.position.y > 0.2; };
  dem::Insertion insertion;
  insertion.lower = {0, 0, 0};
  insertion.upper = {0.4, 0.4, 0.2};
  insertion.gap = 1e-3;
  insertion.existing = existing;
  insertion.room = room;
  const dem::Inserted inserted = dem::insert_spheres(radii, insertion);
  std::vector<dem::Sphere> all;
  for (std::size_t i = 0; i < radii.size(); ++i) all.push_back({inserted.positions[i], radii[i]});
  for (const dem::Sphere& sphere : all) {
    EXPECT_TRUE(room(sphere));
    for (int axis = 0; axis < 3; ++axis) EXPECT_GE(sphere.position[axis] - sphere.radius, 0);
    EXPECT_LE(sphere.position.x + sphere.radius, 0.4);
    EXPECT_LE(sphere.position.y + sphere.radius, 0.4);
    EXPECT_LE(sphere.position.z + sphere.radius, inserted.top);
  }
  all.insert(all.end(), existing.begin(), existing.end());
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (i >= radii.size() && j >= radii.size()) continue;
      const double gap = base::norm(all[i].position - all[j].position) - all[i].radius - all[j].radius;
      ASSERT_GE(gap, 1e-3 - 1e-12) << i << " " << j;
    }
  }
  // 400 spheres of 2 cm radius hold 0.0168 m3: the box of 0.032 m3 must have grown.
  EXPECT_GT(inserted.top, 0.2);
}

TEST(Insertion, SameSeedSamePlaces) {
  const auto radii = some_radii(100);
  dem::Insertion insertion;
  insertion.upper = {0.4, 0.4, 0.2};
  const auto places = [&](std::uint64_t seed) {
    insertion.seed = seed;
    std::vector<double> numbers;
    for (const Vec3& p : dem::insert_spheres(radii, insertion).positions) {
      numbers.insert(numbers.end(), {p.x, p.y, p.z});
    }
    return numbers;
  };
  EXPECT_EQ(places(1), places(1));
  EXPECT_NE(places(1), places(2));
}

TEST(Insertion, SaysWhenThereIsNoRoom) {
  const auto radii = some_radii(3);
  dem::Insertion insertion;
  insertion.upper = {0.02, 1, 1};
  EXPECT_THROW(dem::insert_spheres(radii, insertion), base::UserError);
  insertion.upper = {1, 1, 1};
  insertion.room = [](const dem::Sphere&) { return false; };
  EXPECT_THROW(dem::insert_spheres(radii, insertion), base::UserError);
}

}  // namespace
