// Absurd states: handled as the law says, or stopped with the grain's id, place and step. What is not finite: see
// unit/dem_lists.cpp.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "dem/dem.hpp"
#include "tests/dem_backend.hpp"

namespace {

dem::Setup setup_of(double young_modulus, double restitution) {
  dem::set_threads(1);
  dem::Setup setup;
  setup.materials = {{"stone", young_modulus, 0.2, 2700}};
  setup.interactions = {{0.5, restitution, 0}};
  return setup;
}

std::string outcome(dem::Simulation& sim, int steps, double dt) {
  try {
    sim.advance(steps, dt);
  } catch (const base::UnstableError& e) {
    return e.what();
  }
  return "went on";
}

// Hertz: deepest overlap (15 m v^2 / 16 E* sqrt(R))^(2/5): 0.11 R for stone of 50 GPa at 100 m/s, which rebounds with
// its e; 0.94 R for ballast softened to 0.24 GPa, which Hertz no longer describes: stopped.
TEST(Extremes, HundredMetresPerSecond) {
  for (const double modulus : {50e9, 0.24e9}) {
    const auto sim = dem_test::create(setup_of(modulus, 0.5));
    sim->add_plane({{0, 0, 0}, {0, 0, 1}}, 0);
    sim->add_grains(
        std::vector<dem::Grain>{{.position = {0.3, 0, 0.021}, .radius = 0.02, .velocity = {0, 0, -100}, .id = 77}});
    const std::string text = outcome(*sim, 20000, 1e-8);
    if (modulus > 1e9) {
      EXPECT_EQ(text, "went on");
      EXPECT_EQ(sim->counts().wall_contacts, 0);
      EXPECT_NEAR(sim->grains()[0].velocity.z, 50, 0.05);
    } else {
      EXPECT_NE(text.find("grain 77: overlap with a wall is 0.3"), std::string::npos) << text;
      EXPECT_NE(text.find("at (0.3, 0, "), std::string::npos) << text;
      EXPECT_NE(text.find(", step "), std::string::npos) << text;
    }
  }
}

// A dust grain of 0.1 mm falls on a sphere of 1 m and rebounds with its e: the neighbour search finds it, and the
// masses (1e12 : 1) lose no digit that matters.
TEST(Extremes, SizeRatioOfTenThousand) {
  const auto sim = dem_test::create(setup_of(1e9, 0.7));
  sim->add_grains(
      std::vector<dem::Grain>{{.position = {0, 0, 0}, .radius = 1, .id = 1},
                              {.position = {0, 0, 1 + 1.02e-4}, .radius = 1e-4, .velocity = {0, 0, -0.1}, .id = 2}});
  EXPECT_EQ(outcome(*sim, 20000, 5e-9), "went on");
  EXPECT_EQ(sim->counts().contacts, 0);
  EXPECT_NEAR(sim->grains()[1].velocity.z, 0.07, 0.07 * 1e-3);
}

// Two spheres that start 29 % in each other fly apart with no more energy than the overlap held, 8/15 E* sqrt(R*)
// d^2.5; at 31 % the run stops before its first step.
TEST(Extremes, ThirtyPercentOverlapAtTheStart) {
  for (const double share : {0.29, 0.31}) {
    const auto sim = dem_test::create(setup_of(1e8, 1));
    const double radius = 0.02, overlap = share * radius;
    sim->add_grains(std::vector<dem::Grain>{{.position = {0, 0, 0}, .radius = radius, .id = 5},
                                            {.position = {2 * radius - overlap, 0, 0}, .radius = radius, .id = 6}});
    const std::string text = outcome(*sim, 20000, 1e-7);
    if (share > 0.3) {
      EXPECT_NE(text.find("overlap with another grain is 0.31 of the smaller radius"), std::string::npos) << text;
      EXPECT_NE(text.find("step 0"), std::string::npos) << text;
      continue;
    }
    EXPECT_EQ(text, "went on");
    const double modulus = 1e8 / (2 * (1 - 0.04));
    const double held = 8.0 / 15.0 * modulus * std::sqrt(radius / 2) * std::pow(overlap, 2.5);
    EXPECT_EQ(sim->counts().contacts, 0);
    EXPECT_NEAR(sim->energy().kinetic, held, 1e-5 * held);
  }
}

// No box bounds the grains: one that flies off is still there, and costs its neighbours nothing.
TEST(Extremes, AGrainFliesAway) {
  const auto sim = dem_test::create(setup_of(1e8, 0.5));
  sim->add_grains(std::vector<dem::Grain>{{.position = {0, 0, 0}, .radius = 0.02, .velocity = {1e5, 0, 0}, .id = 1},
                                          {.position = {0, 0.05, 0}, .radius = 0.02, .id = 2}});
  EXPECT_EQ(outcome(*sim, 1000, 1e-3), "went on");
  EXPECT_NEAR(sim->grains()[0].position.x, 1e5, 1e-6);
  EXPECT_EQ(sim->grains()[1].position.y, 0.05);
}

// Linear springs know no Rayleigh wave: the step follows k / m. A line of five spheres between two walls, struck at one
// end, keeps its energy at the reported limit and explodes at twice of it.
TEST(Extremes, StepOfLinearSprings) {
  for (const double share : {0.98, 2.5}) {
    auto setup = setup_of(1e9, 1);
    setup.interactions[0] = {0, 1, 0, "linear"};
    setup.interactions[0].normal_stiffness = 1e5;
    const auto sim = dem_test::create(setup);
    std::vector<dem::Grain> line;
    for (int k = 0; k < 5; ++k) line.push_back({.position = {0.0398 * k, 0, 0}, .radius = 0.02, .id = k});
    line[0].velocity = {0.1, 0, 0};
    sim->add_plane({{-0.0199, 0, 0}, {1, 0, 0}}, 0);
    sim->add_plane({{0.0398 * 4 + 0.0199, 0, 0}, {-1, 0, 0}}, 0);
    sim->add_grains(line);
    const auto step = sim->stable_step();
    const double mass = 2700 * 4.0 / 3.0 * std::numbers::pi * 8e-6;
    EXPECT_NEAR(step.limit, 2 / std::sqrt(8 * 1e5 / mass), 1e-12);
    EXPECT_NE(step.limiter.find("linear springs"), std::string::npos) << step.limiter;
    const double start = 0.5 * mass * 0.01 + 4 * 0.5 * 1e5 * 4e-8 + 2 * 0.5 * 1e5 * 1e-8;
    const std::string text = outcome(*sim, 20000, share * step.limit);
    if (share < 1) {
      EXPECT_EQ(text, "went on");
      EXPECT_NEAR(sim->energy().stored(), start, 0.05 * start);
    } else {
      EXPECT_TRUE(text != "went on" || sim->energy().stored() > 2 * start) << text;
    }
  }
}

}  // namespace
