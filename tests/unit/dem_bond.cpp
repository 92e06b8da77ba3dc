// Linear parallel bond (dem/kernels/parallel_bond.hpp; Potyondy, Cundall 2004, section 2.2).
#include <gtest/gtest.h>

#include <algorithm>

#include "dem/law_parameters.hpp"
#include "tests/dem_pair_helper.hpp"

using namespace dem_test;

namespace {

constexpr double radius = 0.01, bond_radius = 0.006;  // [m]
const double mass = sphere_mass(radius, 2500);
const double area = std::numbers::pi * bond_radius * bond_radius, inertia = 0.25 * area * bond_radius * bond_radius;
constexpr double never = 1e30;  // [Pa]

PairParameters cement(double tensile, double shear) {
  PairParameters pair = dem::linear_pair({1e6, 0.5e6, 0.5, 1});
  pair.bond_normal_stiffness = 2e10;  // [Pa/m]
  pair.bond_shear_stiffness = 1e10;
  pair.bond_tensile_strength = tensile;
  pair.bond_shear_strength = shear;
  return pair;
}

/// Two spheres that just touch, bonded.
Pair<ParallelBond> bonded(const PairParameters& parameters) {
  Pair<ParallelBond> pair{parameters, {radius, mass, {0, 0, 2 * radius}, {}}, {radius, mass, {}, {}}};
  ParallelBond::bond(0, bond_radius, pair.history.data());
  return pair;
}

struct Motion {
  double stretch = 0;         // [m] now
  Vec3 sliding{}, turning{};  // [m], [rad] in the step up to now, held still before and after
};
/// Reaction of a fresh bond to one motion; the normal is z.
BondReaction<double> answer(const PairParameters& parameters, const Motion& motion) {
  double history[ParallelBond::history + 1] = {};
  ParallelBond::bond(1e-6, bond_radius, history);
  const Touch<double> touch{1e-6 - motion.stretch, radius / 2, mass / 2, {0, 0, 1}, motion.sliding};
  return ParallelBond::press<true>(parameters, touch, Turning<double>{motion.turning, 0}, {1, 0}, history);
}

}  // namespace

// Stretch, shear, bending and twist, each alone: k_n A, k_s A, k_n I, k_s J. Tension pulls i towards j.
TEST(Bond, Stiffnesses) {
  const auto pair = cement(never, never);
  EXPECT_NEAR(answer(pair, {.stretch = 1e-5}).reaction.force.z, -2e10 * area * 1e-5, 1e-9);
  EXPECT_NEAR(answer(pair, {.sliding = {1e-6, 0, 0}}).reaction.force.x, -(1e10 * area + 0.5e6) * 1e-6, 0.5);
  EXPECT_NEAR(answer(pair, {.stretch = 1e-4, .sliding = {0, 1e-6, 0}}).reaction.force.y, -1e10 * area * 1e-6, 1e-9);
  const auto turned = answer(pair, {.turning = {1e-3, 0, 2e-3}});
  EXPECT_NEAR(turned.bond.moment.x, -2e10 * inertia * 1e-3, 1e-12);
  EXPECT_NEAR(turned.bond.moment.z, -1e10 * 2 * inertia * 2e-3, 1e-12);
  EXPECT_NEAR(turned.bond.elastic, 0.5 * (2e10 * inertia * 1e-6 + 1e10 * 2 * inertia * 4e-6), 1e-15);
}

// -N / A + |M| R / I and |V| / A + |T| R / J against the strengths: just below it holds, just above it is gone.
TEST(Bond, Breaks) {
  const double tension = 2e10 * 1e-5 + 2e10 * 3e-4 * bond_radius, shear = 1e10 * 2e-6 + 1e10 * 1e-3 * bond_radius;
  const Motion pulled{.stretch = 1e-5, .turning = {0, 3e-4, 0}};
  const Motion slid{.stretch = 1e-6, .sliding = {0, 2e-6, 0}, .turning = {0, 0, 1e-3}};
  EXPECT_GT(norm(answer(cement(1.001 * tension, never), pulled).reaction.force), 1);
  EXPECT_GT(norm(answer(cement(never, 1.001 * shear), slid).reaction.force), 1);
  for (const auto& gone :
       {answer(cement(0.999 * tension, never), pulled), answer(cement(never, 0.999 * shear), slid)}) {
    EXPECT_EQ(norm(gone.reaction.force), 0);
    EXPECT_EQ(norm(gone.bond.moment), 0);
    EXPECT_EQ(gone.bond.elastic, 0);
    EXPECT_GT(gone.bond.loss, 0);
  }
}

