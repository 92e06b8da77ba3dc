// Clumps in a simulation: a clump of one sphere moves as the sphere, a dumbbell falls, spins and collides as a rigid
// body.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "dem/dem.hpp"
#include "tests/dem_backend.hpp"

namespace {

using dem::Vec3;

dem::Setup setup_of(double friction, double restitution) {
  dem::Setup setup;
  setup.materials = {{"stone", 1e7, 0.25, 2500}};
  setup.interactions = {{friction, restitution, 0.05}};
  setup.gravity = {0, 0, -9.81};
  return setup;
}

dem::Clump dumbbell() {
  const std::array<dem::Sphere, 2> spheres{dem::Sphere{{-0.01, 0, 0}, 0.015}, dem::Sphere{{0.01, 0, 0}, 0.015}};
  return dem::make_clump(spheres);
}

std::vector<dem::Grain> heap(bool clumps, int lanes, base::Energy* energy) {
  auto setup = setup_of(0.5, 0.6);
  setup.lanes = lanes;
  const auto sim = dem_test::create(setup);
  const std::array<dem::Sphere, 1> one{dem::Sphere{{0.1, 0.2, 0.3}, 0.01}};
  if (clumps) sim->add_shape(dem::make_clump(one));
  sim->add_plane({{0, 0, 0}, {0.1, 0, 1}}, 0);
  std::vector<dem::Grain> grains;
  for (int k = 0; k < 40; ++k)
    grains.push_back({.position = {0.021 * (k % 3), 0.026 * (k / 3 % 3) + 0.001 * (k % 7), 0.03 + 0.022 * (k / 9)},
                      .radius = 0.01 + 0.0001 * (k % 5),
                      .velocity = {0.1 * (k % 4), 0, -0.5},
                      .angular_velocity = {0, 3.0 * (k % 2), 1},
                      .id = 100 - k,
                      .shape = clumps ? 0 : -1});
  sim->add_grains(grains);
  sim->advance(1500, 2e-5);
  *energy = sim->energy();
  EXPECT_GT(energy->loss_contact_damping, 0.005 * energy->kinetic);
  return sim->grains();
}

// A body of one sphere has no other physics than the sphere; only roundings differ (its rotation goes through a
// quaternion). Wrong mass, inertia or a torque about another point changes the heap at once.
TEST(DemClumpMotion, ClumpOfOneSphereIsTheSphere) {
  for (const int lanes : {0, 1}) {
    base::Energy a, b;
    const auto spheres = heap(false, lanes, &a), clumps = heap(true, lanes, &b);
    for (std::size_t k = 0; k < spheres.size(); ++k) {
      EXPECT_LT(norm(spheres[k].position - clumps[k].position), 1e-12) << k;
      EXPECT_LT(norm(spheres[k].velocity - clumps[k].velocity), 1e-10) << k;
      EXPECT_LT(norm(spheres[k].angular_velocity - clumps[k].angular_velocity), 1e-8) << k;
    }
    EXPECT_NEAR(a.kinetic, b.kinetic, 1e-10);
    EXPECT_NEAR(a.loss_friction, b.loss_friction, 1e-10);
    EXPECT_NEAR(a.loss_rolling, b.loss_rolling, 1e-10);
    EXPECT_NEAR(a.work_gravity, b.work_gravity, 1e-10);
  }
}

// Without torque the centre falls on a parabola, and spin about a principal axis stays.
TEST(DemClumpMotion, FreeFlightKeepsSpin) {
  const auto sim = dem_test::create(setup_of(0.5, 0.6));
  const auto shape = dumbbell();
  sim->add_shape(shape);
  sim->add_grains(std::vector<dem::Grain>{{.position = {0, 0, 1},
                                           .radius = shape.reach,
                                           .velocity = {1, 0, 0},
                                           .angular_velocity = {0, 0, 20},
                                           .id = 1,
                                           .shape = 0}});
  sim->advance(1000, 1e-5);
  const auto g = sim->grains()[0];
  EXPECT_NEAR(g.position.x, 0.01, 1e-14);
  EXPECT_NEAR(g.position.z, 1 - 0.5 * 9.81 * 1e-4, 1e-13);
  EXPECT_NEAR(g.angular_velocity.z, 20, 1e-11);
  EXPECT_NEAR(2 * std::atan2(g.orientation.z, g.orientation.w), 0.2, 1e-10);  // 20 rad/s for 10 ms
  // Spheres follow: 0.01 m from the centre, turned by 0.2 rad.
  const auto spheres = sim->spheres();
  ASSERT_EQ(spheres.size(), 2u);
  const Vec3 arm = spheres[1].position - g.position;
  EXPECT_NEAR(std::abs(arm.x), 0.01 * std::cos(0.2), 1e-9);
  EXPECT_NEAR(std::abs(arm.y), 0.01 * std::sin(0.2), 1e-9);
}

// Rigid-body impact: one end of a dumbbell on the floor, elastic, no friction. With the impulse J at the lever d from
// the centre, v' = v + J/m, omega' = J d / I, and the contact point rebounds with its own speed: J = 2 v / (1/m +
// d^2/I). The sum of two spheres' masses instead of the union's gives another I and another split.
TEST(DemClumpMotion, ObliqueRebound) {
  auto setup = setup_of(0, 1);
  setup.materials[0].young_modulus = 1e10;  // a contact of 0.3 ms, during which it hardly turns
  setup.gravity = {};
  setup.interactions[0].rolling_friction = 0;
  const auto sim = dem_test::create(setup);
  const auto shape = dumbbell();
  sim->add_shape(shape);
  sim->add_plane({{0, 0, 0}, {0, 0, 1}}, 0);
  const double tilt = 0.5;  // [rad] about y: the far end is higher
  const double height = 0.01 * std::sin(tilt) + 0.015;
  sim->add_grains(std::vector<dem::Grain>{{.position = {0, 0, height + 1e-6},
                                           .radius = shape.reach,
                                           .velocity = {0, 0, -0.1},
                                           .id = 1,
                                           .shape = 0,
                                           .orientation = {std::cos(tilt / 2), 0, std::sin(tilt / 2), 0}}});
  sim->advance(20000, 1e-7);
  ASSERT_EQ(sim->counts().wall_contacts, 0);
  const double lever = 0.01 * std::cos(tilt), inverse_mass = 1 / (2500 * shape.volume);
  const double inverse_inertia = inverse_mass / shape.inertia.z;  // across the axis: both larger moments are equal
  const double impulse = 2 * 0.1 / (inverse_mass + lever * lever * inverse_inertia);
  const auto g = sim->grains()[0];
  EXPECT_NEAR(g.velocity.z, -0.1 + impulse * inverse_mass, 2e-4);
  EXPECT_NEAR(std::abs(g.angular_velocity.y), impulse * lever * inverse_inertia, 2e-2);
  EXPECT_NEAR(sim->energy().kinetic, 0.5 * 0.01 / inverse_mass, 1e-6 * 0.005 / inverse_mass);
}

// Stored + lost = stored at the start + worked, with all that loses energy, while lists are rebuilt, a clump is taken
// out and another added: a ledger row that does not follow its body breaks the sum.
double ledger_error(double step) {
  auto setup = setup_of(0.5, 0.6);
  setup.skin = 2e-4;
  const auto sim = dem_test::create(setup);
  const auto shape = dumbbell();
  sim->add_shape(shape);
  sim->add_plane({{0, 0, 0}, {0.2, 0, 1}}, 0);
  sim->set_grain_damping(0.5);
  std::vector<dem::Grain> grains;
  for (int k = 0; k < 12; ++k)
    grains.push_back({.position = {0.06 * (k % 3), 0.06 * (k / 3 % 2), 0.05 + 0.06 * (k / 6)},
                      .radius = shape.reach,
                      .velocity = {0.1 * (k % 4), 0, -0.5},
                      .angular_velocity = {4.0 * (k % 3), 3.0 * (k % 2), 1},
                      .id = 100 - k,
                      .shape = 0,
                      .orientation = {0.8, 0.1 * k, 0.5, -0.3}});
  sim->add_grains(grains);
  sim->advance(0, step);
  const double start = sim->energy().stored();
  sim->advance(static_cast<int>(0.1 / step), step);
  EXPECT_GT(sim->counts().rebuilds, 5);
  const auto e = sim->energy();
  EXPECT_GT(e.loss_rolling, 0);
  EXPECT_GT(e.loss_friction, 0);
  return std::abs(e.stored() + e.losses() - start - e.works()) / start;
}

TEST(DemClumpMotion, LedgerCloses) {
  const double coarse = ledger_error(2e-5), fine = ledger_error(5e-6);
  EXPECT_LT(coarse, 1e-3);
  EXPECT_LT(fine, 0.3 * coarse);
}

}  // namespace
