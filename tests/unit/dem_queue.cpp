// Contacts taken one by one, as on a GPU: a window of steps is queued at once and decides by itself where it stops. It
// must do what the same steps do when the host looks at each of them, and what the sweep does.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "base/error.hpp"
#include "dem/dem.hpp"
#include "tests/dem_backend.hpp"

namespace {

using dem::Vec3;

constexpr double step = 1e-4;  // [s]

dem::Setup setup_of(int lanes) {
  dem::Setup setup;
  setup.materials = {{"stone", 1e7, 0.25, 2500}};
  setup.interactions = {{.friction = 0.5, .restitution = 0.7, .rolling_friction = 0.1}};
  setup.gravity = {0, 0, -9.81};
  setup.lanes = lanes;
  return setup;
}

std::vector<dem::Grain> falling(int number) {
  std::vector<dem::Grain> grains;
  for (int k = 0; k < number; ++k) {
    const double odd = std::sin(12.9898 * k);
    grains.push_back({.position = {0.042 * (k % 4) + 0.002 * odd, 0.042 * (k / 4 % 4), 0.022 + 0.043 * (k / 16)},
                      .radius = 0.019 + 0.001 * odd,
                      .velocity = {0.3 * odd, 0.2 - 0.1 * (k % 3), -0.5},
                      .id = 3 * k});
  }
  return grains;
}

base::Skin sheet(double height) {
  base::Skin skin;
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i) skin.nodes.push_back({-0.1 + 0.12 * i, -0.1 + 0.12 * j, height});
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 3; ++i) {
      const int a = 4 * j + i;
      skin.facets.push_back({a, a + 1, a + 5, a + 4});
    }
  return skin;
}

void expect_same_bits(const dem::Simulation& one, const dem::Simulation& other) {
  const auto a = one.grains(), b = other.grains();
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t k = 0; k < a.size(); ++k)
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(a[k].position[axis], b[k].position[axis]) << a[k].id;
      EXPECT_EQ(a[k].velocity[axis], b[k].velocity[axis]) << a[k].id;
      EXPECT_EQ(a[k].angular_velocity[axis], b[k].angular_velocity[axis]) << a[k].id;
    }
  EXPECT_EQ(one.counts().rebuilds, other.counts().rebuilds);
  EXPECT_EQ(one.counts().steps, other.counts().steps);
  const auto e = one.energy(), f = other.energy();
  EXPECT_EQ(e.kinetic, f.kinetic);
  EXPECT_NEAR(e.loss_friction, f.loss_friction, 1e-12 * e.loss_friction);
  EXPECT_NEAR(e.work_walls, f.work_walls, 1e-12 * std::fabs(e.work_walls));
}

/// `total` steps in windows of `length`.
void advance(dem::Simulation& sim, int total, int length) {
  for (int done = 0; done < total; done += length) sim.advance(std::min(length, total - done), step);
}

// Lists become stale in the middle of a window (more builds than windows). A queue that did the rest of a stale step
// twice, left it out, or went on beyond it differs in the last digits at once.
TEST(DemQueue, WindowsEqualSingleSteps) {
  const auto run = [](int length) {
    auto sim = dem_test::create(setup_of(1));
    sim->add_plane({{0, 0, 0}, {0, 0, 1}}, 0);
    sim->set_wall_velocity(sim->add_plane({{-0.03, 0, 0}, {1, 0, 0}}, 0), {0.4, 0, 0});
    sim->add_grains(falling(64));
    advance(*sim, 500, length);
    return sim;
  };
  const auto single = run(1), few = run(3), many = run(77), all = run(500);
  ASSERT_GT(all->counts().rebuilds, 8);
  ASSERT_GT(all->counts().contacts, 10);
  for (const auto* other : {&few, &many, &all}) expect_same_bits(*single, **other);
}

// The same where the wall is a body that falls on the grains, turns and is held up by them.
TEST(DemQueue, WallBodyMovesWithinTheWindow) {
  const auto run = [](int length, int lanes) {
    auto sim = dem_test::create(setup_of(lanes));
    sim->add_plane({{0, 0, 0}, {0, 0, 1}}, 0);
    sim->add_grains(falling(32));
    const int wall = sim->add_mesh(sheet(0.1), 0, true);
    sim->set_wall_body(wall, {.centre = {0.08, 0.08, 0.1},
                              .mass = 2,
                              .inertia = {0.02, 0.02, 0.04},
                              .moves = {true, true, true},
                              .turns = {true, true, true},
                              .damping = 2});
    sim->set_wall_load(wall, {0, 0, -30}, {0.1, 0, 0});
    advance(*sim, 900, length);
    return std::pair{std::move(sim), wall};
  };
  const auto [single, wall] = run(1, 1);
  const auto [window, same] = run(450, 1);
  const auto [swept, again] = run(450, 2);
  expect_same_bits(*single, *window);
  const auto a = single->wall_body(wall), b = window->wall_body(same), c = swept->wall_body(again);
  ASSERT_GT(std::fabs(a.contact_force.z), 5);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_EQ(a.centre[axis], b.centre[axis]);
    EXPECT_EQ(a.angular_velocity[axis], b.angular_velocity[axis]);
    EXPECT_EQ(a.contact_force[axis], b.contact_force[axis]);
  }
  EXPECT_NEAR(b.centre.z, c.centre.z, 1e-5);  // impacts pull rounding apart
}

