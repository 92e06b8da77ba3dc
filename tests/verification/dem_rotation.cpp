// Rotation schemes against the cases of Irazabal2017 5.3.2, and in free flight. Every test prints its table: the three
// schemes side by side.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

#include "dem/clump.hpp"
#include "dem/kernels/rotation.hpp"

namespace {

using namespace dem::kernels;
using std::numbers::pi;

/// The same measurement for every scheme: {quaternion (Zhao-van Wachem), Runge-Kutta, direct}.
template <class Measure>
auto for_each_scheme(Measure&& measure) {
  return std::array{measure(ZhaoVanWachem{}), measure(RungeKutta{}), measure(Direct{})};
}
constexpr std::array<const char*, 3> scheme_names{"quaternion", "runge_kutta", "direct"};

// ---- free flight

struct Drift {
  double energy = 0, momentum = 0;  // largest relative change; momentum as a vector in space
};

template <class Scheme>
Drift free_flight(Scheme, const Vec3& inertia, const Vec3& velocity, double angle_per_step, int steps) {
  RigidRotation r;
  r.angular_velocity = velocity;
  const double dt = angle_per_step / norm(velocity), energy = rotational_energy(r, inertia);
  const Vec3 momentum = angular_momentum(r, inertia);
  Drift drift;
  for (int step = 0; step < steps; ++step) {
    Scheme::begin_step(r, inertia, {}, dt);
    Scheme::finish_step(r, inertia, {}, dt);
    drift.energy = std::max(drift.energy, std::fabs(rotational_energy(r, inertia) / energy - 1));
    drift.momentum = std::max(drift.momentum, norm(angular_momentum(r, inertia) - momentum) / norm(momentum));
  }
  return drift;
}

// A ballast stone's moments (1 : 1.7 : 1.8), spun about no axis of its own. Energy and angular momentum are conserved
// by the equations; a scheme of second order with a drift of third order would lose 1e-2 here.
TEST(RotationFlight, DriftOfEveryScheme) {
  const Vec3 inertia{1.52e-4, 2.58e-4, 2.79e-4};
  std::printf("free flight, 0.01 rad per step, 1e5 steps: largest relative change\n");
  std::printf("%-12s %12s %12s   spun about\n", "scheme", "energy", "momentum");
  for (const Vec3& velocity : {Vec3{1, 1, 1}, Vec3{1, 0.1, 0.2}, Vec3{0.1, 1, 0.1}, Vec3{0.3, 0.1, 1}}) {
    const auto drift =
        for_each_scheme([&](auto scheme) { return free_flight(scheme, inertia, velocity, 0.01, 100000); });
    for (std::size_t s = 0; s < 3; ++s) {
      std::printf("%-12s %12.2e %12.2e   %g %g %g\n", scheme_names[s], drift[s].energy, drift[s].momentum, velocity.x,
                  velocity.y, velocity.z);
    }
    EXPECT_LE(drift[0].energy, 1e-5);
    EXPECT_LE(drift[0].momentum, 1e-5);
    EXPECT_LE(drift[1].energy, 1e-9);
    EXPECT_LE(drift[1].momentum, 1e-9);
    EXPECT_GE(drift[2].energy, 1e-3);  // the direct scheme gains energy in every step
  }
}

// ---- test case 1: cylinder rotating freely

// omega' = (sin 50t, cos 50t, 100) rad/s for 0.5 s: Euler's equations with I_x = I_y = 2 I_z (5.56a with one cosine).
template <class Scheme>
double precession_error(Scheme, double dt) {
  const Vec3 inertia{1, 1, 0.5};
  RigidRotation r;
  r.angular_velocity = {0, 1, 100};
  double error = 0;
  const long steps = std::lround(0.5 / dt);
  for (long step = 1; step <= steps; ++step) {
    Scheme::begin_step(r, inertia, {}, dt);
    Scheme::finish_step(r, inertia, {}, dt);
    const double phase = 50 * static_cast<double>(step) * dt;
    const Vec3 expected{std::sin(phase), std::cos(phase), 100};
    error = std::max(error, norm(to_body(r.orientation, r.angular_velocity) - expected));
  }
  return error;
}

// The midpoint rule lags by (50 dt)^3 / 6 rad per step: 0.0104 after 500 steps of 1e-3 s.
TEST(RotationCase1, Precession) {
  std::printf("precession, largest error of omega' [rad/s]\n%-12s %10s %10s %10s   order\n", "scheme", "1e-3 s",
              "5e-4 s", "2.5e-4 s");
  const auto errors = for_each_scheme([](auto scheme) {
    return std::array{precession_error(scheme, 1e-3), precession_error(scheme, 5e-4), precession_error(scheme, 2.5e-4)};
  });
  std::array<double, 3> order{};
  for (std::size_t s = 0; s < 3; ++s) {
    order[s] = std::log2(errors[s][1] / errors[s][2]);
    std::printf("%-12s %10.2e %10.2e %10.2e   %.2f\n", scheme_names[s], errors[s][0], errors[s][1], errors[s][2],
                order[s]);
  }
  EXPECT_LE(errors[0][0], 0.011);
  EXPECT_NEAR(order[0], 2, 0.1);
  EXPECT_LE(errors[1][0], 1e-6);
  EXPECT_GE(order[1], 3.9);
  EXPECT_GE(errors[2][0], 0.5);  // "erroneous results from the first steps"; converges at first order
  EXPECT_NEAR(order[2], 1, 0.2);
}

// ---- test case 2: fixed ball under T = (0, 1e5 e^t, 0) N m

// r = 1 m, 1100 kg/m3; theta_y = 1e5 / I (e^t - t - 1) (5.57), unrolled over its turns. Largest error within 1 s.
template <class Scheme>
double variable_torque_error(Scheme, double dt) {
  const double moment = 0.4 * 1100 * 4.0 / 3.0 * pi;
  const Vec3 inertia{moment, moment, moment};
  RigidRotation r;
  double angle = 0, error = 0;
  const long steps = std::lround(1 / dt);
  for (long step = 0; step < steps; ++step) {
    const double t = static_cast<double>(step) * dt;
    const Quaternion before = r.orientation;
    Scheme::begin_step(r, inertia, {0, 1e5 * std::exp(t), 0}, dt);
    const Quaternion turn = r.orientation * conjugate(before);
    angle += 2 * std::atan2(turn.y, turn.w);
    Scheme::finish_step(r, inertia, {0, 1e5 * std::exp(t + dt), 0}, dt);
    error = std::max(error, std::fabs(angle - 1e5 / moment * (std::exp(t + dt) - t - dt - 1)));
  }
  return error;
}

// A ball has no gyroscopic term: what is left is the order in the torque. Velocity Verlet is the central difference of
// theta'' = T / I, whose angle lags by dt^2 / 12 T(0) / I (e^t - 1 + t); a torque held over the step (5.41) is first
// order.
TEST(RotationCase2, VariableTorque) {
  std::printf("variable torque, largest error of the angle within 1 s [rad]\n%-12s %10s %10s   order\n", "scheme",
              "1e-3 s", "1e-4 s");
  const auto errors = for_each_scheme([](auto scheme) {
    return std::array{variable_torque_error(scheme, 1e-3), variable_torque_error(scheme, 1e-4)};
  });
  for (std::size_t s = 0; s < 3; ++s) {
    std::printf("%-12s %10.2e %10.2e   %.2f\n", scheme_names[s], errors[s][0], errors[s][1],
                std::log10(errors[s][0] / errors[s][1]));
  }
  for (const std::size_t s : {0u, 1u}) {
    EXPECT_NEAR(errors[s][1], 1e-8 / 12 * 1e5 / (0.4 * 1100 * 4.0 / 3.0 * pi) * std::exp(1.0), 1e-9);
    EXPECT_NEAR(std::log10(errors[s][0] / errors[s][1]), 2, 0.1);
  }
  EXPECT_GE(errors[2][1], 1e3 * errors[0][1]);
}

// ---- test cases 3 and 4: fibres that bounce without loss

// Table 5.3: E 5e7 Pa, Poisson 0.35 (fibre) and 0.23 (wall), no friction, e = 1; box of 1 m, gravity along -z. The
// fibre of figure 5.28 is known from a picture only: here nine spheres of radius 0.02 m, 0.02 m apart, 1000 kg/m3. The
// step is 1e-5 s (source: 1e-7 s), 1/300 of a contact.
constexpr double radius = 0.02, density = 1000, gravity = 9.81, box = 1;
const double wall_modulus = 5e7 / ((1 - 0.35 * 0.35) + (1 - 0.23 * 0.23));
const double fibre_modulus = 5e7 / (2 * (1 - 0.35 * 0.35));

const dem::Clump& fibre() {
  static const dem::Clump clump = [] {
    std::vector<dem::Sphere> spheres;
    for (int i = -4; i <= 4; ++i) spheres.push_back({{radius * i, 0, 0}, radius});
    return dem::make_clump(spheres);
  }();
  return clump;
}

struct Body {
  Vec3 position, velocity{};
  RigidRotation rotation;
  Vec3 force{}, torque{};
};

/// Hertz: F = 4/3 E* sqrt(R*) overlap^(3/2) along `direction` at `point`; returns the energy 8/15 E* sqrt(R*)
/// overlap^(5/2).
double press(Body& body, double overlap, double modulus, double effective_radius, const Vec3& direction,
             const Vec3& point) {
  const double stiffness = modulus * std::sqrt(effective_radius * overlap);
  const Vec3 force = (4.0 / 3.0 * stiffness * overlap) * direction;
  body.force += force;
  body.torque += cross(point - body.position, force);
  return 8.0 / 15.0 * stiffness * overlap * overlap;
}

class Fibres {
 public:
  explicit Fibres(std::vector<Body> bodies) : bodies_(std::move(bodies)) { find_forces(); }