// Pulled apart slowly: once broken it never holds again, and history is clean for the next contact. What the pull put
// in is lost.
TEST(Bond, BreakingLosesWhatItStored) {
  const auto pair = cement(1e5, never);
  double history[ParallelBond::history + 1] = {};
  ParallelBond::bond(0, bond_radius, history);
  const double dt = 1e-7, speed = 0.01;
  double work = 0, lost = 0;
  for (int n = 0; n < 10000; ++n) {
    const Touch<double> touch{-speed * dt * n, radius / 2, mass / 2, {0, 0, 1}, {0, 0, speed}};
    const auto now = ParallelBond::press<true>(pair, touch, Turning<double>{}, {dt / 2, dt / 2}, history);
    work -= now.reaction.force.z * speed * dt;
    lost += now.bond.loss;
  }
  const double stretch = 1e5 / 2e10;
  EXPECT_NEAR(lost / (0.5 * 2e10 * area * stretch * stretch), 1, 1e-3);
  EXPECT_NEAR(work / lost, 1, 1e-3);
  EXPECT_FALSE(ParallelBond::bonded(history));
  for (double number : history) EXPECT_EQ(number, 0);
}

// A bonded pair thrown tumbling and shaking: momentum and angular momentum to rounding, energy to the integrator's
// error, whatever its axis does.
TEST(Bond, TumblingPairKeepsEnergyAndMomenta) {
  auto pair = bonded(cement(never, never));
  pair.i.velocity = {0.3, 0.1, 0.05};
  pair.j.velocity = {-0.2, 0.1, 0};
  pair.i.spin = {20, -10, 40};
  pair.j.spin = {-5, 15, 30};
  const auto momentum = [&] { return mass * (pair.i.velocity + pair.j.velocity); };
  const auto angular = [&] {
    return mass * (cross(pair.i.position, pair.i.velocity) + cross(pair.j.position, pair.j.velocity)) +
           pair.i.inertia() * (pair.i.spin + pair.j.spin);
  };
  const Vec3 p = momentum(), l = angular();
  const double before = pair.energy();
  const double period = 2 * std::numbers::pi * std::sqrt(mass / 2 / (2e10 * area));
  double most = 0;
  for (int n = 0; n < 20000; ++n) {
    pair.step(period / 200);
    most = std::max(most, std::abs(pair.energy() / before - 1));
  }
  EXPECT_LT(norm(momentum() - p), 1e-12 * norm(p));
  EXPECT_LT(norm(angular() - l), 1e-10 * norm(l));
  EXPECT_LT(most, 0.01);
  EXPECT_TRUE(ParallelBond::bonded(pair.history.data()));
}

// The same seen from a turned frame that flies past, and with i and j exchanged.
TEST(Bond, FrameIndifferentAndReciprocal) {
  const Vec3 axis{1 / 3.0, 2 / 3.0, -2 / 3.0}, boost{0.7, -0.3, 0.4};
  auto plain = bonded(cement(never, never));
  plain.i.velocity = {0.3, 0.1, 0.05};
  plain.i.spin = {20, -10, 40};
  auto moved = plain, swapped = plain;
  std::swap(swapped.i, swapped.j);
  for (Body* body : {&moved.i, &moved.j}) {
    body->position = rotated(body->position, axis, 1.1);
    body->velocity = rotated(body->velocity, axis, 1.1) + boost;
    body->spin = rotated(body->spin, axis, 1.1);
  }
  for (int n = 0; n < 500; ++n)
    for (auto* pair : {&plain, &moved, &swapped}) pair->step(1e-6);
  const double scale = norm(plain.reaction.force), moment = norm(plain.bond.moment);
  EXPECT_GT(std::min(scale, moment), 1e-3);
  EXPECT_LT(norm(rotated(plain.reaction.force, axis, 1.1) - moved.reaction.force), 1e-6 * scale);
  EXPECT_LT(norm(rotated(plain.bond.moment, axis, 1.1) - moved.bond.moment), 1e-6 * moment);
  EXPECT_LT(norm(plain.reaction.force + swapped.reaction.force), 1e-9 * scale);
  EXPECT_LT(norm(plain.bond.moment + swapped.bond.moment), 1e-9 * moment);
}

// Turned as one body about any axis, its own included, a loaded bond turns its shear and bending along.
TEST(Bond, LoadTurnsWithThePair) {
  const auto pair = cement(never, never);
  for (const Vec3& axis : {Vec3{0, 0, 1}, Vec3{0, 1, 0}, Vec3{0.6, 0, 0.8}}) {
    double history[ParallelBond::history + 1] = {};
    ParallelBond::bond(0, bond_radius, history);
    Touch<double> touch{-1e-6, radius / 2, mass / 2, {0, 0, 1}, {1e-6, 0, 0}};
    const auto first = ParallelBond::press<true>(pair, touch, Turning<double>{{0, 1e-4, 0}, 0}, {1, 0}, history);
    touch.velocity = {};
    const int steps = 2000;
    const double angle = 1.0;
    BondReaction<double> last;
    for (int n = 1; n <= steps; ++n) {
      touch.normal = rotated({0, 0, 1}, axis, angle * n / steps);
      const double spin = angle / steps * dot(axis, touch.normal);  // [rad] per step of 1 s
      last = ParallelBond::press<true>(pair, touch, Turning<double>{{}, spin}, {0.5, 0.5}, history);
    }
    EXPECT_LT(norm(last.reaction.force - rotated(first.reaction.force, axis, angle)),
              1e-3 * norm(first.reaction.force));
    EXPECT_LT(norm(last.bond.moment - rotated(first.bond.moment, axis, angle)), 1e-3 * norm(first.bond.moment));
  }
}
