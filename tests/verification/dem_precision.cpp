// Mixed precision: what it costs, as dem/sweep_access.hpp states it. Against formulas where there are any, else against
// double. One by one as on a GPU, and in both widths that the sweeps come in (portable, AVX2 where the processor has
// it).
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "dem/dem.hpp"
#include "dem/laws.hpp"
#include "dem/sweep.hpp"
#include "tests/dem_backend.hpp"

namespace {

using dem::Grain;
using dem::Interaction;
using dem::Precision;
using dem::Simulation;
using dem::Vec3;

constexpr double modulus = 2.4e8, ratio = 0.2, density = 2700, step = 5e-6;  // those of benchmark A

/// The ways to take contacts.
std::vector<int> all_lanes() {
  if (dem_test::backend() == dem::Backend::cuda) return {1};
  return dem::sweep_lanes() == 4 ? std::vector<int>{1, 2, 4} : std::vector<int>{1, 2};
}

std::unique_ptr<Simulation> simulation(Precision precision, int lanes, const Interaction& between, Vec3 gravity = {}) {
  dem::Setup setup;
  setup.materials = {{"stone", modulus, ratio, density}};
  setup.interactions = {between};
  setup.gravity = gravity;
  setup.lanes = lanes;
  setup.precision = precision;
  return dem_test::create(setup);
}

double mass_of(const Grain& g) { return density * 4.0 / 3.0 * std::numbers::pi * g.radius * g.radius * g.radius; }

/// Largest difference of velocities and of surface speeds from turning.
double difference(const Simulation& a, const Simulation& b) {
  const auto x = a.grains(), y = b.grains();
  double most = 0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    most = std::max(most, norm(x[k].velocity - y[k].velocity));
    most = std::max(most, x[k].radius * norm(x[k].angular_velocity - y[k].angular_velocity));
  }
  return most;
}

// Hertz: F = 4/3 E* sqrt(R*) d^1.5, d = (15 m* v^2 / 16 E* sqrt(R*))^0.4, duration 2.94328 d / v. Far from the origin:
// places rounded to single precision there (0.1 mm) would leave no contact at all.
TEST(Precision, HertzImpactFarFromTheOrigin) {
  const double radius = 0.02, speed = 0.1;
  for (const int lanes : all_lanes())
    for (const Vec3 at : {Vec3{}, Vec3{1500, -800, 30}}) {
      const auto sim = simulation(Precision::mixed, lanes, {.friction = 0.5, .restitution = 1});
      std::vector<Grain> pair{{.position = at, .radius = radius, .velocity = {speed, 0, 0}, .id = 1},
                              {.position = at + Vec3{2 * radius, 0, 0}, .radius = radius, .id = 2}};
      sim->add_grains(pair);
      const double mass = 0.5 * mass_of(pair[0]), effective = modulus / (2 * (1 - ratio * ratio));
      const double root = std::sqrt(0.5 * radius);
      const double overlap = std::pow(15 * mass * speed * speed / (16 * effective * root), 0.4);
      const double force = 4.0 / 3.0 * effective * root * std::pow(overlap, 1.5);
      const double duration = 2.94328 * overlap / speed, dt = duration / 2000;
      double gap = 0, before = 0, strongest = 0, last = speed;
      int steps = 0;
      do {
        sim->advance(1, dt);
        ++steps;
        const auto grains = sim->grains();
        before = gap;
        gap = norm(grains[0].position - grains[1].position) - 2 * radius;
        strongest = std::max(strongest, mass_of(pair[0]) * (last - grains[0].velocity.x) / dt);
        last = grains[0].velocity.x;
      } while (gap < 0 && steps < 3000);
      EXPECT_NEAR(strongest / force, 1, 1e-4);
      EXPECT_NEAR((steps - gap / (gap - before)) * dt / duration, 1, 1e-4);
    }
}

