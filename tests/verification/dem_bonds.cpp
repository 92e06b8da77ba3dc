// Bonds in a simulation (dem/bond.hpp; Potyondy, Cundall 2004): oscillators, a cantilever, breakage, conservation, the
// stable step.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "base/error.hpp"
#include "dem/dem.hpp"
#include "tests/dem_backend.hpp"

using base::Vec3;
using dem::Grain;
using dem::kernels::BondParameters;
using dem::kernels::BondSection;

namespace {

constexpr double density = 2500, never = std::numeric_limits<double>::infinity();  // [kg/m3], [Pa]

double mass_of(double radius) { return 4.0 / 3.0 * std::numbers::pi * radius * radius * radius * density; }
double inertia_of(double radius) { return 0.4 * mass_of(radius) * radius * radius; }

struct Choice {
  int lanes = 0;
  double skin = 0;  // [m]
  bool ledger = true;
};
std::unique_ptr<dem::Simulation> simulation(const Choice& choice = {}) {
  dem::set_threads(1);
  dem::Setup setup;
  setup.materials = {{"stone", 1e8, 0.25, density}, {"anchor", 1e8, 0.25, 1e16}, {"plate", 1e8, 0.25, 0}};
  setup.interactions.assign(9, {0.5, 1, 0});
  setup.interactions[2] = setup.interactions[6] = {0, 1, 0};  // the plate lifts and does nothing else
  setup.lanes = choice.lanes;
  setup.skin = choice.skin;
  setup.track_energy = choice.ledger;
  return dem_test::create(setup);
}

// ---- two spheres whose surfaces are 1 mm apart, along x: no contact acts
constexpr double radius = 0.01, distance = 0.021;  // [m]
const BondParameters cement{0.006, 2e10, 1e10, never, never};
const BondSection section(cement);

std::unique_ptr<dem::Simulation> pair(const Vec3& velocity, const Vec3& spin, const BondParameters& bond = cement) {
  auto sim = simulation();
  const Grain grains[] = {
      {.position = {distance, 0, 0}, .radius = radius, .velocity = velocity, .angular_velocity = spin, .id = 1},
      {.position = {}, .radius = radius, .velocity = -velocity, .angular_velocity = -spin, .id = 2}};
  sim->add_grains(grains);
  const dem::Bond between{1, 2, bond};
  sim->add_bonds({&between, 1});
  return sim;
}

/// x_n of velocity Verlet on x'' = -omega^2 x from x = 0 with speed v: its amplitude and frequency are exact.
double verlet_oscillator(double omega, double speed, double dt, int n) {
  const double phase = 2 * std::asin(0.5 * omega * dt);
  return speed * dt * std::sin(n * phase) / std::sin(phase);
}

}  // namespace

// Relative stretch, angle of twist and of bending: sqrt(k_n A / m*), sqrt(2 k_s J / I), sqrt(2 k_n I_b / I) to
// rounding, with the loads of the bond's stiffnesses. A history half a step off shows as 1 %.
TEST(Bonds, OscillatorsOfAPair) {
  const double steps_per_period = 200;
  struct Case {
    Vec3 velocity, spin;
    double stiffness, omega;
  };
  const double inertia = inertia_of(radius), half = 0.5 * distance;
  const Case cases[] = {
      {{0.01, 0, 0}, {}, section.normal_stiffness, std::sqrt(section.normal_stiffness / (0.5 * mass_of(radius)))},
      {{}, {0.1, 0, 0}, section.twist_stiffness, std::sqrt(2 * section.twist_stiffness / inertia)},
      // About the same axis against each other: the bond bends, and does not shear as both arms are alike.
      {{}, {0, 0.1, 0}, section.bending_stiffness, std::sqrt(2 * section.bending_stiffness / inertia)}};
  EXPECT_GT(half, radius);
  for (const Case& c : cases) {
    const auto sim = pair(c.velocity, c.spin);
    const double dt = 2 * std::numbers::pi / c.omega / steps_per_period;
    const double speed = 2 * (c.velocity.x + c.spin.x + c.spin.y);
    double most = 0, error = 0;
    for (int n = 0; n < 1000; n += 7) {
      const auto bond = sim->bonds().at(0);
      const double load = bond.force.x + bond.moment.x + bond.moment.y;
      const double exact = -c.stiffness * verlet_oscillator(c.omega, speed, dt, n);
      most = std::max(most, std::abs(exact));
      error = std::max(error, std::abs(load - exact));
      sim->advance(7, dt);
    }
    EXPECT_LT(error, 1e-6 * most) << "omega = " << c.omega;
  }
}

