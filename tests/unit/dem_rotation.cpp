// Quaternions and one step of the rotation schemes. Whole motions: tests/verification/dem_rotation.cpp.
#include <gtest/gtest.h>

#include <cmath>

#include "dem/kernels/rotation.hpp"

namespace {

using namespace dem::kernels;

void expect_near(const Vec3& a, const Vec3& b, double tolerance) { EXPECT_NEAR(norm(a - b), 0, tolerance); }

/// Rotation about a unit vector by its formula (Rodrigues; the matrix of Irazabal2017 5.28).
Vec3 rodrigues(const Vec3& axis, double angle, const Vec3& v) {
  return std::cos(angle) * v + std::sin(angle) * cross(axis, v) + (1 - std::cos(angle)) * dot(axis, v) * axis;
}

const Vec3 axis = (1 / std::sqrt(14.0)) * Vec3{1, -2, 3};
const Vec3 some{0.3, 0.7, -1.1};

// Both sides of the change from series to sine (0.2 rad), a small angle and more than a turn.
TEST(Rotation, TurnIsRodrigues) {
  for (const double angle : {0.0, 1e-9, 1e-3, 0.1, 0.1999999, 0.2000001, 1.0, 3.0, 7.0}) {
    const Quaternion q = turn_by(angle * axis);
    EXPECT_NEAR(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z, 1, 1e-15) << angle;
    expect_near(to_space(q, some), rodrigues(axis, angle, some), 1e-15 * 8);
    expect_near(to_body(q, to_space(q, some)), some, 1e-15 * 4);
  }
}

// (a b) turns by b first: the other order would fail by the commutator, here of order one.
TEST(Rotation, ProductTurnsByTheSecondFirst) {
  const Quaternion a = turn_by({0.5, 0, 0}), b = turn_by({0, 0.9, 0});
  expect_near(to_space(a * b, some), to_space(a, to_space(b, some)), 1e-15 * 4);
  expect_near(to_space(conjugate(a) * a, some), some, 1e-15 * 4);
}

TEST(Rotation, NormalisedZeroIsNoTurn) {
  EXPECT_EQ(normalised({0, 0, 0, 0}).w, 1);
  EXPECT_EQ(normalised({0, 0, 3, 0}).y, 1);
}

// L' = I' omega' and E = 1/2 omega' I' omega' with the body turned: z of the body along x of space.
TEST(Rotation, MomentumAndEnergy) {
  RigidRotation r;
  r.orientation = turn_by({0, std::acos(0.0), 0});
  r.angular_velocity = {2, 0, 0};
  expect_near(angular_momentum(r, {1, 2, 5}), {10, 0, 0}, 1e-14);
  EXPECT_NEAR(rotational_energy(r, {1, 2, 5}), 10, 1e-14);
}

template <class Scheme>
class EveryRotationScheme : public testing::Test {};
using Schemes = testing::Types<ZhaoVanWachem, RungeKutta, Direct>;
TYPED_TEST_SUITE(EveryRotationScheme, Schemes);

// A step at rest without torque does nothing, not even by rounding.
TYPED_TEST(EveryRotationScheme, RestStaysRest) {
  RigidRotation r;
  TypeParam::begin_step(r, {1, 2, 3}, {}, 0.1);
  TypeParam::finish_step(r, {1, 2, 3}, {}, 0.1);
  EXPECT_EQ(norm(r.angular_velocity), 0);
  EXPECT_EQ(r.orientation.w, 1);
}

// A ball turns by omega dt about a fixed axis, whatever the orientation.
TYPED_TEST(EveryRotationScheme, FreeBallTurnsUniformly) {
  RigidRotation r;
  r.orientation = turn_by(some);
  r.angular_velocity = 3.0 * axis;
  const Quaternion start = r.orientation;
  for (int step = 0; step < 10; ++step) {
    TypeParam::begin_step(r, {0.4, 0.4, 0.4}, {}, 0.02);
    TypeParam::finish_step(r, {0.4, 0.4, 0.4}, {}, 0.02);
  }
  expect_near(r.angular_velocity, 3.0 * axis, 1e-14);
  expect_near(to_space(r.orientation, some), to_space(turn_by(0.6 * axis) * start, some), 1e-14);
}

// Spin about a principal axis of any body is steady (omega' x I' omega' = 0).
TYPED_TEST(EveryRotationScheme, PrincipalSpinIsSteady) {
  RigidRotation r;
  r.orientation = turn_by(some);
  r.angular_velocity = to_space(r.orientation, {0, 0, 4});
  const Vec3 before = r.angular_velocity;
  TypeParam::begin_step(r, {1, 2, 5}, {}, 0.05);
  TypeParam::finish_step(r, {1, 2, 5}, {}, 0.05);
  expect_near(r.angular_velocity, before, 1e-14);
}

// The torque's impulse (T(n) + T(n+1)) dt / 2 is the change of angular momentum, exactly (Runge-Kutta keeps it in
// flight). A torque taken into the wrong frame fails by its own size.
TEST(Rotation, ImpulseChangesMomentumExactly) {
  const Vec3 inertia{1, 2, 5}, first{0.3, -0.2, 0.9}, second{-0.4, 0.1, 0.5};
  const double dt = 0.03;
  RigidRotation r;
  r.orientation = turn_by(some);
  r.angular_velocity = {0.2, 0.5, -0.1};
  const Vec3 before = angular_momentum(r, inertia);
  RungeKutta::begin_step(r, inertia, first, dt);
  RungeKutta::finish_step(r, inertia, second, dt);
  expect_near(angular_momentum(r, inertia) - before, (0.5 * dt) * (first + second), 1e-15);
  const Vec3 kicked = angular_momentum(r, inertia);
  kick(r, inertia, 0.01 * first);
  expect_near(angular_momentum(r, inertia) - kicked, 0.01 * first, 1e-15);
}

TEST(Rotation, SchemeByName) {
  const auto name = [](RotationScheme scheme) {
    return with_rotation_scheme(scheme, [](auto chosen) {
      using Scheme = decltype(chosen);
      return std::is_same_v<Scheme, ZhaoVanWachem> ? 0 : std::is_same_v<Scheme, RungeKutta> ? 1 : 2;
    });
  };
  EXPECT_EQ(name(RotationScheme::quaternion), 0);
  EXPECT_EQ(name(RotationScheme::runge_kutta), 1);
  EXPECT_EQ(name(RotationScheme::direct), 2);
}

}  // namespace