TEST(Precision, RestitutionIsReturned) {
  for (const int lanes : all_lanes())
    for (const double e : {0.3, 0.7, 0.95}) {
      const auto sim = simulation(Precision::mixed, lanes, {.friction = 0.5, .restitution = e});
      sim->add_grains(std::vector<Grain>{{.position = {}, .radius = 0.02, .velocity = {0, 0, 1}, .id = 1},
                                         {.position = {0, 0, 0.0451}, .radius = 0.025, .id = 2}});
      sim->advance(20000, 1e-6);
      const auto grains = sim->grains();
      EXPECT_NEAR(grains[1].velocity.z - grains[0].velocity.z, e, 1e-3 * e);
    }
}

// Every law and rolling model that a scene can choose: an oblique impact of turning spheres goes as in double, and the
// ledger holds the same. A law that loses its history, or reads it as doubles, is off by per cents.
TEST(Precision, EveryLawAndRollingModel) {
  const std::vector<Interaction> laws{{.law = "hertz_mindlin"},
                                      {.friction = 0, .rolling_friction = 0, .law = "hertz_mindlin"},
                                      {.law = "stress_friction", .critical_stress = 1e5, .friction_exponent = -0.2},
                                      {.law = "hysteretic", .damping_mode = 1},
                                      {.law = "viscoelastic", .dissipative_coefficient = 1e-4},
                                      {.law = "linear", .normal_stiffness = 2e5, .shear_stiffness = 1.4e5},
                                      {.law = "voigt_slider",
                                       .normal_stiffness = 2e5,
                                       .shear_stiffness = 1e5,
                                       .normal_viscosity = 5,
                                       .shear_viscosity = 2}};
  for (std::size_t law = 0; law < laws.size(); ++law)
    for (const char* rolling : {"none", "type_a", "type_c", "brof"}) {
      std::unique_ptr<Simulation> one_by_one;
      for (const int lanes : all_lanes()) {
        Interaction between = laws[law];
        if (law != 1) between.friction = 0.4;
        between.restitution = 0.6;
        between.rolling = rolling;
        if (between.rolling != "none") between.rolling_friction = 0.1;
        if (between.rolling == "type_c") between.rolling_damping = 0.3;
        std::unique_ptr<Simulation> runs[2];
        for (const Precision precision : {Precision::full, Precision::mixed}) {
          auto& sim = runs[static_cast<int>(precision)];
          sim = simulation(precision, lanes, between);
          sim->add_grains(std::vector<Grain>{
              {.position = {}, .radius = 0.02, .velocity = {0.3, 0, 1}, .angular_velocity = {9, -20, 4}, .id = 1},
              {.position = {0.01, 0.005, 0.0435}, .radius = 0.025, .angular_velocity = {0, 5, 0}, .id = 2}});
          sim->advance(4000, 1e-6);
        }
        EXPECT_LT(difference(*runs[0], *runs[1]), 3e-6) << between.law << ", " << rolling << ", " << lanes;
        const base::Energy a = runs[0]->energy(), b = runs[1]->energy();
        const double scale = 2e-6 * a.kinetic;
        EXPECT_NEAR(a.loss_friction, b.loss_friction, scale) << between.law << ", " << rolling;
        EXPECT_NEAR(a.loss_contact_damping, b.loss_contact_damping, scale) << between.law << ", " << rolling;
        EXPECT_NEAR(a.loss_rolling, b.loss_rolling, scale) << between.law << ", " << rolling;
        if (lanes == 1)
          one_by_one = std::move(runs[1]);
        else
          EXPECT_LT(difference(*one_by_one, *runs[1]), 1.5e-6) << between.law << ", " << rolling << ", " << lanes;
      }
    }
}

/// Spheres that fall into a box, in the middle of it.
std::vector<Grain> falling(int number) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> radius(0.011, 0.031), shift(-0.004, 0.004);
  std::vector<Grain> grains;
  for (int k = 0; k < number; ++k)
    grains.push_back({.position = Vec3{0.04 + 0.07 * (k % 5), 0.04 + 0.07 * (k / 5 % 5), 0.04 + 0.07 * (k / 25)} +
                                  Vec3{shift(random), shift(random), shift(random)},
                      .radius = radius(random),
                      .id = k});
  return grains;
}