// A chain of N + 1 spheres h apart, the first held by its mass, the last lifted by a plate: F and deflection as a chain
// of springs has them (sum over the bonds of F (L - x_k)^2 / (k_n I) + F / (k_s A)), which tends to the Timoshenko beam
// F L^3 / 3 E I + F L / k G A with E = k_n h, k G = k_s h like 1 / 4 N^2.
TEST(Bonds, CantileverTendsToTheTimoshenkoBeam) {
  const double length = 1, young = 1e8, shear = 0.4e8, bond_radius = 0.02, lift = 1e-3;
  double before = 0;
  for (const int n : {4, 8, 16}) {
    const double h = length / n, r = 0.45 * h;
    const BondParameters is{bond_radius, young / h, shear / h, never, never};
    const BondSection s(is);
    const auto sim = simulation();
    std::vector<Grain> grains;
    std::vector<dem::Bond> bonds;
    for (int k = 0; k <= n; ++k) {
      grains.push_back({.position = {k * h, 0, 0}, .radius = r, .material = k == 0 ? 1 : 0, .id = k});
      if (k > 0) bonds.push_back({k, k - 1, is});
    }
    sim->add_grains(grains);
    sim->add_bonds(bonds);
    base::Skin plate{"plate", {}, {}};
    for (const double x : {-0.3, 0.3})
      for (const double y : {-0.3, 0.3}) plate.nodes.push_back({length + x * h, y * h, -r});
    plate.facets = {{0, 2, 3, -1}, {0, 3, 1, -1}};
    const int wall = sim->add_mesh(plate, 2, false);
    const double first = 3.516 * std::sqrt(young * s.area * bond_radius * bond_radius / 4 / (mass_of(r) / h));
    sim->set_grain_damping(2 * first);
    const double dt = 0.5 * sim->stable_step().limit;
    const int steps = static_cast<int>(10 / first / dt);
    sim->set_wall_velocity(wall, {0, 0, lift / (steps * dt)});
    sim->advance(steps, dt);
    sim->set_wall_velocity(wall, {});
    sim->advance(2 * steps, dt);
    ASSERT_EQ(sim->wall_contacts().size(), 1u);
    const double force = sim->wall_contacts()[0].force.z, deflection = sim->grains().back().position.z;
    EXPECT_LT(std::abs(sim->grains().front().position.z), 1e-9 * lift);
    double compliance = n / s.shear_stiffness;
    for (int k = 1; k <= n; ++k) compliance += std::pow(length - (k - 0.5) * h, 2) / s.bending_stiffness;
    EXPECT_NEAR(deflection / (force * compliance), 1, 1e-5) << n;
    const double moment_of_area = s.area * bond_radius * bond_radius / 4;
    const double beam = length * length * length / (3 * young * moment_of_area) + length / (shear * s.area);
    const double error = 1 - deflection / (force * beam);
    EXPECT_NEAR(error * 4 * n * n, 1, 0.01) << n;
    if (before > 0) {
      EXPECT_NEAR(std::log2(before / error), 2, 0.02);
    }
    before = error;
  }
}

// Pulled apart with 2 v: the bond breaks at strength x area, and what it had stored is lost; the rest flies on. The
// ledger closes to (omega dt)^2 / 4, here 2.5e-7.
TEST(Bonds, BreaksAtItsStrengthAndTheLedgerCloses) {
  BondParameters weak = cement;
  weak.tensile_strength = 1e6;
  const double speed = 0.7, omega = std::sqrt(section.normal_stiffness / (0.5 * mass_of(radius))), dt = 1e-3 / omega;
  const auto sim = pair({speed, 0, 0}, {}, weak);
  const double before = mass_of(radius) * speed * speed;
  double largest = 0, worst = 0;
  for (int n = 0; n < 2000; ++n) {
    sim->advance(1, dt);
    const auto e = sim->energy();
    largest = std::max(largest, norm(sim->bonds()[0].force));
    worst = std::max(worst, std::abs(e.stored() + e.losses() - before) / before);
  }
  EXPECT_EQ(sim->broken_bonds(), 1);
  EXPECT_TRUE(sim->bonds()[0].broken);
  EXPECT_NEAR(largest / (weak.tensile_strength * section.area), 1, 3e-3);  // one step's stretch short of it
  const auto e = sim->energy();
  const double stretch = weak.tensile_strength / weak.normal_stiffness;
  EXPECT_NEAR(e.loss_breakage / (0.5 * section.normal_stiffness * stretch * stretch), 1, 3e-3);
  EXPECT_GT(e.loss_breakage, 0.1 * before);
  EXPECT_EQ(e.elastic_bonds, 0);
  EXPECT_LT(worst, 1e-6);
  sim->reset_energy();
  EXPECT_EQ(sim->energy().loss_breakage, 0);
}