  template <class Scheme>
  void step(Scheme, double dt) {
    for (Body& body : bodies_) {
      body.velocity += (0.5 * dt / mass_) * body.force;
      body.position += dt * body.velocity;
      Scheme::begin_step(body.rotation, inertia_, body.torque, dt);
    }
    find_forces();
    for (Body& body : bodies_) {
      body.velocity += (0.5 * dt / mass_) * body.force;
      Scheme::finish_step(body.rotation, inertia_, body.torque, dt);
    }
  }

  double energy() const {
    double sum = elastic_;
    for (const Body& body : bodies_) {
      sum += 0.5 * mass_ * norm2(body.velocity) + rotational_energy(body.rotation, inertia_) +
             mass_ * gravity * body.position.z;
    }
    return sum;
  }
  double elastic() const { return elastic_; }
  double rotational() const {
    double sum = 0;
    for (const Body& body : bodies_) sum += rotational_energy(body.rotation, inertia_);
    return sum;
  }

 private:
  Vec3 centre(const Body& body, const dem::Sphere& sphere) const {
    return body.position + to_space(body.rotation.orientation, sphere.position);
  }

  void find_forces() {
    elastic_ = 0;
    for (Body& body : bodies_) {
      body.force = {0, 0, -mass_ * gravity};
      body.torque = {};
      touch_walls(body);
    }
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) touch(bodies_[i], bodies_[j]);
    }
  }
  void touch_walls(Body& body) {
    for (int a = 0; a < 3; ++a) {
      for (const double side : {0.0, box}) {
        if (std::fabs(body.position[a] - side) >= fibre().reach) continue;
        Vec3 inward{};
        inward[a] = side == 0 ? 1 : -1;
        for (const dem::Sphere& sphere : fibre().spheres) {
          const Vec3 c = centre(body, sphere);
          const double overlap = radius - std::fabs(c[a] - side);
          if (overlap > 0) elastic_ += press(body, overlap, wall_modulus, radius, inward, c - radius * inward);
        }
      }
    }
  }
  void touch(Body& a, Body& b) {
    if (norm(a.position - b.position) >= 2 * fibre().reach) return;
    for (const dem::Sphere& one : fibre().spheres) {
      const Vec3 ca = centre(a, one);
      for (const dem::Sphere& other : fibre().spheres) {
        const Vec3 way = ca - centre(b, other);
        const double squared = norm2(way);
        if (squared >= 4 * radius * radius) continue;
        const double distance = std::sqrt(squared), overlap = 2 * radius - distance;
        const Vec3 direction = (1 / distance) * way, point = ca - (0.5 * distance) * direction;
        elastic_ += press(a, overlap, fibre_modulus, radius / 2, direction, point);
        press(b, overlap, fibre_modulus, radius / 2, -direction, point);
      }
    }
  }

  std::vector<Body> bodies_;
  double mass_ = density * fibre().volume, elastic_ = 0;
  Vec3 inertia_ = mass_ * fibre().inertia;
};

