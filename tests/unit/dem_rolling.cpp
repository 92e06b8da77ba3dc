// Bounded rolling friction (dem/kernels/rolling.hpp; Irazabal2017 5.2).
#include <gtest/gtest.h>

#include <algorithm>

#include "dem/kernels/rolling.hpp"

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
