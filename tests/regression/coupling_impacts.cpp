// Impacts that grains and bodies share, against theory: the scenes of configs/ as a user starts them.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/regression/run_helper.hpp"

namespace {

using namespace regression;

struct Impact {
  double rebound = 0, energy_in_bar = 0, largest_force = 0, lasts = 0;
};

/// Hertz's contact in series with the bar's impedance Z = rho c A, while no wave has come back (Sears 1908; Goldsmith,
/// Impact, 1960, ch. 4): m x'' = -F, u' = F / Z, F = 4/3 E* sqrt(R) (x - u)^1.5; energy in the bar: integral of F u'.
/// Midpoint rule, steps of 1 ns.
Impact bar_struck_by_ball() {
  constexpr double radius = 0.01, young = 200e9, density = 7800, area = 0.01 * 0.02, dt = 1e-9;
  const double mass = density * 4.0 / 3.0 * std::numbers::pi * radius * radius * radius;
  const double modulus = 1 / ((1 - 0.3 * 0.3) / young + 1 / young);
  const double k = 4.0 / 3.0 * modulus * std::sqrt(radius), impedance = std::sqrt(young * density) * area;
  const auto force = [&](double overlap) { return k * std::pow(std::max(overlap, 0.0), 1.5); };
  double overlap = 0, speed = 1;
  Impact is;
  do {
    const double begins = force(overlap);
    const double middle = force(overlap + 0.5 * dt * (speed - begins / impedance));
    overlap += dt * (speed - 0.5 * dt * begins / mass - middle / impedance);
    speed -= dt * middle / mass;
    is.energy_in_bar += dt * middle * middle / impedance;
    is.largest_force = std::max(is.largest_force, middle);
    is.lasts += dt;
  } while (overlap > 0);
  is.rebound = -speed;
  return is;
}

TEST(Impacts, BarKeepsWhatOneDimensionalTheorySays) {
  const Impact theory = bar_struck_by_ball();
  EXPECT_LT(theory.lasts, 2 * 0.5 / std::sqrt(200e9 / 7800));  // the wave is not back yet
  const fs::path out = scratch() / "bar_impact";
  const auto finished = trackbed("run " + scene("bar_impact.toml") + " --out " + out.string());
  ASSERT_EQ(finished.status, 0) << finished.output;
  const auto json = summary(out);
  const auto& results = json["results"];
  EXPECT_NEAR(results["rebound"]["value"].get<double>(), theory.rebound, 0.02 * theory.rebound);
  EXPECT_NEAR(results["rebound"]["expected"].get<double>(), theory.rebound, 1e-4 * theory.rebound);
  EXPECT_NEAR(results["largest_force"]["value"].get<double>(), theory.largest_force, 0.02 * theory.largest_force);
  EXPECT_NEAR(json["energy"]["interface_seen_by_bodies"].get<double>(), theory.energy_in_bar,
              0.02 * theory.energy_in_bar);
  EXPECT_LT(json["energy"]["relative_error"].get<double>(), 1e-3);
  EXPECT_LE(json["momentum_error"].get<double>(), 1e-12);
}

TEST(Impacts, GrainComesToRestOnABlock) {
  const fs::path out = scratch() / "grain_on_block";
  const auto finished = trackbed("run " + scene("grain_on_block.toml") + " --out " + out.string());
  ASSERT_EQ(finished.status, 0) << finished.output;
  const auto json = summary(out);
  const auto& results = json["results"];
  EXPECT_EQ(results["restitution"]["within"], true) << results["restitution"]["value"];
  for (const char* name : {"weight_on_block", "weight_at_base"})
    EXPECT_LT(std::abs(results[name]["relative_error"].get<double>()), 1e-3) << name;
  EXPECT_LT(json["energy"]["relative_error"].get<double>(), 0.01);
  EXPECT_LE(json["momentum_error"].get<double>(), 1e-12);
}

TEST(Impacts, SleeperComesToRestOnStones) {
  const fs::path out = scratch() / "sleeper_drop";
  const auto finished = trackbed("run " + scene("sleeper_drop.toml") + " --out " + out.string());
  ASSERT_EQ(finished.status, 0) << finished.output;
  const auto json = summary(out);
  const auto& results = json["results"];
  for (const char* name : {"weight_on_floor", "weight_on_stones"})
    EXPECT_LT(std::abs(results[name]["relative_error"].get<double>()), 2e-3) << name;
  EXPECT_EQ(results["settlement"]["within"], true) << results["settlement"]["value"];
  EXPECT_LT(json["energy"]["relative_error"].get<double>(), 1e-3);
  EXPECT_LE(json["momentum_error"].get<double>(), 1e-12);
}

}  // namespace
