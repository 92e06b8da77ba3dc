// Free vibrations. The cantilever of Nishiura2017 3.1 on the meshes of the static table: expected f1 and f2 from
// CalculiX 2.20 and FrontISTR, lumped mass. A consistent mass, or a support that moves, is off by more than 0.2 % here.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/fem_helper.hpp"

namespace {

testing::Environment* const petsc = testing::AddGlobalTestEnvironment(new fem_test::PetscEnvironment);

fem::BodyModes modes_of(const fem::Body& body, int count) {
  fem::Setup setup{{body}, {}};
  setup.solver.kind = fem::Solver::modal;
  return fem::Model::create(MPI_COMM_SELF, setup)->find_modes(count).at(0);
}

struct Row {
  const char* element;
  int cells_x, cells_yz;
  double f1, f2;  // [Hz]
};
std::ostream& operator<<(std::ostream& out, const Row& row) { return out << row.element << " " << row.cells_x; }

struct CantileverModes : testing::TestWithParam<Row> {};

TEST_P(CantileverModes, AsInOtherCodes) {
  const Row expected = GetParam();
  auto body =
      fem_test::box(expected.element, {2.4, 0.25, 0.22, expected.cells_x, expected.cells_yz, expected.cells_yz});
  body.supports = {{"x_min", {true, true, true}, ""}};
  const auto found = modes_of(body, 2);
  EXPECT_EQ(found.rigid_motions, 0);
  ASSERT_EQ(found.modes.size(), 2u);
  EXPECT_NEAR(found.modes[0].frequency, expected.f1, 2e-3 * expected.f1);
  EXPECT_NEAR(found.modes[1].frequency, expected.f2, 2e-3 * expected.f2);
}

INSTANTIATE_TEST_SUITE_P(Fem, CantileverModes,
                         testing::Values(Row{"tet4", 24, 2, 34.48, 41.54}, Row{"tet4", 48, 4, 29.29, 33.43},
                                         Row{"hex8", 24, 2, 28.17, 31.64}, Row{"hex8", 48, 4, 27.21, 30.78},
                                         Row{"hex8_bbar", 48, 4, 26.895, 30.427},
                                         Row{"hex8_incompatible", 48, 4, 26.877, 30.485},
                                         Row{"tet10", 24, 2, 26.88, 30.49}, Row{"hex20", 12, 2, 26.87, 30.48},
                                         Row{"hex20_reduced", 24, 2, 26.885, 30.495}));

// A bar on rollers all round, free ends, n cells, lumped mass: omega_k = 2 c / h sin(k pi / (2 n)) (chain of equal
// masses and springs, end masses half), c^2 = (lambda + 2 mu) / rho. One rigid motion, which is no mode.
TEST(Modes, FreeChain) {
  const int cells = 10;
  auto body = fem_test::box("hex8", {1, 0.05, 0.05, cells, 1, 1});
  for (const char* side : {"y_min", "y_max"}) body.supports.push_back({side, {false, true, true}, ""});
  const auto found = modes_of(body, 4);
  EXPECT_EQ(found.rigid_motions, 1);
  ASSERT_EQ(found.modes.size(), 4u);
  const double c = fem_test::compression_wave_speed(), h = 1.0 / cells, rest = 1e-9 * 2350 * 0.05 * 0.05;
  int longitudinal = 1;
  for (const auto& mode : found.modes) {
    EXPECT_LT(mode.effective_mass.x, rest) << "a free body's momentum stays with its rigid motion";
    const double omega = 2 * c / h * std::sin(longitudinal * std::numbers::pi / (2 * cells));
    if (std::abs(mode.frequency - omega / (2 * std::numbers::pi)) < 1e-7 * mode.frequency) ++longitudinal;
  }
  EXPECT_GE(longitudinal, 3);
}

// All modes of a small clamped block together carry the whole free mass along every axis.
TEST(Modes, EffectiveMassesSumToTheFreeMass) {
  auto body = fem_test::box("hex8_bbar", {0.5, 0.3, 0.2, 2, 1, 1});
  body.supports = {{"x_min", {true, true, true}, ""}};
  const auto found = modes_of(body, 1000);
  EXPECT_EQ(found.modes.size(), 24u);  // eight free nodes
  base::Vec3 sum;
  for (const auto& mode : found.modes) sum += mode.effective_mass;
  const double free = 0.75 * 2350 * 0.5 * 0.3 * 0.2;  // a quarter of the mass is lumped to the clamped nodes
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(sum[c], free, 1e-8 * free);
}

// Free in space: six rigid motions known beforehand, then the first bending about each axis of the section, by
// Timoshenko's equations of a free beam (shear coefficient 5/6): 167.03 and 188.33 Hz. Euler-Bernoulli: 171.8 Hz.
TEST(Modes, FreeBeamHasSixRigidMotions) {
  const auto found = modes_of(fem_test::box("hex8_bbar", {2.4, 0.25, 0.22, 48, 4, 4}), 2);
  EXPECT_EQ(found.rigid_motions, 6);
  ASSERT_EQ(found.modes.size(), 2u);
  EXPECT_NEAR(found.modes[0].frequency, 167.03, 0.005 * 167.03);
  EXPECT_NEAR(found.modes[1].frequency, 188.33, 0.005 * 188.33);
}

}  // namespace
