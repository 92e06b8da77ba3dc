// Steps of a window, and how long it may be: closed forms of the smallest cases.
#include <gtest/gtest.h>

#include <cmath>

#include "coupling/coupled_step.hpp"

namespace {

using namespace coupling;

TEST(Window, StepsThatAreSetAndStepsThatAreChosen) {
  const auto expect = [](const Window& found, int n_dem, int n_fem, double length) {
    EXPECT_EQ(found.n_dem, n_dem);
    EXPECT_EQ(found.n_fem, n_fem);
    EXPECT_NEAR(found.length(), length, 1e-12 * length);
    EXPECT_NEAR(found.n_dem * found.dt_dem, length, 1e-12 * length);
  };
  expect(choose_window(1.0, 4.5), 4, 1, 4);
  expect(choose_window(4.5, 1.0), 1, 4, 4);
  expect(choose_window(1.0, 4.5, {.n_dem = 2}), 2, 1, 2);
  expect(choose_window(1.0, 4.5, {.n_dem = 10}), 10, 3, 10);
  expect(choose_window(1.0, 4.5, {.n_fem = 2}), 9, 2, 9);
  expect(choose_window(1.0, 4.5, {.n_dem = 10, .n_fem = 1}), 10, 1, 4.5);
  expect(choose_window(1.0, 0.01, {.n_dem = 1, .n_fem = 100}), 1, 100, 1);
  expect(choose_window(1.0, 0.3, {.n_dem = 1}), 1, 4, 1);
}

Window window(int n_dem, int n_fem, double length) { return {n_dem, n_fem, length / n_dem, length / n_fem}; }

// Grain and node free: omega^2 = lambda_grain + lambda_node, and velocity Verlet is stable up to 2 / omega.
TEST(CoupledStep, OneStepOfTheWholeIsStableToTwoOverOmega) {
  const SkinContacts contacts{.grain = 3, .node = 6};
  const double limit = 2 / std::sqrt(9.0);
  EXPECT_DOUBLE_EQ(longest_window(window(1, 1, 0.1), {}, contacts), limit);
  EXPECT_NEAR(growth(window(1, 1, 0.99 * limit), {}, contacts), 1, 1e-3);
  // z + 1/z = 2 - (1.1 x 2)^2
  EXPECT_NEAR(growth(window(1, 1, 1.1 * limit), {}, contacts), 1.42 + std::sqrt(1.42 * 1.42 - 1), 1e-3);
  // omega^4 - 16 omega^2 + 3 x 7 = 0: omega^2 = 8 + sqrt(43)
  const SkinContacts on_body{.grain = 3, .node = 6, .body = 7};
  const double with_body = 2 / std::sqrt(8 + std::sqrt(43.0));
  EXPECT_DOUBLE_EQ(longest_window(window(1, 1, 0.1), {}, on_body), with_body);
  EXPECT_NEAR(growth(window(1, 1, 0.99 * with_body), {}, on_body), 1, 1e-3);
  EXPECT_GT(growth(window(1, 1, 1.01 * with_body), {}, on_body), 1.2);
  EXPECT_TRUE(std::isinf(longest_window(window(1, 1, 0.1), {}, {.grain = 3, .body = 7})));
}

// A node against a grain that stays: |z|^2 = 1 + (1 - c) q, c = (n + 1) / (2 n).
TEST(CoupledStep, HeldForcesGrowAsTheTwoByTwoMatrixHasIt) {
  for (const int n : {2, 10, 100}) {
    const double c = (n + 1) / (2.0 * n), q = 0.5;
    EXPECT_NEAR(growth(window(n, 1, 1), {}, {.grain = 1e-12, .node = q}), std::sqrt(1 + (1 - c) * q), 1e-3) << n;
  }
}

// Short windows: a lag tau is a dashpot - k tau on the node's side, which has the share lambda_node / omega^2 = 0.6 of
// the motion: zeta = - 0.6 tau omega / 2; a dashpot 0.6 k tau of the contact takes it away.
TEST(CoupledStep, LagIsANegativeDashpot) {
  struct Case {
    int n_dem, n_fem;
    Scheme scheme;
    double lag;  // of the window
  };
  for (const auto& [n_dem, n_fem, scheme, lag] :
       {Case{10, 1, Scheme::sequential, 0.45}, Case{1, 10, Scheme::sequential, -0.45},
        Case{1, 1, Scheme::concurrent, 1}, Case{10, 1, Scheme::concurrent, 1.45},
        Case{1, 10, Scheme::concurrent, 0.55}})
    for (const auto motion : {SkinMotion::linear, SkinMotion::quadratic}) {
      const CouplingSettings settings{.scheme = scheme, .skin_motion = motion};
      const double W = 0.05, expected = -0.6 * 0.5 * lag * W;  // omega = 1
      SkinContacts contacts{.grain = 0.4, .node = 0.6};
      EXPECT_NEAR(damping_ratio(window(n_dem, n_fem, W), settings, contacts), expected, 0.06 * std::abs(expected))
          << n_dem << " : " << n_fem;
      if (lag < 0) continue;
      contacts.dashpot = 0.6 * lag * W;
      EXPECT_NEAR(damping_ratio(window(n_dem, n_fem, W), settings, contacts), 0, 0.06 * std::abs(expected))
          << n_dem << " : " << n_fem;
    }
}

TEST(CoupledStep, LateForcesShortenTheWindow) {
  const SkinContacts contacts{.grain = 0.4, .node = 0.6};
  const double concurrent = longest_window(window(10, 1, 0.1), {.scheme = Scheme::concurrent}, contacts);
  const double sequential = longest_window(window(10, 1, 0.1), {}, contacts);
  EXPECT_LT(concurrent, sequential);
  EXPECT_LT(sequential, 2 / std::sqrt(0.6));
  // The grain stays: zeta = - tau sqrt(lambda_node) / 2 = - 0.1 in the limit of short windows.
  EXPECT_NEAR(concurrent, 0.2 / (std::sqrt(0.6) * 1.45), 0.04);
  SkinContacts damped = contacts;
  damped.dashpot = 0.4;
  EXPECT_GT(longest_window(window(10, 1, 0.1), {.scheme = Scheme::concurrent}, damped), concurrent);
}

}  // namespace
