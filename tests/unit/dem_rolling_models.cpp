// Rolling resistance per contact (dem/kernels/rolling_models.hpp; Ai et al. 2011, Irazabal2017 5.1-5.3).
#if defined(__GNUC__)  // packs wider than this build's registers: their functions are inlined, no call passes one
#pragma GCC diagnostic ignored "-Wpsabi"
#endif
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "dem/law_parameters.hpp"
#include "dem/laws.hpp"
#include "tests/dem_pair_helper.hpp"

using namespace dem_test;

namespace {

constexpr double radius = 0.01, normal_force = 20, shear_stiffness = 1e6, limit = 0.2 * radius * normal_force;
const double mass = sphere_mass(radius, 2500), inertia = 1.4 * mass * radius * radius;

PairParameters stone() {
  PairParameters pair = dem::hertz_wall({"stone", 1e9, 0.25, 2500}, {"stone", 1e9, 0.25, 0}, {0.5, 0.5, 0.2});
  pair.rolling_stiffness = dem::rolling_stiffness(pair.rolling_friction, dem::normal_to_shear_stiffness(pair));
  pair.rolling_damping = 0.3;
  return pair;
}
const Touch<double> touch{1e-5, radius, mass, {0, 0, 1}, {}};

template <class Model>
class RollingModels : public testing::Test {};
using Models = testing::Types<NoRolling, RollingA, RollingC>;
TYPED_TEST_SUITE(RollingModels, Models);

}  // namespace

// |M| <= eta_r R* F_n, no part along the normal, exchange of i and j turns it round, and it never drives.
TYPED_TEST(RollingModels, BoundedReciprocalPassive) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(-1, 1);
  double history[TypeParam::history + 1] = {}, mirrored[TypeParam::history + 1] = {};
  const PairParameters pair = stone();
  double work = 0, loss = 0, stored = 0;
  for (int n = 0; n < 2000; ++n) {
    const Vec3 turning{5 * unit(random), 5 * unit(random), 5 * unit(random)};
    const double force = normal_force * (1 + unit(random)), k_t = shear_stiffness * (1 + 0.5 * unit(random));
    const RollingContact<double> contact{turning, force, k_t, inertia}, other{-turning, force, k_t, inertia};
    Touch<double> swapped = touch;
    swapped.normal = {0, 0, -1};
    const auto on_i = TypeParam::template resist<true>(pair, touch, contact, {5e-6, 5e-6}, history);
    const auto on_j = TypeParam::template resist<true>(pair, swapped, other, {5e-6, 5e-6}, mirrored);
    EXPECT_LE(norm(on_i.moment + on_j.moment), 1e-14 * limit);
    EXPECT_LE(norm(on_i.moment), 0.2 * radius * force * (1 + 1e-12));
    EXPECT_NEAR(on_i.moment.z, 0, 1e-14 * limit);
    work -= dot(on_i.moment, turning) * 1e-5;
    loss += on_i.loss;
    stored = on_i.elastic;
  }
  EXPECT_GE(work, 0);
  EXPECT_NEAR(work, stored + loss, 1e-9 * work);
}

TYPED_TEST(RollingModels, FrameIndifferent) {
  const Vec3 axis{1 / 3.0, 2 / 3.0, -2 / 3.0}, turning{3, -2, 5};
  double history[TypeParam::history + 1] = {}, moved_history[TypeParam::history + 1] = {};
  Touch<double> moved = touch;
  moved.normal = rotated(touch.normal, axis, 1.1);
  for (int n = 0; n < 50; ++n) {
    const RollingContact<double> contact{turning, normal_force, shear_stiffness, inertia};
    RollingContact<double> seen = contact;
    seen.angular_velocity = rotated(turning, axis, 1.1);
    const auto plain = TypeParam::template resist<true>(stone(), touch, contact, {5e-6, 5e-6}, history);
    const auto other = TypeParam::template resist<true>(stone(), moved, seen, {5e-6, 5e-6}, moved_history);
    EXPECT_LT(norm(rotated(plain.moment, axis, 1.1) - other.moment), 1e-12 * limit);
  }
}

TYPED_TEST(RollingModels, NothingWhereApart) {
  double history[TypeParam::history + 1] = {};
  const RollingContact<double> contact{{3, -2, 5}, normal_force, shear_stiffness, inertia},
      apart{{3, -2, 5}, 0, 0, inertia};
  Touch<double> open = touch;
  open.overlap = -1e-6;
  TypeParam::template resist<true>(stone(), touch, contact, {5e-6, 5e-6}, history);
  const auto gone = TypeParam::template resist<true>(stone(), open, apart, {5e-6, 5e-6}, history);
  EXPECT_EQ(norm(gone.moment), 0);
  EXPECT_GE(gone.loss, 0);  // what the spring still held
  for (double number : history) EXPECT_EQ(number, 0);
}

