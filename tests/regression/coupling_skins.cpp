// Grains on solids of the second order as a user runs them: what passes the skin, and a plate under grains against the
// same plate under a uniform load.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/regression/run_helper.hpp"

namespace {

using namespace regression;

// Three grains of 0.18 kg strike a soft slab that is held at both ends, off its nodes, and slide as they bounce.
std::string drop_scene(const std::string& element) {
  const fs::path file = scratch() / ("drop_" + element + ".toml");
  std::ofstream(file) << fmt::format(R"(title = "grains on a slab"

[time]
dem_step = "2 us"
fem_step = "2 us"

[grains]
material = {{ young_modulus = "1 GPa", poisson_ratio = 0.2, density = "2700 kg/m3" }}
friction = 0.3
restitution = 1.0

[[grain]]
position = [0.23, 0.02, 0.0401]
radius = "25 mm"
velocity = [1.0, 0.2, -1.0]
repeat = [3.0, 1.0, 1.0]
spacing = [0.06, 0.0, 0.0]

[[body]]
name = "slab"
mesh = "{}/meshes/box.geo"
mesh_parameters = {{ length = 0.6, width = 0.2, height = 0.03, cells_x = 8, cells_y = 3, cells_z = 1 }}
element = "{}"
gravity = false
skin = ["z_max"]

[[body.material]]
young_modulus = "0.5 GPa"
poisson_ratio = 0.3
density = "2000 kg/m3"

[[body.support]]
group = "x_min"
fix = ["x", "y", "z"]

[[body.support]]
group = "x_max"
fix = ["x", "y", "z"]

[[stage]]
name = "bounce"
duration = "10 ms"
measure = true

[output]
probe_interval = "0.1 ms"
)",
                                     TRACKBED_SOURCE_FOLDER, element);
  return file.string();
}

// In windows of one step of either side momentum and work pass to rounding, and the ledger closes with the error of the
// steps (measured: 1.5e-6 to 3e-6 of what passes, a quarter of it with half the step). With the overlap taken on plane
// parts and the motion and work at the face's nodes, the ledger would miss the force times what the faces bend.
TEST(Skins, OfTheSecondOrderKeepMomentumAndEnergy) {
  for (const char* element : {"hex20", "hex20_reduced", "tet10"}) {
    const fs::path out = scratch() / element;
    const auto finished = trackbed("run " + drop_scene(element) + " --out " + out.string(), 2);
    ASSERT_EQ(finished.status, 0) << finished.output;
    const auto json = summary(out);
    EXPECT_LE(json["momentum_error"].get<double>(), 1e-12) << element;
    const auto energy = [&](const char* name) { return json["energy"][name].get<double>(); };
    const double passed = energy("interface_seen_by_bodies");
    EXPECT_GT(passed, 0.1) << element;
    EXPECT_LE(std::abs(energy("interface_seen_by_grains") + passed), 1e-12 * passed) << element;
    EXPECT_LE(std::abs(energy("residual")), 1e-5 * passed) << element;
    fmt::print("{}: {:.3g} J pass the skin, residual {:.2g} J\n", element, passed, energy("residual"));
  }
}

// Li2021 3.1 after Villard 2009: the load is the grains' weight, the deflection that of a uniform load.
TEST(Skins, PlateUnderGrains) {
  const fs::path out = scratch() / "plate_under_grains";
  const auto finished = trackbed("run " + scene("quick/plate_under_grains.toml") + " --out " + out.string(), 2);
  ASSERT_EQ(finished.status, 0) << finished.output;
  const auto json = summary(out);
  EXPECT_LE(json["momentum_error"].get<double>(), 1e-12);
  for (const auto& [name, result] : json["results"].items()) {
    ASSERT_TRUE(result.contains("relative_error")) << name;
    EXPECT_LT(std::abs(result["relative_error"].get<double>()), name == "load" ? 1e-3 : 0.02) << name;
  }
}

}  // namespace
