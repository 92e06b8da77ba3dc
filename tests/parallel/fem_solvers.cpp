// Implicit answers on one rank and on several: the matrix that ranks put together, its factors or its multigrid, and
// the modes are the same to rounding. A row that goes to the wrong rank, or a support that a ghost does not know,
// changes the first digits.
#include <gtest/gtest.h>

#include <cmath>

#include "base/error.hpp"
#include "tests/fem_helper.hpp"

namespace {

using fem::Quantity;

testing::Environment* const petsc = testing::AddGlobalTestEnvironment(new fem_test::PetscEnvironment);

/// A clamped beam of tetrahedra and a block of hexahedra of two materials on rollers, both under load and weight.
fem::Setup two_bodies(fem::Solver kind, fem::LinearSolver linear = fem::LinearSolver::direct) {
  auto beam = fem_test::box("tet4", {1.2, 0.25, 0.22, 12, 2, 2});
  beam.name = "beam";
  beam.gravity = true;
  beam.damping = 5;
  beam.supports = {{"x_min", {true, true, true}, ""}};
  beam.loads = {
      {"tip", "x_max", fem::LoadKind::nodal_total, {30, 0, -200}, fem_test::history([](double) { return 1; }), ""}};
  auto ground = fem_test::box("hex8_bbar", {});
  ground.name = "ground";
  ground.mesh_file = TRACKBED_SOURCE_FOLDER "/meshes/ground.geo";
  ground.mesh_parameters = {{"cells_x", 3}, {"cells_y", 12}, {"cells_formation", 2}, {"cells_subgrade", 3}};
  ground.materials = {{"formation", "linear_elastic", 120e6, 0.3, 2000, ""},
                      {"subgrade", "linear_elastic", 60e6, 0.3, 1900, ""}};
  ground.supports = {
      {"base", {true, true, true}, ""}, {"cut_x", {true, false, false}, ""}, {"cut_y0", {false, true, false}, ""}};
  ground.loads = {
      {"top", "top", fem::LoadKind::traction, {0, 1e3, -1e5}, fem_test::history([](double) { return 1; }), ""}};
  fem::Setup setup{{beam, ground}, {0, 0, -9.81}};
  setup.solver.kind = kind;
  setup.solver.linear_solver = linear;
  return setup;
}

/// Returns the energy of one rank alone.
base::Energy expect_same(const fem::Setup& setup, int steps, double dt, double tolerance) {
  const auto together = fem::Model::create(MPI_COMM_WORLD, setup), alone = fem::Model::create(MPI_COMM_SELF, setup);
  for (int i = 0; i < steps; ++i) {
    fem_test::step(*together, dt);
    fem_test::step(*alone, dt);
  }
  const auto near = [&](const base::Vec3& a, const base::Vec3& b) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], tolerance * base::norm(b));
  };
  near(together->probe_group("beam", "x_max", Quantity::displacement),
       alone->probe_group("beam", "x_max", Quantity::displacement));
  near(together->probe_group("ground", "top", Quantity::displacement),
       alone->probe_group("ground", "top", Quantity::displacement));
  near(together->reaction("ground", "base"), alone->reaction("ground", "base"));
  const auto a = together->energy(), b = alone->energy();
  for (auto term :
       {&base::Energy::kinetic, &base::Energy::strain, &base::Energy::work_loads, &base::Energy::work_gravity,
        &base::Energy::loss_damping, &base::Energy::loss_viscous, &base::Energy::loss_plastic})
    EXPECT_NEAR(a.*term, b.*term, tolerance * b.strain);
  return b;
}

TEST(FemSolvers, Statics) { expect_same(two_bodies(fem::Solver::statics), 1, 1, 1e-10); }

TEST(FemSolvers, StaticsByMultigrid) {
  expect_same(two_bodies(fem::Solver::statics, fem::LinearSolver::iterative), 1, 1, 1e-8);
}

TEST(FemSolvers, Newmark) {
  auto setup = two_bodies(fem::Solver::newmark);
  setup.bodies[0].stiffness_damping = 1e-5;
  expect_same(setup, 20, 5e-4, 1e-10);
}

/// Ground that yields, a beam whose end is led.
fem::Setup yielding(fem::Solver kind) {
  auto setup = two_bodies(kind);
  auto& subgrade = setup.bodies[1].materials[1];
  subgrade.law = "drucker_prager";
  subgrade.cohesion = 15e3;
  subgrade.friction_angle = 0.4;
  setup.bodies[0].motions = {{"led",
                              "x_max",
                              fem::PrescribedMotion::Kind::displacement,
                              {false, true, false},
                              fem_test::history([](double t) { return 1e-4 * std::sin(300 * t); }),
                              ""}};
  return setup;
}

TEST(FemSolvers, StaticsThatYield) {
  EXPECT_GT(expect_same(yielding(fem::Solver::statics), 3, 1e-3, 1e-10).loss_plastic, 0);
}

TEST(FemSolvers, NewmarkThatYieldsCreepsAndAbsorbs) {
  auto setup = yielding(fem::Solver::newmark);
  auto& ground = setup.bodies[1];
  ground.materials[0].law = "kelvin_voigt";
  ground.materials[0].shear_viscosity = ground.materials[0].bulk_viscosity = 1e4;
  ground.supports.erase(ground.supports.begin());
  ground.absorbing = {{"base", ""}};
  const auto energy = expect_same(setup, 20, 5e-4, 1e-10);
  for (const double loss : {energy.loss_plastic, energy.loss_viscous, energy.loss_damping}) EXPECT_GT(loss, 0);
}

// The beam as a ring on a fixed base, cut along it: its seam lies on the first and the last rank.
TEST(FemSolvers, PeriodicFaces) {
  for (const auto kind : {fem::Solver::explicit_steps, fem::Solver::newmark, fem::Solver::statics}) {
    auto setup = two_bodies(kind);
    setup.bodies[0].periodic = {{"x_min", "x_max", ""}};
    setup.bodies[0].supports = {{"z_min", {true, true, true}, ""}};
    if (kind == fem::Solver::statics) setup.bodies[0].damping = 0;
    expect_same(setup, kind == fem::Solver::statics ? 1 : 50, kind == fem::Solver::explicit_steps ? 5e-6 : 5e-4, 1e-10);
  }
}

TEST(FemSolvers, Modes) {
  auto setup = two_bodies(fem::Solver::modal);
  setup.bodies[0].supports = {{"x_min", {false, true, false}, ""}};  // four free motions
  const auto together = fem::Model::create(MPI_COMM_WORLD, setup), alone = fem::Model::create(MPI_COMM_SELF, setup);
  const auto a = together->find_modes(5), b = alone->find_modes(5);
  for (std::size_t body = 0; body < 2; ++body) {
    EXPECT_EQ(a[body].rigid_motions, body == 0 ? 4 : 0);
    ASSERT_EQ(a[body].modes.size(), 5u);
    for (std::size_t k = 0; k < 5; ++k)
      EXPECT_NEAR(a[body].modes[k].frequency, b[body].modes[k].frequency, 1e-10 * b[body].modes[k].frequency);
  }
}

TEST(FemSolvers, AMechanismIsRefusedOnEveryRank) {
  auto setup = two_bodies(fem::Solver::statics);
  setup.bodies[1].supports.clear();
  EXPECT_THROW(fem::Model::create(MPI_COMM_WORLD, setup), base::UserError);
}

}  // namespace