void add_box(Simulation& sim) {
  sim.add_plane({{0, 0, 0}, {0, 0, 1}}, 0);
  for (const Vec3 inward : {Vec3{1, 0, 0}, Vec3{-1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, -1, 0}})
    sim.add_plane({Vec3{0.18, 0.18, 0} - 0.18 * inward, inward}, 0);
}

// A bed that is still coming to rest, 1000 steps on: energies as in double. Measured: 1e-7.
TEST(Precision, BedMovesAsInDouble) {
  const Interaction stone{.friction = 0.6, .restitution = 0.4};
  const Vec3 gravity{0, 0, -9.81};
  const auto pour = simulation(Precision::full, 0, stone, gravity);
  pour->add_grains(falling(300));
  add_box(*pour);
  pour->advance(20000, 4 * step);
  const auto start = pour->grains();
  for (const int lanes : all_lanes()) {
    base::Energy energy[2];
    for (const Precision precision : {Precision::full, Precision::mixed}) {
      const auto sim = simulation(precision, lanes, stone, gravity);
      sim->add_grains(start);
      add_box(*sim);
      sim->advance(0, step);
      const base::Energy first = sim->energy();
      sim->reset_energy();
      sim->advance(1000, step);
      const base::Energy& e = energy[static_cast<int>(precision)] = sim->energy();
      EXPECT_GT(sim->counts().contacts, 200);
      const double gained =
          e.kinetic + e.elastic_normal + e.elastic_shear - first.kinetic - first.elastic_normal - first.elastic_shear;
      const double lost = e.loss_friction + e.loss_contact_damping + e.loss_rolling + e.loss_damping;
      EXPECT_NEAR(gained + lost, e.work_gravity, 1e-4 * first.kinetic);  // closes equally well in both
    }
    EXPECT_NEAR(energy[1].kinetic / energy[0].kinetic, 1, 1e-5);
    EXPECT_NEAR(energy[1].elastic_normal / energy[0].elastic_normal, 1, 1e-5);
    EXPECT_NEAR(energy[1].elastic_shear / energy[0].elastic_shear, 1, 1e-5);
    EXPECT_NEAR(energy[1].loss_friction / energy[0].loss_friction, 1, 1e-4);
    EXPECT_NEAR(energy[1].loss_contact_damping / energy[0].loss_contact_damping, 1, 1e-4);
  }
}

// Three spheres on a floor and one on top, held by friction alone: once at rest, nothing trembles and nothing creeps.
TEST(Precision, PileAtRestStaysAtRest) {
  const double r = 0.02;
  for (const int lanes : all_lanes()) {
    const auto sim = simulation(Precision::mixed, lanes, {.friction = 0.8, .restitution = 0.3, .rolling_friction = 0.1},
                                {0, 0, -9.81});
    sim->add_plane({{0, 0, 0}, {0, 0, 1}}, 0);
    const double away = 2 * r / std::sqrt(3.0), top = r + 2 * r * std::sqrt(2.0 / 3.0);
    std::vector<Grain> grains{{.position = {0, 0, top}, .radius = r, .id = 0}};
    for (int k = 0; k < 3; ++k) {
      const double angle = 2 * std::numbers::pi / 3 * k + 0.3;
      grains.push_back(
          {.position = {away * std::cos(angle), away * std::sin(angle), r - 1e-7}, .radius = r, .id = k + 1});
    }
    sim->add_grains(grains);
    sim->advance(200000, step);
    const auto rested = sim->grains();
    EXPECT_GT(rested[0].position.z, top - 1e-4);
    sim->advance(100000, step);
    const auto later = sim->grains();
    for (std::size_t k = 0; k < later.size(); ++k) {
      EXPECT_LT(norm(later[k].velocity), 1e-7) << k;
      EXPECT_LT(norm(later[k].position - rested[k].position), 1e-9) << k;
    }
  }
}

