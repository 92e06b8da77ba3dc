// Stresses: at nodes from the elements around them, their invariants, and the explicit answer against the static one.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "fem/recovery.hpp"
#include "tests/fem_helper.hpp"

namespace {

testing::Environment* const petsc = testing::AddGlobalTestEnvironment(new fem_test::PetscEnvironment);

// Linear in space: recovered exactly at corners, on faces and inside. A mean over the touching elements misses it by
// half a layer on the surface.
TEST(Stress, LinearFieldIsRecoveredAtEveryNode) {
  for (const char* element : {"tet4", "hex8"}) {
    const auto mesh = fem::read_mesh(MPI_COMM_SELF, fem_test::box(element, {1.2, 0.5, 0.4, 4, 3, 2}));
    const auto field = [](const base::Vec3& x) { return 3 - 2 * x.x + 5 * x.y + 7 * x.z; };
    for (int node = 0; node < static_cast<int>(mesh.nodes.size()); ++node) {
      const auto recovery = fem::recovery_at(mesh, node);
      double value = 0;
      for (std::size_t i = 0; i < recovery.elements.size(); ++i)
        value += recovery.weights[i] * field(mesh.centre(recovery.elements[i]));
      EXPECT_NEAR(value, field(mesh.nodes[node]), 1e-11) << element << " node " << node;
    }
  }
}

// One cell across, or cells twenty times as long as thick: the slope across is not told, and the patch stays small, so
// that a wave is seen where it is; at the end the slope along the bar leads to the face.
TEST(Stress, BarOfOneCellAcross) {
  for (const double width : {0.01, 2.0}) {
    const auto mesh = fem::read_mesh(MPI_COMM_SELF, fem_test::box("hex8", {20, width, width, 100, 1, 1}));
    const auto field = [](const base::Vec3& x) { return 3 - 2 * x.x; };
    for (int node = 0; node < static_cast<int>(mesh.nodes.size()); ++node) {
      const auto recovery = fem::recovery_at(mesh, node);
      EXPECT_EQ(recovery.elements.size(), 2u);
      double value = 0;
      for (std::size_t i = 0; i < recovery.elements.size(); ++i)
        value += recovery.weights[i] * field(mesh.centre(recovery.elements[i]));
      EXPECT_NEAR(value, field(mesh.nodes[node]), 1e-9) << node;
    }
  }
}

// The mean over a face of a field that is linear in space is its value at the face's centre.
TEST(Stress, MeanOverAFace) {
  for (const char* element : {"tet4", "tet10", "hex8", "hex20"}) {
    const auto mesh = fem::read_mesh(MPI_COMM_SELF, fem_test::box(element, {1.2, 0.5, 0.4, 4, 3, 2}));
    const auto field = [](const base::Vec3& x) { return 3 - 2 * x.x + 5 * x.y + 7 * x.z; };
    const auto recovery = fem::recovery_over(mesh, mesh.groups.at("z_max").facets);
    double value = 0;
    for (std::size_t i = 0; i < recovery.elements.size(); ++i)
      value += recovery.weights[i] * field(mesh.centre(recovery.elements[i]));
    base::Vec3 lower = mesh.nodes[0], upper = lower;
    for (const auto& node : mesh.nodes) {
      for (int c = 0; c < 3; ++c) lower[c] = std::min(lower[c], node[c]), upper[c] = std::max(upper[c], node[c]);
    }
    const base::Vec3 centre{0.5 * (lower.x + upper.x), 0.5 * (lower.y + upper.y), upper.z};
    EXPECT_NEAR(value, field(centre), 1e-11) << element;
  }
}

// One element alone has one stress: it is that of its nodes.
TEST(Stress, OneElementGivesItsOwn) {
  const auto mesh = fem::read_mesh(MPI_COMM_SELF, fem_test::box("hex8", {}));
  const auto recovery = fem::recovery_at(mesh, 3);
  ASSERT_EQ(recovery.elements.size(), 1u);
  EXPECT_NEAR(recovery.weights[0], 1, 1e-12);
}

TEST(Stress, Invariants) {
  // uniaxial: the stress itself; pure shear t: sqrt(3) t and +-t; pressure changes nothing
  EXPECT_NEAR(fem::von_mises({5, 0, 0, 0, 0, 0}), 5, 1e-14);
  EXPECT_NEAR(fem::von_mises({0, 0, 0, 0, 2, 0}), 2 * std::sqrt(3.0), 1e-14);
  EXPECT_NEAR(fem::von_mises({7, 7, 7, 1, 0, 0}), std::sqrt(3.0), 1e-13);
  const auto shear = fem::principal({7, 7, 7, 1, 0, 0});
  EXPECT_NEAR(shear[0], 8, 1e-13);
  EXPECT_NEAR(shear[1], 7, 1e-13);
  EXPECT_NEAR(shear[2], 6, 1e-13);
}

fem::Body cantilever(int cells_x, int cells_yz, std::function<double(double)> load) {
  auto body = fem_test::box("hex8_bbar", {2.4, 0.25, 0.22, cells_x, cells_yz, cells_yz});
  body.supports = {{"x_min", {true, true, true}, ""}};
  body.loads = {{"tip", "x_max", fem::LoadKind::nodal_total, {0, 0, -1}, fem_test::history(std::move(load)), ""}};
  return body;
}

fem::Setup statics(const fem::Body& body) {
  fem::Setup setup{{body}, {}};
  setup.solver.kind = fem::Solver::statics;
  return setup;
}

// A block under its own weight on rollers: the foot carries rho g h, whoever asks over its whole face.
TEST(Stress, FootOfABlockUnderItsWeight) {
  auto body = fem_test::box("hex8", {1, 1, 1, 3, 3, 4});
  body.gravity = true;
  body.materials[0].poisson_ratio = 0;  // uniaxial in every layer, whose mean stress is that of its middle
  body.supports = {
      {"x_min", {true, false, false}, ""}, {"y_min", {false, true, false}, ""}, {"z_min", {false, false, true}, ""}};
  auto setup = statics(body);
  setup.gravity = {0, 0, -10};
  const auto model = fem::Model::create(MPI_COMM_SELF, setup);
  fem_test::step(*model, 1);
  const double weight = body.materials[0].density * 10;
  EXPECT_NEAR(model->stress_at("box", {std::nullopt, "z_min"})[2], -weight, 1e-9 * weight);
  EXPECT_EQ(model->plastic_strain_at("box", {std::nullopt, "z_min"}), 0);
  EXPECT_THROW(model->stress_at("box", {std::nullopt, "solid"}), base::UserError);
}

// A Kelvin-Voigt bar that is stretched at a constant rate by Newmark steps that damp its waves: its stress is
// E eps + 4/3 mu_D eps' (nu and bulk viscosity 0, sides held), and the support carries it over the area.
TEST(Stress, ViscousPartIsSeen) {
  constexpr double rate = 1e-3, viscosity = 3e10;
  auto body = fem_test::box("hex8", {1, 1, 1, 2, 2, 2});
  body.materials[0].law = "kelvin_voigt";
  body.materials[0].poisson_ratio = 0;
  body.materials[0].shear_viscosity = viscosity;
  body.supports = {{"solid", {false, true, true}, ""}, {"x_min", {true, false, false}, ""}};
  fem::PrescribedMotion pull;
  pull.name = "pull";
  pull.group = "x_max";
  pull.along = {true, false, false};
  pull.history = fem_test::history([](double t) { return rate * t; });
  body.motions = {pull};
  auto setup = statics(body);
  setup.solver.kind = fem::Solver::newmark;
  setup.solver.gamma = 0.9;
  setup.solver.beta = 0.49;
  const auto model = fem::Model::create(MPI_COMM_SELF, setup);
  for (int k = 0; k < 100; ++k) fem_test::step(*model, 0.01);
  const double expected = rate * (body.materials[0].young_modulus * 1 + 4.0 / 3.0 * viscosity);
  EXPECT_NEAR(model->stress_at("box", {std::nullopt, "x_min"})[0], expected, 1e-6 * expected);
  EXPECT_NEAR(-model->reaction("box", "x_min").x, expected, 1e-6 * expected);
}

// Middle of the top face of the cantilever of Nishiura2017 3.1: M c / I = 200 N 1.2 m 0.11 m / (0.25 m (0.22 m)^3 / 12)
// = 119.0 kPa, as CalculiX finds on fine meshes; within 1 %. The elements below it have 0.83 of that.
TEST(Stress, MiddleOfTheTopFace) {
  const auto model = fem::Model::create(MPI_COMM_SELF, statics(cantilever(72, 6, [](double) { return 200; })));
  fem_test::step(*model, 1);
  const auto stress = model->stress_at("box", {base::Vec3(1.2, 0, 0.11), ""});
  EXPECT_NEAR(fem::von_mises(stress), 119.0e3, 0.01 * 119.0e3);
  EXPECT_NEAR(stress[0], 119.0e3, 0.01 * 119.0e3);  // pulled on top
  EXPECT_NEAR(fem::principal(stress)[0], 119.0e3, 0.01 * 119.0e3);
}

// Damped until it rests under the load, the explicit model has the static model's stress, element by element.
TEST(Stress, ExplicitHoldIsTheStaticAnswer) {
  const auto still = fem::Model::create(MPI_COMM_SELF, statics(cantilever(24, 2, [](double) { return 200; })));
  fem_test::step(*still, 1);
  auto body = cantilever(24, 2, [](double t) { return 200 * std::min(1.0, t / 0.02); });
  body.damping = 2 * 2 * std::numbers::pi * 27;
  const auto held = fem::Model::create(MPI_COMM_SELF, {{body}, {}});
  while (held->time() < 0.16) fem_test::step(*held, 0.95 * held->stable_step().limit);
  const auto expected = still->element_stresses("box"), found = held->element_stresses("box");
  ASSERT_EQ(found.size(), 96u);
  for (std::size_t e = 0; e < found.size(); ++e)
    EXPECT_NEAR(fem::von_mises(found[e]), fem::von_mises(expected[e]), 0.0012 * fem::von_mises(expected[e])) << e;
}

}  // namespace