// The contact acts beside the bond: pressed together both push, pulled apart only the bond holds.
TEST(Bonds, ContactActsBeside) {
  for (const double way : {-1e-6, 1e-6}) {
    const auto sim = simulation();
    std::vector<Grain> grains{{.position = {2 * radius, 0, 0}, .radius = radius, .id = 1},
                              {.position = {}, .radius = radius, .id = 2}};
    sim->add_grains(grains);
    const dem::Bond between{1, 2, cement};
    sim->add_bonds({&between, 1});
    sim->advance(0, 1e-9);
    grains[0].position.x += way;
    sim->set_grains(grains);
    sim->advance(0, 1e-9);
    EXPECT_NEAR(sim->bonds()[0].force.x / (-section.normal_stiffness * way), 1, 1e-6);
    const auto contacts = sim->grain_contacts();
    ASSERT_EQ(contacts.size(), way < 0 ? 1u : 0u);
    if (way > 0) continue;
    const double stiffness = 4.0 / 3.0 * 1e8 / (2 * (1 - 0.25 * 0.25)) * std::sqrt(radius / 2);
    EXPECT_NEAR(norm(contacts[0].force) / (stiffness * 1e-9), 1, 1e-6);
  }
}

namespace {

/// A cube of 27 bonded spheres, not quite alike, thrown and spinning; `order` maps its places to ids.
struct Cube {
  std::vector<Grain> grains;
  std::vector<dem::Bond> bonds;
};
Cube cube(double strength) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> share(0.9, 1.0), speed(-0.3, 0.3);
  Cube made;
  for (int k = 0; k < 27; ++k)
    made.grains.push_back({.position = {0.02 * (k % 3), 0.02 * (k / 3 % 3), 0.02 * (k / 9)},
                           .radius = 0.01 * share(random),
                           .velocity = {1 + speed(random), speed(random), speed(random)},
                           .angular_velocity = {30 * speed(random), 30 * speed(random), 30 * speed(random)},
                           .id = 100 - k});
  for (const auto& [i, j] : dem::pairs_within(made.grains, 0.004))
    made.bonds.push_back({i, j, {0.006, 2e9, 1e9, strength, strength}});
  return made;
}
struct Momenta {
  Vec3 linear, angular;
};
Momenta momenta(const dem::Simulation& sim) {
  Momenta sum;
  for (const Grain& g : sim.grains()) {
    const double m = mass_of(g.radius);
    sum.linear += m * g.velocity;
    sum.angular += m * cross(g.position, g.velocity) + inertia_of(g.radius) * g.angular_velocity;
  }
  return sum;
}
/// Largest error of the ledger over the energy of the shaking at the start; half of the bonds break.
double cube_error(double dt, const Choice& choice) {
  const auto sim = simulation(choice);
  const Cube c = cube(1.3e5);
  sim->add_grains(c.grains);
  sim->add_bonds(c.bonds);
  const double before = sim->energy().kinetic - 0.5 * 27 * mass_of(0.0095);  // about: without the flight as a whole
  const double whole = sim->energy().stored();
  double worst = 0;
  for (int n = 0; n < 50; ++n) {
    sim->advance(static_cast<int>(2e-4 / dt), dt);
    const auto e = sim->energy();
    worst = std::max(worst, std::abs(e.stored() + e.losses() - whole));
  }
  EXPECT_GT(sim->broken_bonds(), 10);
  EXPECT_LT(sim->broken_bonds(), 50);
  EXPECT_GT(sim->counts().rebuilds, choice.skin > 0 ? 5 : 0);
  EXPECT_GT(sim->energy().loss_breakage, 0.05 * before);
  return worst / before;
}

}  // namespace