// Skins on straight ways and on parabolas: nodes, impulses on them and lists as the sweep has them, whose host moves
// them step by step. Before the first impact the two differ by rounding only.
TEST(DemQueue, MeshFollowsItsTargets) {
  // In windows of one step, which are replayed as long as they are the same, and of many.
  for (const auto& [way, length] : std::vector<std::pair<dem::MeshWay, int>>{{dem::MeshWay::line, 40},
                                                                             {dem::MeshWay::line, 1},
                                                                             {dem::MeshWay::parabola, 40},
                                                                             {dem::MeshWay::parabola, 4}}) {
    std::vector<Vec3> impulses[2];
    std::vector<dem::Grain> grains[2];
    for (const int lanes : {1, 2}) {
      const auto sim = dem_test::create(setup_of(lanes));
      const base::Skin skin = sheet(0);
      const int wall = sim->add_mesh(skin, 0, true);
      sim->add_grains(falling(16));
      double time = 0;
      for (int window = 0; window < 480 / length; ++window) {
        const double end = time + length * step, speed_at = way == dem::MeshWay::line ? end : time;
        std::vector<Vec3> places = skin.nodes, velocities(places.size());
        for (std::size_t k = 0; k < places.size(); ++k) {
          places[k].z += 0.004 * std::sin(60 * end + static_cast<double>(k));
          velocities[k].z = 0.24 * std::cos(60 * speed_at + static_cast<double>(k));
        }
        sim->set_mesh_target(wall, places, velocities, way);
        sim->advance(length, step);
        time = end;
        std::vector<Vec3> impulse(places.size());
        sim->nodal_impulse(wall, impulse);
        Vec3 to_nodes;
        for (const Vec3& one : impulse) to_nodes += one;
        const Vec3 to_grains = sim->wall_impulse_on_grains(wall);
        EXPECT_LT(norm(to_nodes + to_grains), 1e-12 + 1e-12 * norm(to_grains));
        impulses[lanes - 1].insert(impulses[lanes - 1].end(), impulse.begin(), impulse.end());
      }
      grains[lanes - 1] = sim->grains();
      EXPECT_GT(sim->counts().rebuilds, 3);
    }
    double largest = 0, apart = 0;
    for (std::size_t k = 0; k < impulses[0].size(); ++k) {
      largest = std::max(largest, norm(impulses[0][k]));
      apart = std::max(apart, norm(impulses[0][k] - impulses[1][k]));
    }
    EXPECT_GT(largest, length == 40 ? 1e-3 : 1e-4);
    EXPECT_LT(apart, 1e-9 * largest);
    for (std::size_t k = 0; k < grains[0].size(); ++k)
      EXPECT_LT(norm(grains[0][k].position - grains[1][k].position), 1e-12);
  }
}

std::string message_of(const std::function<void()>& run) {
  try {
    run();
  } catch (const base::UnstableError& e) {
    return e.what();
  }
  return "no error";
}

// Trouble in the middle of a queued window: the steps behind it must leave everything as it was, so that cause, grain,
// place, speed and step are those of the sweep, which stops at once.
TEST(DemQueue, TroubleNamesTheSameGrainPlaceAndStep) {
  const auto stopped = [](int lanes, int fast) {
    auto setup = setup_of(lanes);
    setup.maximum_overlap = 0.12;
    const auto sim = dem_test::create(setup);
    sim->add_plane({{0, 0, 0}, {0, 0, 1}}, 0);
    auto grains = falling(48);
    grains[static_cast<std::size_t>(fast)].velocity.z = -6;
    sim->add_grains(grains);
    return message_of([&] { sim->advance(400, step); }) + " " + std::to_string(sim->counts().steps);
  };
  const auto pressed = stopped(1, 37), fallen = stopped(1, 5);
  EXPECT_NE(pressed.find("of the smaller radius; at"), std::string::npos) << pressed;
  EXPECT_NE(fallen.find("overlap with a wall is"), std::string::npos) << fallen;
  EXPECT_EQ(pressed, stopped(2, 37));
  EXPECT_EQ(fallen, stopped(2, 5));
}

// A grain that is thrown out of all numbers within the window, by a wall that comes at it too fast for the step.
TEST(DemQueue, WhatIsNotFiniteStopsTheWindow) {
  const auto stopped = [](int lanes) {
    auto setup = setup_of(lanes);
    setup.maximum_overlap = 1e300;
    setup.interactions[0].restitution = 1;
    const auto sim = dem_test::create(setup);
    sim->add_grains(falling(4));
    sim->set_gravity({0, 0, -1e107});
    return message_of([&] { sim->advance(300, step); }) + " " + std::to_string(sim->counts().steps);
  };
  const auto text = stopped(1);
  EXPECT_NE(text.find("not finite"), std::string::npos) << text;
  EXPECT_EQ(text, stopped(2));
}

// Loads, gravity and damping that change between windows reach the steps of the next one, though these are the same
// queued calls: against free fall, x = v t + g t^2 / 2 in both windows.
TEST(DemQueue, EveryWindowHasItsOwnConstants) {
  for (const int length : {100, 2}) {
    const auto sim = dem_test::create(setup_of(1));
    sim->add_grains(std::vector<dem::Grain>{{.position = {0, 0, 1}, .radius = 0.02, .id = 1}});
    advance(*sim, 100, length);
    sim->set_gravity({0, 3, 0});
    advance(*sim, 100, length);
    const double t = 100 * step;
    const auto grain = sim->grains()[0];
    EXPECT_NEAR(grain.position.z, 1 - 0.5 * 9.81 * t * t - 9.81 * t * t, 1e-14);
    EXPECT_NEAR(grain.position.y, 1.5 * t * t, 1e-14);
    EXPECT_NEAR(grain.velocity.y, 3 * t, 1e-14);
    for (int done = 0; done < 50; done += std::min(length, 50)) sim->advance(std::min(length, 50), 0.5 * step);
    EXPECT_NEAR(sim->grains()[0].velocity.y, 3 * (t + 25 * step), 1e-14);
  }
}

}  // namespace
