// Laws of solids at one point: their equations, rotations, the plastic return, and what bad parameters answer.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "base/error.hpp"
#include "fem/families.hpp"

namespace {

using fem::Deformation;
using fem::MaterialRegion;

MaterialRegion region(const std::string& law, double young, double poisson) {
  return {"", law, young, poisson, 2000, ""};
}

template <class Law>
std::array<double, 6> stress_of(const Law& law, const Deformation<double>& d, double* history = nullptr) {
  std::array<double, 6> stress;
  fem::Loss<double> loss;
  law.stress(d, history, stress.data(), loss);
  return stress;
}

// Nishiura2017 eq. 7-8 with numbers: E 1 MPa, nu 0.25 (lambda = mu = 0.4 MPa), mu_D 10 Pa s, bulk viscosity 20 Pa s
// (lambda_D 40/3). A code that takes the bulk viscosity for lambda_D, or the tensor's shear for the engineering one,
// differs.
TEST(FemLaws, KelvinVoigtIsSpringAndDashpot) {
  auto m = region("kelvin_voigt", 1e6, 0.25);
  m.shear_viscosity = 10;
  m.bulk_viscosity = 20;
  const fem::KelvinVoigt law(m);
  const Deformation<double> d{{{1e-3, 4e-3, 0}, {0, 2e-3, 0}, {0, 0, 0}}, {{3, 0, 0}, {0, 0, 5}, {0, 1, -6}}};
  const auto s = stress_of(law, d);
  const double spring = 0.4e6 * 3e-3, dashpot = 40.0 / 3.0 * -3;
  EXPECT_NEAR(s[0], spring + 0.8e6 * 1e-3 + dashpot + 20 * 3, 1e-9);
  EXPECT_NEAR(s[1], spring + 0.8e6 * 2e-3 + dashpot, 1e-9);
  EXPECT_NEAR(s[2], spring + dashpot + 20 * -6, 1e-9);
  EXPECT_NEAR(s[3], 0.4e6 * 4e-3, 1e-9);
  EXPECT_NEAR(s[4], 10 * (5 + 1), 1e-9);
  EXPECT_NEAR(s[5], 0, 1e-9);
  fem::Loss<double> loss;
  double stress[6];
  law.stress(d, static_cast<double*>(nullptr), stress, loss);
  // lambda_D (tr D)^2 + 2 mu_D D : D
  EXPECT_NEAR(loss.viscous, 40.0 / 3.0 * 9 + 20 * (9 + 36 + 2 * 9), 1e-9);
}

/// Rotation about z by an angle, minus the identity.
Deformation<double> turned(double angle) {
  return {{{std::cos(angle) - 1, -std::sin(angle), 0}, {std::sin(angle), std::cos(angle) - 1, 0}, {0, 0, 0}}, {}};
}

// Eq. 2-4: F F^T of a rotation is I, so it gives no stress; spinning at 100 /s gives no drag. A stretch before the
// rotation gives the stretch's stress, turned. The small-strain form gives 2 (cos - 1) mu and more.
TEST(FemLaws, LeftCauchyGreenForgetsRotations) {
  auto m = region("left_cauchy_green", 1e6, 0.25);
  m.shear_viscosity = m.bulk_viscosity = 10;
  const fem::LeftCauchyGreen law(m);
  auto d = turned(1.2);
  const double c = std::cos(1.2), s = std::sin(1.2), spin = 100;
  const double rate[3][3] = {{-s * spin, -c * spin, 0}, {c * spin, -s * spin, 0}, {0, 0, 0}};
  std::memcpy(d.rate, rate, sizeof rate);
  for (const double value : stress_of(law, d)) EXPECT_NEAR(value, 0, 1e-9);
  // F = R diag(1 + e, 1, 1): eps = R diag(e + e^2 / 2, 0, 0) R^T
  const double e = 1e-3, strain = e + e * e / 2;
  d = turned(1.2);
  d.gradient[0][0] += c * e;
  d.gradient[1][0] += s * e;
  const auto stress = stress_of(law, d);
  EXPECT_NEAR(stress[0], 0.4e6 * strain * (1 + 2 * c * c), 1e-9 * 1e3);
  EXPECT_NEAR(stress[1], 0.4e6 * strain * (1 + 2 * s * s), 1e-9 * 1e3);
  EXPECT_NEAR(stress[2], 0.4e6 * strain, 1e-9 * 1e3);
  EXPECT_NEAR(stress[3], 0.8e6 * strain * s * c, 1e-9 * 1e3);
  EXPECT_GT(std::abs(stress_of(fem::LinearElastic(m), turned(1.2))[0]), 1e5);
}

MaterialRegion soil(double cohesion, double friction_degrees, double dilation_degrees) {
  auto m = region("drucker_prager", 60e6, 0.3);
  m.cohesion = cohesion;
  m.friction_angle = friction_degrees * std::numbers::pi / 180;
  m.dilation_angle = dilation_degrees * std::numbers::pi / 180;
  return m;
}

/// One point of soil led along given axial and lateral strains.
struct Point {
  explicit Point(const MaterialRegion& m) : law(m) {}
  fem::DruckerPrager<false> law;
  double history[7] = {};

