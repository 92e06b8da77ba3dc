// A grain on a linear spring bounces on a block of one cell, which is one mass on one spring: every scheme of the
// coupling window against its own recursion, written out here. E 2 MPa, 0.1 m cube, nu = 0: stiffness E A / L = 2e5
// N/m, lumped mass of the top rho A L / 2 = 1 kg. A force taken from another window, a skin that moves otherwise or an
// impulse that is divided by another length of time is an error of the first digits.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "tests/regression/run_helper.hpp"

namespace {

using namespace regression;

constexpr double grain_radius = 0.03, contact_stiffness = 1e5, block_mass = 1, block_stiffness = 2e5, gap = 1e-4;
constexpr double grain_mass = 2700 * 4.0 / 3.0 * std::numbers::pi * grain_radius * grain_radius * grain_radius;
constexpr double duration = 16e-3;

std::string one_cell_scene() {
  const fs::path file = scratch() / "one_cell.toml";
  std::ofstream(file) << fmt::format(R"(title = "a grain on one cell"
gravity = [0.0, 0.0, 0.0]
[grains]
material = {{ young_modulus = "1 GPa", poisson_ratio = 0.2, density = "2700 kg/m3" }}
law = "linear"
normal_stiffness = "1e5 N/m"
shear_stiffness = "1e5 N/m"
friction = 0.0
restitution = 1.0
[[grain]]
position = [0.05, 0.0, 0.0801]
radius = "30 mm"
velocity = [0.0, 0.0, -1.0]
[[body]]
name = "block"
mesh = "{}/meshes/box.geo"
mesh_parameters = {{ length = 0.1, width = 0.1, height = 0.1, cells_x = 1, cells_y = 1, cells_z = 1 }}
element = "hex8"
gravity = false
skin = ["z_max"]
[[body.material]]
young_modulus = "2 MPa"
poisson_ratio = 0.0
density = "2000 kg/m3"
[[body.support]]
group = "z_min"
fix = ["x", "y", "z"]
[[stage]]
name = "bounce"
duration = {}
measure = true
[[probe]]
name = "speed"
kind = "grain_velocity"
grain = 0
component = "z"
[[probe]]
name = "top"
kind = "displacement"
body = "block"
group = "z_max"
component = "z"
[[result]]
name = "rebound"
probe = "speed"
take = "max"
[[result]]
name = "deepest"
probe = "top"
take = "min"
[[result]]
name = "last"
probe = "top"
take = "last"
)",
                                     TRACKBED_SOURCE_FOLDER, duration);
  return file.string();
}

struct Case {
  const char *scheme, *skin_motion;
  int n_dem, n_fem;
  double window = 0;  // [s]
  bool newmark = false;
  bool concurrent() const { return std::string(scheme) == "concurrent"; }
  bool quadratic() const { return std::string(skin_motion) == "quadratic"; }
  std::string text() const {
    return fmt::format("{}{} {} {} : {}, window {:g} s", newmark ? "newmark " : "", scheme, skin_motion, n_dem, n_fem,
                       window);
  }
};

struct Bounce {
  double rebound = 0, deepest = 0, last = 0;  // [m/s], [m], [m]
  double mismatch = 0;                        // [J] of the two views of the interface
  double lost = 0;                            // [J] integral of (dF/dt) v over the contact
  double momentum_error = 0;
};

Bounce run(const Case& is, int ranks = 0) {
  const fs::path out = scratch() / "one_cell";
  const auto finished = trackbed(
      fmt::format("run {} --out {} --overwrite --threads 1 --set coupling.scheme={} --set coupling.skin_motion={} "
                  "--set coupling.n_dem={} --set coupling.n_fem={} --set time.dem_step={:.17g} --set "
                  "time.fem_step={:.17g} --set time.force_step=true {}",
                  one_cell_scene(), out.string(), is.scheme, is.skin_motion, is.n_dem, is.n_fem, is.window / is.n_dem,
                  is.window / is.n_fem, is.newmark ? "--set fem.solver=newmark" : ""),
      ranks);
  EXPECT_EQ(finished.status, 0) << finished.output;
  const auto json = summary(out);
  EXPECT_EQ(json["steps"]["dem"], json["steps"]["windows"].get<int>() * is.n_dem);
  EXPECT_EQ(json["steps"]["fem"], json["steps"]["windows"].get<int>() * is.n_fem);
  const auto value = [&](const char* name) { return json["results"][name]["value"].get<double>(); };
  const auto& energy = json["energy"];
  return {value("rebound"),
          value("deepest"),
          value("last"),
          energy["interface_seen_by_grains"].get<double>() + energy["interface_seen_by_bodies"].get<double>(),
          0,
          json["momentum_error"].get<double>()};
}

/// The block's top: displacement, velocity, acceleration.
struct Top {
  double u = 0, v = 0, a = 0;
  void predict(double dt) {
    v += 0.5 * dt * a;
    u += dt * v;
  }
  void correct(double dt, double force) {
    a = (force - block_stiffness * u) / block_mass;
    v += 0.5 * dt * a;
  }
  /// Newmark's average acceleration.
  void implicit_step(double dt, double force) {
    const double reached = u + dt * v + 0.25 * dt * dt * a;
    const double next = (force - block_stiffness * reached) / (block_mass + 0.25 * dt * dt * block_stiffness);
    u = reached + 0.25 * dt * dt * next;
    v += 0.5 * dt * (a + next);
    a = next;
  }
};

