// Equilibria against established codes: the cantilever of Nishiura2017 3.1 (L 2.4 m, 0.25 x 0.22 m, E 45 GPa, nu 0.167,
// clamped at x = 0, 200 N shared equally by the nodes at x = L). Expected tip displacements: CalculiX 2.20 and
// FrontISTR on the same meshes, which agree to all digits given; a wrong split, quadrature or node share changes the
// third digit.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/error.hpp"
#include "tests/fem_helper.hpp"

namespace {

using fem::Quantity;

testing::Environment* const petsc = testing::AddGlobalTestEnvironment(new fem_test::PetscEnvironment);

fem::Setup statics(const fem::Body& body, base::Vec3 gravity = {}) {
  fem::Setup setup{{body}, gravity};
  setup.solver.kind = fem::Solver::statics;
  return setup;
}

struct Tip {
  const char* element;
  int cells_x, cells_yz;
  double deflection;  // [m]
  fem::LinearSolver solver;
};
std::ostream& operator<<(std::ostream& out, const Tip& tip) { return out << tip.element << " " << tip.cells_x; }

fem::Body cantilever(const std::string& element, int cells_x, int cells_yz) {
  auto body = fem_test::box(element, {2.4, 0.25, 0.22, cells_x, cells_yz, cells_yz});
  body.supports = {{"x_min", {true, true, true}, "supports"}};
  body.loads = {
      {"tip", "x_max", fem::LoadKind::nodal_total, {0, 0, -1}, fem_test::history([](double) { return 200; }), ""}};
  return body;
}

struct StaticTip : testing::TestWithParam<Tip> {};

TEST_P(StaticTip, DeflectsAsInOtherCodes) {
  const Tip expected = GetParam();
  auto setup = statics(cantilever(expected.element, expected.cells_x, expected.cells_yz));
  setup.solver.linear_solver = expected.solver;
  const auto model = fem::Model::create(MPI_COMM_SELF, setup);
  fem_test::step(*model, 1);
  const double tip = -model->probe_point("box", {2.4, 0, 0}, Quantity::displacement).z;
  EXPECT_NEAR(tip, expected.deflection, 2e-5 * expected.deflection);
  // Supports carry the load and nothing else; moments are theirs too, but forces sum.
  const auto reaction = model->reaction("box", "x_min");
  EXPECT_NEAR(reaction.x, 0, 1e-7);
  EXPECT_NEAR(reaction.y, 0, 1e-7);
  EXPECT_NEAR(reaction.z, 200, 1e-7);
  // A load that grows in proportion does half the work of the whole load on the whole way (Clapeyron).
  const auto energy = model->energy();
  EXPECT_NEAR(energy.strain, energy.work_loads, 1e-8 * energy.strain);
  EXPECT_EQ(energy.kinetic, 0);
}

constexpr auto direct = fem::LinearSolver::direct, iterative = fem::LinearSolver::iterative;
INSTANTIATE_TEST_SUITE_P(
    Fem, StaticTip,
    testing::Values(Tip{"tet4", 24, 2, 52.5128e-6, direct}, Tip{"tet4", 48, 4, 77.0629e-6, direct},
                    Tip{"tet4", 48, 4, 77.0629e-6, iterative}, Tip{"hex8", 24, 2, 84.1215e-6, direct},
                    Tip{"hex8", 48, 4, 90.3343e-6, direct}, Tip{"hex8_bbar", 48, 4, 92.4457e-6, direct},
                    Tip{"hex8_bbar", 48, 4, 92.4457e-6, iterative}, Tip{"tet10", 24, 2, 92.5695e-6, direct},
                    Tip{"hex8_incompatible", 48, 4, 92.5848e-6, direct},
                    Tip{"hex8_one_point", 48, 4, 92.5848e-6, direct},  // boxes: the same element
                    Tip{"hex20", 12, 2, 92.4977e-6, direct}, Tip{"hex20_reduced", 24, 2, 92.5948e-6, direct}));

// A material so soft that the tip leaves the body by more than ten of its lengths: not what small strains can mean.
TEST(Statics, AbsurdDisplacementsAreRefused) {
  auto beam = cantilever("hex8", 8, 2);
  beam.materials[0].young_modulus = 1;
  const auto model = fem::Model::create(MPI_COMM_SELF, statics(beam));
  try {
    fem_test::step(*model, 1);
    FAIL() << "accepted";
  } catch (const base::UserError& error) {
    EXPECT_NE(std::string(error.what()).find("times its size"), std::string::npos) << error.what();
  }
}

/// Downward displacement [m] at a point of the body in equilibrium.
double sag(const fem::Model& model, const char* body, base::Vec3 point) {
  return -model.probe_point(body, point, Quantity::displacement).z;
}

// Strip of 8 x 1 x 0.1 m, E 30 GPa, nu 0.2, held from below where |x| >= 3 m, 8.5 kPa on its top (after Villard 2009);
// a quarter of the mesh 80 x 4 x 2. Expected deflections at mid-thickness: CalculiX and FrontISTR, eight points.
TEST(Statics, PlateOnLedges) {
  auto plate = fem_test::box("hex20_reduced", {});
  plate.mesh_file = TRACKBED_SOURCE_FOLDER "/meshes/strip.geo";
  plate.mesh_parameters = {{"cells_span", 30}, {"cells_ledge", 10}, {"cells_y", 2}, {"cells_z", 2}};
  plate.materials = {{"", "linear_elastic", 30e9, 0.2, 2500, ""}};
  plate.supports = {
      {"ledge", {true, true, true}, ""}, {"mid_x", {true, false, false}, ""}, {"mid_y", {false, true, false}, ""}};
  plate.loads = {
      {"q", "top", fem::LoadKind::traction, {0, 0, -1}, fem_test::history([](double) { return 8.5e3; }), ""}};
  const auto model = fem::Model::create(MPI_COMM_SELF, statics(plate));
  fem_test::step(*model, 1);
  constexpr double expected[] = {11.8190e-3, 11.1846e-3, 9.3876e-3, 6.7455e-3, 3.7848e-3, 1.2321e-3};
  for (int k = 0; k < 6; ++k)
    EXPECT_NEAR(sag(*model, "box", {0.5 * k, 0, 0}), expected[k], 1e-4 * expected[k]) << 0.5 * k << " m";
}

// Block of 10 x 6 x 3 m, E 60 MPa, nu 0.3, on a rigid base between smooth walls; 100 kPa on 0.3 x 0.3 m. A quarter of
// it, four hex20 over half the footing, growing away. Expected: CalculiX and FrontISTR, hex20 on such meshes.
TEST(Statics, FootingOnSubgrade) {
  auto ground = fem_test::box("hex20", {});
  ground.mesh_file = TRACKBED_SOURCE_FOLDER "/meshes/loaded_block.geo";
  ground.mesh_parameters = {{"cells_patch", 4}, {"cells_x", 9}, {"cells_y", 8}, {"cells_z", 9}, {"growth", 1.6}};
  ground.materials = {{"", "linear_elastic", 60e6, 0.3, 1900, ""}};
  ground.supports = {{"base", {true, true, true}, ""}};
  for (const char* side : {"mid_x", "far_x"}) ground.supports.push_back({side, {true, false, false}, ""});
  for (const char* side : {"mid_y", "far_y"}) ground.supports.push_back({side, {false, true, false}, ""});
  ground.loads = {
      {"q", "patch", fem::LoadKind::traction, {0, 0, -1}, fem_test::history([](double) { return 100e3; }), ""}};
  const auto model = fem::Model::create(MPI_COMM_SELF, statics(ground));
  fem_test::step(*model, 1);
  EXPECT_NEAR(sag(*model, "box", {0, 0, 0}), 0.4903e-3, 3e-3 * 0.4903e-3);
  EXPECT_NEAR(sag(*model, "box", {0.15, 0.15, 0}), 0.2347e-3, 3e-3 * 0.2347e-3);
}

// A column under its own weight on rollers: u = rho g (x - L) x / (2 E) upwards from the base, linear elements hit it
// at their nodes; the base carries the weight.
TEST(Statics, ColumnUnderItsOwnWeight) {
  auto body = fem_test::box("hex8", {2, 0.4, 0.4, 8, 2, 2});
  body.gravity = true;
  body.materials[0].poisson_ratio = 0;
  body.supports = {
      {"x_min", {true, false, false}, ""}, {"y_min", {false, true, false}, ""}, {"z_min", {false, false, true}, ""}};
  const auto model = fem::Model::create(MPI_COMM_SELF, statics(body, {-9.81, 0, 0}));
  fem_test::step(*model, 1);
  const double down = 2350 * 9.81 * 2 * 2 / (2 * 45e9);
  EXPECT_NEAR(model->probe_group("box", "x_max", Quantity::displacement).x, -down, 1e-9 * down);
  const double weight = 2350 * 9.81 * 2 * 0.4 * 0.4;
  EXPECT_NEAR(model->reaction("box", "x_min").x, weight, 1e-9 * weight);
  const auto energy = model->energy();
  EXPECT_NEAR(energy.strain, energy.work_gravity, 1e-9 * energy.strain);
}

// The same equilibrium as the start of an explicit run: it stays at rest, where a start from zero would swing.
TEST(Statics, ExplicitRunFromEquilibriumStaysThere) {
  auto body = cantilever("hex8", 12, 2);
  body.gravity = true;
  fem::Setup setup{{body}, {0, 0, -9.81}};
  setup.solver.start_in_equilibrium = true;
  const auto model = fem::Model::create(MPI_COMM_SELF, setup);
  const double tip = model->probe_point("box", {2.4, 0, 0}, Quantity::displacement).z;
  EXPECT_LT(tip, -200e-6);  // the beam's weight of 3 kN bends it four times as far as the load
  for (int i = 0; i < 500; ++i) fem_test::step(*model, 0.9 * model->stable_step().limit);
  EXPECT_NEAR(model->probe_point("box", {2.4, 0, 0}, Quantity::displacement).z, tip, 1e-8 * std::abs(tip));
}

// Drucker-Prager in a triaxial test led by displacement, in many elements: an equal pressure of 100 kPa, then axial
// strain from there, then back by 0.001. c 20 kPa, phi 30 degrees, outer cone, psi = phi, E 60 MPa, nu 0.3: elastic to
// -(q + p) = -369.282032 kPa, which it keeps; the lateral strain grows by the flow; the way back is elastic, 60 kPa.
struct Triaxial : testing::TestWithParam<std::string> {};

TEST_P(Triaxial, YieldsAndComesBack) {
  auto body = fem_test::box(GetParam(), {1, 1, 1, 2, 2, 2});
  body.materials = {{"", "drucker_prager", 60e6, 0.3, 2000, ""}};
  body.materials[0].cohesion = 20e3;
  body.materials[0].friction_angle = body.materials[0].dilation_angle = std::numbers::pi / 6;
  body.supports = {
      {"x_min", {true, false, false}, ""}, {"y_min", {false, true, false}, ""}, {"z_min", {false, false, true}, ""}};
  for (const char* side : {"x_max", "y_max"})
    body.loads.push_back(
        {side, side, fem::LoadKind::pressure, {}, fem_test::history([](double) { return 100e3; }), ""});
  const double start = 100e3 * (1 - 2 * 0.3) / 60e6;
  const double axial[] = {0, 0.002, 0.005, 0.010, 0.009};
  body.motions = {{"plate",
                   "z_max",
                   fem::PrescribedMotion::Kind::displacement,
                   {false, false, true},
                   fem_test::history([&](double t) { return t < 0.5 ? 0 : -start - axial[std::lround(t) - 1]; }),
                   ""}};
  const auto model = fem::Model::create(MPI_COMM_SELF, statics(body));
  const double stress[] = {-100e3, -220e3, -369282.0323, -369282.0323, -309282.0323};
  const double lateral[] = {0, 6.0e-4, 2.11435935e-3, 9.61435935e-3, 9.31435935e-3};
  for (int k = 0; k < 5; ++k) {
    fem_test::step(*model, 1);
    for (const auto& found : model->element_stresses("box")) {
      EXPECT_NEAR(found[2], stress[k], 1e-6 * std::abs(stress[k])) << "step " << k;
      EXPECT_NEAR(found[0], -100e3, 0.1);
    }
    EXPECT_NEAR(model->probe_group("box", "x_max", Quantity::displacement).x, lateral[k] - start, 1e-8);
  }
}

INSTANTIATE_TEST_SUITE_P(Fem, Triaxial, testing::Values("hex8", "hex8_bbar", "hex20_reduced", "tet10", "tet4"),
                         [](const auto& info) { return info.param; });

std::string message_of(const fem::Setup& setup) {
  try {
    fem::Model::create(MPI_COMM_SELF, setup);
  } catch (const base::UserError& error) {
    return error.what();
  }
  return "no error";
}

// A motion without resistance is named before any solver stumbles over it.
TEST(Statics, FreeMotionsAreNamed) {
  auto body = fem_test::box("hex8", {2, 0.4, 0.4, 4, 1, 1});
  const std::string
      head = "scene.toml:3: body \"box\": nothing holds it against ",
      tail = "; there is no equilibrium, the static system is singular; add a [[body.support]] that fixes it";
  EXPECT_EQ(message_of(statics(body)),
            head +
                "translation along x, translation along y, translation along z, rotation about x through (1, 0, 0) m, "
                "rotation about y through (1, 0, 0) m, rotation about z through (1, 0, 0) m" +
                tail);
  body.supports = {{"x_min", {true, false, false}, ""}};
  EXPECT_EQ(message_of(statics(body)), head +
                                           "translation along y, translation along z, rotation about x through (1, 0, "
                                           "0) m" +
                                           tail);
  body.supports = {{"x_min", {true, true, true}, ""}};
  EXPECT_EQ(message_of(statics(body)), "no error");
  auto setup = statics(body);
  setup.bodies[0].supports = {{"z_min", {false, true, true}, ""}};
  EXPECT_EQ(message_of(setup), head + "translation along x" + tail);
  setup.solver.kind = fem::Solver::explicit_steps;
  EXPECT_EQ(message_of(setup), "no error");
  setup.solver.start_in_equilibrium = true;
  EXPECT_EQ(message_of(setup), head + "translation along x" + tail);
}

// Cells of eight points in a row have motions without strain: refused where a matrix is solved for. Two by two are kept
// from them by each other.
TEST(Statics, RowsOfReducedCellsAreRefused) {
  auto row = fem_test::box("hex20_reduced", {1, 0.25, 0.25, 4, 1, 1});
  row.supports = {{"x_min", {true, true, true}, ""}};
  const std::string message = message_of(statics(row));
  EXPECT_EQ(message.find("scene.toml:3: body \"box\": element = \"hex20_reduced\": cell 1 at (0.125, "), 0u) << message;
  EXPECT_NE(message.find("mesh two cells across, or choose \"hex20\""), std::string::npos) << message;
  row.mesh_parameters["cells_y"] = row.mesh_parameters["cells_z"] = 2;
  EXPECT_EQ(message_of(statics(row)), "no error");
}

// The small-strain limit of the form for turning bodies, in elements that turn with their mean rotation: rounding at
// their places, not at their small displacements, ends the iterations.
TEST(Statics, TurningFramesConverge) {
  for (const char* element : {"hex8_bbar", "hex8_incompatible", "hex8_one_point"}) {
    auto body = cantilever(element, 24, 2);
    const auto linear = fem::Model::create(MPI_COMM_SELF, statics(body));
    body.materials[0].law = "left_cauchy_green";
    const auto turning = fem::Model::create(MPI_COMM_SELF, statics(body));
    for (const auto& model : {linear.get(), turning.get()}) fem_test::step(*model, 1);
    const double expected = sag(*linear, "box", {2.4, 0, 0});
    EXPECT_NEAR(sag(*turning, "box", {2.4, 0, 0}), expected, 1e-3 * expected) << element;
  }
}

// A cube whose nodes are all led at a constant acceleration: what drives it is its mass times that.
TEST(Newmark, ReactionsOfDrivenNodesHaveInertia) {
  for (const auto kind : {fem::Solver::explicit_steps, fem::Solver::newmark}) {
    auto body = fem_test::box("hex8", {1, 1, 1, 1, 1, 1});
    body.motions = {{"shaker",
                     "solid",
                     fem::PrescribedMotion::Kind::displacement,
                     {true, false, false},
                     fem_test::history([](double t) { return 50 * t * t; }),
                     ""}};
    body.supports = {{"solid", {false, true, true}, ""}};
    fem::Setup setup{{body}, {}};
    setup.solver.kind = kind;
    const auto model = fem::Model::create(MPI_COMM_SELF, setup);
    for (int i = 0; i < 10; ++i) fem_test::step(*model, 1e-4);
    EXPECT_NEAR(model->reaction("box", "solid").x, 2350 * 100, 1e-4 * 2350 * 100);
  }
}

}  // namespace
