// What single contact laws have of their own, against their equations; tests/unit/dem_laws.cpp has what all must keep.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <string>

#include "base/error.hpp"
#include "dem/law_parameters.hpp"
#include "tests/dem_pair_helper.hpp"

using namespace dem_test;

namespace {

const dem::Material stone{"stone", 1e9, 0.25, 2500};
constexpr double radius = 0.01, overlap = 1e-5;  // [m]
const double mass = sphere_mass(radius, stone.density);

Touch<double> sphere_on_plane(double depth, const Vec3& velocity) { return {depth, radius, mass, {0, 0, 1}, velocity}; }

/// Message of the UserError that `fails` throws.
std::string message(const std::function<void()>& fails) {
  try {
    fails();
  } catch (const base::UserError& error) {
    return error.what();
  }
  return "no error";
}

}  // namespace

// ---- constants
// Irazabal2017 3.27 and 4.1 by hand: equal materials halve both moduli; a wall is infinitely stiff in shear. 3.26: c_t
// / c_n = sqrt(k_t / k_n).
TEST(LawParameters, Hertz) {
  const auto pair = dem::hertz_pair(stone, stone, {0.3, 1, 0.1});
  EXPECT_NEAR(pair.effective_young_modulus, 1e9 / (2 * (1 - 0.0625)), 1e-3);
  EXPECT_NEAR(pair.effective_shear_modulus, 0.4e9 / (2 * 1.75), 1e-3);
  EXPECT_NEAR(pair.shear_damping, std::sqrt(8 * pair.effective_shear_modulus / (2 * pair.effective_young_modulus)),
              1e-15);
  const auto wall = dem::hertz_wall(stone, {"steel", 200e9, 0.3, 0}, {0.3, 1, 0.1});
  EXPECT_NEAR(wall.effective_young_modulus, 1 / (0.9375 / 1e9 + 0.91 / 200e9), 1e-3);
  EXPECT_NEAR(wall.effective_shear_modulus, 0.4e9 / 1.75, 1e-3);
}

// Irazabal2017 3.17 in its two branches (the first with 1 - 2 gamma^2).
TEST(LawParameters, LinearRestitution) {
  for (double g : {0.05, 0.3, 0.7, 0.72, 0.9}) {
    const double s = std::sqrt(1 - g * g),
                 branch = std::atan(2 * g * s / (g < std::sqrt(0.5) ? 1 - 2 * g * g : 2 * g * g - 1));
    const double log_e = -g / s * (g < std::sqrt(0.5) ? std::numbers::pi - branch : branch);
    EXPECT_NEAR(dem::linear_restitution(g), std::exp(log_e), 1e-14) << g;
    EXPECT_NEAR(dem::linear_damping_ratio(std::exp(log_e)), g, 1e-12) << g;
  }
}

// Talebiahooie2021 eq. 16 by hand, and the closed integral of one impact.
TEST(LawParameters, HystereticDamping) {
  EXPECT_DOUBLE_EQ(dem::hysteretic_damping(0, 0.5), 1.5);
  EXPECT_DOUBLE_EQ(dem::hysteretic_damping(1, 0.5), 0.5625);
  EXPECT_NEAR(dem::hysteretic_damping(2, 0.5), 0.5625 * std::numbers::e, 1e-15);
  EXPECT_EQ(dem::hysteretic_damping(1, 0), 0.75);
  for (double d : {1e-9, 1e-3, 0.1, 0.5625, 1.5, 5.0}) {
    const double e = dem::hysteretic_restitution(d);
    EXPECT_NEAR(d * (1 + e), std::log1p(d) - std::log1p(-d * e), 1e-12 * d) << d;
    EXPECT_LT(e, 1);
  }
  EXPECT_EQ(dem::hysteretic_restitution(0), 1);
}

// Nishiura2017 Table 1, ballast and sleeper, to the printed digits.
TEST(LawParameters, VoigtShearStiffness) {
  EXPECT_NEAR(dem::voigt_shear_stiffness(1.613e9, 0.2), 0.672e9, 0.0005e9);
  EXPECT_NEAR(dem::voigt_shear_stiffness(2.390e9, 0.167), 1.024e9, 0.0005e9);
}

// Irazabal2017 6.8, 6.9: the peak Hertz stress is also 2 E* / pi sqrt(overlap / R*).
TEST(LawParameters, CriticalStress) {
  const double e = 0.125e9, r = 0.0044, weight = 0.887;
  const double d = std::pow(0.75 * weight / (e * std::sqrt(r)), 2.0 / 3.0);
  EXPECT_NEAR(dem::critical_stress({weight, r, e}) / (2 * e / std::numbers::pi * std::sqrt(d / r)), 1, 1e-12);
}

