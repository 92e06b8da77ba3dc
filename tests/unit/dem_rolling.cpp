// Bounded rolling friction (dem/kernels/rolling.hpp; Irazabal2017 5.2).
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "dem/dem.hpp"
#include "dem/kernels/rolling.hpp"
#include "tests/dem_backend.hpp"

using base::Vec3;
using namespace dem::kernels;

namespace {
constexpr double inertia = 2e-4, dt = 1e-4;  // [kg m2], [s]
}

// Below the limit the rotation stops within the step, whatever torque acts. With I omega dt, as 5.4 is printed, it
// would not.
TEST(Rolling, StopsWithinOneStep) {
  const Vec3 spin{0.02, -0.01, 0.03}, torque{0.01, 0.02, -0.005};
  const auto resistance = bounded_rolling_friction({spin, torque, inertia, 1.0, dt});
  EXPECT_LT(norm(spin + dt / inertia * (torque + resistance.torque)), 1e-16);
}

// Above the limit the torque is the limit, against the rotation that would come.
TEST(Rolling, BoundedByTheContacts) {
  const Vec3 spin{0, 50, 0};
  const auto resistance = bounded_rolling_friction({spin, {}, inertia, 0.3, dt});
  EXPECT_NEAR(resistance.torque.y, -0.3, 1e-15);
  EXPECT_GT(resistance.loss, 0);
  EXPECT_EQ(norm(bounded_rolling_friction({spin, {}, inertia, 0, dt}).torque), 0);
  EXPECT_EQ(norm(bounded_rolling_friction({{}, {}, inertia, 0.3, dt}).torque), 0);
}

// A grain braked from 50 rad/s: the losses are its rotational energy, the time is I omega / T, then it rests for good
// (a torque of fixed size against omega would tremble).
TEST(Rolling, LossIsTheRotationalEnergy) {
  Vec3 spin{0, 50, 0};
  const double limit = 0.0037;
  double loss = 0;
  int moving = 0;
  for (int step = 0; step < 40000; ++step) {
    const auto resistance = bounded_rolling_friction({spin, {}, inertia, limit, dt});
    spin += dt / inertia * resistance.torque;
    loss += resistance.loss;
    moving += norm(spin) > 0;
  }
  EXPECT_EQ(norm(spin), 0);
  EXPECT_NEAR(loss, 0.5 * inertia * 2500, 1e-12);
  EXPECT_NEAR(moving * dt, inertia * 50 / limit, 2 * dt);
}

// A torque below the limit never starts a rotation and does no work.
TEST(Rolling, HoldsAgainstSmallTorque) {
  Vec3 spin;
  double loss = 0;
  for (int step = 0; step < 100; ++step) {
    const Vec3 torque{0.001 * (step % 7), -0.002, 0};
    const auto resistance = bounded_rolling_friction({spin, torque, inertia, 0.01, dt});
    spin += dt / inertia * (torque + resistance.torque);
    loss += std::abs(resistance.loss);
  }
  EXPECT_LT(norm(spin), 1e-18);
  EXPECT_LT(loss, 1e-18);
}

// A grain that spins between two smaller ones, all three pressed into a row by smooth walls: it slows down as
// I domega/dt = -2 eta min(R_i, R_j) F, the smaller ones do not turn. One contact after the other and swept.
TEST(Rolling, LimitOfTwoGrainsIsThatOfTheSmallerOne) {
  const double large = 0.02, small = 0.015, overlap = 1e-6, eta = 0.2, density = 2500, step = 1e-6;
  for (const int lanes : {1, 0}) {
    dem::Setup setup;
    setup.materials = {{"stone", 1e8, 0.25, density}, {"wall", 1e8, 0.25, 0}};
    const dem::Interaction grains{1e-9, 1, eta}, smooth{};
    setup.interactions = {grains, smooth, smooth, smooth};
    setup.lanes = lanes;
    const auto sim = dem_test::create(setup);
    const double apart = large + small - overlap;
    sim->add_grains(
        std::vector<dem::Grain>{{.position = {0, 0, 0}, .radius = large, .angular_velocity = {0, 0, 10}, .id = 0},
                                {.position = {-apart, 0, 0}, .radius = small, .id = 1},
                                {.position = {apart, 0, 0}, .radius = small, .id = 2}});
    // Walls that press as hard as the grains on each other: F ~ sqrt(R*) overlap^1.5.
    const double reduced = large * small / (large + small);
    const double at_wall = overlap * std::cbrt(reduced / small);
    for (const double side : {-1.0, 1.0}) sim->add_plane({{side * (apart + small - at_wall), 0, 0}, {-side, 0, 0}}, 1);
    sim->advance(1000, step);
    const double force = 4.0 / 3.0 * (1e8 / (2 * (1 - 0.0625))) * std::sqrt(reduced) * std::pow(overlap, 1.5);
    const double moment = 0.4 * density * 4.0 / 3.0 * std::numbers::pi * std::pow(large, 5);
    const auto now = sim->grains();
    EXPECT_NEAR(10 - now[0].angular_velocity.z, 2 * eta * small * force / moment * 1000 * step,
                1e-3 * 2 * eta * small * force / moment * 1000 * step)
        << lanes;
    EXPECT_EQ(norm(now[1].angular_velocity), 0) << lanes;
  }
}
