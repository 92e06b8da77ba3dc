// The same run twice on the same number of threads agrees to the last bit; another number of threads or of SIMD lanes
// only adds the same forces in another order.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <numbers>
#include <random>
#include <string>

#include "dem/dem.hpp"
#include "dem/laws.hpp"
#include "tests/dem_backend.hpp"

namespace {

using dem::Vec3;

struct Outcome {
  std::vector<dem::Grain> grains;
  base::Energy energy;
  double start = 0;  // [J] stored: kinetic, and elastic of grains that overlap from the first
  std::vector<Vec3> impulse;
  std::int64_t rebuilds = 0;
};

std::vector<dem::Grain> bed() {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> shift(-0.001, 0.001), radius(0.018, 0.021);
  std::vector<dem::Grain> grains;
  for (int k = 0; k < 1500; ++k) {
    const Vec3 p{0.04 * (k % 10 + 0.5) + shift(random), 0.04 * (k / 10 % 10 + 0.5) + shift(random),
                 0.04 * (k / 100 + 0.5) + shift(random)};
    grains.push_back({.position = p,
                      .radius = radius(random),
                      .velocity = {0.11 * (k % 5 - 2), 0.07 * (k % 7 - 3), -1 - 0.05 * (k % 4)},
                      .angular_velocity = {20.0 * (k % 3 - 1), 10.0 * (k % 5 - 2), 5},
                      .id = k});
  }
  return grains;
}

struct Case {
  int threads = 1, lanes = 0;
  std::string law = "hertz_mindlin", rolling = "brof";
  int steps = 100;     // per window
  bool bonds = false;  // of what touches, some of which break
};

Outcome run(const Case& c) {
  dem::set_threads(c.threads);
  dem::Setup setup;
  setup.materials = {{"stone", 1e7, 0.2, 2700}, {"wall", 1e8, 0.2, 0}};
  dem::Interaction pair{0.6, 0.5, 0.1};
  pair.law = c.law;
  pair.rolling = c.rolling;
  pair.normal_stiffness = 5e4;
  pair.shear_stiffness = 3e4;
  pair.normal_viscosity = pair.shear_viscosity = 5;
  pair.dissipative_coefficient = 1e-4;
  pair.damping_mode = 1;
  pair.critical_stress = 1e5;
  pair.friction_exponent = -0.1;
  pair.rolling_damping = 0.3;
  setup.interactions.assign(4, pair);
  setup.gravity = {0, 0, -9.81};
  setup.lanes = c.lanes;
  const auto sim = dem_test::create(setup);
  const auto grains = bed();
  sim->add_grains(grains);
  std::vector<dem::Bond> bonds;
  if (c.bonds)
    for (const auto& [i, j] : dem::pairs_within(grains, 0)) bonds.push_back({i, j, {0.01, 1e9, 5e8, 3e5, 3e5}});
  sim->add_bonds(bonds);
  base::Skin floor;
  for (int i = 0; i <= 5; ++i)
    for (int j = 0; j <= 5; ++j) floor.nodes.push_back({0.08 * i, 0.08 * j, 0});
  for (int i = 0; i < 5; ++i)
    for (int j = 0; j < 5; ++j) floor.facets.push_back({6 * i + j, 6 * i + 6 + j, 6 * i + 7 + j, 6 * i + j + 1});
  const int mesh = sim->add_mesh(floor, 1, false);
  sim->add_plane({{0, 0, 0}, {1, 0, 0}}, 1);
  sim->add_plane({{0.4, 0, 0}, {-1, 0, 0}}, 1);
  sim->add_plane({{0, 0, 0}, {0, 1, 0}}, 1);
  sim->add_plane({{0, 0.4, 0}, {0, -1, 0}}, 1);
  auto target = floor.nodes;
  const std::vector<Vec3> velocities(target.size());
  Outcome outcome;
  outcome.impulse.resize(target.size());
  sim->advance(0, 4e-5);
  outcome.start = sim->energy().stored();
  for (int window = 0; window < 4; ++window) {
    for (auto& p : target) p.z = window % 2 ? 0 : 2e-4 * p.x;
    sim->set_mesh_target(mesh, target, velocities);
    sim->advance(c.steps, 4e-5);
  }
  outcome.grains = sim->grains();
  outcome.energy = sim->energy();
  outcome.rebuilds = sim->counts().rebuilds;
  sim->nodal_impulse(mesh, outcome.impulse);
  EXPECT_GT(sim->counts().contacts, 300);
  return outcome;
}

void expect_same(const Outcome& a, const Outcome& b) {
  EXPECT_EQ(a.rebuilds, b.rebuilds);
  for (std::size_t k = 0; k < a.grains.size(); ++k) {
    ASSERT_EQ(std::memcmp(&a.grains[k].position, &b.grains[k].position, sizeof(Vec3)), 0) << k;
    ASSERT_EQ(std::memcmp(&a.grains[k].velocity, &b.grains[k].velocity, sizeof(Vec3)), 0) << k;
    ASSERT_EQ(std::memcmp(&a.grains[k].angular_velocity, &b.grains[k].angular_velocity, sizeof(Vec3)), 0) << k;
  }
  EXPECT_EQ(std::memcmp(&a.energy, &b.energy, sizeof(base::Energy)), 0);
  EXPECT_EQ(std::memcmp(a.impulse.data(), b.impulse.data(), a.impulse.size() * sizeof(Vec3)), 0);
}

// 400 steps of a collapse from 1 m/s, grains of 20 mm: 1e-9 of radius and speed. A pair counted twice or not at all, or
// a history lost between two ranges of grains, changes forces by their whole size.
void expect_close(const Outcome& a, const Outcome& b) {
  for (std::size_t k = 0; k < a.grains.size(); ++k) {
    ASSERT_LT(norm(a.grains[k].position - b.grains[k].position), 1e-9 * 0.02) << k;
    ASSERT_LT(norm(a.grains[k].velocity - b.grains[k].velocity), 1e-9) << k;
    ASSERT_LT(norm(a.grains[k].angular_velocity - b.grains[k].angular_velocity) * 0.02, 1e-9) << k;
  }
  const double scale = a.energy.kinetic;
  EXPECT_NEAR(a.energy.kinetic, b.energy.kinetic, 1e-9 * scale);
  EXPECT_NEAR(a.energy.elastic_normal, b.energy.elastic_normal, 1e-9 * scale);
  EXPECT_NEAR(a.energy.elastic_shear, b.energy.elastic_shear, 1e-9 * scale);
  EXPECT_NEAR(a.energy.loss_friction, b.energy.loss_friction, 1e-9 * scale);
  EXPECT_NEAR(a.energy.loss_contact_damping, b.energy.loss_contact_damping, 1e-9 * scale);
  EXPECT_NEAR(a.energy.loss_rolling, b.energy.loss_rolling, 1e-9 * scale);
  for (std::size_t k = 0; k < a.impulse.size(); ++k) EXPECT_LT(norm(a.impulse[k] - b.impulse[k]), 1e-9);
}

/// Stored + lost = stored at the start + worked.
void expect_closed(const Outcome& o, double tolerance) {
  EXPECT_NEAR(o.energy.stored() + o.energy.losses(), o.start + o.energy.works(), tolerance * o.start);
}

TEST(DemThreads, TheSameRunTwiceIsTheSameToTheLastBit) {
  for (const int lanes : {0, 1}) {
    const Outcome once = run({2, lanes}), again = run({2, lanes});
    EXPECT_GT(once.rebuilds, 3);
    expect_same(once, again);
  }
}

TEST(DemThreads, OneByOneDoesNotDependOnThreadsAtAll) { expect_same(run({1, 1}), run({2, 1})); }

TEST(DemThreads, ThreadsAndLanesAgree) {
  const Outcome one = run({1, 2});
  expect_close(one, run({2, 2}));
  expect_close(one, run({3, 2}));
  expect_close(one, run({1, 1}));
  expect_close(one, run({2, 0}));
}

// Bonds are added up in the order in which they were made, whatever the threads and the numbering.
TEST(DemThreads, BondsDoNotDependOnThreads) {
  const auto one = run({.lanes = 1, .bonds = true});
  expect_same(one, run({.threads = 2, .lanes = 1, .bonds = true}));
  expect_same(run({.threads = 2, .bonds = true}), run({.threads = 2, .bonds = true}));
  EXPECT_GT(one.energy.loss_breakage, 0);
  EXPECT_GT(one.energy.elastic_bonds, 0);
  expect_closed(one, 2e-3);
}

// Every law and rolling model a scene can name: taken several at once, one by one (as on a GPU), and looked up contact
// by contact (walls of mixed laws) it is the same law; and its energies add up.
TEST(DemThreads, EveryLawAgreesBetweenLanes) {
  dem::for_each_law(dem::laws, [](const auto& row) {
    SCOPED_TRACE(row.name);
    const std::string law(row.name);
    const int steps = law == "hysteretic" ? 3 : 100;  // it divides by approach speeds, however small: roundings grow
    const Outcome two = run({1, 2, law, "brof", steps});
    expect_close(two, run({1, 1, law, "brof", steps}));
    expect_close(two, run({1, 4, law, "brof", steps}));
    expect_closed(two, 2e-3);
  });
}

// Type A changes its sign with that of the turning: a grain at rest trembles, roundings grow, and the work of a moment
// that jumps is known to first order only. It gets fewer steps.
TEST(DemThreads, EveryRollingModelAgreesBetweenLanes) {
  dem::for_each_law(dem::rolling_models, [](const auto& row) {
    SCOPED_TRACE(row.name);
    const std::string model(row.name), law = "hertz_mindlin";
    const int steps = model == "type_a" ? 1 : 100;
    const Outcome two = run({1, 2, law, model, steps});
    expect_close(two, run({1, 1, law, model, steps}));
    expect_close(two, run({1, 4, law, model, steps}));
    EXPECT_EQ(two.energy.loss_rolling > 0, model != "none");
    expect_closed(two, model == "type_a" ? 1e-2 : 1e-3);
  });
}

}  // namespace
