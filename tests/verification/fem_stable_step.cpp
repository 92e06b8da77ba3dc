// The reported stable step against 2 / omega_max of the assembled problem, computed with a dense eigensolver elsewhere:
// free unit cubes of concrete, in units of h / c_p (a one-point estimate h / c_p would be above them), and the step's
// meaning: just below it a run stays bounded, a little above the true limit it does not.
#include <gtest/gtest.h>

#include <cmath>

#include "base/error.hpp"
#include "tests/fem_helper.hpp"
#include "tests/fem_mesh.hpp"

namespace {

testing::Environment* const petsc = testing::AddGlobalTestEnvironment(new fem_test::PetscEnvironment);

struct Cube {
  const char* element;
  int cells;        // per edge
  double expected;  // dt_crit c_p / h
};
std::ostream& operator<<(std::ostream& out, const Cube& cube) { return out << cube.element << " " << cube.cells; }

struct StableStepOfCubes : testing::TestWithParam<Cube> {};

TEST_P(StableStepOfCubes, NeverAboveAndCloseBelow) {
  const auto [element, cells, expected] = GetParam();
  const auto model = fem::Model::create(MPI_COMM_SELF, {{fem_test::box(element, {1, 1, 1, cells, cells, cells})}, {}});
  const double scaled = model->stable_step().limit * fem_test::compression_wave_speed() * cells;
  EXPECT_LE(scaled, expected * (1 + 1e-5));  // five digits are given
  EXPECT_GE(scaled, 0.95 * expected);
}

INSTANTIATE_TEST_SUITE_P(Fem, StableStepOfCubes,
                         testing::Values(Cube{"hex8", 1, 0.84486}, Cube{"hex8", 4, 0.99216}, Cube{"tet4", 1, 0.64900},
                                         Cube{"tet4", 4, 0.66533}));

// The bound by the worst element alone: that of the cube's one cell, whatever the mesh (FEM reference: 0.84486 and
// 0.52525 h / c_p; 1.008674e-5 and 6.241588e-6 s for the cantilever).
TEST(StableStep, BoundByElements) {
  const auto limit = [](const char* element, const fem_test::BoxSize& size) {
    auto body = fem_test::box(element, size);
    if (size.length > 2) body.supports = {{"x_min", {true, true, true}, ""}};
    fem::Setup setup{{body}, {}};
    setup.solver.step_bound = fem::StepBound::elements;
    return fem::Model::create(MPI_COMM_SELF, setup)->stable_step().limit;
  };
  const double h = 0.25 / fem_test::compression_wave_speed();
  EXPECT_NEAR(limit("hex8", {1, 1, 1, 4, 4, 4}), 0.84486 * h, 1e-5 * h);
  EXPECT_NEAR(limit("tet4", {1, 1, 1, 4, 4, 4}), 0.52525 * h, 1e-5 * h);
  EXPECT_NEAR(limit("hex8", {2.4, 0.25, 0.22, 48, 4, 4}), 1.008674e-5, 1e-11);
  EXPECT_NEAR(limit("tet4", {2.4, 0.25, 0.22, 48, 4, 4}), 6.241588e-6, 1e-11);
}

struct StableStepOfElements : testing::TestWithParam<std::string> {};

// Every element against its own largest eigenvalue on the same free cube (3 x 3 x 3), by 400 power iterations on M^-1 K
// of elements that never went through a model: these approach it from below, so their step is a little too long.
TEST_P(StableStepOfElements, NeverAboveAndCloseBelow) {
  const auto body = fem_test::box(GetParam(), {1, 1, 1, 3, 3, 3});
  const auto mesh = fem_test::block_mesh(GetParam(), {3, 3, 3}, [](int i, int j, int k) {
    return base::Vec3{i / 3.0, j / 3.0 - 0.5, k / 3.0 - 0.5};
  });
  const auto block = fem::ElementBlock::make({GetParam(), body.materials[0], mesh.nodes, mesh.connectivity});
  std::vector<double> mass(mesh.nodes.size(), 0.0), u(3 * mesh.nodes.size());
  block->add_lumped_mass(mass.data());
  for (std::size_t i = 0; i < u.size(); ++i) u[i] = 1e-6 * std::sin(static_cast<double>(i * i + 1));
  double eigenvalue = 0;
  for (int turn = 0; turn < 400; ++turn) {
    auto f = fem_test::forces_of(*block, u);
    double energy = fem_test::product(u, f), inertia = 0, largest = 0;
    for (std::size_t i = 0; i < u.size(); ++i) inertia += mass[i / 3] * u[i] * u[i];
    eigenvalue = energy / inertia;
    for (std::size_t i = 0; i < u.size(); ++i) {
      u[i] = f[i] / mass[i / 3];
      largest = std::max(largest, std::abs(u[i]));
    }
    for (double& value : u) value *= 1e-6 / largest;
  }
  const double expected = 2 / std::sqrt(eigenvalue);
  const double limit = fem::Model::create(MPI_COMM_SELF, {{body}, {}})->stable_step().limit;
  std::printf("%s: dt_crit c_p / h = %.4f\n", GetParam().c_str(), expected * fem_test::compression_wave_speed() * 3);
  EXPECT_LE(limit, expected);
  EXPECT_GE(limit, 0.95 * expected);
}

INSTANTIATE_TEST_SUITE_P(Fem, StableStepOfElements, testing::ValuesIn(fem::element_names()),
                         [](const auto& info) { return info.param; });

fem::Body pushed_cube() {
  auto body = fem_test::box("hex8", {1, 1, 1, 4, 4, 4});
  body.loads = {{"push",
                 "x_max",
                 fem::LoadKind::face_total,
                 {1, 0.3, 0.1},
                 fem_test::history([](double t) { return t < 1e-4 ? 1e4 : 0; }),
                 ""}};
  return body;
}

TEST(StableStep, JustBelowTheLimitStaysBounded) {
  const auto model = fem::Model::create(MPI_COMM_SELF, {{pushed_cube()}, {}});
  const double dt = model->stable_step().limit;
  for (int i = 0; i < 3000; ++i) fem_test::step(*model, dt);
  const auto energy = model->energy();
  EXPECT_LT(std::abs(energy.stored() - energy.works()), 0.5 * energy.works());
}

// 0.99216 h / c_p is the true limit; the reported one is at most 5 % below it.
TEST(StableStep, AboveTheTrueLimitItStopsWithTheCause) {
  const auto model = fem::Model::create(MPI_COMM_SELF, {{pushed_cube()}, {}});
  const double dt = 1.02 * 0.99216 * 0.25 / fem_test::compression_wave_speed();
  try {
    for (int i = 0; i < 20000; ++i) fem_test::step(*model, dt);
    FAIL() << "a step above 2 / omega_max stayed bounded";
  } catch (const base::UnstableError& error) {
    const std::string message = error.what();
    EXPECT_NE(message.find("body \"box\" became unstable: the velocity of node"), std::string::npos) << message;
    EXPECT_NE(message.find("stable step"), std::string::npos) << message;
  }
}

// The softer body never decides: limit and limiter are those of the concrete, whichever stands first.
TEST(StableStep, TheStiffestBodyLimits) {
  auto soft = fem_test::box("hex8", {1, 1, 1, 2, 2, 2});
  soft.name = "soft";
  soft.materials[0].young_modulus = 60e6;
  const auto concrete = fem_test::box("hex8", {1, 1, 1, 2, 2, 2});
  const double alone = fem::Model::create(MPI_COMM_SELF, {{concrete}, {}})->stable_step().limit;
  const auto both = fem::Model::create(MPI_COMM_SELF, {{soft, concrete}, {}})->stable_step();
  EXPECT_NEAR(both.limit, alone, 0.03 * alone);
  EXPECT_NE(both.limiter.find("body \"box\""), std::string::npos) << both.limiter;
}

}  // namespace
