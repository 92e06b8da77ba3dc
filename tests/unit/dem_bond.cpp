// Linear parallel bond (dem/kernels/parallel_bond.hpp; Potyondy, Cundall 2004, section 2.2) and what makes bonds.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/error.hpp"
#include "dem/dem.hpp"
#include "tests/dem_backend.hpp"

using base::Vec3;
using namespace dem::kernels;

namespace {

constexpr double radius = 0.01, bond_radius = 0.006;  // [m]
const double area = std::numbers::pi * bond_radius * bond_radius, inertia = 0.25 * area * bond_radius * bond_radius;
constexpr double never = std::numeric_limits<double>::infinity();  // [Pa]

BondParameters cement(double tensile, double shear) { return {bond_radius, 2e10, 1e10, tensile, shear}; }

/// Two spheres that just overlap, j below i.
constexpr double overlap = 1e-6;  // [m]
BondState fresh() { return {overlap, {0, 0, 1}, {}}; }

struct Motion {
  double stretch = 0;         // [m]
  Vec3 sliding{}, turning{};  // [m] at the bond, [rad] of i
};
BondMotion motion_of(const Motion& m) {
  const double arm = radius - 0.5 * (overlap - m.stretch);
  // i turns about the bond: its centre goes along.
  const Vec3 way = m.sliding + cross(m.turning, {0, 0, arm});
  return {overlap - m.stretch, {0, 0, 1}, arm, arm, way, m.turning, {}};
}
/// Reaction of a fresh bond to one motion; the normal is z.
BondReaction answer(const BondParameters& bond, const Motion& m) {
  BondState state = fresh();
  return ParallelBond::press(bond, motion_of(m), state);
}

Vec3 rotated(const Vec3& v, const Vec3& axis, double angle) {
  return std::cos(angle) * v + std::sin(angle) * cross(axis, v) + (1 - std::cos(angle)) * dot(axis, v) * axis;
}

template <class Call>
std::string message(Call&& call) {
  try {
    call();
  } catch (const base::UserError& error) {
    return error.what();
  }
  return "no error";
}

}  // namespace

// Stretch, shear, bending and twist, each alone: k_n A, k_s A, k_n I, k_s J. Tension pulls i towards j.
TEST(Bond, Stiffnesses) {
  const auto bond = cement(never, never);
  EXPECT_NEAR(answer(bond, {.stretch = 1e-5}).force.z, -2e10 * area * 1e-5, 1e-9);
  EXPECT_NEAR(answer(bond, {.stretch = -1e-5}).force.z, 2e10 * area * 1e-5, 1e-9);
  EXPECT_NEAR(answer(bond, {.sliding = {1e-6, 0, 0}}).force.x, -1e10 * area * 1e-6, 1e-9);
  EXPECT_NEAR(answer(bond, {.stretch = 1e-4, .sliding = {0, 1e-6, 0}}).force.y, -1e10 * area * 1e-6, 1e-9);
  const auto turned = answer(bond, {.turning = {1e-3, 0, 0}});
  EXPECT_NEAR(turned.moment.x, -2e10 * inertia * 1e-3, 1e-12);
  EXPECT_NEAR(norm(turned.force), 0, 1e-9) << "a turn about the bond itself";
  const auto twisted = answer(bond, {.turning = {0, 0, 2e-3}});
  EXPECT_NEAR(twisted.moment.z, -1e10 * 2 * inertia * 2e-3, 1e-12);
  EXPECT_NEAR(twisted.elastic, 0.5 * 1e10 * 2 * inertia * 4e-6, 1e-15);
}

// -N / A + |M| R / I and |V| / A + |T| R / J against the strengths: just below it holds, just above it is gone.
TEST(Bond, Breaks) {
  const double tension = 2e10 * 1e-5 + 2e10 * 3e-4 * bond_radius, shear = 1e10 * 2e-6 + 1e10 * 1e-3 * bond_radius;
  const Motion pulled{.stretch = 1e-5, .turning = {0, 3e-4, 0}};
  const Motion slid{.sliding = {0, 2e-6, 0}, .turning = {0, 0, 1e-3}};
  EXPECT_TRUE(answer(cement(1.001 * tension, never), pulled).holds);
  EXPECT_TRUE(answer(cement(never, 1.001 * shear), slid).holds);
  for (const auto& gone :
       {answer(cement(0.999 * tension, never), pulled), answer(cement(never, 0.999 * shear), slid)}) {
    EXPECT_FALSE(gone.holds);
    EXPECT_EQ(norm(gone.force), 0);
    EXPECT_EQ(norm(gone.moment), 0);
    EXPECT_EQ(gone.elastic, 0);
  }
}

// Half the last load works over the step in which the bond gives way: stored + half a step's work is what is lost, here
// of a pull in ten equal steps, the tenth of which is too much.
TEST(Bond, BreakingLosesWhatWasTakenIn) {
  const double step = 1e-6;
  const auto bond = cement(2e10 * 9.5 * step, never);
  BondState state = fresh();
  BondReaction last;
  for (int n = 1; n <= 10; ++n) {
    BondMotion motion = motion_of({.stretch = n * step});
    motion.displacement = {0, 0, step};
    last = ParallelBond::press(bond, motion, state);
    EXPECT_EQ(last.holds, n < 10);
  }
  EXPECT_NEAR(last.loss / (0.5 * 2e10 * area * 9 * 10 * step * step), 1, 1e-9);
}