TEST(LawParameters, AbsurdValuesAreNamed) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(message([] {
              dem::hertz_pair({"ice", -1, 0.3, 900}, stone, {});
            }),
            "material ice: young_modulus = -1; must be > 0 and finite [Pa]");
  EXPECT_EQ(message([] {
              dem::hertz_wall(stone, {"rubber", 1e6, 0.6, 0}, {});
            }),
            "material rubber: poisson_ratio = 0.6; must be in (-1, 0.5]");
  EXPECT_EQ(message([] {
              dem::hertz_pair(stone, stone, {-0.1, 1, 0});
            }),
            "friction = -0.1; must be >= 0 and finite; 0 for none");
  EXPECT_EQ(message([] {
              dem::hertz_pair(stone, stone, {0.3, 0, 0});
            }),
            "restitution = 0; must be in (0, 1]; 1 for no damping");
  EXPECT_EQ(message([&] {
              dem::linear_pair({nan, 1e6, 0.3, 1});
            }),
            "normal_stiffness = nan; must be > 0 and finite [N/m]");
  EXPECT_EQ(message([] {
              dem::linear_pair({1e6, -1, 0.3, 1});
            }),
            "shear_stiffness = -1; must be >= 0 and finite [N/m]");
  EXPECT_EQ(message([] { dem::voigt_pair({1e6, 1e6, -2, 0, 0.3}); }), "normal_viscosity = -2; must be >= 0 [N s/m]");
  EXPECT_EQ(message([] { dem::hysteretic_damping(3, 0.5); }),
            "damping_mode = 3; must be 0 (Gonthier), 1 (Lankarani) or 2 (Zhiying)");
  EXPECT_EQ(message([] { dem::hysteretic_damping(0, 0); }), "restitution = 0; must be in (0, 1]; 1 for no damping");
  EXPECT_EQ(message([] { dem::hysteretic_damping(1, -0.1); }), "restitution = -0.1; must be in [0, 1]");
  EXPECT_EQ(message([] { dem::critical_stress({0, 0.01, 1e9}); }), "weight = 0; must be > 0 and finite [N]");
  PairParameters pair;
  dem::check_parameters(pair);
  pair.friction_exponent = 0.15;
  EXPECT_EQ(message([&] { dem::check_parameters(pair); }),
            "friction_exponent = 0.15; must be <= 0 and finite: friction falls with stress");
  pair.friction_exponent = -0.15;
  EXPECT_EQ(message([&] { dem::check_parameters(pair); }),
            "critical_stress = 0; must be > 0 where friction_exponent is not 0 [Pa]");
}

// ---- linear
// Eq. 3: at constant velocities the spring has taken exactly what was covered since the surfaces met, wherever within a
// step they did. Without the rule it is off by up to half a step.
TEST(LinearLaw, ShearOnset) {
  const auto pair = dem::linear_pair({1e6, 0.7e6, 100, 1});
  const double dt = 1e-6, down = 2, sideways = 0.3;
  for (double part : {0.01, 0.3, 0.5, 0.99}) {
    double history[Linear::history + 1] = {};
    for (int n = 0; n < 10; ++n) {
      const double since = (n + part) * dt;
      const auto on_i =
          Linear::press<true>(pair, sphere_on_plane(down * since, {sideways, 0, -down}), {0.5 * dt, 0.5 * dt}, history);
      EXPECT_NEAR(on_i.force.x / (-0.7e6 * sideways * since), 1, 1e-12) << part << " " << n;
    }
  }
}

// Eqs. 1, 6, 7 at one instant, long after the touch.
TEST(LinearLaw, NormalForce) {
  auto pair = dem::linear_pair({1e6, 0.7e6, 0.3, 0.6});
  const double c_n = 2 * pair.damping_ratio * std::sqrt(mass * 1e6);
  double history[Linear::history + 1] = {};
  const auto on_i = Linear::press<true>(pair, sphere_on_plane(overlap, {0, 0, -0.1}), {1e-9, 1e-9}, history);
  EXPECT_NEAR(on_i.normal_force, 1e6 * overlap + 0.1 * c_n, 1e-12);
  EXPECT_NEAR(on_i.loss_damping, 0.01 * c_n * 2e-9, 1e-18);
  EXPECT_NEAR(on_i.elastic_normal, 0.5 * 1e6 * overlap * overlap, 1e-18);
}

