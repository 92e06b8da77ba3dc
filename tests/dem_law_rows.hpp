#pragma once
// One row per contact law for tests/unit/dem_laws.cpp: the law, its parameters for what a test asks, and the
// restitution that it must return for it. Two spheres of 10 mm and 15 mm that meet at 1 m/s.
#include <gtest/gtest.h>

#include <algorithm>

#include "dem/law_parameters.hpp"
#include "tests/dem_pair_helper.hpp"

namespace dem_test::law_rows {

inline const dem::Material stone{"stone", 1e9, 0.25, 2500};
inline const double mass_i = sphere_mass(0.01, stone.density), mass_j = sphere_mass(0.015, stone.density);
inline const double reduced_mass = mass_i * mass_j / (mass_i + mass_j);
inline constexpr double reduced_radius = 0.006, stiffness = 1e6;  // [m], [N/m]

struct Asked {
  double restitution = 1, friction = 0.3;
};

/// Restitution of a viscoelastic impact by its one dimensionless equation, x'' = -x^1.5 - b x^0.5 x', x'(0) = 1, up to
/// where the force is used up; fourth-order Runge-Kutta.
inline double viscoelastic_restitution(double b) {
  const double h = 1e-4;
  double x = 0, v = 1;
  const auto a = [b](double place, double speed) {
    const double root = std::sqrt(std::max(place, 0.0));
    return -root * (place + b * speed);
  };
  while (v > 0 || a(x, v) < 0) {
    const double v1 = v, a1 = a(x, v1), v2 = v + h / 2 * a1, a2 = a(x + h / 2 * v1, v2), v3 = v + h / 2 * a2,
                 a3 = a(x + h / 2 * v2, v3), v4 = v + h * a3, a4 = a(x + h * v3, v4);
    x += h / 6 * (v1 + 2 * v2 + 2 * v3 + v4);
    v += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
  }
  return -v;
}

// ---- one row per law: its parameters, and the restitution that it must return at 1 m/s
struct HertzRow {
  using Law = HertzMindlin;
  static PairParameters parameters(const Asked& a) {
    return dem::hertz_pair(stone, stone, {a.friction, a.restitution, 0});
  }
  static double restitution(double asked) { return asked; }
};

struct StressFrictionRow : HertzRow {
  using Law = StressFriction;
  static PairParameters parameters(const Asked& a) {
    PairParameters pair = HertzRow::parameters(a);
    pair.critical_stress = 1e7;  // the impacts here peak at 5e7 Pa, the random contacts at 2e7 Pa
    pair.friction_exponent = -0.15;
    return pair;
  }
};

template <int mode>
struct HystereticRow {
  using Law = Hysteretic;
  static PairParameters parameters(const Asked& a) {
    PairParameters pair = HertzRow::parameters({1, a.friction});
    pair.hysteretic_damping = dem::hysteretic_damping(mode, a.restitution);
    return pair;
  }
  static double restitution(double asked) { return dem::hysteretic_restitution(dem::hysteretic_damping(mode, asked)); }
};

struct ViscoelasticRow {
  using Law = Viscoelastic;
  static double coefficient(double asked) { return 1e-4 * (1 - asked); }  // [s]
  static PairParameters parameters(const Asked& a) {
    PairParameters pair = HertzRow::parameters({1, a.friction});
    pair.dissipative_coefficient = coefficient(a.restitution);
    return pair;
  }
  static double restitution(double asked) {
    const double rho = 4.0 / 3.0 * HertzRow::parameters({}).effective_young_modulus * std::sqrt(reduced_radius);
    return viscoelastic_restitution(1.5 * coefficient(asked) * std::pow(rho / reduced_mass, 0.4));
  }
};

struct LinearRow {
  using Law = Linear;
  static PairParameters parameters(const Asked& a) {
    return dem::linear_pair({stiffness, 0.7 * stiffness, a.friction, a.restitution});
  }
  static double restitution(double asked) { return asked; }
};

struct DampedLinearRow : LinearRow {  // a tangential dashpot as well
  static PairParameters parameters(const Asked& a) {
    PairParameters pair = LinearRow::parameters(a);
    pair.shear_damping = std::sqrt(0.7);
    return pair;
  }
};

struct VoigtRow : LinearRow {
  using Law = VoigtSlider;
  static PairParameters parameters(const Asked& a) {
    const double c_n = 2 * dem::linear_damping_ratio(a.restitution) * std::sqrt(stiffness * reduced_mass);
    return dem::voigt_pair({stiffness, dem::voigt_shear_stiffness(stiffness, 0.2), c_n, 0.5 * c_n, a.friction});
  }
};

using Rows = testing::Types<HertzRow, StressFrictionRow, HystereticRow<0>, HystereticRow<1>, HystereticRow<2>,
                            ViscoelasticRow, LinearRow, DampedLinearRow, VoigtRow>;

}  // namespace dem_test::law_rows