// Nothing moved: the same answer again, whatever the bond carries.
TEST(Bond, ALookChangesNothing) {
  const auto bond = cement(never, never);
  BondState state = fresh();
  const Motion m{.stretch = 1e-6, .sliding = {1e-6, 2e-6, 0}, .turning = {1e-4, 0, 2e-4}};
  const auto first = ParallelBond::press(bond, motion_of(m), state);
  BondMotion still = motion_of(m);
  still.displacement = still.turn_i = still.turn_j = {};
  const auto again = ParallelBond::press(bond, still, state);
  EXPECT_LT(norm(again.force - first.force), 1e-14 * norm(first.force));
  EXPECT_LT(norm(again.moment - first.moment), 1e-14 * norm(first.moment));
}

// Turned as one body about any axis, its own included, by one radian in 100 steps, a loaded bond turns its load along
// and takes up no more. Turns that follow the normal by projection alone are off by per cents.
TEST(Bond, LoadTurnsWithThePair) {
  const auto bond = cement(never, never);
  const int steps = 100;
  const double angle = 1.0;
  for (const Vec3& axis : {Vec3{0, 0, 1}, Vec3{0, 1, 0}, Vec3{0.6, 0, 0.8}}) {
    BondState state = fresh();
    const auto first =
        ParallelBond::press(bond, motion_of({.sliding = {1e-6, 0, 0}, .turning = {0, 1e-4, 1e-4}}), state);
    const double distance = 2 * radius - overlap;
    BondReaction last;
    for (int n = 1; n <= steps; ++n) {
      const auto at = [&](int k) { return rotated({0, 0, 1}, axis, angle * k / steps); };
      const Vec3 turn = (angle / steps) * axis;
      last = ParallelBond::press(
          bond, {overlap, at(n), 0.5 * distance, 0.5 * distance, distance * (at(n) - at(n - 1)), turn, turn}, state);
    }
    // Spurious strain: the chord of a step is shorter than its arc by a share of (1/100)^2 / 24.
    const double spurious = 1e10 * area * distance * angle * 1e-4 / 20;
    EXPECT_LT(norm(last.force - rotated(first.force, axis, angle)), 2e-4 * norm(first.force) + spurious);
    EXPECT_LT(norm(last.moment - rotated(first.moment, axis, angle)), 2e-4 * norm(first.moment));
  }
}

// All pairs within the gap and no others; the surfaces count, not the centres.
TEST(Bond, PairsWithinAGap) {
  std::vector<dem::Grain> grains;
  for (int k = 0; k < 4; ++k) grains.push_back({.position = {0.0205 * (3 - k), 0, 0}, .radius = 0.01, .id = 10 + k});
  grains.push_back({.position = {0, 0.0312, 0}, .radius = 0.02, .id = 7});
  using Pairs = std::vector<std::array<std::int64_t, 2>>;
  EXPECT_EQ(dem::pairs_within(grains, 0.0006), (Pairs{{10, 11}, {11, 12}, {12, 13}}));
  EXPECT_EQ(dem::pairs_within(grains, 0.0013), (Pairs{{7, 13}, {10, 11}, {11, 12}, {12, 13}}));
  EXPECT_TRUE(dem::pairs_within(grains, 0).empty());
}

TEST(Bond, MistakesAreNamed) {
  dem::Setup setup;
  setup.materials = {{"stone", 1e9, 0.25, 2500}};
  setup.interactions = {{0.5, 1, 0}};
  const auto sim = dem_test::create(setup);
  const std::array<dem::Sphere, 2> two{dem::Sphere{{-0.01, 0, 0}, 0.015}, dem::Sphere{{0.01, 0, 0}, 0.015}};
  const int dumbbell = sim->add_shape(dem::make_clump(two));
  sim->add_grains(std::vector<dem::Grain>{{.position = {0, 0, 0}, .radius = radius, .id = 3},
                                          {.position = {0.02, 0, 0}, .radius = radius, .id = 5},
                                          {.position = {0.1, 0, 0}, .radius = 0.025, .id = 8, .shape = dumbbell}});
  const auto add = [&](std::int64_t i, std::int64_t j, const BondParameters& is) {
    const dem::Bond bond{i, j, is};
    return message([&] { sim->add_bonds({&bond, 1}); });
  };
  const auto good = cement(1e6, 1e6);
  EXPECT_EQ(add(3, 4, good), "dem: bond of grains 3 and 4: there is no grain 4");
  EXPECT_EQ(add(3, 3, good), "dem: bond of grains 3 and 3: a grain cannot be bonded to itself");
  EXPECT_EQ(add(3, 8, good), "dem: bond of grains 3 and 8: grain 8 is a clump; bonds join spheres");
  auto bad = good;
  bad.radius = 0;
  EXPECT_EQ(add(3, 5, bad), "bond: radius = 0; must be > 0 and finite [m]");
  bad = good;
  bad.tensile_strength = -1;
  EXPECT_EQ(add(3, 5, bad), "bond: tensile_strength = -1; must be > 0 [Pa]");
  EXPECT_TRUE(sim->bonds().empty());
  EXPECT_EQ(add(3, 5, good), "no error");
  EXPECT_EQ(add(5, 3, good), "dem: bond of grains 5 and 3: they are bonded already");
  EXPECT_EQ(message([&] { dem::pairs_within(sim->grains(), 0.1); }), "dem: bonds join spheres; grain 8 is a clump");
}
