// Measures of grains and contacts on arrangements whose values are exact.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "dem/measure/contact_forces.hpp"
#include "dem/measure/contact_numbers.hpp"
#include "dem/measure/region.hpp"
#include "dem/measure/stress.hpp"

namespace {

using dem::BallRegion;
using dem::BoxRegion;
using dem::Vec3;

dem::Grain grain_at(std::int64_t id, const Vec3& position, double radius = 0.5) {
  dem::Grain grain;
  grain.id = id;
  grain.position = position;
  grain.radius = radius;
  return grain;
}

dem::GrainContact contact(const dem::Grain& i, const dem::Grain& j, const Vec3& force_on_i) {
  return {i.id, j.id, i.position, j.position, force_on_i, 0};
}

TEST(Region, ShareOfALine) {
  const BoxRegion box{{0, 0, 0}, {2, 1, 1}};
  EXPECT_DOUBLE_EQ(share_inside(box, {-1, 0.5, 0.5}, {1, 0.5, 0.5}), 0.5);
  EXPECT_DOUBLE_EQ(share_inside(box, {-1, 0.5, 0.5}, {3, 0.5, 0.5}), 0.5);
  EXPECT_DOUBLE_EQ(share_inside(box, {0.5, 0.5, 0.5}, {1, 0.5, 0.6}), 1);
  EXPECT_DOUBLE_EQ(share_inside(box, {-1, 2, 0.5}, {3, 2, 0.5}), 0);
  EXPECT_DOUBLE_EQ(share_inside(box, {1, 0.5, 0.5}, {1, 0.5, 0.5}), 1);
  const BallRegion ball{{0, 0, 0}, 1};
  EXPECT_DOUBLE_EQ(share_inside(ball, {0, 0, 0}, {4, 0, 0}), 0.25);
  EXPECT_DOUBLE_EQ(share_inside(ball, {-2, 0.6, 0}, {2, 0.6, 0}), 0.4);  // a chord of 1.6
  EXPECT_DOUBLE_EQ(share_inside(ball, {-2, 1.5, 0}, {2, 1.5, 0}), 0);
  EXPECT_DOUBLE_EQ(share_inside(ball, {2, 0, 0}, {3, 0, 0}), 0);
}

TEST(Region, VolumeAndBox) {
  EXPECT_DOUBLE_EQ(volume(BoxRegion{{0, 0, 0}, {2, 3, 4}}), 24);
  EXPECT_DOUBLE_EQ(volume(BallRegion{{1, 2, 3}, 3}), 36 * std::numbers::pi);
  EXPECT_EQ(box_around(BallRegion{{1, 2, 3}, 3}).lower.z, 0);
  EXPECT_TRUE(contains(BallRegion{{1, 2, 3}, 3}, {1, 2, 6}));
  EXPECT_FALSE(contains(BallRegion{{1, 2, 3}, 3}, {3, 4, 5}));
}

/// n^3 touching spheres of diameter 1, filling [0, n]^3, pressed by walls on all sides: every contact across `axis`
/// carries push[axis].
struct Cube {
  std::vector<dem::Grain> grains;
  std::vector<dem::GrainContact> contacts;
  std::vector<dem::WallContact> walls;

  Cube(int n, const Vec3& push) {
    const auto at = [n](int i, int j, int k) { return static_cast<std::size_t>((k * n + j) * n + i); };
    for (int id = 0; id < n * n * n; ++id)
      grains.push_back(grain_at(id, {id % n + 0.5, id / n % n + 0.5, id / n / n + 0.5}));
    for (int k = 0; k < n; ++k)
      for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i)
          for (int axis = 0; axis < 3; ++axis) {
            const int place[3] = {i, j, k};
            const dem::Grain& here = grains[at(i, j, k)];
            Vec3 step{};
            step[axis] = 1;
            if (place[axis] + 1 < n)
              contacts.push_back(
                  contact(here, grains[at(i + (axis == 0), j + (axis == 1), k + (axis == 2))], step * -push[axis]));
            else
              walls.push_back({here.id, 1, here.position, here.position + step * 0.5, step * -push[axis], 0});
            if (place[axis] == 0)
              walls.push_back({here.id, 0, here.position, here.position - step * 0.5, step * push[axis], 0});
          }
  }
};

// A cubic array pressed by walls: sigma = -force per contact / d^2 along every axis, in the whole cube, in any part of
// it, and with contacts cut by the region's faces. Without the walls 1/n would be missing, without weights the box of
// 1.3 would be wrong by up to a third.
TEST(Stress, CubicArrayPressedByWalls) {
  const Cube cube(4, {2, 3, 5});
  for (const BoxRegion& box : {BoxRegion{{0, 0, 0}, {4, 4, 4}}, BoxRegion{{1, 1, 1}, {3, 2, 4}}}) {
    const auto stress = region_stress(box, cube.grains, cube.contacts, cube.walls);
    EXPECT_NEAR(stress.xx, -2, 1e-12);
    EXPECT_NEAR(stress.yy, -3, 1e-12);
    EXPECT_NEAR(stress.zz, -5, 1e-12);
    EXPECT_NEAR(stress.pressure(), 10.0 / 3, 1e-12);
    EXPECT_NEAR(stress.von_mises(), std::sqrt(0.5 * (1 + 4 + 9)), 1e-12);
    EXPECT_NEAR(stress.xy, 0, 1e-12);
  }
  const BoxRegion cut{{0, 0, 1.2}, {4, 4, 2.5}};  // vertical branches cut anywhere
  EXPECT_NEAR(region_stress(cut, cube.grains, cube.contacts, cube.walls).zz, -5, 1e-12);
  EXPECT_EQ(region_stress(BoxRegion{{9, 9, 9}, {10, 10, 10}}, cube.grains, cube.contacts, cube.walls).zz, 0);
}

