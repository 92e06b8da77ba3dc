// The energy ledger of central difference: every term is integrated, and what is left over is dt^2/8 sum m a^2, so it
// is bounded and shrinks with dt^2. Work taken with forces and ways of different instants gives a first-order, growing
// rest.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/fem_helper.hpp"

namespace {

using fem::Quantity;

testing::Environment* const petsc = testing::AddGlobalTestEnvironment(new fem_test::PetscEnvironment);

double rest(const base::Energy& energy) { return energy.stored() - energy.works() + energy.losses(); }

/// A clamped beam under a smooth load; returns the largest rest of the ledger over the work put in.
double largest_rest(double fraction, double damping) {
  auto body = fem_test::box("hex8", {1, 0.2, 0.2, 10, 2, 2});
  body.damping = damping;
  body.supports = {{"x_min", {true, true, true}, ""}};
  body.loads = {{"tip",
                 "x_max",
                 fem::LoadKind::face_total,
                 {0, 0, -1},
                 fem_test::history([](double t) { return 1e3 * std::sin(3e3 * t); }),
                 ""}};
  const auto model = fem::Model::create(MPI_COMM_SELF, {{body}, {}});
  const double dt = fraction * model->stable_step().limit;
  double largest = 0, work = 0;
  while (model->time() < 3e-3) {
    fem_test::step(*model, dt);
    const auto energy = model->energy();
    largest = std::max(largest, std::abs(rest(energy)));
    work = std::max(work, std::abs(energy.work_loads));
  }
  return largest / work;
}

TEST(FemEnergy, RestShrinksWithTheSquareOfTheStep) {
  const double coarse = largest_rest(0.8, 0), fine = largest_rest(0.4, 0);
  EXPECT_LT(coarse, 1e-3);
  EXPECT_NEAR(coarse / fine, 4, 0.5);
}

TEST(FemEnergy, DampingIsCounted) {
  const double coarse = largest_rest(0.8, 500), fine = largest_rest(0.4, 500);
  EXPECT_LT(coarse, 1e-3);
  EXPECT_NEAR(coarse / fine, 4, 0.5);
}

// A free body struck once keeps its energy: the mean over the last thousand steps is that over the first, to 1e-6.
TEST(FemEnergy, FreeBodyDoesNotDrift) {
  auto body = fem_test::box("hex8_bbar", {0.6, 0.2, 0.2, 3, 1, 1});
  body.loads = {{"strike",
                 "x_max",
                 fem::LoadKind::face_total,
                 {1, 0.5, -0.2},
                 fem_test::history([](double t) { return t < 2e-4 ? 1e4 * std::sin(t * 1.5707963e4) : 0.0; }),
                 ""}};
  const auto model = fem::Model::create(MPI_COMM_SELF, {{body}, {}});
  const double dt = 0.9 * model->stable_step().limit;
  while (model->time() < 2.5e-4) fem_test::step(*model, dt);
  const auto mean_energy = [&] {
    double sum = 0;
    for (int i = 0; i < 20000; ++i) {
      fem_test::step(*model, dt);
      sum += model->energy().stored() / 20000;
    }
    return sum;
  };
  const double first = mean_energy();
  for (int i = 0; i < 80000; ++i) fem_test::step(*model, dt);
  const double last = mean_energy();  // 100 000 steps later
  EXPECT_NEAR(last, first, 1e-6 * first);
  std::printf("drift over 100 000 steps: %.2e\n", last / first - 1);
}

// u = g t^2 / 2 is exact for this scheme: free fall strains nothing, and gravity's work is the kinetic energy.
TEST(FemEnergy, FreeFall) {
  auto body = fem_test::box("tet4", {0.6, 0.2, 0.2, 3, 1, 1});
  body.gravity = true;
  const auto model = fem::Model::create(MPI_COMM_SELF, {{body}, {0, 0, -9.81}});
  const double dt = 0.9 * model->stable_step().limit;
  for (int i = 0; i < 500; ++i) fem_test::step(*model, dt);
  const double t = model->time(), way = 0.5 * 9.81 * t * t;
  EXPECT_NEAR(model->probe_group("box", "solid", Quantity::displacement).z, -way, 1e-9 * way);
  const auto energy = model->energy();
  EXPECT_NEAR(energy.work_gravity, model->counts()[0].mass * 9.81 * way, 1e-9 * energy.work_gravity);
  EXPECT_NEAR(energy.kinetic, energy.work_gravity, 1e-9 * energy.work_gravity);
  EXPECT_LT(energy.strain, 1e-9 * energy.kinetic);
}

// Forces on the skin: total impulse becomes momentum, their work appears as interface work, and the state that a skin
// shows after predict() is that of the step's end, whose velocity the next correct() confirms when nothing accelerates.
TEST(FemEnergy, SkinForces) {
  auto body = fem_test::box("hex8", {0.6, 0.2, 0.2, 3, 1, 1});
  body.skin = {"z_max"};
  const auto model = fem::Model::create(MPI_COMM_SELF, {{body}, {}});
  const auto& skin = model->skins().at(0);
  EXPECT_EQ(skin.facets.size(), 3u);
  for (const auto& facet : skin.facets) {
    const auto normal =
        base::cross(skin.nodes[facet[1]] - skin.nodes[facet[0]], skin.nodes[facet[2]] - skin.nodes[facet[0]]);
    EXPECT_GT(normal.z, 0) << "outward means towards the grains";
  }
  const auto owned = model->owned_skin_nodes(0);
  const std::vector<base::Vec3> forces(owned.size(), {5, -2, -100});
  const double dt = 0.5 * model->stable_step().limit;
  const int steps = 400;
  std::vector<base::Vec3> places(owned.size()), velocities(owned.size());
  for (int i = 0; i < steps; ++i) {
    model->predict(dt);
    model->skin_state(0, places, velocities);
    model->set_skin_forces(0, forces);
    model->inner_forces();
    model->correct(dt);
  }
  // the first half step knew of no force: (steps - 1/2) dt of impulse
  const double impulse = -100.0 * static_cast<double>(owned.size()) * dt * (steps - 0.5);
  const auto energy = model->energy();
  EXPECT_LT(std::abs(rest(energy)), 0.02 * energy.work_interface);
  EXPECT_GT(energy.work_interface, 0);
  model->set_skin_forces(0, std::vector<base::Vec3>(owned.size()));
  // momentum = mass times velocity of the mass centre; nodes of a box cell by cell weigh as their lumped mass
  const double expected = impulse / model->counts()[0].mass;
  const auto mean = [&] { return model->probe_group("box", "solid", Quantity::velocity).z; };
  double sum = 0;
  for (int i = 0; i < 2000; ++i) {
    fem_test::step(*model, dt);
    sum += mean() / 2000;
  }
  EXPECT_NEAR(sum, expected, 0.02 * std::abs(expected));
}

// Held: at rest where it is, whatever acts on it; let go: it moves on from there.
TEST(FemEnergy, HoldAndLetGo) {
  auto body = fem_test::box("hex8", {0.6, 0.2, 0.2, 3, 1, 1});
  body.gravity = true;
  const auto model = fem::Model::create(MPI_COMM_SELF, {{body}, {0, 0, -9.81}});
  const double dt = 0.9 * model->stable_step().limit;
  for (int i = 0; i < 10; ++i) fem_test::step(*model, dt);
  const double before = model->probe_group("box", "solid", Quantity::displacement).z;
  model->hold("box", true);
  for (int i = 0; i < 10; ++i) fem_test::step(*model, dt);
  EXPECT_EQ(model->probe_group("box", "solid", Quantity::displacement).z, before);
  EXPECT_EQ(model->energy().kinetic, 0);
  EXPECT_NEAR(rest(model->energy()), 0, 1e-9 * model->energy().work_gravity);
  model->hold("box", false);
  model->set_displacement_zero();
  for (int i = 0; i < 10; ++i) fem_test::step(*model, dt);
  const double t = 10 * dt, way = 0.5 * 9.81 * t * t;
  EXPECT_NEAR(model->probe_group("box", "solid", Quantity::displacement).z, -way, 1e-9 * way);
}

}  // namespace
