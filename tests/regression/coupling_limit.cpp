// A grain between a plane and a block of one light, soft cell, pressed by 10 N through linear springs, between side
// walls that keep it from slipping out; a load on the block holds against it, and the block is let go in balance but
// for a small velocity of the grain, so that nothing parts. The contact, not the block's own springs, sets the window.
// Lumped mass of the top rho A L / 2 = 0.01 kg in four nodes, k = 1e5 N/m, grain 0.30536 kg: lambda_node = k (1/4) /
// (0.01 / 4 kg) = 1e7, lambda_grain = 2 k / m = 6.55e5, both in 1/s2.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/regression/run_helper.hpp"

namespace {

using namespace regression;

std::string light_scene() {
  const fs::path file = scratch() / "light.toml";
  std::ofstream(file) << fmt::format(R"(title = "a grain on a light cell"
gravity = [0.0, 0.0, 0.0]
[grains]
material = {{ young_modulus = "1 GPa", poisson_ratio = 0.2, density = "2700 kg/m3" }}
law = "linear"
normal_stiffness = "1e5 N/m"
shear_stiffness = "1e4 N/m"
friction = 0.0
restitution = 1.0
[[grain]]
position = [0.05, 0.0, 0.0799]
radius = "30 mm"
velocity = [0.0, 0.0, 0.001]
[[wall]]
name = "lid"
plane = {{ point = [0.0, 0.0, 0.1098], normal = [0.0, 0.0, -1.0] }}
[[wall]]
name = "left"
plane = {{ point = [0.02, 0.0, 0.0], normal = [1.0, 0.0, 0.0] }}
[[wall]]
name = "right"
plane = {{ point = [0.08, 0.0, 0.0], normal = [-1.0, 0.0, 0.0] }}
[[wall]]
name = "front"
plane = {{ point = [0.0, -0.03, 0.0], normal = [0.0, 1.0, 0.0] }}
[[wall]]
name = "back"
plane = {{ point = [0.0, 0.03, 0.0], normal = [0.0, -1.0, 0.0] }}
[[body]]
name = "block"
mesh = "{}/meshes/box.geo"
mesh_parameters = {{ length = 0.1, width = 0.1, height = 0.1, cells_x = 1, cells_y = 1, cells_z = 1 }}
element = "hex8"
gravity = false
skin = ["z_max"]
[[body.material]]
young_modulus = "20 kPa"
poisson_ratio = 0.0
density = "20 kg/m3"
[[body.support]]
group = "z_min"
fix = ["x", "y", "z"]
[[body.load]]
name = "hold"
group = "z_max"
kind = "face_total"
direction = [0.0, 0.0, 1.0]
history = {{ kind = "constant", value = "10 N" }}
[[stage]]
name = "held"
duration = "10 ms"
hold = ["block"]
[[stage]]
name = "rest"
duration = "0.3 s"
measure = true
[[probe]]
name = "speed"
kind = "grain_velocity"
grain = 0
component = "z"
[[result]]
name = "fastest"
probe = "speed"
take = "max_abs"
[output]
probe_interval = "10 ms"
)",
                                     TRACKBED_SOURCE_FOLDER);
  return file.string();
}

Finished run(const fs::path& out, double step, const std::string& more) {
  return trackbed(fmt::format("run {} --out {} --threads 1 --set time.dem_step={:.9g} --set time.fem_step={:.9g} {}",
                              light_scene(), out.string(), step, step, more));
}

double reported_limit(const fs::path& out) {
  const auto text = summary(out)["dt_limiter"]["coupling"].get<std::string>();
  const auto at = text.find("a window of 1 : 1");
  EXPECT_NE(at, std::string::npos) << text;
  const auto begin = text.rfind("; ", at);
  return std::stod(text.substr(begin == std::string::npos ? 0 : begin + 2));
}

TEST(Limit, BelowItStableAboveItShortenedOrStopped) {
  const fs::path out = scratch() / "light";
  auto finished = run(out, 1e-4, "");
  ASSERT_EQ(finished.status, 0) << finished.output;
  const double limit = reported_limit(out);
  const double contacts = 2 / std::sqrt(1e7 + 6.55e5);
  EXPECT_LT(limit, contacts);        // the block's own springs take their part,
  EXPECT_GT(limit, 0.9 * contacts);  // which is small

  const std::string forced = " --overwrite --set time.force_step=true ";
  finished =
      run(out, 0.99 * limit,
          forced + fmt::format("--set 'stage.rest.duration={} s' --set output.probe_interval=0.5", 1e5 * 0.99 * limit));
  ASSERT_EQ(finished.status, 0) << finished.output;
  EXPECT_GE(summary(out)["steps"]["windows"].get<int>(), 99999);
  EXPECT_LT(summary(out)["results"]["fastest"]["value"].get<double>(), 0.002);  // 0.001 at the start

  finished = run(out, 1.6 * limit, forced);
  EXPECT_EQ(finished.status, 3) << finished.output;
  EXPECT_NE(finished.output.find("is above the coupled limit of "), std::string::npos) << finished.output;
  EXPECT_NE(finished.output.find("; remove time.force_step, or make the skin's facets larger (heavier nodes)"),
            std::string::npos)
      << finished.output;

  finished = run(out, 1.6 * limit, "--overwrite");
  EXPECT_EQ(finished.status, 0) << finished.output;
  EXPECT_NE(finished.output.find("window shortened to "), std::string::npos) << finished.output;
  EXPECT_LT(summary(out)["dt_s"]["fem"].get<double>(), 0.9 * limit);
}

}  // namespace
