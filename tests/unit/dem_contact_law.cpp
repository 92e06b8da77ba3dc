// Hertz-Mindlin contact law (dem/kernels/contact_law.hpp; Irazabal2017 3.2.3): what every law must keep.
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <random>

#include "dem/kernels/contact_law.hpp"
#include "dem/pair_parameters.hpp"

using base::Vec3;
using namespace dem::kernels;

namespace {

const dem::Material stone{"stone", 1e9, 0.25, 2500};
constexpr double radius = 0.01;  // [m]
const double mass = 4.0 / 3.0 * std::numbers::pi * radius * radius * radius * stone.density;
const double inertia = 0.4 * mass * radius * radius;

PairParameters wall(double friction, double restitution) {
  return dem::wall_parameters(stone, stone, {friction, restitution, 0});
}

struct Impact {
  Vec3 velocity, angular_velocity;  // after
  double energy_error = 0;          // relative, after
};

/// One sphere against a plane by velocity Verlet, about 500 steps per contact.
Impact impact(const PairParameters& pair, Vec3 velocity, Vec3 spin) {
  const double overlap_scale =
      std::pow(15 * mass * velocity.z * velocity.z / (16 * pair.effective_young_modulus * std::sqrt(radius)), 0.4);
  const double dt = 2.94 * overlap_scale / std::abs(velocity.z) / 500;
  const Vec3 arm{0, 0, -radius};
  Vec3 acceleration, angular_acceleration;
  double height = radius, losses = 0;
  const double before = 0.5 * mass * norm2(velocity) + 0.5 * inertia * norm2(spin);
  ContactHistory history;
  do {
    const Vec3 half = velocity + 0.5 * dt * acceleration, half_spin = spin + 0.5 * dt * angular_acceleration;
    height += dt * half.z;
    const Vec3 now = half + 0.5 * dt * acceleration, now_spin = half_spin + 0.5 * dt * angular_acceleration;
    const auto contact = hertz_mindlin(pair, {radius - height, radius, mass, {0, 0, 1}},
                                       {now + cross(now_spin, arm), dt * (half + cross(half_spin, arm)), dt}, history);
    losses += contact.loss_friction + contact.loss_damping;
    acceleration = (1 / mass) * contact.force;
    angular_acceleration = (1 / inertia) * cross(arm, contact.force);
    velocity = half + 0.5 * dt * acceleration;
    spin = half_spin + 0.5 * dt * angular_acceleration;
  } while (height < radius);
  const double after = 0.5 * mass * norm2(velocity) + 0.5 * inertia * norm2(spin);
  return {velocity, spin, (after + losses) / before - 1};
}

/// Rotation by `angle` about a unit axis (Rodrigues).
Vec3 rotate(const Vec3& v, const Vec3& axis, double angle) {
  return std::cos(angle) * v + std::sin(angle) * cross(axis, v) + (1 - std::cos(angle)) * dot(axis, v) * axis;
}

}  // namespace

// A dashpot coefficient wrong by a constant factor (sqrt 2, the reduced mass) shows at every e but 1.
TEST(ContactLaw, RestitutionRecovered) {
  for (double e : {0.2, 0.4, 0.5, 0.6, 0.8, 1.0})
    for (double speed : {0.1, 3.0})
      EXPECT_NEAR(impact(wall(0.3, e), {0, 0, -speed}, {}).velocity.z / speed, e, 2e-4) << e;
}

// Gross sliding: the tangential impulse is mu (1 + e) m v_n exactly. A damper that attracts at the end gives more.
TEST(ContactLaw, GrossSlidingImpulse) {
  const double mu = 0.2, e = 0.5;
  const auto after = impact(wall(mu, e), {4, 0, -1}, {});
  EXPECT_NEAR(after.velocity.x, 4 - mu * (1 + e), 2e-4);
  EXPECT_NEAR(after.angular_velocity.y, 2.5 * mu * (1 + e) / radius, 0.05);
}

