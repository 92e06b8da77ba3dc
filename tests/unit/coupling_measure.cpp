// Porosity and coordination of arrangements whose values are exact.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "coupling/measure.hpp"

namespace {

using coupling::Box;
using coupling::Vec3;

// A sphere on a lattice of 30 to 50 points per diameter is wrong by up to 7e-3 of its volume.
constexpr double lattice_error = 4e-3;

/// Simple cubic arrangement of touching spheres of radius 0.5, n per edge, filling [0, n]^3.
std::vector<dem::GrainSphere> simple_cubic(int n) {
  std::vector<dem::GrainSphere> grains;
  for (int k = 0; k < n; ++k) {
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        dem::GrainSphere grain;
        grain.position = {i + 0.5, j + 0.5, k + 0.5};
        grain.radius = 0.5;
        grain.id = static_cast<std::int64_t>(grains.size()) + 10;
        grains.push_back(grain);
      }
    }
  }
  return grains;
}

// Simple cubic: 1 - pi/6. Counting whole spheres by centre would give 1 - 8 (pi/6)/6.75 for the shifted box below.
TEST(Measure, SimpleCubicPorosity) {
  const auto grains = simple_cubic(3);
  EXPECT_NEAR(coupling::porosity(grains, {{0, 0, 0}, {3, 3, 3}}, 0.03), 1 - std::numbers::pi / 6, lattice_error);
  // One period from the middle of a sphere to the middle of the next has the same porosity.
  EXPECT_NEAR(coupling::porosity(grains, {{0.5, 0.5, 0.5}, {1.5, 1.5, 2.5}}, 0.02), 1 - std::numbers::pi / 6,
              lattice_error);
}

TEST(Measure, OverlapCountsOnce) {
  auto grains = simple_cubic(1);
  grains.push_back(grains.front());
  EXPECT_NEAR(coupling::porosity(grains, {{0, 0, 0}, {1, 1, 1}}, 0.02), 1 - std::numbers::pi / 6, lattice_error);
}

TEST(Measure, FilterRestrictsTheRegion) {
  const auto grains = simple_cubic(2);
  const auto lower_half = [](const Vec3& p) { return p.z < 1; };
  EXPECT_NEAR(coupling::porosity(grains, {{0, 0, 0}, {2, 2, 4}}, 0.03, lower_half), 1 - std::numbers::pi / 6,
              lattice_error);
  EXPECT_DOUBLE_EQ(coupling::porosity(grains, {{0, 0, 0}, {2, 2, 4}}, 0.1, [](const Vec3&) { return false; }), 1);
  EXPECT_NEAR(coupling::volume({{0, 0, 0}, {2, 2, 4}}, 0.1, lower_half), 4, 1e-9);
}

TEST(Measure, EmptyBoxIsAllPores) {
  EXPECT_DOUBLE_EQ(coupling::porosity({}, {{0, 0, 0}, {1, 1, 1}}, 0.1), 1);
  EXPECT_DOUBLE_EQ(coupling::porosity({}, {{0, 0, 0}, {1, 1, 0}}, 0.1), 1);
}

// A chain of three with two contacts: the middle grain has 2, the ends 1: mean 4/3; halving (contacts / grains) gives
// 2/3.
TEST(Measure, CoordinationOfAChain) {
  std::vector<dem::Grain> grains(3);
  for (int i = 0; i < 3; ++i) {
    grains[static_cast<std::size_t>(i)].position = {static_cast<double>(i), 0, 0};
    grains[static_cast<std::size_t>(i)].id = 7 * i;
  }
  std::vector<dem::GrainContact> contacts(2);
  contacts[0].id_i = 0, contacts[0].id_j = 7;
  contacts[1].id_i = 14, contacts[1].id_j = 7;
  EXPECT_DOUBLE_EQ(coupling::coordination(grains, contacts, {{-1, -1, -1}, {3, 1, 1}}), 4.0 / 3.0);
  EXPECT_DOUBLE_EQ(coupling::coordination(grains, contacts, {{0.5, -1, -1}, {1.5, 1, 1}}), 2);
  EXPECT_DOUBLE_EQ(coupling::coordination(grains, contacts, {{5, 5, 5}, {6, 6, 6}}), 0);
}

}  // namespace