/// A fibre whose x' lies along this direction.
Body fibre_along(const Vec3& direction, const Vec3& position, const Vec3& velocity) {
  const Vec3 turn = cross(Vec3{1, 0, 0}, direction);
  Body body{position, velocity, {}, {}, {}};
  body.rotation.orientation = turn_by((std::acos(direction.x) / norm(turn)) * turn);
  return body;
}

struct Bouncing {
  double error = 0, elastic = 0, rotational = 0;  // largest error of the total energy and shares of it
};

template <class Scheme>
Bouncing bounce(Scheme scheme, const std::vector<Body>& bodies, double time, double dt) {
  Fibres fibres(bodies);
  const double start = fibres.energy();
  Bouncing result;
  for (long step = 0; step < std::lround(time / dt); ++step) {
    fibres.step(scheme, dt);
    result.error = std::max(result.error, std::fabs(fibres.energy() / start - 1));
    result.elastic = std::max(result.elastic, fibres.elastic() / start);
    result.rotational = std::max(result.rotational, fibres.rotational() / start);
  }
  return result;
}

void expect_energy_kept(const char* title, const std::vector<Body>& bodies, double time) {
  const auto result = for_each_scheme([&](auto scheme) { return bounce(scheme, bodies, time, 1e-5); });
  std::printf("%s: largest error of the total energy, largest elastic and rotational share\n", title);
  for (std::size_t s = 0; s < 3; ++s) {
    std::printf("%-12s %10.4f %% %8.2f %% %8.2f %%\n", scheme_names[s], 100 * result[s].error, 100 * result[s].elastic,
                100 * result[s].rotational);
  }
  EXPECT_GE(result[0].elastic, 0.1);  // they did collide, and it made them turn
  EXPECT_GE(result[0].rotational, 0.1);
  EXPECT_LE(result[0].error, 0.003);
  EXPECT_LE(result[1].error, 0.003);
  EXPECT_GE(result[2].error, 0.003);  // "goes beyond the limits after the first contacts"
}

// x' 30 degrees below the horizontal in the middle of the box: the first bounce makes it turn.
TEST(RotationCase3, OneFibre) {
  const std::vector<Body> bodies{fibre_along({0.866025403784, 0, -0.5}, {0.5, 0.5, 0.5}, {})};
  expect_energy_kept("one fibre, 2 s", bodies, 2);
}

// Nine fibres in a row across the box, thrown at (1, 0, -1) m/s; x' 15 degrees off the y axis, as in the source, and
// every other one tilted, so that the first contacts are between fibres in space.
TEST(RotationCase4, NineFibres) {
  std::vector<Body> bodies;
  for (int i = 0; i < 9; ++i) {
    const double tilt = i % 2 == 0 ? 0.0 : 0.4;
    const Vec3 direction{0.25882 * std::cos(tilt), -0.96593 * std::cos(tilt), std::sin(tilt)};
    bodies.push_back(fibre_along((1 / norm(direction)) * direction, {0.1 + 0.1 * i, 0.5, 0.5}, {1, 0, -1}));
  }
  expect_energy_kept("nine fibres, 1 s", bodies, 1);
}

}  // namespace