// Stick, slip and reversal in one impact. Losses by F_n+1 . d instead of the sums derived in the header miss by up to
// 2e-3.
TEST(ContactLaw, EnergyClosesInObliqueImpact) {
  for (double e : {0.3, 0.8, 1.0})
    for (double sideways : {0.1, 0.5, 2.0})
      EXPECT_NEAR(impact(wall(0.3, e), {sideways, 0.2, -1}, {30, -20, 5}).energy_error, 0, 2e-5)
          << e << " " << sideways;
}

TEST(ContactLaw, CoulombLimitAndNoAttraction) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto pair = wall(0.4, 0.2);
  ContactHistory history;
  int clamped = 0, sliding = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec3 velocity{unit(random), unit(random), 2 * unit(random)};
    const double overlap = 1e-5 * (1.1 + unit(random));
    const auto contact =
        hertz_mindlin(pair, {overlap, radius, mass, {0, 0, 1}}, {velocity, 1e-6 * velocity, 1e-6}, history);
    const double tangential = std::hypot(contact.force.x, contact.force.y);
    EXPECT_GE(contact.force.z, 0);
    EXPECT_EQ(contact.force.z, contact.normal_force);
    EXPECT_LE(tangential, pair.friction * contact.normal_force * (1 + 1e-12));
    EXPECT_GE(contact.loss_damping, 0);
    clamped += contact.normal_force == 0;
    sliding += tangential > 0.999 * pair.friction * contact.normal_force;
  }
  EXPECT_GT(clamped, 10);
  EXPECT_GT(sliding, 10);
  EXPECT_LT(sliding, 1990);
}

// Closed paths of tangential displacement and overlap, quasi-static: the work put in may not be negative. Keeping the
// force on unloading (3.20 without its second branch) gives energy back that was never stored.
TEST(ContactLaw, NoEnergyGainOverClosedCycle) {
  const int steps = 200;
  for (double friction : {0.05, 0.5, 100.0})
    for (double phase : {0.0, 0.7, 1.6, 2.5, 3.1, 4.0, 5.5}) {
      const auto pair = wall(friction, 1);
      ContactHistory history;
      Vec3 last_force, last_place;
      double work = 0, losses = 0, stored = 0;
      for (int i = 0; i <= 3 * steps; ++i) {
        const double angle = 2 * std::numbers::pi * i / steps;
        const Vec3 place{1e-6 * (std::sin(angle + phase) - std::sin(phase)), 0.4e-6 * std::sin(2 * angle), 0};
        const double overlap = 1e-5 * (1.05 - std::cos(angle));
        const auto contact =
            hertz_mindlin(pair, {overlap, radius, mass, {0, 0, 1}}, {{}, place - last_place, 1e-6}, history);
        const Vec3 shear{contact.force.x, contact.force.y, 0};
        work -= 0.5 * dot(last_force + shear, place - last_place);
        losses += contact.loss_friction;
        stored = contact.elastic_shear;
        last_force = shear;
        last_place = place;
      }
      EXPECT_GE(work, -1e-12);
      EXPECT_GE(losses, -1e-12);
      EXPECT_NEAR(work, stored + losses, 1e-12 * (1e-9 + std::abs(work)) + 1e-20);  // the identity in the header
    }
}

// Exchanging i and j must turn every force round.
TEST(ContactLaw, ActionEqualsReaction) {
  const auto pair = wall(0.4, 0.5);
  const Vec3 n{0.6, 0, 0.8}, velocity{0.3, -0.2, -0.5};
  ContactHistory history{{8, 4, -6}, 2e5}, mirrored{{-8, -4, 6}, 2e5};
  const auto on_i = hertz_mindlin(pair, {2e-5, radius, mass, n}, {velocity, 1e-6 * velocity, 1e-6}, history);
  const auto on_j = hertz_mindlin(pair, {2e-5, radius, mass, -n}, {-velocity, -1e-6 * velocity, 1e-6}, mirrored);
  EXPECT_EQ(norm(on_i.force + on_j.force), 0);
  EXPECT_EQ(norm(history.shear_force + mirrored.shear_force), 0);
}

