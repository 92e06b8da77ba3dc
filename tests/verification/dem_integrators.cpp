// Integrators of the grains (Irazabal2017 3.3.1): velocity Verlet is of second order, symplectic Euler of first.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "dem/dem.hpp"
#include "tests/dem_backend.hpp"

using base::Vec3;
using dem::TimeScheme;

namespace {

std::unique_ptr<dem::Simulation> simulation(TimeScheme scheme, double restitution, double friction) {
  dem::set_threads(1);
  dem::Setup setup;
  setup.materials = {{"stone", 1e8, 0.25, 2500}};
  setup.interactions = {{friction, restitution, 0}};
  setup.gravity = {0, 0, -9.81};
  setup.time_scheme = scheme;
  return dem_test::create(setup);
}

constexpr double radius = 0.02;

dem::Grain falling(bool clump) {
  return {.position = {0, 0, 1}, .radius = radius, .velocity = {1, 0, 0}, .id = 1, .shape = clump ? 0 : -1};
}
void add_ball(dem::Simulation& sim) {
  const std::array<dem::Sphere, 1> ball{dem::Sphere{{}, 0.01}};
  sim.add_shape(dem::make_clump(ball));
}

/// A sphere in the middle of an oblique impact on a plane. Without a dashpot: its force starts like t^(1/4), which
/// alone lowers the order of velocity Verlet to 5/4.
dem::Grain impact(TimeScheme scheme, int steps) {
  const auto sim = simulation(scheme, 1, 0.3);
  sim->add_plane({{}, {0, 0, 1}}, 0);
  const dem::Grain grain{.position = {0, 0, radius}, .radius = radius, .velocity = {0.3, 0, -1}, .id = 1};
  sim->add_grains({&grain, 1});
  const double time = 3e-4;
  sim->advance(steps, time / steps);
  EXPECT_EQ(sim->wall_contacts().size(), 1u);
  return sim->grains()[0];
}

}  // namespace

// x = x_0 + v t: exact; z: velocity Verlet exact, symplectic Euler too low by dt g t / 2, whatever dt. Spheres and
// clumps.
TEST(Integrators, FreeFall) {
  for (const bool clump : {false, true})
    for (const double dt : {1e-3, 1e-4}) {
      const double time = 0.1, fallen = 0.5 * 9.81 * time * time;
      for (const auto scheme : {TimeScheme::velocity_verlet, TimeScheme::symplectic_euler}) {
        const auto sim = simulation(scheme, 1, 0);
        add_ball(*sim);
        const auto grain = falling(clump);
        sim->add_grains({&grain, 1});
        for (int part = 0; part < 2; ++part) sim->advance(static_cast<int>(std::lround(time / dt / 2)), dt);
        const auto end = sim->grains()[0];
        const double late = scheme == TimeScheme::symplectic_euler ? 0.5 * dt * 9.81 * time : 0;
        EXPECT_NEAR(end.position.x, 0.1, 1e-13);
        EXPECT_NEAR(end.position.z, 1 - fallen - late, 1e-13) << dt;
        EXPECT_NEAR(end.velocity.z, -9.81 * time, 1e-12);
      }
    }
}

// Order of accuracy in an impact with slip: error at a fixed instant against a hundred times finer steps. A force of
// another instant makes velocity Verlet first order, a wrong velocity symplectic Euler zeroth.
TEST(Integrators, OrderInAHertzImpact) {
  const auto exact = impact(TimeScheme::velocity_verlet, 100000);
  const auto error = [&](TimeScheme scheme, int steps) {
    const auto end = impact(scheme, steps);
    return norm(end.position - exact.position) + norm(end.velocity - exact.velocity) * 1e-4;
  };
  for (const auto scheme : {TimeScheme::velocity_verlet, TimeScheme::symplectic_euler}) {
    const double order = scheme == TimeScheme::velocity_verlet ? 2 : 1;
    const double coarse = error(scheme, 125), fine = error(scheme, 1000);
    EXPECT_NEAR(std::log(coarse / fine) / std::log(8), order, 0.15);
  }
  EXPECT_GT(error(TimeScheme::symplectic_euler, 1000), 10 * error(TimeScheme::velocity_verlet, 1000));
}

// An undamped shear spring and a turning grain: symplectic Euler neither feeds nor drains a sphere that rocks on a
// plane, pressed on by gravity. Springs that take part of the next step's way would pump it up within some hundred
// swings.
TEST(Integrators, SymplecticEulerKeepsTheEnergyOfARockingSphere) {
  const auto sim = simulation(TimeScheme::symplectic_euler, 1, 1e6);
  sim->add_plane({{}, {0, 0, 1}}, 0);
  const double mass = 4.0 / 3.0 * std::numbers::pi * radius * radius * radius * 2500, speed = 1e-4;
  const double modulus = 1e8 / (2 * (1 - 0.25 * 0.25));
  const double rest = std::pow(mass * 9.81 / (4.0 / 3.0 * modulus * std::sqrt(radius)), 2.0 / 3.0);
  const dem::Grain grain{.position = {0, 0, radius - rest}, .radius = radius, .velocity = {speed, 0, 0}, .id = 1};
  sim->add_grains({&grain, 1});
  const double dt = 0.2 * sim->stable_step().limit, shaking = 0.5 * mass * speed * speed;
  sim->advance(0, dt);
  const double before = sim->energy().stored();
  double most = 0;
  for (int n = 0; n < 100; ++n) {
    sim->advance(200, dt);
    const auto e = sim->energy();
    most = std::max(most, std::abs(e.stored() - e.works() - before) / shaking);
  }
  EXPECT_LT(most, 0.1);
}

// A clump of one sphere moves as the sphere, under symplectic Euler too, damped or not.
TEST(Integrators, ClumpsAndSpheresAlike) {
  for (const double damping : {0.0, 2.0}) {
    dem::Grain ends[2];
    for (const bool clump : {false, true}) {
      const auto sim = simulation(TimeScheme::symplectic_euler, 0.6, 0.5);
      add_ball(*sim);
      sim->add_plane({{0, 0, 0.9}, {0.1, 0, 1}}, 0);
      sim->set_grain_damping(damping);
      const auto grain = falling(clump);
      sim->add_grains({&grain, 1});
      sim->advance(20000, 1e-5);
      EXPECT_GT(sim->energy().loss_friction, 0);
      ends[clump] = sim->grains()[0];
    }
    EXPECT_LT(norm(ends[0].position - ends[1].position), 1e-11);
    EXPECT_LT(norm(ends[0].angular_velocity - ends[1].angular_velocity), 1e-7);
  }
}

// Artificial damping brakes and never drives, whatever alpha dt: v falls by 1 / (1 + alpha dt) in a step.
TEST(Integrators, DampingIsImplicit) {
  const auto sim = simulation(TimeScheme::symplectic_euler, 1, 0);
  sim->set_gravity({});
  sim->set_grain_damping(1e4);
  const auto grain = falling(false);
  sim->add_grains({&grain, 1});
  sim->advance(1, 1e-3);
  EXPECT_NEAR(sim->grains()[0].velocity.x, 1.0 / 11, 1e-12);
}
