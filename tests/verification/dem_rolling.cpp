// Rolling resistance in a simulation: the two cases of Irazabal2017 5.2.2 (after Ai et al. 2011), and a sphere that
// ends in contact with several facets (4.5.3).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "dem/dem.hpp"
#include "tests/dem_backend.hpp"

namespace {

using dem::Vec3;

constexpr double gravity = 9.81, step = 5e-5;  // [m/s2], [s] Table 5.2
constexpr double radius = 0.05;                // [m] not in the table; the formulas below hold for any
const double mass = 1056 * 4.0 / 3.0 * std::numbers::pi * radius * radius * radius;

/// A sphere at rest on a plane that slopes up along x by `slope`, then given 1 m/s up the slope.
std::unique_ptr<dem::Simulation> rolling_sphere(const std::string& model, double eta, double slope, int plane_fixed) {
  dem::set_threads(1);
  dem::Setup setup;
  setup.materials = {{"sphere", 4e7, 0.49, 1056}};
  dem::Interaction pair{0.8, 0.2, eta};
  pair.rolling = model;
  pair.rolling_damping = 0.3;
  setup.interactions = {pair};
  setup.gravity = {-gravity * std::sin(slope), 0, -gravity * std::cos(slope)};
  setup.maximum_overlap = 0.5;
  auto sim = dem_test::create(setup);
  sim->add_plane({{0, 0, 0}, {0, 0, 1}}, plane_fixed);
  sim->add_grains(std::vector<dem::Grain>{{.position = {0, 0, radius}, .radius = radius, .id = 1}});
  // "Its movement in x is restrained" until it rests: gravity across the plane alone.
  sim->set_gravity({0, 0, setup.gravity.z});
  sim->advance(20000, step);
  sim->set_gravity(setup.gravity);
  auto g = sim->grains();
  g[0].velocity = {1, 0, 0};
  sim->set_grains(g);
  return sim;
}

/// Rolling resistance now [N m] about y: what the change of the spin leaves over after the contact force's torque.
struct Sample {
  double time, velocity, spin;
};
std::vector<Sample> history_of(dem::Simulation& sim, double duration, int every) {
  std::vector<Sample> samples;
  const int steps = static_cast<int>(duration / step / every);
  for (int k = 0; k < steps; ++k) {
    sim.advance(every, step);
    const auto g = sim.grains()[0];
    samples.push_back({(k + 1) * every * step, g.velocity.x, g.angular_velocity.y});
  }
  return samples;
}

// Case 1. Sliding: v' = -mu g. Then rolling under the constant moment eta R m g: a = -eta g / (1 + 2/5), from
//   m a = -F, I omega' = F R - eta R m g, a = omega' R.    It ends at rest and stays there: both speeds vanish.
// A resistance that trembles (type A) never comes to rest; one that drives the grain (5.4 as printed) speeds it up.
TEST(RollingCase1, ConstantMomentWhileRollingNothingAtRest) {
  const double eta = 0.2;
  const auto sim = rolling_sphere("brof", eta, 0, 0);
  const auto samples = history_of(*sim, 2.0, 20);
  // The sphere slides until v = omega R: 1 - mu g t = (5/2) (mu - eta) g t.
  const double sliding = 1 / (0.8 * gravity + 2.5 * (0.8 - eta) * gravity), rolling_speed = 1 - 0.8 * gravity * sliding;
  const double deceleration = eta * gravity / 1.4, stop = sliding + rolling_speed / deceleration;
  int rolling = 0;
  for (const Sample& s : samples) {
    if (s.time > sliding + 0.02 && s.time < stop - 0.02) {
      EXPECT_NEAR(s.velocity, rolling_speed - deceleration * (s.time - sliding), 2e-3) << s.time;
      EXPECT_NEAR(s.spin * radius, s.velocity, 2e-3) << s.time;
      ++rolling;
    }
    if (s.time > stop + 0.1) {
      EXPECT_LT(std::abs(s.velocity), 1e-6) << s.time;
      EXPECT_LT(std::abs(s.spin) * radius, 1e-6) << s.time;
    }
  }
  EXPECT_GT(rolling, 100);
}

// Case 2. On a slope of 10 degrees it stops for eta > tan 10 = 0.176 and rolls back below. Rolling up: m a = -m g sin b
// - F, and the moment of rolling resistance eta R m g cos b.
TEST(RollingCase2, StopsOnASlopeAboveItsTangent) {
  const double slope = 10 * std::numbers::pi / 180;
  for (const double eta : {0.1, 0.2, 0.4}) {
    const auto sim = rolling_sphere("brof", eta, slope, 0);
    const auto samples = history_of(*sim, 1.5, 100);
    const double end = samples.back().velocity;
    if (eta < std::tan(slope)) {
      // Rolling down: a = -(sin b - eta cos b) g / 1.4.
      const Sample &a = samples[samples.size() - 50], &b = samples.back();
      const double expected = -(std::sin(slope) - eta * std::cos(slope)) * gravity / 1.4;
      EXPECT_NEAR((b.velocity - a.velocity) / (b.time - a.time), expected, 1e-2 * -expected);
      EXPECT_LT(end, -0.1);
    } else {
      EXPECT_LT(std::abs(end), 1e-6) << eta;
      EXPECT_LT(std::abs(samples.back().spin) * radius, 1e-6) << eta;
    }
  }
}

// Type C with a damping of 0.3 also brakes to rest, after oscillating in its spring.
TEST(RollingCase1, TypeCComesToRest) {
  const auto sim = rolling_sphere("type_c", 0.2, 0, 0);
  const auto samples = history_of(*sim, 2.5, 100);
  EXPECT_LT(std::abs(samples.back().velocity), 1e-4);
  EXPECT_LT(std::abs(samples.back().spin) * radius, 1e-4);
}

/// A plane z = 0 of 2 m with a hole: its rim and, below it, walls that run to a point or a small floor.
base::Skin holed_plane(int sides, double rim, double bottom, double depth) {
  base::Skin skin;
  for (int ring = 0; ring < 3; ++ring) {
    const double r = ring == 0 ? 2 : ring == 1 ? rim : bottom, z = ring == 2 ? -depth : 0;
    for (int k = 0; k < sides; ++k) {
      const double angle = 2 * std::numbers::pi * (k + 0.5) / sides;
      skin.nodes.push_back({r * std::cos(angle), r * std::sin(angle), z});
    }
  }
  for (int ring = 0; ring < 2; ++ring)
    for (int k = 0; k < sides; ++k) {
      const int next = (k + 1) % sides, a = ring * sides, b = a + sides;
      skin.facets.push_back({a + k, a + next, b + next, b + k});
    }
  for (int k = 1; k + 1 < sides; ++k) skin.facets.push_back({2 * sides, 2 * sides + k, 2 * sides + k + 1, -1});
  return skin;
}

// 4.5.3: spheres fall into holes of three shapes and rest there within 2.5 s, on rims (edges and vertices) and walls at
// once; at rest the contact forces carry the weight.
TEST(MultipleContact, RestsWithinTwoAndAHalfSeconds) {
  dem::set_threads(1);
  for (const int sides : {3, 4, 8}) {
    dem::Setup setup;
    setup.materials = {{"sphere", 1e6, 0.2, 100}};  // Table 4.6
    setup.interactions = {{0.3, 0.4, 0}};
    setup.gravity = {0, 0, -gravity};
    setup.maximum_overlap = 0.5;
    const auto sim = dem_test::create(setup);
    const double rim = 0.25 / std::cos(std::numbers::pi / sides);  // edges 0.25 m from the axis
    sim->add_mesh(holed_plane(sides, rim, 0.1, 0.3), 0, false);
    sim->add_grains(std::vector<dem::Grain>{{.position = {0.02, 0.01, 0.6}, .radius = 0.3, .id = 1}});
    sim->advance(50000, 5e-5);
    const auto g = sim->grains()[0];
    EXPECT_LT(norm(g.velocity), 1e-3) << sides;
    const auto contacts = sim->wall_contacts();
    EXPECT_GE(contacts.size(), 3u) << sides;
    Vec3 force;
    for (const auto& c : contacts) force += c.force;
    const double weight = 100 * 4.0 / 3.0 * std::numbers::pi * 0.027 * gravity;
    EXPECT_NEAR(force.z, weight, 1e-3 * weight) << sides;
  }
}

}  // namespace
