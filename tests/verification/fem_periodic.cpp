// Faces that are one, against rings of equal masses and springs, simple shear and free fall. A face that stays free, is
// held, or has its nodes' masses or forces counted once or thrice, shows in every one of these.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

#include "base/error.hpp"
#include "tests/fem_helper.hpp"

namespace {

using base::Vec3;
using fem::Quantity;

testing::Environment* const petsc = testing::AddGlobalTestEnvironment(new fem_test::PetscEnvironment);

fem::Body ring(const std::string& element, const fem_test::BoxSize& size) {
  auto body = fem_test::box(element, size);
  body.periodic = {{"x_min", "x_max", "scene.toml:9"}};
  return body;
}

/// A column of 100 cells of 0.1 m between rollers, with a cross-section "struck" at 3 m.
fem::Body struck_ring(const std::function<double(double)>& force) {
  auto body = ring("hex8", {});
  body.mesh_parameters.clear();
  const auto file = std::filesystem::temp_directory_path() / ("trackbed_ring_" + std::to_string(getpid()) + ".geo");
  std::ofstream(file) << "Point(1) = {0, 0, 0}; Point(2) = {0, 0.1, 0}; Point(3) = {0, 0.1, 0.1}; Point(4) = {0, 0, "
                         "0.1}; Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};\n"
                         "Curve Loop(1) = {1, 2, 3, 4}; Plane Surface(1) = {1}; Transfinite Curve{1, 2, 3, 4} = 2; "
                         "Transfinite Surface{1}; Recombine Surface{1};\n"
                         "a[] = Extrude {3, 0, 0} { Surface{1}; Layers{30}; Recombine; };\n"
                         "b[] = Extrude {7, 0, 0} { Surface{a[0]}; Layers{70}; Recombine; };\n"
                         "Physical Volume(\"solid\") = {a[1], b[1]}; Physical Surface(\"x_min\") = {1};\n"
                         "Physical Surface(\"struck\") = {a[0]}; Physical Surface(\"x_max\") = {b[0]};\n";
  body.mesh_file = file.string();
  body.supports = {{"solid", {false, true, true}, ""}};
  body.loads = {{"strike", "struck", fem::LoadKind::face_total, {1, 0, 0}, fem_test::history(force), ""}};
  return body;
}

// A force F(t) on a cross-section of a ring sends F / (2 rho c A) both ways. At x = 1 m the wave to the left passes
// after 2 m; the one to the right leaves at x = 10 m, comes in at 0 and passes after 8 m. A seam that reflects would
// bring the first one back after 4 m.
TEST(FemPeriodic, WavePassesTheSeam) {
  const double c = fem_test::compression_wave_speed(), duration = 2 / c, impedance = 2350 * c * 0.01;
  const auto model = fem::Model::create(MPI_COMM_SELF, {{struck_ring([=](double t) {
                                                          const double s = std::sin(std::numbers::pi * t / duration);
                                                          return t < duration ? 100 * s * s : 0.0;
                                                        })},
                                                        {}});
  const double dt = 0.9 * model->stable_step().limit, whole = 50 / impedance;
  double first = 0, first_at = 0, between = 0, second = 0, second_at = 0;
  while (model->time() < 11 / c) {
    fem_test::step(*model, dt);
    const double v = model->probe_point("box", {1, 0, 0}, Quantity::velocity).x, way = c * model->time();
    if (way < 4.2 && v > first) first = v, first_at = way;
    if (way > 4.4 && way < 7.9) between = std::max(between, std::abs(v));
    if (way > 8 && v > second) second = v, second_at = way;
    EXPECT_NEAR(model->probe_group("box", "x_min", Quantity::velocity).x,
                model->probe_group("box", "x_max", Quantity::velocity).x, 0);
  }
  EXPECT_NEAR(first, whole, 0.01 * whole);
  EXPECT_NEAR(first_at, 3, 0.05);  // the pulse's crest follows its front by 1 m
  EXPECT_LT(between, 0.01 * whole);
  EXPECT_NEAR(second, whole, 0.02 * whole);
  EXPECT_NEAR(second_at, 9, 0.05);
}

// Momentum of a free ring that is struck while it falls along x: M g x_c is the work of its weight, and the middle
// moves under F and M g alone, step for step.
TEST(FemPeriodic, MomentumIsKept) {
  const auto force = [](double t) { return 1e3 * std::sin(3e3 * t); };
  fem::Setup setup{{struck_ring(force)}, {2, 0, 0}};
  setup.bodies[0].gravity = true;
  const auto model = fem::Model::create(MPI_COMM_SELF, setup);
  const double mass = model->counts()[0].mass, dt = 0.9 * model->stable_step().limit;
  EXPECT_NEAR(mass, 2350 * 0.1, 1e-10 * mass);
  double x = 0, v = 0;
  for (int i = 0; i < 500; ++i) {
    v += 0.5 * dt * (2 + force(i * dt) / mass);
    x += dt * v;
    v += 0.5 * dt * (2 + force((i + 1) * dt) / mass);
    fem_test::step(*model, dt);
  }
  EXPECT_NEAR(model->energy().work_gravity, mass * 2 * x, 1e-10 * mass * 2 * x);
}

// A ring of n equal masses and springs: omega_k = 2 c / h sin(k pi / n), each twice but for k = n / 2. The step of a
// wide one, which has nothing faster, is 2 / omega_max.
TEST(FemPeriodic, ModesAndStepOfARing) {
  const double c = fem_test::compression_wave_speed();
  for (const int cells : {3, 10}) {
    auto body = ring("hex8", {1, 10, 10, cells, 1, 1});
    body.supports = {{"solid", {false, true, true}, ""}};
    const double scale = 2 * c * cells, largest = scale * std::sin((cells / 2) * std::numbers::pi / cells);
    const double limit = fem::Model::create(MPI_COMM_SELF, {{body}, {}})->stable_step().limit;
    EXPECT_LE(limit, 2 / largest * (1 + 1e-12));
    EXPECT_GE(limit, 0.95 * 2 / largest);
    for (const char* side : {"width", "height"}) body.mesh_parameters[side] = 0.05;
    fem::Setup setup{{body}, {}};
    setup.solver.kind = fem::Solver::modal;
    const auto found = fem::Model::create(MPI_COMM_SELF, setup)->find_modes(2).at(0);
    EXPECT_EQ(found.rigid_motions, 1);
    ASSERT_EQ(found.modes.size(), 2u);
    const double expected = scale * std::sin(std::numbers::pi / cells) / (2 * std::numbers::pi);
    for (const auto& mode : found.modes) EXPECT_NEAR(mode.frequency, expected, 1e-7 * expected);
  }
}

// What one pair leaves free: three translations and the turn about the shift. Two pairs leave the translations.
TEST(FemPeriodic, RigidMotionsLeft) {
  fem::Setup setup{{ring("hex8", {1, 1, 1, 2, 2, 2})}, {}};
  setup.solver.kind = fem::Solver::modal;
  EXPECT_EQ(fem::Model::create(MPI_COMM_SELF, setup)->find_modes(1).at(0).rigid_motions, 4);
  setup.bodies[0].periodic.push_back({"y_min", "y_max", ""});
  EXPECT_EQ(fem::Model::create(MPI_COMM_SELF, setup)->find_modes(1).at(0).rigid_motions, 3);
}

// A layer on a fixed base, sheared at its top: u_x = tau z / mu everywhere, as in a layer without end. Ends that are
// free let go of the shear stress there.
TEST(FemPeriodic, SimpleShearHasNoEnds) {
  constexpr double mu = 45e9 / (2 * 1.167), tau = 1e6;
  for (const char* element : {"tet4", "hex8_bbar", "hex8_incompatible", "hex20"}) {
    auto body = ring(element, {1, 0.5, 0.5, 3, 2, 2});
    body.periodic.push_back({"y_min", "y_max", ""});
    body.supports = {{"z_min", {true, true, true}, ""}};
    body.loads = {
        {"shear", "z_max", fem::LoadKind::traction, {1, 0, 0}, fem_test::history([](double) { return tau; }), ""}};
    fem::Setup setup{{body}, {}};
    setup.solver.kind = fem::Solver::statics;
    const bool multigrid = body.element == "hex8_bbar";
    setup.solver.linear_solver = multigrid ? fem::LinearSolver::iterative : fem::LinearSolver::direct;
    const auto model = fem::Model::create(MPI_COMM_SELF, setup);
    fem_test::step(*model, 1);
    for (const Vec3 at : {Vec3{0, 0, 0.25}, Vec3{1, 0.25, 0}, Vec3{0.33, -0.25, 0.25}}) {
      const Vec3 u = model->probe_point("box", at, Quantity::displacement);
      EXPECT_NEAR(u.x, tau * (at.z + 0.25) / mu, 1e-9 * tau / mu) << element;
      EXPECT_NEAR(base::norm(Vec3{0, u.y, u.z}), 0, 1e-9 * tau / mu) << element;
    }
    for (const auto& stress : model->element_stresses("box")) EXPECT_NEAR(stress[5], tau, 1e-8 * tau) << element;
    EXPECT_NEAR(model->reaction("box", "z_min").x, -tau * 0.5, 1e-8 * tau) << element;
  }
}

// Two pairs: edges and corners have one unknown. Falling, the block moves as one and feels nothing.
TEST(FemPeriodic, FallsWithoutForce) {
  for (const char* element : {"tet10", "hex8"}) {
    auto body = ring(element, {1, 1, 1, 3, 3, 3});
    body.periodic.push_back({"y_min", "y_max", ""});
    body.gravity = true;
    const Vec3 gravity{3, -4, 5};
    const auto model = fem::Model::create(MPI_COMM_SELF, {{body}, gravity});
    const double dt = 0.9 * model->stable_step().limit;
    for (int i = 0; i < 100; ++i) fem_test::step(*model, dt);
    const double way = 0.5 * model->time() * model->time();
    for (const Vec3 at : {Vec3{0, -0.5, -0.5}, Vec3{1, 0.5, 0.5}, Vec3{0.5, 0, 0}}) {
      const Vec3 u = model->probe_point("box", at, Quantity::displacement);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(u[c], way * gravity[c], 1e-12 * way) << element;
    }
    for (const auto& stress : model->element_stresses("box")) EXPECT_LT(fem::von_mises(stress), 1e-9 * 45e9 * way);
  }
}

// Nodes of a support or a load on one face act on the other: the load on both faces is felt twice by the one unknown,
// and a support of one face holds both.
TEST(FemPeriodic, SupportsAndLoadsOnTheSeam) {
  auto body = ring("hex8", {1, 0.1, 0.1, 4, 1, 1});
  body.supports = {{"solid", {false, true, true}, ""}, {"x_max", {true, false, false}, ""}};
  body.loads = {
      {"left", "x_min", fem::LoadKind::face_total, {1, 0, 0}, fem_test::history([](double) { return 30; }), ""}};
  EXPECT_THROW(fem::Model::create(MPI_COMM_SELF, {{body}, {}}), base::UserError);  // held there: does nothing
  body.supports.pop_back();
  body.loads.push_back(
      {"right", "x_max", fem::LoadKind::face_total, {1, 0, 0}, fem_test::history([](double) { return 12; }), ""});
  const auto model = fem::Model::create(MPI_COMM_SELF, {{body}, {}});
  const double seam_mass = 2350 * 0.01 * 0.25;  // of the four nodes: half a cell on each side
  EXPECT_NEAR(model->probe_group("box", "x_min", Quantity::acceleration).x, 42 / seam_mass, 1e-9);
  EXPECT_NEAR(model->probe_group("box", "x_max", Quantity::acceleration).x, 42 / seam_mass, 1e-9);
}

// Led on one face, the other follows; a motion of all nodes leads each unknown once.
TEST(FemPeriodic, MotionsOnTheSeam) {
  for (const char* group : {"x_max", "solid"}) {
    auto body = ring("hex8", {1, 0.1, 0.1, 4, 1, 1});
    body.motions = {{"shift",
                     group,
                     fem::PrescribedMotion::Kind::velocity,
                     {true, true, true},
                     fem_test::history([](double) { return 0.2; }),
                     ""}};
    const auto model = fem::Model::create(MPI_COMM_SELF, {{body}, {}});
    for (int i = 0; i < 10; ++i) fem_test::step(*model, 1e-6);
    for (const char* face : {"x_min", "x_max"}) {
      const Vec3 u = model->probe_group("box", face, Quantity::displacement);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(u[c], 0.2 * model->time(), 1e-15) << group;
    }
  }
}

}  // namespace