TYPED_TEST(RollingModels, LanesAgreeWithPlainNumbers) {
  using Real = Pack<double, 4>;
  std::mt19937 random(13);
  std::uniform_real_distribution<double> unit(-1, 1);
  Real history[TypeParam::history + 1] = {};
  double plain_history[4][TypeParam::history + 1] = {};
  for (int n = 0; n < 200; ++n) {
    Touch<Real> pack{};
    RollingContact<Real> packs{};
    Moment<double> one[4];
    for (int k = 0; k < 4; ++k) {
      Touch<double> plain = touch;
      plain.overlap = 1e-5 * (0.7 + unit(random));
      const bool apart = plain.overlap <= 0;
      const RollingContact<double> contact{{unit(random), unit(random), unit(random)},
                                           apart ? 0 : normal_force * (1 + unit(random)),
                                           apart ? 0 : shear_stiffness,
                                           inertia};
      pack.overlap[k] = plain.overlap;
      pack.effective_radius[k] = radius;
      pack.normal.z[k] = 1;
      packs.angular_velocity.x[k] = contact.angular_velocity.x;
      packs.angular_velocity.y[k] = contact.angular_velocity.y;
      packs.angular_velocity.z[k] = contact.angular_velocity.z;
      packs.normal_force[k] = contact.normal_force;
      packs.shear_stiffness[k] = contact.shear_stiffness;
      packs.inertia[k] = inertia;
      one[k] = TypeParam::template resist<true>(stone(), plain, contact, {5e-6, 5e-6}, plain_history[k]);
    }
    const Moment<Real> four = TypeParam::template resist<true>(stone(), pack, packs, {5e-6, 5e-6}, history);
    for (int k = 0; k < 4; ++k) {
      const Vec3 moment{four.moment.x[k], four.moment.y[k], four.moment.z[k]};
      ASSERT_LT(norm(moment - one[k].moment), 1e-12 * limit) << n;
      ASSERT_NEAR(four.loss[k], one[k].loss, 1e-12 * limit * 1e-5);
    }
  }
}

// Type A by hand: magnitude eta_r R* F_n against the turning in the contact plane; zero at rest.
TEST(RollingTypeA, ConstantMoment) {
  double* none = nullptr;  // history
  for (double rate : {1e-6, 50.0}) {
    const RollingContact<double> contact{{0.6 * rate, 0.8 * rate, 7}, normal_force, shear_stiffness, inertia};
    const auto on_i = RollingA::resist<true>(stone(), touch, contact, {5e-6, 5e-6}, none);
    EXPECT_NEAR(on_i.moment.x, -0.6 * limit, 1e-15);
    EXPECT_NEAR(on_i.moment.y, -0.8 * limit, 1e-15);
    EXPECT_NEAR(on_i.loss, limit * rate * 1e-5, 1e-15 * rate);
  }
  const auto twisted = RollingA::resist<true>(stone(), touch, {{0, 0, 3}, normal_force, 0, 0}, {1, 1}, none);
  EXPECT_EQ(norm(twisted.moment), 0);
}

// Type C: k_r = 2.25 k_n eta_r^2 R*^2. Below the limit an oscillator with the asked damping ratio, theta = exp(-delta w
// t) sin(w_d t) theta'(0) / w_d; in steady rolling the moment of type A.
TEST(RollingTypeC, OscillatesAndYields) {
  const PairParameters pair = stone();
  const double k_n = shear_stiffness * pair.effective_young_modulus / (4 * pair.effective_shear_modulus);
  const double k_r = 2.25 * k_n * 0.2 * 0.2 * radius * radius, w = std::sqrt(k_r / inertia), delta = 0.3;
  const double w_d = w * std::sqrt(1 - delta * delta), dt = 2 * std::numbers::pi / w / 2000;
  double history[RollingC::history + 1] = {};
  double theta = 0, rate = 1e-2, moment = 0, last = rate;
  for (int n = 1; n <= 4000; ++n) {
    const double half = rate + 0.5 * dt * moment / inertia;
    theta += dt * half;
    const double seen = half + 0.5 * dt * moment / inertia;
    moment = RollingC::resist<true>(pair, touch, {{seen, 0, 0}, normal_force, shear_stiffness, inertia},
                                    {0.5 * dt, 0.5 * dt}, history)
                 .moment.x;
    rate = half + 0.5 * dt * moment / inertia;
    const double t = n * dt, expected = std::exp(-delta * w * t) * std::sin(w_d * t) * 1e-2 / w_d;
    ASSERT_NEAR(theta, expected, 3e-3 * 1e-2 / w_d) << n;
    last = std::min(last, rate);
  }
  EXPECT_LT(last, 0);
  for (int n = 0; n < 4000; ++n)
    moment = RollingC::resist<true>(pair, touch, {{10, 0, 0}, normal_force, shear_stiffness, inertia},
                                    {0.5 * dt, 0.5 * dt}, history)
                 .moment.x;
  EXPECT_NEAR(moment / -limit, 1, 1e-12);
}

// 1 / I_r = 1 / (7/5 m_i R_i^2) + 1 / (7/5 m_j R_j^2); a wall leaves the first term alone.
TEST(RollingTypeC, Inertia) {
  EXPECT_NEAR(rolling_inertia(2.0, 0.1, 2.0, 0.1), 0.7 * 2 * 0.01, 1e-17);
  EXPECT_NEAR(rolling_inertia(2.0, 0.1, 0.0, 0.0), 1.4 * 2 * 0.01, 1e-17);
}

TEST(RollingTable, NamesAndHistories) {
  int rows = 0;
  dem::for_each_law(dem::rolling_models, [&](const auto&) { ++rows; });
  EXPECT_EQ(rows, 4);
  int history = -1;
  EXPECT_TRUE(dem::with_law(dem::rolling_models, "type_c", [&](const auto& row) { history = row.history; }));
  EXPECT_EQ(history, 4);
  EXPECT_FALSE(dem::with_law(dem::rolling_models, "type_b", [](const auto&) {}));
}