// A ball of ten diameters holds the stress up to the grain of its surface.
TEST(Stress, BallInACubicArray) {
  const Cube cube(12, {1, 1, 1});
  const auto stress = region_stress(BallRegion{{6, 6, 6}, 5}, cube.grains, cube.contacts, cube.walls);
  EXPECT_NEAR(stress.pressure(), 1, 0.02);
  EXPECT_NEAR(stress.von_mises(), 0, 0.02);
}

// A column of n spheres of weight w under gravity: the contact below sphere k carries what lies above, so that the
// stress between two heights is the weight above over the area, on average.
TEST(Stress, ColumnUnderGravity) {
  constexpr int n = 10;
  constexpr double weight = 3;
  std::vector<dem::Grain> grains;
  std::vector<dem::GrainContact> contacts;
  for (int k = 0; k < n; ++k) grains.push_back(grain_at(k, {0.5, 0.5, k + 0.5}));
  for (int k = 0; k + 1 < n; ++k) contacts.push_back(contact(grains[k], grains[k + 1], {0, 0, -weight * (n - 1 - k)}));
  const std::vector<dem::WallContact> floor{{0, 0, grains[0].position, {0.5, 0.5, 0}, {0, 0, weight * n}, 0}};
  const auto between = [&](double lower, double upper) {
    return region_stress(BoxRegion{{0, 0, lower}, {1, 1, upper}}, grains, contacts, floor).zz;
  };
  EXPECT_NEAR(between(4.5, 5.5), -weight * 5, 1e-12);                // one contact, five spheres above it
  EXPECT_NEAR(between(5, 6), -weight * (0.5 * 5 + 0.5 * 4), 1e-12);  // half of two
  EXPECT_NEAR(between(0, 0.5), -weight * n, 1e-12);                  // on the floor: all of it
  EXPECT_NEAR(between(0, n), -weight * 0.5 * n, 1e-12);              // mean
}

// Simple shear: force along x on a branch along z gives the symmetric half on both; compression stays negative.
TEST(Stress, ShearIsSymmetric) {
  const std::vector<dem::Grain> grains{grain_at(1, {0, 0, 0}), grain_at(2, {0, 0, 1})};
  const std::vector<dem::GrainContact> contacts{contact(grains[0], grains[1], {4, 0, -6})};
  const auto stress = region_stress(BoxRegion{{-1, -1, 0}, {1, 1, 1}}, grains, contacts, {});
  EXPECT_DOUBLE_EQ(stress.zz, -1.5);
  EXPECT_DOUBLE_EQ(stress.zx, 0.5);
  EXPECT_DOUBLE_EQ(stress.xy, 0);
}

/// A triangle 0-1-2 on a floor, a tail 3 hanging on 2, a lone 4.
struct Few {
  std::vector<dem::Grain> grains{grain_at(0, {0, 0, 0}), grain_at(1, {1, 0, 0}), grain_at(2, {0.5, 0, 0.9}),
                                 grain_at(3, {1.5, 0, 1}), grain_at(4, {5, 0, 0})};
  std::vector<dem::GrainContact> contacts{contact(grains[0], grains[1], {}), contact(grains[1], grains[2], {}),
                                          contact(grains[2], grains[0], {}), contact(grains[3], grains[2], {}),
                                          contact(grains[2], grains[3], {})};  // two spheres of clumps
  std::vector<dem::WallContact> walls{{0, 0, {}, {}, {}, 0}, {4, 0, {}, {}, {}, 0}};
  BoxRegion all{{-10, -10, -10}, {10, 10, 10}};
};

// Thornton 2000: N = 5, C = 4, N0 = 0 (the floor bears the lone one, which is one contact), N1 = 2 counting the floor:
// Z_m over the three of the triangle = (2 + 2 + 3)/3. Counting the clumps' double contact twice would give 8/3.
TEST(ContactNumbers, RattlersCarryNothing) {
  const Few few;
  const auto numbers = contact_numbers(few.all, few.grains, few.contacts, few.walls);
  EXPECT_EQ(numbers.grains, 5u);
  EXPECT_EQ(numbers.rattlers, 2u);
  EXPECT_DOUBLE_EQ(numbers.rattler_share(), 0.4);
  EXPECT_DOUBLE_EQ(numbers.coordination, 8.0 / 5);
  EXPECT_DOUBLE_EQ(numbers.mechanical, 7.0 / 3);
  // Four are needed: nobody has them.
  EXPECT_EQ(contact_numbers(few.all, few.grains, few.contacts, few.walls, 4).mechanical, 0);
  // Only centres inside count; their partners may be outside.
  const auto one = contact_numbers(BoxRegion{{0.2, -1, 0.5}, {0.8, 1, 1.5}}, few.grains, few.contacts, few.walls);
  EXPECT_EQ(one.grains, 1u);
  EXPECT_DOUBLE_EQ(one.mechanical, 3);
  EXPECT_EQ(contact_numbers(BoxRegion{{8, 8, 8}, {9, 9, 9}}, few.grains, few.contacts, few.walls).coordination, 0);
}

