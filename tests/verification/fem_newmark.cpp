// Newmark's method against the discrete equations of one degree of freedom, and against the explicit solver.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include "tests/fem_helper.hpp"

namespace {

using fem::Quantity;

testing::Environment* const petsc = testing::AddGlobalTestEnvironment(new fem_test::PetscEnvironment);

fem::Setup newmark(const fem::Body& body, double beta = 0.25, double gamma = 0.5) {
  fem::Setup setup{{body}, {}};
  setup.solver.kind = fem::Solver::newmark;
  setup.solver.beta = beta;
  setup.solver.gamma = gamma;
  return setup;
}

/// One cell on rollers, clamped at x_min: its only free motion is the end's, omega = c sqrt(2) / h with half the mass.
fem::Body oscillator() {
  auto body = fem_test::box("hex8", {0.1, 0.1, 0.1, 1, 1, 1});
  body.supports = {{"x_min", {true, true, true}, ""}};
  for (const char* side : {"y_min", "y_max", "z_min", "z_max"})
    body.supports.push_back({side, {false, true, true}, ""});
  body.loads = {
      {"pull", "x_max", fem::LoadKind::face_total, {1, 0, 0}, fem_test::history([](double) { return 1e5; }), ""}};
  return body;
}
double oscillator_omega() { return fem_test::compression_wave_speed() * std::sqrt(2.0) / 0.1; }

/// The oscillator's displacement over its static one, by Newmark's formulas for one unknown.
std::vector<double> one_unknown(double beta, double gamma, double phase, double alpha_dt, double stiff_over_dt, int n) {
  std::vector<double> path;  // time in steps, so omega = phase
  double u = 0, v = 0, a = phase * phase;
  const double k = phase * phase, c = alpha_dt + stiff_over_dt * k;
  for (int i = 0; i < n; ++i) {
    const double ug = u + v + (0.5 - beta) * a, vg = v + (1 - gamma) * a;
    a = (k - c * vg - k * ug) / (1 + gamma * c + beta * k);
    u = ug + beta * a;
    v = vg + gamma * a;
    path.push_back(u);
  }
  return path;
}

struct Scheme {
  double beta, gamma, phase, mass_damping, stiffness_damping;  // phase: omega dt; damping as ratios at omega
};

class OneUnknown : public testing::TestWithParam<Scheme> {};

TEST_P(OneUnknown, StepsAsTheFormulasSay) {
  const auto [beta, gamma, phase, mass_damping, stiffness_damping] = GetParam();
  const double omega = oscillator_omega(), dt = phase / omega;
  auto body = oscillator();
  body.damping = 2 * mass_damping * omega;
  body.stiffness_damping = 2 * stiffness_damping / omega;
  const auto model = fem::Model::create(MPI_COMM_SELF, newmark(body, beta, gamma));
  const double static_way = 1e5 / (0.5 * 2350 * 0.001 * omega * omega);
  for (const double expected : one_unknown(beta, gamma, phase, body.damping * dt, body.stiffness_damping / dt, 40)) {
    fem_test::step(*model, dt);
    ASSERT_NEAR(model->probe_group("box", "x_max", Quantity::displacement).x / static_way, expected, 1e-9);
  }
}

INSTANTIATE_TEST_SUITE_P(Fem, OneUnknown,
                         testing::Values(Scheme{0.25, 0.5, 0.3, 0, 0}, Scheme{0.25, 0.5, 50, 0, 0},
                                         Scheme{1.0 / 6.0, 0.5, 3.4, 0, 0}, Scheme{0.3025, 0.6, 0.5, 0, 0},
                                         Scheme{0.25, 0.5, 0.3, 0.05, 0}, Scheme{0.25, 0.5, 0.3, 0, 0.1}));

fem::Body beam() {
  auto body = fem_test::box("hex8", {1, 0.2, 0.2, 10, 2, 2});
  body.supports = {{"x_min", {true, true, true}, ""}};
  body.loads = {{"tip",
                 "x_max",
                 fem::LoadKind::face_total,
                 {0, 0, -1},
                 fem_test::history([](double t) { return 1e3 * (1 - std::cos(1e3 * t)); }),
                 ""}};
  return body;
}

// Both schemes are of second order, so both differences from the explicit answer at a tiny step shrink with the square.
TEST(Newmark, AgreesWithExplicitToSecondOrder) {
  const auto tip_at_end = [](const fem::Setup& setup, int steps) {
    const auto model = fem::Model::create(MPI_COMM_SELF, setup);
    for (int i = 0; i < steps; ++i) fem_test::step(*model, 4e-3 / steps);
    return model->probe_group("box", "x_max", Quantity::displacement).z;
  };
  const double exact = tip_at_end({{beam()}, {}}, 4000);
  const double coarse = tip_at_end(newmark(beam()), 40) - exact, fine = tip_at_end(newmark(beam()), 80) - exact;
  EXPECT_LT(std::abs(coarse), 0.02 * std::abs(exact));
  EXPECT_NEAR(coarse / fine, 4, 0.4);
}

// Average acceleration keeps the energy of a linear body at any step, and its ledger closes exactly.
TEST(Newmark, AverageAccelerationClosesTheLedger) {
  auto body = beam();
  body.damping = 50;
  body.stiffness_damping = 1e-6;
  const auto model = fem::Model::create(MPI_COMM_SELF, newmark(body));
  double largest = 0;
  for (int i = 0; i < 100; ++i) {
    fem_test::step(*model, 2e-4);
    const auto energy = model->energy();
    largest = std::max(largest, std::abs(energy.stored() - energy.works() + energy.losses()));
  }
  EXPECT_LT(largest, 1e-9 * model->energy().work_loads);
  EXPECT_GT(model->energy().loss_damping, 0.005 * model->energy().work_loads);
  EXPECT_GT(model->energy().loss_viscous, 0.005 * model->energy().work_loads);
}

// A wall of dashpots at the end, c = rho c_p per area: damping of the half mass of the cell, alpha = 2 c_p / h.
TEST(Newmark, AbsorbingBoundary) {
  const double omega = oscillator_omega(), dt = 0.3 / omega;
  auto body = oscillator();
  body.absorbing = {{"x_max", ""}};
  const auto model = fem::Model::create(MPI_COMM_SELF, newmark(body));
  const double static_way = 1e5 / (0.5 * 2350 * 0.001 * omega * omega);
  const double alpha = 2 * fem_test::compression_wave_speed() / 0.1;
  for (const double expected : one_unknown(0.25, 0.5, 0.3, alpha * dt, 0, 40)) {
    fem_test::step(*model, dt);
    ASSERT_NEAR(model->probe_group("box", "x_max", Quantity::displacement).x / static_way, expected, 1e-9);
  }
  const auto energy = model->energy();
  EXPECT_NEAR(energy.stored() + energy.losses(), energy.works(), 1e-9 * energy.work_loads);
}

// The end is driven by h(t) = A (1 - cos(w t)) and pulls the other one: m u'' = k (h - u), from rest u = A (1 -
// cos(omega t)) - A / (1 - r^2) (cos(w t) - cos(omega t)), r = w / omega. Both errors, of the path and of the ledger,
// are of second order.
TEST(Newmark, DrivenEnd) {
  const double omega = oscillator_omega(), w = 0.4 * omega, way = 1e-3;
  const auto errors = [&](int steps) {
    auto body = oscillator();
    body.loads.clear();
    body.supports.erase(body.supports.begin());
    body.motions = {{"shaker",
                     "x_min",
                     fem::PrescribedMotion::Kind::displacement,
                     {true, false, false},
                     fem_test::history([=](double t) { return way * (1 - std::cos(w * t)); }),
                     ""}};
    const auto model = fem::Model::create(MPI_COMM_SELF, newmark(body));
    const double end = 20 / omega;
    for (int i = 0; i < steps; ++i) fem_test::step(*model, end / steps);
    const double ratio = w / omega;
    const double exact =
        way * (1 - std::cos(omega * end) - (std::cos(w * end) - std::cos(omega * end)) / (1 - ratio * ratio));
    const auto energy = model->energy();
    return std::array{model->probe_group("box", "x_max", Quantity::displacement).x - exact,
                      energy.stored() - energy.works()};
  };
  const auto coarse = errors(200), fine = errors(400);
  EXPECT_LT(std::abs(fine[0]), 5e-3 * way);
  EXPECT_NEAR(coarse[0] / fine[0], 4, 0.3);
  EXPECT_LT(std::abs(fine[1]), 0.3 * std::abs(coarse[1]));
}

// A block between rollers is pulled until all of it is at the apex, sigma = c / tan phi from all sides, where the law
// has no stiffness left: nodes that are held or led are no part of the equations, and the steps go on.
TEST(Newmark, PullsToTheApex) {
  auto body = fem_test::box("hex8", {1, 1, 1, 1, 1, 2});
  body.materials = {{"", "drucker_prager", 60e6, 0.3, 1800, ""}};
  body.materials[0].cohesion = 10e3;
  body.materials[0].friction_angle = body.materials[0].dilation_angle = std::numbers::pi / 6;
  body.supports = {{"solid", {true, true, false}, ""}, {"z_min", {false, false, true}, ""}};
  fem::PrescribedMotion pull;
  pull.name = "pull";
  pull.group = "z_max";
  pull.along = {false, false, true};
  pull.history = fem_test::history([](double t) { return 0.01 * t; });
  body.motions = {pull};
  const auto model = fem::Model::create(MPI_COMM_SELF, newmark(body));
  for (int i = 0; i < 400; ++i) fem_test::step(*model, 1e-3);
  const double apex = 10e3 * std::sqrt(3.0);
  EXPECT_NEAR(-model->reaction("box", "z_min").z, apex, 1e-3 * apex);
  EXPECT_NEAR(model->stress_at("box", {std::nullopt, "z_max"})[0], apex, 1e-3 * apex);
}

// Plastic steps: the implicit scheme goes where the explicit one goes at a tiny step.
TEST(Newmark, YieldsAsTheExplicitSolver) {
  auto body = beam();
  body.materials[0].law = "drucker_prager";
  body.materials[0].cohesion = 8e5;  // yields at 0.96 MPa in tension; the edge sees 1.5 MPa
  body.materials[0].friction_angle = 0.5;
  const auto end_of = [](const fem::Setup& setup, int steps) {
    const auto model = fem::Model::create(MPI_COMM_SELF, setup);
    for (int i = 0; i < steps; ++i) fem_test::step(*model, 4e-3 / steps);
    return std::pair(model->probe_group("box", "x_max", Quantity::displacement).z, model->energy());
  };
  const auto [exact, explicit_energy] = end_of({{body}, {}}, 4000);
  const auto [implicit, energy] = end_of(newmark(body), 160);
  EXPECT_GT(explicit_energy.loss_plastic, 0.05 * explicit_energy.work_loads);
  EXPECT_NEAR(implicit, exact, 0.01 * std::abs(exact));
  EXPECT_NEAR(energy.loss_plastic, explicit_energy.loss_plastic, 0.02 * explicit_energy.loss_plastic);
  EXPECT_NEAR(energy.stored() + energy.losses(), energy.works(), 0.01 * energy.work_loads);
}

// gamma > 1/2 takes energy out of what the step cannot follow, and never puts any in.
TEST(Newmark, LargeGammaDampsWithoutDamping) {
  const auto energy_after = [](double beta, double gamma) {
    const auto model = fem::Model::create(MPI_COMM_SELF, newmark(oscillator(), beta, gamma));
    const double dt = 1 / oscillator_omega();
    for (int i = 0; i < 50; ++i) fem_test::step(*model, dt);
    const auto energy = model->energy();
    return energy.stored() - energy.works();
  };
  EXPECT_NEAR(energy_after(0.25, 0.5), 0, 1e-9);
  EXPECT_LT(energy_after(0.3025, 0.6), -1e-3);
}

// Linear acceleration is stable up to omega dt = 2 sqrt(3): the limit says so, and beyond it grows without bounds.
TEST(Newmark, ConditionalSchemesSayTheirLimit) {
  const auto model = fem::Model::create(MPI_COMM_SELF, newmark(oscillator(), 1.0 / 6.0, 0.5));
  const double limit = 2 * std::sqrt(3.0) / oscillator_omega();
  EXPECT_LE(model->stable_step().limit, limit * (1 + 1e-12));
  EXPECT_GE(model->stable_step().limit, 0.95 * limit);
  EXPECT_TRUE(std::isinf(fem::Model::create(MPI_COMM_SELF, newmark(oscillator()))->stable_step().limit));
  for (int i = 0; i < 200; ++i) fem_test::step(*model, 1.05 * limit);
  EXPECT_GT(std::abs(model->probe_group("box", "x_max", Quantity::displacement).x), 1);
}

}  // namespace