// ---- hysteretic
// The energy that the damper takes in one impact is 1/2 m v^2 (1 - e'^2) with e' of the closed integral, in each mode
// and at each speed. With the mode's D mixed up, or the speed not scaled, it is off by 10 % and more.
TEST(HystereticLaw, EnergyLossOfOneImpact) {
  for (int mode : {0, 1, 2})
    for (double speed : {0.05, 5.0})
      for (double e : {0.3, 0.6, 0.9}) {
        auto pair = dem::hertz_wall(stone, stone, {0.3, 1, 0});
        pair.hysteretic_damping = dem::hysteretic_damping(mode, e);
        Pair<Hysteretic> run{pair, {radius, mass, {0, 0, radius}, {0, 0, -speed}}, {}};
        run.collide(HertzImpact{pair.effective_young_modulus, radius, mass, speed}.duration() / 1000);
        const double returned = dem::hysteretic_restitution(pair.hysteretic_damping);
        const double lost = 0.5 * mass * speed * speed * (1 - returned * returned);
        EXPECT_NEAR(run.loss_damping / lost, 1, 1e-4) << mode << " " << e;
        EXPECT_NEAR(run.i.velocity.z / speed, returned, 2e-4) << mode << " " << e;
      }
}

// Eqs. 8, 11 with G, nu and the radius 2 R* of eq. 9; a contact struck after it formed slowly is damped by its largest
// approach speed (by the first one the force would be 1000 times as large).
TEST(HystereticLaw, ForceAtOneInstant) {
  auto pair = dem::hertz_pair(stone, stone, {100, 1, 0});
  pair.hysteretic_damping = 0.5;
  const double g = stone.young_modulus / (2 * (1 + stone.poisson_ratio)), r = 2 * radius;
  double history[Hysteretic::history + 1] = {};
  const Interval now{0, 0};
  const double elastic = 2 * g * std::sqrt(2 * r) / (3 * (1 - stone.poisson_ratio)) * std::pow(overlap, 1.5);
  EXPECT_NEAR(Hysteretic::press<true>(pair, sphere_on_plane(overlap, {}), now, history).normal_force / elastic, 1,
              1e-12);
  const auto slow = Hysteretic::press<true>(pair, sphere_on_plane(overlap, {0, 0, -1e-3}), now, history);
  EXPECT_NEAR(slow.normal_force / elastic, 1.5, 1e-12);
  const auto struck = Hysteretic::press<true>(pair, sphere_on_plane(overlap, {0, 0, -1}), now, history);
  EXPECT_NEAR(struck.normal_force / elastic, 1.5, 1e-12);
  const auto opens = Hysteretic::press<true>(pair, sphere_on_plane(overlap, {0, 0, 0.5}), now, history);
  EXPECT_NEAR(opens.normal_force / elastic, 0.75, 1e-12);
  const double k_s = 2 * g * std::sqrt(2 * overlap * r) / (2 - stone.poisson_ratio);
  EXPECT_NEAR(history[Hysteretic::history - 1] / k_s, 1, 1e-12);
}

// ---- viscoelastic
// e = 1 - C1 b + 3/5 C1^2 b^2 (Ramirez et al. 1999), up to b^2.5; C1 = 1.15344, b = 3/2 A (rho / m)^0.4 v^0.2. So e
// falls with speed.
TEST(ViscoelasticLaw, RestitutionFallsWithSpeed) {
  auto pair = dem::hertz_wall(stone, stone, {0.3, 1, 0});
  pair.dissipative_coefficient = 2e-6;
  const double rho = 4.0 / 3.0 * pair.effective_young_modulus * std::sqrt(radius);
  for (double speed : {0.01, 1.0, 10.0}) {
    Pair<Viscoelastic> run{pair, {radius, mass, {0, 0, radius}, {0, 0, -speed}}, {}};
    run.collide(HertzImpact{pair.effective_young_modulus, radius, mass, speed}.duration() / 2000);
    const double b = 1.5 * 2e-6 * std::pow(rho / mass, 0.4) * std::pow(speed, 0.2), c1b = 1.15344 * b;
    EXPECT_GT(b, 0.005);
    EXPECT_NEAR(run.i.velocity.z / speed, 1 - c1b + 0.6 * c1b * c1b, 0.5 * std::pow(b, 2.5) + 1e-5) << b;
  }
}

// ---- stress-dependent friction
// 6.4, 6.6 at one instant in full sliding, on both sides of the critical stress. sigma = 2 E* / pi sqrt(overlap / R*).
TEST(StressFrictionLaw, FallsBeyondTheCriticalStress) {
  auto pair = dem::hertz_wall(stone, stone, {0.6, 1, 0});
  const double stress = 2 * pair.effective_young_modulus / std::numbers::pi * std::sqrt(overlap / radius);
  for (double ratio : {0.5, 0.999, 1.0, 1.001, 3.0})
    for (double exponent : {-0.05, -0.15}) {
      pair.critical_stress = stress / ratio;
      pair.friction_exponent = exponent;
      double history[StressFriction::history + 1] = {};
      const auto on_i = StressFriction::press<true>(pair, sphere_on_plane(overlap, {1e3, 0, 0}), {1e-6, 1e-6}, history);
      const double mu = ratio > 1 ? 0.6 * std::pow(ratio, exponent) : 0.6;
      EXPECT_NEAR(-on_i.force.x / on_i.normal_force, mu, 1e-9) << ratio;
    }
}