/// A row of grains a unit apart along x with these normal forces between them, and a shear of an eighth of each.
std::vector<dem::GrainContact> row_of_forces(const std::vector<double>& normal) {
  std::vector<dem::GrainContact> contacts;
  for (std::size_t k = 0; k < normal.size(); ++k) {
    const double x = static_cast<double>(k);
    contacts.push_back(contact(grain_at(2 * static_cast<int>(k), {x, 0, 0}),
                               grain_at(2 * static_cast<int>(k) + 1, {x + 1, 0, 0}),
                               {-normal[k], 0, 0.125 * normal[k]}));
  }
  return contacts;
}

TEST(ContactForces, MeanShareAndQuantile) {
  const auto contacts = row_of_forces({1, 2, 3, 4, 10});
  const auto forces = dem::contact_forces(nullptr, contacts);
  ASSERT_EQ(forces.size(), 5u);
  EXPECT_DOUBLE_EQ(forces[2].normal, 3);
  EXPECT_DOUBLE_EQ(forces[2].shear, 0.375);
  EXPECT_DOUBLE_EQ(dem::mean_normal_force(forces), 4);
  EXPECT_DOUBLE_EQ(dem::share_above_mean(forces), 0.2);
  EXPECT_DOUBLE_EQ(dem::normal_force_quantile(forces, 0.5), 3);
  EXPECT_DOUBLE_EQ(dem::normal_force_quantile(forces, 0.9), 4 + 0.6 * 6);
  EXPECT_DOUBLE_EQ(dem::normal_force_quantile(forces, 0), 1);
  EXPECT_DOUBLE_EQ(dem::normal_force_quantile(forces, 1), 10);
  const dem::Region left = BoxRegion{{0, -1, -1}, {2, 1, 1}};  // contact points at 0.5, 1.5, 2.5, …
  EXPECT_DOUBLE_EQ(dem::mean_normal_force(dem::contact_forces(&left, contacts)), 1.5);
  // A wall pushes the grain away from it.
  const std::vector<dem::WallContact> walls{{0, 0, {0, 0, 0}, {0, 0, -0.5}, {0, 2, 7}, 0}};
  const auto with_wall = dem::contact_forces(nullptr, {}, walls);
  EXPECT_DOUBLE_EQ(with_wall.at(0).normal, 7);
  EXPECT_DOUBLE_EQ(with_wall[0].shear, 2);
  EXPECT_EQ(dem::mean_normal_force({}), 0);
  EXPECT_EQ(dem::share_above_mean({}), 0);
  EXPECT_EQ(dem::normal_force_quantile({}, 0.5), 0);
}

// Forces 1, 2, 3, 4, 10 of mean 4 fall at 0.25, 0.5, 0.75, 1 and 2.5: classes of 0.5 hold 1, 2, 1, 0, 0, 1 of five.
TEST(ContactForces, HistogramIsADensity) {
  const auto forces = dem::contact_forces(nullptr, row_of_forces({1, 2, 3, 4, 10}));
  const auto histogram = dem::force_histogram(forces, 0.5);
  const std::vector<double> expected{0.4, 0.8, 0.4, 0, 0, 0.4};
  ASSERT_EQ(histogram.normal.size(), expected.size());
  for (std::size_t k = 0; k < expected.size(); ++k) {
    EXPECT_NEAR(histogram.normal[k], expected[k], 1e-12) << k;
    EXPECT_NEAR(histogram.shear[k], expected[k], 1e-12) << k;  // in proportion
  }
  EXPECT_TRUE(dem::force_histogram({}).normal.empty());
}

// Exponential forces, the tail of Radjai1996: P(x) = exp(-x), 1/e of the contacts above the mean.
TEST(ContactForces, ExponentialForces) {
  std::vector<dem::ContactForce> forces;
  constexpr int n = 20000;
  for (int k = 0; k < n; ++k) forces.push_back({-3 * std::log((k + 0.5) / n), 1});
  EXPECT_NEAR(dem::mean_normal_force(forces), 3, 1e-3);
  EXPECT_NEAR(dem::share_above_mean(forces), std::exp(-1), 1e-3);
  EXPECT_NEAR(dem::normal_force_quantile(forces, 0.9), 3 * std::log(10), 0.01);
  const auto histogram = dem::force_histogram(forces, 0.1);
  EXPECT_NEAR(histogram.normal[10], std::exp(-1.05), 0.01);
}

}  // namespace