TEST(ContactLaw, FrameIndifferent) {
  const auto pair = wall(0.4, 0.5);
  const Vec3 axis{1 / 3.0, 2 / 3.0, -2 / 3.0};
  const double angle = 1.1;
  const auto turn = [&](const Vec3& v) { return rotate(v, axis, angle); };
  const Vec3 n{0, 0, 1}, velocity{0.3, -0.2, -0.5}, displacement{3e-7, -1e-7, -5e-7};
  for (double force : {0.5, 50.0}) {
    ContactHistory a{{force, 2 * force, 0.1 * force}, 2e5}, b{turn(a.shear_force), 2e5};
    const auto plain = hertz_mindlin(pair, {2e-5, radius, mass, n}, {velocity, displacement, 1e-6}, a);
    const auto turned =
        hertz_mindlin(pair, {2e-5, radius, mass, turn(n)}, {turn(velocity), turn(displacement), 1e-6}, b);
    EXPECT_LT(norm(turn(plain.force) - turned.force), 1e-12 * norm(plain.force));
    EXPECT_NEAR(plain.loss_friction, turned.loss_friction, 1e-12 * std::abs(plain.loss_friction));
    EXPECT_NEAR(plain.loss_damping, turned.loss_damping, 1e-12 * plain.loss_damping);
  }
}

// A sticking pair that tilts as one body carries its force along: plain projection would lose 1 - cos of every tilt.
TEST(ContactLaw, HistoryTiltsWithTheContact) {
  const auto pair = wall(10, 1);
  const Vec3 start{1, 0, 0}, axis{0, 1, 0};
  ContactHistory history{start, 1e5};
  Vec3 normal{0, 0, 1};
  const int steps = 100;
  const double overlap = 1e-5;
  history.shear_stiffness = 8 * pair.effective_shear_modulus * std::sqrt(radius * overlap);
  for (int i = 1; i <= steps; ++i) {
    normal = rotate({0, 0, 1}, axis, 0.5 * std::numbers::pi * i / steps);
    hertz_mindlin(pair, {overlap, radius, mass, normal}, {{}, {}, 1e-6}, history);
  }
  EXPECT_LT(norm(history.shear_force - rotate(start, axis, 0.5 * std::numbers::pi)), 1e-12);
}

TEST(ContactLaw, NothingWithoutOverlap) {
  const auto pair = wall(0.4, 0.5);
  for (double overlap : {0.0, -1e-3}) {
    ContactHistory history{{3, 4, 0}, 1e5};
    const auto contact =
        hertz_mindlin(pair, {overlap, radius, mass, {0, 0, 1}}, {{1, 1, -1}, {1e-6, 0, 0}, 1e-6}, history);
    EXPECT_EQ(norm(contact.force), 0);
    EXPECT_EQ(contact.elastic_normal + contact.elastic_shear + contact.loss_damping, 0);
    EXPECT_DOUBLE_EQ(contact.loss_friction, 25 / 2e5);  // what the spring still held is gone
    EXPECT_EQ(norm(history.shear_force), 0);
    EXPECT_EQ(history.shear_stiffness, 0);
  }
}

// Eqs. 3.27 and 4.1 by hand: equal materials halve both moduli; a wall is infinitely stiff in shear.
TEST(ContactLaw, PairParameters) {
  const auto pair = dem::pair_parameters(stone, stone, {0.3, 1, 0.1});
  EXPECT_NEAR(pair.effective_young_modulus, 1e9 / (2 * (1 - 0.0625)), 1e-3);
  EXPECT_NEAR(pair.effective_shear_modulus, 0.4e9 / (2 * 1.75), 1e-3);
  const dem::Material steel{"steel", 200e9, 0.3, 0};
  const auto against_wall = dem::wall_parameters(stone, steel, {0.3, 1, 0.1});
  EXPECT_NEAR(against_wall.effective_young_modulus, 1 / (0.9375 / 1e9 + 0.91 / 200e9), 1e-3);
  EXPECT_NEAR(against_wall.effective_shear_modulus, 0.4e9 / 1.75, 1e-3);
  EXPECT_EQ(rolling_resistance_limit(pair, {1e-5, 0.005, mass, {0, 0, 1}}, 20), 0.1 * 0.005 * 20);  // eqs. 5.2, 5.3
}