// Action = reaction: linear and angular momentum to rounding while bonds twist, bend and break and grains collide.
TEST(Bonds, MomentaStayToRounding) {
  for (const double strength : {1.3e5, 1e12}) {
    const auto sim = simulation({.skin = 2e-4});
    const Cube c = cube(strength);
    sim->add_grains(c.grains);
    sim->add_bonds(c.bonds);
    const Momenta before = momenta(*sim);
    sim->advance(10000, 1e-6);
    const Momenta after = momenta(*sim);
    EXPECT_LT(norm(after.linear - before.linear), 1e-13 * norm(before.linear));
    EXPECT_LT(norm(after.angular - before.angular), 1e-12 * norm(before.angular));
    EXPECT_EQ(sim->broken_bonds() > 0, strength < 1e6);
    EXPECT_GT(sim->counts().rebuilds, 5);
  }
}

// Every term integrated: a loss left out, or a bond that forgets its load when the grains are numbered anew, is some
// per cent.
TEST(Bonds, LedgerOfABreakingCubeCloses) {
  EXPECT_LT(cube_error(1e-6, {.skin = 2e-4}), 2e-5);
  EXPECT_LT(cube_error(1e-6, {.lanes = 1}), 2e-5);
}

// The sweep and the GPU's way of taking contacts, and two ways to number the grains: the same motion. Without
// collisions: they would tell roundings apart.
TEST(Bonds, NumberingDoesNotMatter) {
  const Cube c = cube(never);
  std::vector<std::vector<Grain>> ends;
  for (const Choice& choice : {Choice{}, Choice{.lanes = 1, .skin = 2e-4}, Choice{.skin = 1e-4, .ledger = false}}) {
    const auto sim = simulation(choice);
    auto grains = c.grains;
    if (choice.skin == 1e-4) std::reverse(grains.begin(), grains.end());
    sim->add_grains(grains);
    sim->add_bonds(c.bonds);
    sim->advance(1000, 1e-6);
    ends.push_back(sim->grains());
  }
  for (std::size_t k = 0; k < ends[0].size(); ++k)
    for (const auto& other : {ends[1], ends[2]}) {
      EXPECT_LT(norm(ends[0][k].position - other[k].position), 1e-13);
      EXPECT_LT(norm(ends[0][k].velocity - other[k].velocity), 1e-9);
    }
}

// Whether a run is one call of advance() or many with forces looked at anew between them: the same. A bond that takes
// the look for a step creeps.
TEST(Bonds, LooksBetweenStepsChangeNothing) {
  const Cube c = cube(never);
  std::vector<Grain> ends[2];
  for (const bool looks : {false, true}) {
    const auto sim = simulation();
    sim->add_grains(c.grains);
    sim->add_bonds(c.bonds);
    for (int n = 0; n < 100; ++n) {
      sim->advance(5, 1e-6);
      if (looks) sim->set_gravity({});
    }
    ends[looks] = sim->grains();
  }
  for (std::size_t k = 0; k < ends[0].size(); ++k)
    EXPECT_LT(norm(ends[0][k].velocity - ends[1][k].velocity), 1e-9) << k;
}

// A pair thrown tumbling and shaking, 20 steps per period of its stretch, for 20 000 steps: the energy stays where it
// was. Springs that took velocities extrapolated to the instant would double it every few hundred steps.
TEST(Bonds, TumblingPairKeepsItsEnergy) {
  const double omega = std::sqrt(section.normal_stiffness / (0.5 * mass_of(radius)));
  const auto sim = pair({0.3, 0.1, 0.05}, {20, -10, 40});
  const double dt = 2 * std::numbers::pi / omega / 20, before = sim->energy().stored();
  double most = 0;
  for (int n = 0; n < 200; ++n) {
    sim->advance(100, dt);
    most = std::max(most, std::abs(sim->energy().stored() / before - 1));
  }
  EXPECT_LT(most, 0.05);
}

