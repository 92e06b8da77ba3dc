// The reported stable step against 2 / omega_max of the assembled problem, computed with a dense eigensolver elsewhere:
// free unit cubes of concrete, in units of h / c_p (a one-point estimate h / c_p would be above them), and the step's
// meaning: just below it a run stays bounded, a little above the true limit it does not.
#include <gtest/gtest.h>

#include <cmath>

#include "base/error.hpp"
#include "tests/fem_helper.hpp"

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
