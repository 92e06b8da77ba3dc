// Absorbing boundaries, prescribed motion, pressure and stiffness-proportional damping against one-dimensional waves
// and exact motions.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/fem_helper.hpp"

namespace {

using base::Vec3;
using fem::Quantity;

testing::Environment* const petsc = testing::AddGlobalTestEnvironment(new fem_test::PetscEnvironment);

/// Largest speed that comes back to the struck end of a column of concrete, over that of the pulse: sigma / (rho c).
double reflected(const std::string& element, bool shear, bool absorbing) {
  constexpr double density = 2350, length = 10;
  const double c = shear ? std::sqrt(45e9 / (2 * 1.167) / density) : fem_test::compression_wave_speed();
  const double duration = 2.0 / c, stress = 1e4;  // the pulse is 2 m long: 20 cells
  auto body = fem_test::box(element, {length, 0.1, 0.1, 100, 1, 1});
  body.supports = {{"solid", shear ? std::array{true, true, false} : std::array{false, true, true}, ""}};
  if (absorbing) body.absorbing = {{"x_max", ""}};
  body.loads = {{"strike", "x_min", fem::LoadKind::traction, shear ? Vec3{0, 0, 1} : Vec3{1, 0, 0},
                 fem_test::history([=](double t) {
                   const double s = std::sin(std::numbers::pi * t / duration);
                   return t < duration ? stress * s * s : 0.0;
                 }),
                 ""}};
  const auto model = fem::Model::create(MPI_COMM_SELF, {{body}, {}});
  const double dt = 0.9 * model->stable_step().limit;
  double back = 0;
  while (model->time() < (2 * length + 2) / c) {
    fem_test::step(*model, dt);
    // the pulse has left this end; ripples behind it and what comes back remain
    if (model->time() > (length + 2) / c)
      back = std::max(back, base::norm(model->probe_group("box", "x_min", Quantity::velocity)));
  }
  return back / (2 * stress / (density * c));  // at a free end the velocity doubles
}

// Dashpots rho c_p and rho c_s let plane waves out (Lysmer & Kuhlemeyer 1969). Without them all of the pulse comes
// back.
TEST(FemAbsorbing, WavesLeave) {
  EXPECT_LT(reflected("hex8", false, true), 0.02);
  EXPECT_LT(reflected("hex8", true, true), 0.02);
  EXPECT_LT(reflected("hex20_reduced", false, true), 0.02);
  EXPECT_GT(reflected("hex8", false, false), 0.45);
}

double rest(const base::Energy& e) { return e.stored() - e.works() + e.losses(); }

// A free body whose end is led: the end is where the history says, the ledger closes, and shrinks with the square of
// the step; an absorbing side and mass damping are in it.
TEST(FemMotion, LedEndFollowsAndTheLedgerCloses) {
  double largest[2] = {0, 0}, work = 0;
  for (const bool fine : {false, true}) {
    auto body = fem_test::box("hex8", {1, 0.2, 0.2, 10, 2, 2});
    body.damping = 200;
    body.absorbing = {{"x_max", ""}};
    const auto wave = [](double t) { return 1e-4 * (1 - std::cos(3e3 * t)); };
    body.motions = {{"shake",
                     "x_min",
                     fem::PrescribedMotion::Kind::displacement,
                     {true, false, true},
                     fem_test::history(wave),
                     ""}};
    const auto model = fem::Model::create(MPI_COMM_SELF, {{body}, {}});
    const double dt = fine ? 5e-6 : 1e-5;
    for (int i = 0; i < (fine ? 400 : 200); ++i) {
      fem_test::step(*model, dt);
      const auto u = model->probe_group("box", "x_min", Quantity::displacement);
      ASSERT_NEAR(u.x, wave(model->time()), 1e-15);
      ASSERT_NEAR(u.z, wave(model->time()), 1e-15);
      const auto energy = model->energy();
      largest[fine] = std::max(largest[fine], std::abs(rest(energy)));
      work = std::max(work, std::abs(energy.work_loads));
    }
    const double t = model->time();
    EXPECT_NEAR(model->probe_group("box", "x_min", Quantity::velocity).x, 0.3 * std::sin(3e3 * t), 1e-4);
    EXPECT_NEAR(model->load_value("shake"), wave(t), 1e-18);
  }
  EXPECT_LT(largest[0], 2e-3 * work);
  EXPECT_NEAR(largest[0] / largest[1], 4, 0.6);
}

// Led at a constant velocity all over, a body moves without strain: u = v t.
TEST(FemMotion, VelocityIsIntegrated) {
  auto body = fem_test::box("tet10", {1, 0.2, 0.2, 2, 1, 1});
  body.motions = {{"pull",
                   "x_min",
                   fem::PrescribedMotion::Kind::velocity,
                   {true, true, true},
                   fem_test::history([](double) { return 0.5; }),
                   ""}};
  const auto model = fem::Model::create(MPI_COMM_SELF, {{body}, {}});
  const double dt = 0.9 * model->stable_step().limit;
  for (int i = 0; i < 100; ++i) fem_test::step(*model, dt);
  const auto u = model->probe_group("box", "x_min", Quantity::displacement);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(u[c], 0.5 * model->time(), 1e-12);
}

// A pressure on a plane face is a traction against its normal; on the whole outside of a body it moves it nowhere and
// compresses it by 3 p / (3 K) along each edge, on average over the ringing.
TEST(FemPressure, OnAFaceAndAllRound) {
  for (const char* element : {"hex8", "tet10", "hex20"}) {
    Vec3 end[2];
    for (const bool pressure : {false, true}) {
      auto body = fem_test::box(element, {1, 0.4, 0.4, 4, 2, 2});
      body.loads = {{"press",
                     "x_max",
                     pressure ? fem::LoadKind::pressure : fem::LoadKind::traction,
                     {-1, 0, 0},
                     fem_test::history([](double) { return 1e5; }),
                     ""}};
      const auto model = fem::Model::create(MPI_COMM_SELF, {{body}, {}});
      for (int i = 0; i < 50; ++i) fem_test::step(*model, 1e-6);
      end[pressure] = model->probe_group("box", "x_max", Quantity::displacement);
    }
    EXPECT_LT(end[0].x, 0);
    EXPECT_NEAR(end[1].x, end[0].x, 1e-9 * std::abs(end[0].x)) << element;
    auto body = fem_test::box(element, {1, 0.4, 0.4, 4, 2, 2});
    for (const char* face : {"x_min", "x_max", "y_min", "y_max", "z_min", "z_max"})
      body.loads.push_back(
          {face, face, fem::LoadKind::pressure, {}, fem_test::history([](double) { return 1e5; }), ""});
    const auto model = fem::Model::create(MPI_COMM_SELF, {{body}, {}});
    double length = 0;
    const int steps = 1000;
    for (int i = 0; i < steps; ++i) {
      fem_test::step(*model, 1e-6);
      const double left = model->probe_group("box", "x_min", Quantity::displacement).x;
      const double right = model->probe_group("box", "x_max", Quantity::displacement).x;
      EXPECT_NEAR(left, -right, 1e-12);
      length += (right - left) / steps;
    }
    EXPECT_NEAR(length, -1e5 * (1 - 2 * 0.167) / 45e9, 0.1 * 1e5 / 45e9) << element;
  }
}

// beta K as viscosity: the same steps as with beta mu and beta (lambda + 2/3 mu) written out.
TEST(FemStiffnessDamping, IsViscosityInProportion) {
  constexpr double beta = 1e-6, mu = 45e9 / (2 * 1.167), lambda = 45e9 * 0.167 / (1.167 * (1 - 2 * 0.167));
  Vec3 tip[2];
  for (const bool written_out : {false, true}) {
    auto body = fem_test::box("hex8_incompatible", {1, 0.2, 0.2, 5, 2, 2});
    if (written_out) {
      body.materials[0].law = "kelvin_voigt";
      body.materials[0].shear_viscosity = beta * mu;
      body.materials[0].bulk_viscosity = beta * (lambda + 2.0 / 3.0 * mu);
    } else {
      body.stiffness_damping = beta;
    }
    body.supports = {{"x_min", {true, true, true}, ""}};
    body.loads = {
        {"tip", "x_max", fem::LoadKind::face_total, {0, 0, -1}, fem_test::history([](double) { return 100; }), ""}};
    const auto model = fem::Model::create(MPI_COMM_SELF, {{body}, {}});
    for (int i = 0; i < 200; ++i) fem_test::step(*model, 5e-6);
    tip[written_out] = model->probe_group("box", "x_max", Quantity::displacement);
  }
  EXPECT_NEAR(tip[1].z, tip[0].z, 1e-12 * std::abs(tip[0].z));
}

// Skins of second-order elements: faces with their middles, and plane parts through the middles. Their area is the
// face's, they look outwards, and forces on their nodes arrive whole.
TEST(FemSkins, OfTheSecondOrder) {
  for (const char* element : {"tet10", "hex20"}) {
    auto body = fem_test::box(element, {0.6, 0.2, 0.2, 3, 1, 1});
    body.skin = {"z_max"};
    const auto model = fem::Model::create(MPI_COMM_SELF, {{body}, {}});
    const auto& skin = model->skins().at(0);
    EXPECT_EQ(skin.facets.size(), std::string(element) == "hex20" ? 15u : 24u);
    double area = 0;
    for (const auto& f : skin.facets) {
      const auto a = skin.nodes[f[0]];
      auto normal = base::cross(skin.nodes[f[1]] - a, skin.nodes[f[2]] - a) * 0.5;
      if (f[3] >= 0) normal += base::cross(skin.nodes[f[2]] - a, skin.nodes[f[3]] - a) * 0.5;
      EXPECT_GT(normal.z, 0);
      area += normal.z;
    }
    EXPECT_NEAR(area, 0.12, 1e-12);
    const int corners = std::string(element) == "hex20" ? 4 : 3;
    EXPECT_EQ(skin.faces.size(), corners == 4 ? 3u : 6u);
    for (const auto& face : skin.faces) {
      for (int a = 0; a < corners; ++a) {
        const auto middle = (skin.nodes[face[a]] + skin.nodes[face[(a + 1) % corners]]) * 0.5;
        EXPECT_LT(base::norm(skin.nodes[face[corners + a]] - middle), 1e-12);
      }
    }
    ASSERT_EQ(skin.face_of.size(), skin.facets.size());
    for (std::size_t f = 0; f < skin.facets.size(); ++f) {
      const auto& face = skin.faces.at(skin.face_of[f]);
      for (const int node : skin.facets[f])
        EXPECT_TRUE(node < 0 || std::find(face.begin(), face.end(), node) != face.end());
    }
    model->set_skin_forces(0, std::vector<Vec3>(model->owned_skin_nodes(0).size(), {0, 0, -100}));
    const double dt = 0.5 * model->stable_step().limit;
    for (int i = 0; i < 20; ++i) fem_test::step(*model, dt);
    EXPECT_LT(model->probe_group("box", "z_max", Quantity::velocity).z, 0);
    EXPECT_LT(std::abs(rest(model->energy())), 0.05 * model->energy().work_interface);
  }
}

}  // namespace