// Action = reaction: the sum of m v stays to the rounding of double, that of angular momentum to that of a float.
TEST(Precision, MomentumIsKept) {
  for (const int lanes : all_lanes())
    for (const int threads : {1, 3}) {
      dem::set_threads(threads);
      const auto sim = simulation(Precision::mixed, lanes, {.friction = 0.5, .restitution = 0.8, .rolling = "type_c"});
      auto grains = falling(300);
      std::mt19937 random(3);
      std::uniform_real_distribution<double> speed(-1, 1);
      for (Grain& g : grains) {
        g.position = 0.9 * g.position;
        g.velocity = 15 * (Vec3{0.16, 0.16, 0.38} - g.position) + Vec3{speed(random), speed(random), speed(random)};
      }
      sim->add_grains(grains);
      const auto moments = [&] {
        std::pair<Vec3, Vec3> sum;
        for (const Grain& g : sim->grains()) {
          const double m = mass_of(g);
          sum.first += m * g.velocity;
          sum.second += m * cross(g.position, g.velocity) + 0.4 * m * g.radius * g.radius * g.angular_velocity;
        }
        return sum;
      };
      double scale = 0;
      for (const Grain& g : grains) scale += mass_of(g) * norm(g.velocity);
      const auto before = moments();
      sim->advance(2000, step);
      EXPECT_GT(sim->counts().contacts, 30);
      const auto after = moments();
      EXPECT_LT(norm(after.first - before.first), 1e-13 * scale);
      EXPECT_LT(norm(after.second - before.second), 1e-6 * scale);
    }
  dem::set_threads(2);
}

// The limit that sweep_access.hpp states: a shear spring at 100 N, whose last digit is 7.6e-6 N, takes half of a step's
// increment twice, each to half a digit.
TEST(Precision, SlowCreepIsSeenToTheLastDigit) {
  using namespace dem::kernels;
  PairParameters pair;
  pair.normal_stiffness = pair.shear_stiffness = 1e7;
  pair.friction = 10;
  const auto force_after = [&](auto zero, double per_step) {
    using Real = decltype(zero);
    Touch<Real> touch;
    touch.overlap = Real(1e-4);
    touch.effective_radius = touch.effective_mass = Real(0.01);
    touch.normal = {0, 0, 1};
    touch.velocity = {Real(per_step / (1e7 * 5e-6)), 0, 0};  // k_t v dt = per_step
    Real history[4] = {-100, 0, 0, Real(1e7)};
    Real force = 0;
    for (int k = 0; k < 1000; ++k)
      force = -Linear::press<false>(pair, touch, Interval{2.5e-6, 2.5e-6}, history).force.x;
    return static_cast<double>(force);
  };
  EXPECT_NEAR(force_after(0.0, 2e-6), 100.002, 1e-5);
  EXPECT_NEAR(force_after(0.0f, 2e-6), 100, 1e-5);  // all lost
  for (const double per_step : {1e-5, 1e-4, 1e-3})
    EXPECT_NEAR(force_after(0.0f, per_step), force_after(0.0, per_step), 1000 * 7.7e-6) << per_step;
}

/// 300 spheres that have come to rest in a box.
std::vector<Grain> settled() {
  static const std::vector<Grain> grains = [] {
    const auto pour = simulation(Precision::full, 0, {.friction = 0.6, .restitution = 0.4}, {0, 0, -9.81});
    pour->add_grains(falling(300));
    add_box(*pour);
    pour->advance(20000, 4 * step);
    auto rested = pour->grains();
    for (Grain& g : rested) g.velocity = g.angular_velocity = {};
    return rested;
  }();
  return grains;
}

