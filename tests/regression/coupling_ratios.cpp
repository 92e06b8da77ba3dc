// A grain dropped on a deformable block, with the grains or the solids as the finer side of the window.
// Whatever the ratio, what one side gives the other takes (momentum to rounding), the energy balance closes, and the
// rebound is that of the 1 : 1 window, which is one velocity-Verlet step of the whole. A force applied to the wrong
// side of the window, or a skin that jumps between windows, shows as tens of per cents.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

#include "coupling/run_directory.hpp"
#include "tests/regression/run_helper.hpp"

namespace {

using namespace regression;

// The grain starts at its contact with the block's top, z = 0.05 m, with 0.5 m/s downwards.
std::string drop_scene() {
  const fs::path file = scratch() / "drop.toml";
  std::ofstream(file) << fmt::format(R"(title = "a grain on a block"
gravity = [0.0, 0.0, -9.81]

[grains]
material = {{ young_modulus = "1 GPa", poisson_ratio = 0.2, density = "2700 kg/m3" }}
friction = 0.5
restitution = 1.0

[[grain]]
position = [0.16, 0.01, 0.0801]
radius = "30 mm"
velocity = [0.0, 0.0, -0.5]

[[body]]
name = "block"
mesh = "{}/meshes/box.geo"
mesh_parameters = {{ length = 0.3, width = 0.3, height = 0.1, cells_x = 6, cells_y = 6, cells_z = 2 }}
element = "hex8"
gravity = false
skin = ["z_max"]

[[body.material]]
young_modulus = "0.5 GPa"
poisson_ratio = 0.3
density = "2000 kg/m3"

[[body.support]]
group = "z_min"
fix = ["x", "y", "z"]

[[stage]]
name = "bounce"
duration = "4 ms"
measure = true

[[probe]]
name = "speed"
kind = "grain_velocity"
grain = 0
component = "z"

[[result]]
name = "rebound"
probe = "speed"
take = "max"

[output]
probe_interval = "0.05 ms"
)",
                                     TRACKBED_SOURCE_FOLDER);
  return file.string();
}

struct Bounce {
  double rebound = 0, energy_error = 0, momentum_error = 0;
  int dem = 0, fem = 0;
  std::map<std::string, double> last;  // row of history.csv
};

std::map<std::string, double> last_row(const fs::path& out) {
  std::map<std::string, double> row;
  for (const auto& column : coupling::read_history(out / "history.csv").columns)
    row[column.name] = column.values.back();
  return row;
}

Bounce bounce(const std::string& name, double dem_step, double fem_step, int ranks) {
  const fs::path out = scratch() / name;
  const auto finished = trackbed(fmt::format("run {} --out {} --set time.dem_step={:.9g} --set time.fem_step={:.9g}",
                                             drop_scene(), out.string(), dem_step, fem_step),
                                 ranks);
  EXPECT_EQ(finished.status, 0) << finished.output;
  const auto json = summary(out);
  const auto windows = json["steps"]["windows"].get<int>();
  return {json["results"]["rebound"]["value"].get<double>(),
          json["energy"]["relative_error"].get<double>(),
          json["momentum_error"].get<double>(),
          json["steps"]["dem"].get<int>() / windows,
          json["steps"]["fem"].get<int>() / windows,
          last_row(out)};
}

/// Both sides' views of what passed the interface: the momentum that the grain's flight tells, and its moment about the
/// origin at the point where the grain came down.
void expect_impulses_of(const Bounce& bounce) {
  const auto at = [&](const char* quantity, const char* side, char axis) {
    return bounce.last.at(fmt::format("interface_{}_seen_by_{}_{}", quantity, side, axis));
  };
  const double mass = 2700 * 4.0 / 3.0 * std::numbers::pi * std::pow(0.03, 3);
  const double expected = mass * (bounce.last.at("speed") + 0.5 + 9.81 * bounce.last.at("time"));
  EXPECT_NEAR(at("impulse", "grains", 'z'), expected, 1e-9 * expected);
  EXPECT_NEAR(at("angular_impulse", "grains", 'x'), 0.01 * expected, 1e-4 * expected);
  EXPECT_NEAR(at("angular_impulse", "grains", 'y'), -0.16 * expected, 1e-4 * expected);
  // In a window of several steps the nodes move by some 1e-6 m while its one force acts.
  const double moved = bounce.dem == 1 && bounce.fem == 1 ? 1e-12 : 1e-5;  // [m]
  for (const char axis : {'x', 'y', 'z'}) {
    EXPECT_NEAR(at("impulse", "bodies", axis), -at("impulse", "grains", axis), 1e-9 * expected) << axis;
    EXPECT_NEAR(at("angular_impulse", "bodies", axis), -at("angular_impulse", "grains", axis), moved * expected)
        << axis;
  }
}

TEST(Ratios, EitherSideMayBeTheFiner) {
  const Bounce equal = bounce("equal", 4e-6, 4e-6, 1);
  const Bounce fine_grains = bounce("fine_grains", 1e-6, 4e-6, 2);
  const Bounce fine_solids = bounce("fine_solids", 4e-6, 1e-6, 2);
  EXPECT_EQ(equal.dem, 1);
  EXPECT_EQ(equal.fem, 1);
  EXPECT_EQ(fine_grains.dem, 4);
  EXPECT_EQ(fine_grains.fem, 1);
  EXPECT_EQ(fine_solids.dem, 1);
  EXPECT_EQ(fine_solids.fem, 4);
  EXPECT_GT(equal.rebound, 0.1);
  EXPECT_LT(equal.rebound, std::sqrt(0.25 + 2 * 9.81 * 1e-4));  // its speed at contact; some stays in the block
  EXPECT_NEAR(fine_grains.rebound, equal.rebound, 0.01 * equal.rebound);
  EXPECT_NEAR(fine_solids.rebound, equal.rebound, 0.01 * equal.rebound);
  for (const Bounce& one : {equal, fine_grains, fine_solids}) {
    EXPECT_LE(one.momentum_error, 1e-12);
    EXPECT_LE(one.energy_error, 0.01);
    expect_impulses_of(one);
    fmt::print("{} : {}  rebound {:.6f} m/s, energy error {:.2g}, momentum error {:.2g}\n", one.dem, one.fem,
               one.rebound, one.energy_error, one.momentum_error);
  }
}

}  // namespace