Bounce recursion(const Case& is) {
  Top top;
  double height = gap, speed = -1, force = 0;  // of the grain's lowest point over the top at rest; force on the top < 0
  double from = 0, waiting = 0;
  Bounce found;
  const double W = is.window, d = W / is.n_dem, f = W / is.n_fem;
  const int windows = static_cast<int>(std::round(duration / W));
  for (int window = 0; window < windows; ++window) {
    const double leaves = top.v;
    const bool predicted = is.n_fem == 1 && !is.newmark;
    if (predicted) top.predict(f);
    const double to = predicted ? top.u : top.u + W * top.v;
    double impulse = 0;
    for (int step = 1; step <= is.n_dem; ++step) {
      const double share = static_cast<double>(step) / is.n_dem;
      const double bow = is.quadratic() ? W * leaves - (to - from) : 0;
      const double skin = from + share * (to - from) + share * (1 - share) * bow;
      speed -= 0.5 * d * force / grain_mass;
      height += d * speed;
      const double before = force;
      force = -contact_stiffness * std::max(0.0, skin - height);
      speed -= 0.5 * d * force / grain_mass;
      impulse += d * force;
      found.lost += (force - before) * top.v;
    }
    from = to;
    const double acts = (is.concurrent() ? waiting : impulse) / W;
    waiting = impulse;
    if (predicted) top.correct(f, acts);
    for (int step = 0; step < is.n_fem && !predicted; ++step) {
      if (is.newmark) {
        top.implicit_step(f, acts);
        continue;
      }
      top.predict(f);
      top.correct(f, acts);
    }
    found.rebound = std::max(found.rebound, speed);
    found.deepest = std::min(found.deepest, top.u);
    found.last = top.u;
  }
  return found;
}

TEST(Schemes, EveryWindowIsTheRecursionItClaims) {
  for (const Case& is : {Case{"sequential", "linear", 1, 1, 1e-4}, Case{"sequential", "quadratic", 1, 1, 1e-4},
                         Case{"concurrent", "linear", 1, 1, 1e-4}, Case{"sequential", "linear", 10, 1, 1e-4},
                         Case{"sequential", "quadratic", 10, 1, 1e-4}, Case{"sequential", "linear", 1, 10, 1e-4},
                         Case{"sequential", "quadratic", 1, 10, 1e-4}, Case{"concurrent", "quadratic", 100, 1, 1e-4},
                         Case{"concurrent", "linear", 1, 100, 1e-4}, Case{"concurrent", "quadratic", 4, 2, 1e-4},
                         Case{"sequential", "linear", 40, 1, 2e-4, true}}) {
    const Bounce found = run(is), expected = recursion(is);
    EXPECT_GT(expected.rebound, 0.1);
    const double tolerance = is.newmark ? 1e-9 : 1e-12;  // of Newton's method
    EXPECT_NEAR(found.rebound, expected.rebound, tolerance) << is.text();
    EXPECT_NEAR(found.deepest, expected.deepest, tolerance * std::abs(expected.deepest)) << is.text();
    EXPECT_NEAR(found.last, expected.last, tolerance * std::abs(expected.deepest)) << is.text();
    EXPECT_LE(found.momentum_error, 1e-12) << is.text();
  }
}

// On ranks of their own both sides do the same.
TEST(Schemes, RanksChangeNothing) {
  for (const Case& is : {Case{"sequential", "quadratic", 4, 1, 1e-4}, Case{"concurrent", "quadratic", 1, 4, 1e-4}}) {
    const Bounce one = run(is), two = run(is, 2);
    EXPECT_EQ(one.rebound, two.rebound) << is.text();
    EXPECT_EQ(one.deepest, two.deepest) << is.text();
    EXPECT_LE(two.momentum_error, 1e-12) << is.text();
  }
}

/// How late the force acts on the block [s]: coupling/window.hpp.
double lag(const Case& is) {
  return 0.5 * is.window * (1.0 / is.n_fem - 1.0 / is.n_dem) + (is.concurrent() ? is.window : 0);
}

// A force late by tau does the work - tau integral of (dF/dt) v too much. The integral comes from the recursion at
// 1 : 1 with a window of 1 us; what is left over is of second order in the window.
TEST(Schemes, EnergyErrorIsThatOfTheLag) {
  const double per_lag = -recursion({"sequential", "linear", 1, 1, 1e-6}).lost;
  const double energy = 0.5 * grain_mass;
  fmt::print("interface energy error over the grain's energy; a lag tau gives {:.4g} per ms\n",
             1e-3 * per_lag / energy);
  std::vector<Case> rows;
  for (const char* scheme : {"sequential", "concurrent"})
    for (const char* motion : {"linear", "quadratic"})
      for (const auto& [n_dem, n_fem] : {std::pair{1, 1}, {10, 1}, {40, 1}, {1, 10}})
        if (n_dem == 10 || std::string(motion) == "linear") rows.push_back({scheme, motion, n_dem, n_fem});
  rows.push_back({"sequential", "linear", 40, 1, 0, true});
  for (Case& is : rows) {
    fmt::print("| {}{} | {} | {} : {} |", is.newmark ? "newmark, " : "", is.scheme, is.skin_motion, is.n_dem, is.n_fem);
    double coarse = 0, order = 0;
    for (const double window : {4e-4, 2e-4, 1e-4}) {
      is.window = window;
      const double error = run(is).mismatch / energy, expected = lag(is) * per_lag / energy;
      if (lag(is) == 0) {
        EXPECT_LT(std::abs(error), 1e-12) << is.text();
      } else {
        EXPECT_NEAR(error, expected, (window > 1e-4 ? 0.3 : 0.1) * std::abs(expected)) << is.text();
      }
      fmt::print(" {:.2g} % |", 100 * error);
      order = std::log2(coarse / error);
      coarse = error;
    }
    if (lag(is) == 0) {
      fmt::print(" no lag |\n");
      continue;
    }
    fmt::print(" {:.2f} |\n", order);
    EXPECT_NEAR(order, 1, 0.15) << is.text();
  }
}

}  // namespace