// The same pair seen from a turned frame that flies past, and with i and j exchanged.
TEST(Bonds, FrameIndifferentAndReciprocal) {
  const Vec3 axis{1 / 3.0, 2 / 3.0, -2 / 3.0}, boost{0.7, -0.3, 0.4};
  const auto turned = [&](const Vec3& v) {
    return std::cos(1.1) * v + std::sin(1.1) * cross(axis, v) + (1 - std::cos(1.1)) * dot(axis, v) * axis;
  };
  const double dt = 1e-6;
  const int steps = 500;
  std::vector<Grain> ends[3];
  for (int seen = 0; seen < 3; ++seen) {
    const auto sim = simulation();
    std::vector<Grain> grains{{.position = {distance, 0, 0},
                               .radius = radius,
                               .velocity = {0.3, 0.1, 0.05},
                               .angular_velocity = {20, -10, 40},
                               .id = 1},
                              {.position = {}, .radius = radius, .id = 2}};
    if (seen == 1)
      for (Grain& g : grains) {
        g.position = turned(g.position);
        g.velocity = turned(g.velocity) + boost;
        g.angular_velocity = turned(g.angular_velocity);
      }
    sim->add_grains(grains);
    const dem::Bond between = seen == 2 ? dem::Bond{2, 1, cement} : dem::Bond{1, 2, cement};
    sim->add_bonds({&between, 1});
    sim->advance(steps, dt);
    ends[seen] = sim->grains();
  }
  for (int g = 0; g < 2; ++g) {
    EXPECT_LT(norm(turned(ends[0][g].velocity) + boost - ends[1][g].velocity), 1e-9);
    EXPECT_LT(norm(turned(ends[0][g].angular_velocity) - ends[1][g].angular_velocity), 1e-7);
    EXPECT_LT(norm(ends[0][g].velocity - ends[2][g].velocity), 1e-12);
    EXPECT_LT(norm(ends[0][g].angular_velocity - ends[2][g].angular_velocity), 1e-10);
  }
}

// A long chain in free flight: at 0.98 of the live bound it stays what it was, at 1.05 it flies apart: the limit lies
// in [0.95, 1] of the true one. The limit from the start takes the Rayleigh wave beside it.
TEST(Bonds, StableStepOfAChain) {
  const auto chain = [](double share, const BondParameters& bond) {
    const auto sim = simulation();
    std::mt19937 random(7);
    std::uniform_real_distribution<double> speed(-1e-3, 1e-3);
    std::vector<Grain> grains;
    std::vector<dem::Bond> bonds;
    for (int k = 0; k < 60; ++k) {
      grains.push_back({.position = {distance * k, 0, 0},
                        .radius = radius,
                        .velocity = {speed(random), speed(random), speed(random)},
                        .angular_velocity = {100 * speed(random), 100 * speed(random), 100 * speed(random)},
                        .id = k});
      if (k > 0) bonds.push_back({k - 1, k, bond});
    }
    sim->add_grains(grains);
    sim->add_bonds(bonds);
    const auto first = sim->stable_step(), live = sim->contact_stable_step();
    EXPECT_LT(first.limit, live.limit);
    EXPECT_NE(live.limiter.find("bonds of grain"), std::string::npos) << live.limiter;
    EXPECT_NE(first.limiter.find("(2 bonds), with Rayleigh wave over grain"), std::string::npos) << first.limiter;
    const double before = sim->energy().kinetic;
    try {
      sim->advance(4000, share * live.limit);
    } catch (const base::UnstableError&) {
      return std::numeric_limits<double>::infinity();
    }
    return sim->energy().kinetic / before;
  };
  EXPECT_LT(chain(0.98, cement), 3);
  BondParameters slender = cement;
  slender.shear_stiffness = 0.05 * cement.normal_stiffness;
  EXPECT_LT(chain(0.98, slender), 3);
  EXPECT_GT(chain(1.05, slender), 1e6);
}

// Bonds go with their grains, and a scene without bonds holds no memory for them.
TEST(Bonds, GoWithTheirGrains) {
  const auto sim = simulation();
  const Cube c = cube(never);
  sim->add_grains(c.grains);
  sim->advance(10, 1e-6);
  const auto bare = sim->counts().bytes;
  sim->add_bonds(c.bonds);
  sim->advance(10, 1e-6);
  EXPECT_GT(sim->counts().bytes, bare);
  const std::int64_t corner = 100;
  const auto own =
      std::count_if(c.bonds.begin(), c.bonds.end(), [&](const dem::Bond& b) { return b.i == corner || b.j == corner; });
  EXPECT_EQ(own, 3);
  sim->remove_grains({&corner, 1});
  sim->advance(10, 1e-6);
  EXPECT_EQ(sim->bonds().size(), c.bonds.size() - 3);
  EXPECT_EQ(sim->broken_bonds(), 0);
  for (const auto& b : sim->bonds()) EXPECT_TRUE(b.i != corner && b.j != corner);
}