/// Velocities after one step from rest: what all forces on each grain do.
std::vector<Vec3> kicks(Precision precision, int lanes, const Interaction& between, double along) {
  const auto sim = simulation(precision, lanes, between, {});
  auto grains = settled();
  for (Grain& g : grains) g.position.x += along;
  sim->add_grains(grains);
  sim->advance(1, step);
  std::vector<Vec3> velocities;
  for (const Grain& g : sim->grains()) velocities.push_back(g.velocity);
  return velocities;
}
/// Largest difference over the largest kick.
double apart(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double most = 0, largest = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    most = std::max(most, norm(a[k] - b[k]));
    largest = std::max(largest, norm(a[k]));
  }
  return most / largest;
}

// The forces of a bed 100 m along the track are those of the same bed at the origin, to the rounding of the contact: an
// overlap of 10 um is known to 1.4e-14 m there, and to 6e-8 of itself in a float. Places in single precision (8 um
// there), or a distance rounded before the radii are taken off it (2e-9 m), would change forces by 1 and by 3e-4.
TEST(Precision, BedAlongTheTrackFeelsTheSameForces) {
  const Interaction stone{.friction = 0.6, .restitution = 0.4};
  const auto exact = kicks(Precision::full, all_lanes()[0], stone, 0);
  for (const int lanes : all_lanes()) {
    const auto here = kicks(Precision::mixed, lanes, stone, 0), there = kicks(Precision::mixed, lanes, stone, 100);
    EXPECT_LT(apart(here, exact), 3e-7) << lanes;
    EXPECT_LT(apart(there, here), 3e-7) << lanes;
    EXPECT_GT(apart(here, exact), 1e-10) << lanes;  // it is not double
  }
}

// Histories, results and couples of a list in either precision pass through a checkpoint to the last bit; one that was
// written in the other precision goes on as well, from histories rounded once.
TEST(Precision, GoesOnFromACheckpoint) {
  const Interaction stone{
      .friction = 0.6, .restitution = 0.4, .rolling_friction = 0.1, .rolling = "type_c", .rolling_damping = 0.3};
  const auto started = [&](Precision precision) {
    auto sim = simulation(precision, 1, stone, {0, 0, -9.81});
    add_box(*sim);
    return sim;
  };
  const auto run = started(Precision::mixed), same = started(Precision::mixed), other = started(Precision::full);
  run->add_grains(falling(300));
  run->advance(15000, 4 * step);
  const auto saved = run->save();
  same->restore(saved);
  EXPECT_EQ(same->save(), saved);
  other->restore(saved);
  for (auto* sim : {run.get(), same.get(), other.get()}) sim->advance(100, step);
  EXPECT_GT(run->counts().contacts, 100);
  EXPECT_EQ(difference(*run, *same), 0);
  EXPECT_LT(difference(*run, *other), 1e-6);
  EXPECT_GT(difference(*run, *other), 0);
}

// Four numbers of friction per pair in eight bytes or in four, and a result of eight numbers likewise.
TEST(Precision, HistoriesTakeHalfTheMemory) {
  std::size_t bytes[2];
  for (const Precision precision : {Precision::full, Precision::mixed}) {
    dem::Setup setup;
    setup.materials = {{"stone", modulus, ratio, density}};
    setup.interactions = {{.friction = 0.5}};
    setup.lanes = 1;
    setup.track_energy = false;
    setup.precision = precision;
    const auto sim = dem_test::create(setup);
    sim->add_grains(std::vector<Grain>{{.position = {}, .radius = 0.02, .id = 1},
                                       {.position = {0.039, 0, 0}, .radius = 0.02, .id = 2}});
    sim->advance(1, 1e-6);
    EXPECT_EQ(sim->counts().candidate_pairs, 1);
    bytes[static_cast<int>(precision)] = sim->counts().bytes;
  }
  EXPECT_EQ(bytes[0] - bytes[1], (4 + 8) * (sizeof(double) - sizeof(float)));
}

}  // namespace
