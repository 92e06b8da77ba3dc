#pragma once
// Scene files for tests that read them: a folder, and pieces that make a scene together.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "base/error.hpp"
#include "coupling/scene.hpp"

namespace scene_tests {

namespace fs = std::filesystem;
using coupling::Override;
using coupling::Scene;

/// A folder of its own, the working directory while it lives, so that messages hold short names.
class SceneFile : public ::testing::Test {
 protected:
  SceneFile()
      : before_(fs::current_path()),
        folder_(fs::temp_directory_path() / ("trackbed_scene_" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
    fs::current_path(folder_);
    write("box.geo", "DefineConstant[ length = {2.4, Name \"length\"}, cells_x = {48, Name \"cells_x\"} ];\n");
  }
  ~SceneFile() override {
    fs::current_path(before_);
    fs::remove_all(folder_);
  }
  static void write(const std::string& name, const std::string& text) { std::ofstream(name) << text; }
  static Scene read(const std::string& text, const std::vector<Override>& overrides = {}) {
    write("a.toml", text);
    return coupling::read_scene("a.toml", overrides);
  }
  static std::string error_of(const std::string& text, const std::vector<Override>& overrides = {}) {
    try {
      read(text, overrides);
    } catch (const base::UserError& error) {
      return error.what();
    }
    return "no error";
  }
  fs::path before_, folder_;
};

inline const std::string grains = R"([grains]
material = { young_modulus = "16.8 GPa", poisson_ratio = 0.2, density = "2700 kg/m3" }
friction = 0.6
restitution = 0.4
)";
inline const std::string one_grain = R"([[grain]]
position = [0.0, 0.0, "1 m"]
radius = "20 mm"
)";
inline const std::string stage = R"([[stage]]
name = "fall"
duration = "10 ms"
)";
inline const std::string packing = R"([packing]
grading = [ ["22.4 mm", 0.0], ["63 mm", 1.0] ]
young_modulus = "0.24 GPa"
[[packing.layer]]
box = { lower = [0.0, 0.0, 0.0], upper = [1.0, 1.0, 0.3] }
)";

inline const std::string body = R"([[body]]
name = "beam"
mesh = "box.geo"
mesh_parameters = { length = 2.0 }
skin = ["top"]
[[body.material]]
young_modulus = "45 GPa"
poisson_ratio = 0.167
density = "2350 kg/m3"
[[body.support]]
group = "x_min"
fix = ["x", "z"]
[[body.load]]
name = "tip"
group = "x_max"
kind = "nodal_total"
direction = [0.0, 0.0, -1.0]
history = { kind = "step", value = "200 N", start = "1 ms", start_stage = "fall" }
)";

}  // namespace scene_tests