  std::array<double, 6> at(double axial, double lateral) {
    return stress_of(law, {{{lateral, 0, 0}, {0, lateral, 0}, {0, 0, axial}}, {}}, history);
  }
  /// The lateral strain at which the lateral stress is the given one, by halving; the point then stays there.
  double lateral_at(double axial, double stress, double low, double high) {
    double before[7];
    std::memcpy(before, history, sizeof history);
    for (int i = 0; i < 200; ++i) {
      const double middle = 0.5 * (low + high);
      std::memcpy(history, before, sizeof history);
      (at(axial, middle)[0] < stress ? low : high) = middle;
    }
    return low;
  }
};

// alpha and k of the outer cone for c = 20 kPa, phi = 30 and 15 degrees, and of the others by their formulas.
TEST(FemLaws, DruckerPragerConstants) {
  const auto outer = fem::drucker_prager_constants(soil(20e3, 30, 30));
  EXPECT_NEAR(outer.alpha, 0.23094011, 1e-8);
  EXPECT_NEAR(outer.beta, 0.23094011, 1e-8);
  EXPECT_NEAR(outer.k, 24000, 1e-6);
  const auto shallow = fem::drucker_prager_constants(soil(20e3, 15, 0));
  EXPECT_NEAR(shallow.alpha, 0.10902545, 1e-8);
  EXPECT_NEAR(shallow.k, 24413.3114, 1e-4);
  EXPECT_EQ(shallow.beta, 0);
  auto m = soil(20e3, 30, 30);
  m.fit = "inner";
  EXPECT_NEAR(fem::drucker_prager_constants(m).alpha, 2 * 0.5 / (std::sqrt(3.0) * 3.5), 1e-12);
  EXPECT_NEAR(fem::drucker_prager_constants(m).k, 6 * 20e3 * std::cos(m.friction_angle) / (std::sqrt(3.0) * 3.5), 1e-8);
  m.fit = "plane_strain";
  const double tangent = std::tan(m.friction_angle), root = std::sqrt(9 + 12 * tangent * tangent);
  EXPECT_NEAR(fem::drucker_prager_constants(m).alpha, tangent / root, 1e-12);
  EXPECT_NEAR(fem::drucker_prager_constants(m).k, 3 * 20e3 / root, 1e-8);
}

// Triaxial compression at p = 100 kPa, E 60 MPa, nu 0.3, c 20 kPa, phi = psi = 30 degrees; strains count from the
// isotropic state. Closed form: sigma_a = -p - q, q = sqrt3 (k + 3 alpha p) / (1 - sqrt3 alpha) = 269.282 kPa, then
// flow along the cone. eps_lat after 0.002, 0.005, 0.010: 6.0e-4, 2.11435935e-3, 9.61435935e-3.
TEST(FemLaws, DruckerPragerTriaxial) {
  const double p = 100e3, start = -p * (1 - 0.6) / 60e6;
  struct Row {
    double axial, stress, lateral;
  };
  for (const Row& row :
       {Row{0.002, -220e3, 6.0e-4}, Row{0.005, -369282.032, 2.11435935e-3}, Row{0.010, -369282.032, 9.61435935e-3}}) {
    Point point(soil(20e3, 30, 30));
    point.at(start, start);
    const double lateral = point.lateral_at(start - row.axial, -p, start - 0.05, start + 0.05);
    EXPECT_NEAR(lateral - start, row.lateral, 1e-6 * row.lateral);
    EXPECT_NEAR(point.at(start - row.axial, lateral)[2], row.stress, 1e-6 * std::abs(row.stress));
  }
}

// q at failure in compression and extension for p = 0, 100, 200 kPa.
TEST(FemLaws, DruckerPragerStrength) {
  const double compression[] = {69282.032, 269282.032, 469282.032}, extension[] = {29692.300, 115406.585, 201120.871};
  for (int i = 0; i < 3; ++i) {
    const double p = 100e3 * i, start = -p * (1 - 0.6) / 60e6;
    for (const bool compressed : {true, false}) {
      Point point(soil(20e3, 30, 30));
      const double axial = start + (compressed ? -0.02 : 0.02);
      const double lateral = point.lateral_at(axial, -p, start - 0.2, start + 0.2);
      const double q = std::abs(point.at(axial, lateral)[2] + p), expected = (compressed ? compression : extension)[i];
      EXPECT_NEAR(q, expected, 1e-6 * expected) << p << compressed;
    }
  }
}

// Oedometer, phi = psi = 15 degrees: first yield at 2.37180919e-3, and the stresses at 1e-2 reached in any number of
// steps. With phi = 30 degrees 2 G / sqrt3 < 3 alpha K: it never yields.
TEST(FemLaws, DruckerPragerOedometer) {
  Point point(soil(20e3, 15, 15));
  auto s = point.at(-2.37180919e-3 * (1 - 1e-9), 0);
  EXPECT_NEAR(s[2], -191569.204, 0.2);
  EXPECT_NEAR(s[0], -82101.087, 0.1);
  EXPECT_EQ(point.history[6], 0);
  point.at(-2.37180919e-3 * (1 + 1e-6), 0);
  EXPECT_GT(point.history[6], 0);
  for (int steps : {1, 7}) {
    Point other(soil(20e3, 15, 15));
    for (int i = 1; i <= steps; ++i) s = other.at(-1e-2 * i / steps, 0);
    EXPECT_NEAR(s[2], -779260.684, 1e-6 * 779260.684) << steps;
    EXPECT_NEAR(s[0], -428128.369, 1e-6 * 428128.369) << steps;
  }
  Point steep(soil(20e3, 30, 30));
  steep.at(-0.5, 0);
  EXPECT_EQ(steep.history[6], 0);
}

// Pulled in all directions, and sheared a little: the cone's return would turn the deviator inside out, so the stress
// is the apex I1 = k / alpha, s = 0, for any dilation. The state is then on the surface: the same strain changes
// nothing.
TEST(FemLaws, DruckerPragerApex) {
  for (const double dilation : {0.0, 10.0, 30.0}) {
    fem::DruckerPrager<false> law(soil(20e3, 30, dilation));
    double history[7] = {};
    const Deformation<double> d{{{2e-3, 1e-4, 0}, {0, 2.1e-3, 0}, {0, 0, 2e-3}}, {}};
    const double apex = 24000 / 0.230940107675850 / 3;
    for (int i = 0; i < 2; ++i) {
      const auto s = stress_of(law, d, history);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(s[c], apex, 1e-6 * apex);
      for (int c = 3; c < 6; ++c) EXPECT_NEAR(s[c], 0, 1e-6 * apex);
    }
  }
}

// Flow with psi < phi: gamma = f / (G + 9 K alpha beta); in pure shear at J2 beyond the cone the mean stress then falls
// by 3 K beta gamma per step, and the stress lies on the cone.
TEST(FemLaws, DruckerPragerDilation) {
  const auto m = soil(20e3, 30, 10);
  const fem::DruckerPrager<false> law(m);
  const auto constants = fem::drucker_prager_constants(m);
  const double g = 60e6 / 2.6, bulk = 60e6 / 1.2, shear = 3e-3;
  double history[7] = {};
  const auto s = stress_of(law, {{{0, shear, 0}, {0, 0, 0}, {0, 0, 0}}, {}}, history);
  const double gamma = (g * shear - constants.k) / (g + 9 * bulk * constants.alpha * constants.beta);
  EXPECT_NEAR(s[3], g * shear - g * gamma, 1e-9 * g * shear);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(s[c], -3 * bulk * constants.beta * gamma, 1e-9 * g * shear);
  EXPECT_NEAR(std::abs(s[3]) + constants.alpha * (s[0] + s[1] + s[2]), constants.k, 1e-9 * constants.k);
  EXPECT_NEAR(history[3], gamma, 1e-9 * gamma);                   // gamma s / (2 sqrt J2), as engineering shear
  EXPECT_NEAR(history[0], constants.beta * gamma, 1e-9 * gamma);  // beta gamma I
}

// Angles given in the other direction, densities and strengths that no material has.
TEST(FemLaws, MessagesOfParameters) {
  const auto message = [](const MaterialRegion& m) -> std::string {
    try {
      fem::check_material(m, "scene.toml:7: ");
    } catch (const base::UserError& error) {
      return error.what();
    }
    return "no error";
  };
  EXPECT_EQ(message(soil(20e3, 30, 10)), "no error");
  EXPECT_EQ(message(soil(-1, 30, 10)), "scene.toml:7: cohesion = -1; must be >= 0 Pa");
  EXPECT_NE(message(soil(20e3, 95, 10)).find("friction_angle = 1.65806"), std::string::npos);
  EXPECT_NE(message(soil(20e3, 10, 30)).find("must be in [0, friction_angle = "), std::string::npos);
  EXPECT_NE(message(soil(0, 0, 0)).find("cohesion and friction_angle are both 0"), std::string::npos);
  auto m = soil(20e3, 30, 10);
  m.fit = "middle";
  EXPECT_EQ(message(m), "scene.toml:7: fit = \"middle\"; must be one of: outer, inner, plane_strain");
  m = region("kelvin_voigt", 1e6, 0.2);
  m.shear_viscosity = -3;
  EXPECT_EQ(message(m), "scene.toml:7: shear_viscosity = -3; must be >= 0 Pa s");
  m = region("left_cauchy_green", 1e6, 0.2);
  m.bulk_viscosity = -3;
  EXPECT_EQ(message(m), "scene.toml:7: bulk_viscosity = -3; must be >= 0 Pa s");
  EXPECT_EQ(message(region("rubber", 1e6, 0.2)),
            "scene.toml:7: law = \"rubber\"; must be one of: linear_elastic, kelvin_voigt, left_cauchy_green, "
            "drucker_prager");
}

}  // namespace
