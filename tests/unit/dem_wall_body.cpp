// Walls that are rigid bodies: free fall, a guided plate that holds a force, and the impact of a free bar.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/error.hpp"
#include "dem/dem.hpp"
#include "tests/dem_backend.hpp"

namespace {

using dem::Vec3;

dem::Setup setup_of(double friction, double restitution) {
  dem::Setup setup;
  setup.materials = {{"stone", 1e8, 0.25, 2500}};
  setup.interactions = {{friction, restitution, 0}};
  setup.gravity = {0, 0, -9.81};
  return setup;
}

base::Skin plate(double half_length, double half_width, double height) {
  base::Skin skin;
  skin.nodes = {{-half_length, -half_width, height},
                {-half_length, half_width, height},
                {half_length, half_width, height},
                {half_length, -half_width, height}};
  skin.facets = {{0, 1, 2, 3}};  // its normal points down
  return skin;
}

TEST(DemWallBody, FallsFreelyWhereItMay) {
  const auto sim = dem_test::create(setup_of(0.5, 0.5));
  const int wall = sim->add_mesh(plate(0.1, 0.1, 1), 0, true);
  sim->set_wall_body(wall, {.centre = {0, 0, 1}, .mass = 3, .moves = {true, false, true}});
  sim->set_wall_load(wall, {6, 5, 0}, {});
  sim->advance(1000, 1e-4);
  const auto body = sim->wall_body(wall);
  EXPECT_NEAR(body.centre.x, 0.5 * 2 * 0.01, 1e-14);
  EXPECT_EQ(body.centre.y, 0);
  EXPECT_NEAR(body.centre.z, 1 - 0.5 * 9.81 * 0.01, 1e-13);
  EXPECT_NEAR(body.velocity.z, -0.981, 1e-13);
  const auto e = sim->energy();
  EXPECT_NEAR(e.kinetic, 1.5 * (0.981 * 0.981 + 0.2 * 0.2), 1e-12);
  EXPECT_NEAR(e.work_gravity, 1.5 * 0.981 * 0.981, 1e-12);
  EXPECT_NEAR(e.work_loads, 1.5 * 0.04, 1e-12);
}

// A plate without weight pressed on one sphere with F: Hertz's overlap on both sides, (3 F / 4 E* sqrt(R))^(2/3) above
// and with the sphere's weight more below.
TEST(DemWallBody, GuidedPlateHoldsItsForce) {
  const auto sim = dem_test::create(setup_of(0.5, 0.3));
  const double radius = 0.02, force = 20;
  sim->add_plane({{0, 0, 0}, {0, 0, 1}}, 0);
  sim->add_grains(std::vector<dem::Grain>{{.position = {0, 0, radius}, .radius = radius, .id = 1}});
  const int wall = sim->add_mesh(plate(0.1, 0.1, 2 * radius), 0, false);
  sim->set_wall_body(
      wall, {.centre = {0, 0, 2 * radius}, .mass = 0.1, .moves = {false, false, true}, .weighs = false, .damping = 50});
  sim->set_wall_load(wall, {0, 0, -force}, {});
  sim->advance(40000, 1e-5);
  const double modulus = 1 / (2 * (1 - 0.25 * 0.25) / 1e8);
  const double weight = 2500 * 4.0 / 3.0 * std::numbers::pi * std::pow(radius, 3) * 9.81;
  const auto overlap = [&](double f) { return std::pow(0.75 * f / (modulus * std::sqrt(radius)), 2.0 / 3.0); };
  const auto body = sim->wall_body(wall);
  EXPECT_NEAR(body.contact_force.z, force, 1e-6 * force);
  EXPECT_NEAR(body.centre.z, 2 * radius - overlap(force) - overlap(force + weight), 1e-9);
  const auto e = sim->energy();
  EXPECT_NEAR(e.stored() + e.losses(), e.works(), 1e-3 * e.works());
}

// A free bar falls with its end on a free sphere, elastic, without friction or gravity. Impulse along z at the lever d:
// J = (1 + e) v / (1/M + 1/m + d^2/I); the sphere leaves with J/m, the bar turns with J d / I.
TEST(DemWallBody, FreeBarStrikesWithItsEnd) {
  auto setup = setup_of(0, 1);
  setup.materials[0].young_modulus = 1e10;
  setup.gravity = {};
  const auto sim = dem_test::create(setup);
  const double radius = 0.02, lever = 0.08, mass = 0.5, inertia = 2e-3, drop = 1e-6;
  sim->add_grains(
      std::vector<dem::Grain>{{.position = {lever, 0, 0}, .radius = radius, .velocity = {0, 0, 0.1}, .id = 1}});
  const int wall = sim->add_mesh(plate(0.1, 0.1, radius + drop), 0, false);
  sim->set_wall_body(wall, {.centre = {0, 0, radius + drop},
                            .mass = mass,
                            .inertia = {inertia, inertia, inertia},
                            .moves = {true, true, true},
                            .turns = {true, true, true}});
  sim->advance(20000, 1e-7);
  ASSERT_EQ(sim->counts().wall_contacts, 0);
  const double sphere = 2500 * 4.0 / 3.0 * std::numbers::pi * std::pow(radius, 3);
  const double impulse = 2 * 0.1 / (1 / mass + 1 / sphere + lever * lever / inertia);
  const auto body = sim->wall_body(wall);
  EXPECT_NEAR(body.velocity.z, impulse / mass, 1e-4 * impulse / mass);
  EXPECT_NEAR(body.angular_velocity.y, -impulse * lever / inertia, 1e-4 * impulse * lever / inertia);
  EXPECT_NEAR(sim->grains()[0].velocity.z, 0.1 - impulse / sphere, 1e-4 * impulse / sphere);
  EXPECT_NEAR(sim->energy().kinetic, 0.5 * sphere * 0.01, 1e-6 * sphere * 0.005);
}

// A plate that is pressed with F on three spheres fixed in a row by friction and drawn sideways: it keeps its speed,
// each of the spheres rolls or slides, and at last mu F holds it back. The drive's work is in the ledger.
TEST(DemWallBody, DrivenPlateSlidesUnderItsLoad) {
  auto setup = setup_of(0.4, 0.3);
  setup.rotations = false;
  const auto sim = dem_test::create(setup);
  const double radius = 0.02, force = 30, speed = 0.05, mass = 0.5;
  sim->add_plane({{0, 0, 0}, {0, 0, 1}}, 0);
  for (int side : {-1, 1}) {
    const double s = side;
    sim->add_plane({{0.2 * s, 0, 0}, {-s, 0, 0}}, 0);
  }
  std::vector<dem::Grain> grains;
  for (int k = 0; k < 10; ++k) grains.push_back({.position = {-0.18 + 0.04 * k, 0, radius}, .radius = radius, .id = k});
  sim->add_grains(grains);
  const int wall = sim->add_mesh(plate(0.5, 0.1, 2 * radius), 0, false);
  sim->set_wall_body(
      wall,
      {.centre = {0, 0, 2 * radius}, .mass = mass, .moves = {false, false, true}, .weighs = false, .damping = 20});
  sim->set_wall_load(wall, {0, 0, -force}, {});
  sim->set_wall_velocity(wall, {speed, 0, 0});
  sim->advance(12000, 1e-5);
  const auto body = sim->wall_body(wall);
  EXPECT_DOUBLE_EQ(sim->wall_velocity(wall).x, speed);
  EXPECT_NEAR(sim->wall_displacement(wall).x, speed * 0.12, 1e-12);
  EXPECT_NEAR(body.contact_force.z, force, 1e-3 * force);
  EXPECT_NEAR(body.contact_force.x, -0.4 * force, 2e-3 * force);
  const auto e = sim->energy();
  // It slides nearly all the way: work = mu F s + what it took to set the plate moving, within what the springs hold.
  EXPECT_NEAR(e.work_walls, 0.4 * force * speed * 0.12 + 0.5 * mass * speed * speed, 0.05 * 0.4 * force * speed * 0.12);
  EXPECT_NEAR(e.stored() + e.losses() - e.works(), 0, 1e-4 * e.work_walls);
}

// Two springs in a row under a plate that is taken away: what they held leaves the ledger as work of the wall.
TEST(DemWallBody, RemovedWallTakesItsEnergyAlong) {
  auto setup = setup_of(0.4, 1);
  setup.gravity = {};
  const auto sim = dem_test::create(setup);
  const double radius = 0.02;
  sim->add_plane({{0, 0, 0}, {0, 0, 1}}, 0);
  const int lid = sim->add_plane({{0, 0, 2 * radius - 4e-6}, {0, 0, -1}}, 0);
  sim->add_grains(std::vector<dem::Grain>{{.position = {0, 0, radius - 2e-6}, .radius = radius, .id = 1}});
  sim->advance(0, 1e-6);
  sim->reset_energy();
  const auto before = sim->energy();
  ASSERT_GT(before.elastic_normal, 0);
  sim->remove_wall(lid);
  sim->advance(2000, 1e-6);
  const auto after = sim->energy();
  EXPECT_NEAR(after.work_walls, -0.5 * before.elastic_normal, 1e-9 * before.elastic_normal);
  EXPECT_NEAR(after.kinetic + after.elastic_normal, 0.5 * before.elastic_normal, 1e-4 * before.elastic_normal);
}

// A grain flies, a body flies far from it until the lists are about to be made anew, and is taken away. From then on
// lists are made as often as for the grain alone; a way of the body that is kept for good would be missing from what
// the grain may go, and make them several times as often.
TEST(DemWallBody, RemovedBodyLeavesTheListsAlone) {
  auto setup = setup_of(0, 1);
  setup.gravity = {};
  const double speed = 1, dt = 1e-5;
  const auto rebuilds = [&](bool with_body) {
    const auto sim = dem_test::create(setup);
    const int wall = sim->add_mesh(plate(0.1, 0.1, 5), 0, true);
    sim->add_grains(std::vector<dem::Grain>{{.position = {0, 0, 0}, .radius = 0.02, .id = 1}});
    if (with_body) {
      sim->set_wall_body(wall, {.centre = {0, 0, 5}, .mass = 1, .moves = {false, false, false}});
      sim->set_wall_velocity(wall, {0, 0, speed});
      sim->advance(0, dt);
      const auto first = sim->counts().rebuilds;
      int steps = 0;  // from one list to the next
      for (; sim->counts().rebuilds == first; ++steps) sim->advance(1, dt);
      sim->advance(static_cast<int>(0.9 * steps), dt);
      EXPECT_EQ(sim->counts().rebuilds, first + 1);
    }
    sim->remove_wall(wall);
    sim->add_grains(
        std::vector<dem::Grain>{{.position = {0, 1, 0}, .radius = 0.02, .velocity = {speed, 0, 0}, .id = 2}});
    sim->advance(0, dt);
    const auto before = sim->counts().rebuilds;
    sim->advance(20000, dt);
    return sim->counts().rebuilds - before;
  };
  const auto alone = rebuilds(false);
  EXPECT_GT(alone, 5);
  EXPECT_EQ(rebuilds(true), alone);
}

// A light plate on a sphere on the floor, frictionless: springs k below and k' above, masses m and M. The bound must
// lie below the exact limit 2 / omega_max of the two, and not far below.
TEST(DemWallBody, LightPlateLimitsTheStep) {
  auto setup = setup_of(0, 1);
  setup.gravity = {};
  setup.rotations = false;
  const double radius = 0.02, overlap = 1e-6, plate_mass = 0.005;
  const auto sim = dem_test::create(setup);
  sim->add_plane({{0, 0, 0}, {0, 0, 1}}, 0);
  sim->add_grains(std::vector<dem::Grain>{{.position = {0, 0, radius - overlap}, .radius = radius, .id = 1}});
  const int wall = sim->add_mesh(plate(0.1, 0.1, 2 * radius - 2 * overlap), 0, false);
  sim->set_wall_body(wall, {.centre = {0, 0, 2 * radius}, .mass = plate_mass, .moves = {false, false, true}});
  sim->advance(0, 1e-6);
  const double grain_mass = 2500 * 4.0 / 3 * std::numbers::pi * radius * radius * radius;
  const double stiffness = 2 * (1e8 / (2 * (1 - 0.25 * 0.25))) * std::sqrt(radius * overlap);
  const double a = 2 * stiffness / grain_mass, d = stiffness / plate_mass,
               bc = stiffness * stiffness / (grain_mass * plate_mass);
  const double omega2 = 0.5 * (a + d) + std::sqrt(0.25 * (a - d) * (a - d) + bc);
  const auto step = sim->contact_stable_step();
  EXPECT_LT(step.limit, 2 / std::sqrt(omega2));
  EXPECT_GT(step.limit, 0.6 * 2 / std::sqrt(omega2));
  EXPECT_NE(step.limiter.find("of a wall that moves as a body"), std::string::npos) << step.limiter;
}

TEST(DemWallBody, RefusesWhatCannotMove) {
  const auto sim = dem_test::create(setup_of(0, 1));
  const int plane = sim->add_plane({{0, 0, 0}, {0, 0, 1}}, 0), mesh = sim->add_mesh(plate(1, 1, 1), 0, false);
  const auto text = [&](int wall, const dem::WallBody& body) -> std::string {
    try {
      sim->set_wall_body(wall, body);
    } catch (const base::UserError& e) {
      return e.what();
    }
    return "accepted";
  };
  EXPECT_NE(text(mesh, {}).find("needs a mass > 0"), std::string::npos);
  EXPECT_NE(text(mesh, {.mass = 1, .turns = {true, false, false}}).find("moment of inertia > 0"), std::string::npos);
  EXPECT_NE(text(plane, {.mass = 1}).find("a plane cannot be a body"), std::string::npos);
}

}  // namespace
