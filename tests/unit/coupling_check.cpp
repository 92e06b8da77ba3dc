// `trackbed check`: what is on and what is off is said, and numbers that can be worked out by hand are right.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "base/error.hpp"
#include "coupling/check.hpp"

namespace {

namespace fs = std::filesystem;

std::string check_of(const std::string& text, std::vector<coupling::Override> overrides = {},
                     const std::string& backend = "omp") {
  const fs::path file = fs::temp_directory_path() / ("trackbed_check_" + std::to_string(getpid()) + ".toml");
  std::ofstream(file) << text;
  coupling::RunOptions options;
  options.scene = file;
  options.backend = backend;
  options.overrides = std::move(overrides);
  std::string said;
  try {
    said = coupling::check(options);
  } catch (const base::UserError& error) {
    said = error.what();
  }
  fs::remove(file);
  return said;
}

void expect_in(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << "\"" << part << "\" is not in:\n" << text;
}

const std::string one_grain = R"(title = "one grain"
[time]
dem_fraction = 1.0
[grains]
material = { young_modulus = "70 GPa", poisson_ratio = 0.3, density = 2699 }
friction = 0.0
restitution = 0.5
rotations = false
[[grain]]
position = [0, 0, 1]
radius = 0.1
[[stage]]
name = "fall"
duration = "1 s"
)";

TEST(Check, GrainsAloneStartNoFiniteElements) {
  const std::string text = check_of(one_grain);
  expect_in(text, "one grain\n");
  expect_in(text, "grains: 1 listed, diameters 200.0 .. 200.0 mm\n");
  expect_in(text, "rotations: off: no angular velocities\n");
  expect_in(text, "friction: off\n");
  expect_in(text, "contact law: hertz_mindlin\n");
  expect_in(text, "rolling: off\n");
  expect_in(text, "bodies: none: no PETSc\n");
  expect_in(text, "coupling: none: no exchange\n");
  expect_in(text, "stage fall: 1 s, measured from its start\n");
  expect_in(text, "0 FEM steps\n");
}

TEST(Check, PrecisionIsNamed) {
  expect_in(check_of(one_grain), "precision: double\n");
  expect_in(check_of(one_grain, {{"grains.precision", "mixed"}}),
            "precision: mixed: contacts between grains in single");
  expect_in(check_of(one_grain, {{"grains.precision", "single"}}), "grains.precision = \"single\"");
}

TEST(Check, LawsAreNamedPairByPair) {
  const std::string wall =
      "[[wall]]\nname = \"floor\"\nplane = { point = [0, 0, 0], normal = [0, 0, 1] }\nlaw = \"hysteretic\"\n"
      "damping_mode = 1\n";
  const std::string text = check_of(one_grain + wall, {{"grains.rolling", "type_a"}, {"grains.rolling_friction", "1"}});
  expect_in(text, "contact law: hertz_mindlin; with floor: hysteretic\n");
  expect_in(text, "rolling: type_a\n");
}

TEST(Check, BodiesAloneStartNoGrains) {
  const std::string mesh = std::string(TRACKBED_SOURCE_FOLDER) + "/meshes/box.geo";
  const std::string text =
      check_of("[[body]]\nname = \"beam\"\nmesh = \"" + mesh +
               "\"\nmesh_parameters = { cells_x = 4, cells_y = 1, cells_z = 1 }\n"
               "[[body.material]]\nyoung_modulus = \"45 GPa\"\npoisson_ratio = 0.167\ndensity = 2350\n"
               "[[stage]]\nname = \"swing\"\nduration = 0.1\n");
  expect_in(text, "grains: none: no neighbour search, no contact memory\n");
  expect_in(text, "beam: 4 hex8 elements, 20 nodes, 310.2 kg, ");  // 2.4 x 0.25 x 0.22 m, 2350 kg/m3
  expect_in(text, "no skin");
  expect_in(text, "0 DEM steps");
}

// A cube of soil pulled with 1 MPa, fifty times its cohesion: there is no equilibrium, but that is for the run to find,
// as a search may take long. What check prints does not need it.
TEST(Check, SearchesForNoEquilibrium) {
  const std::string mesh = std::string(TRACKBED_SOURCE_FOLDER) + "/meshes/box.geo";
  const std::string cube =
      "[[body]]\nname = \"soil\"\nmesh = \"" + mesh +
      "\"\nmesh_parameters = { length = 1.0, width = 1.0, height = 1.0, cells_x = 1, cells_y = 1, cells_z = 1 }\n"
      "[[body.material]]\nlaw = \"drucker_prager\"\nyoung_modulus = \"60 MPa\"\npoisson_ratio = 0.3\n"
      "density = 1800\ncohesion = \"20 kPa\"\nfriction_angle = \"30 deg\"\ndilation_angle = \"30 deg\"\n"
      "fit = \"outer\"\n"
      "[[body.support]]\ngroup = \"x_min\"\nfix = [\"x\"]\n[[body.support]]\ngroup = \"y_min\"\nfix = [\"y\"]\n"
      "[[body.support]]\ngroup = \"z_min\"\nfix = [\"z\"]\n"
      "[[body.load]]\nname = \"pull\"\ngroup = \"z_max\"\nkind = \"face_total\"\ndirection = [0.0, 0.0, 1.0]\n"
      "history = { kind = \"constant\", value = \"1 MN\" }\n"
      "[[stage]]\nname = \"go\"\nduration = 0.1\n[fem]\nstart = \"equilibrium\"\n";
  const std::string text = check_of(cube);
  expect_in(text, "bodies: explicit, from the equilibrium under the loads of time 0\n");
  expect_in(text, "  stage go: 0.1 s");
  // That there is none, and what was left out is no more than the search: what holds nothing is refused as before.
  expect_in(check_of(cube, {{"body.soil.support.2.fix", "[\"x\"]"}}), "there is no equilibrium");
}

// A linear spring k on a node of mass M, 1 : 1: 2 / sqrt(k / M), the block next to no spring of its own. 10 : 1: the
// force acts (1 - 1/10) / 2 of a window late.
TEST(Check, CoupledLimitAndLagAreSaid) {
  const std::string mesh = std::string(TRACKBED_SOURCE_FOLDER) + "/meshes/box.geo";
  const std::string block = "[[body]]\nname = \"block\"\nmesh = \"" + mesh +
                            "\"\nmesh_parameters = { length = 0.1, width = 0.1, height = 0.1, cells_x = 1, cells_y = "
                            "1, cells_z = 1 }\nskin = [\"z_max\"]\n[[body.material]]\nyoung_modulus = 20\n"
                            "poisson_ratio = 0.0\ndensity = 20\n";
  const std::vector<coupling::Override> linear{{"grains.law", "linear"},
                                               {"grains.normal_stiffness", "1e5 N/m"},
                                               {"grains.shear_stiffness", "1e4 N/m"},
                                               {"time.dem_step", "0.1 ms"},
                                               {"time.fem_step", "1 ms"},
                                               {"coupling.n_fem", "1"}};
  auto with = linear;
  with.push_back({"coupling.n_dem", "1"});
  const std::string text = check_of(one_grain + block, with);
  expect_in(text, "  contact forces act on the bodies 0 s late\n");
  expect_in(text,
            "  coupled limit at block: window of at most 0.0003162 s with one contact of 1e+05 N/m at a node of "
            "0.0025 kg\n");
  with = linear;
  with.push_back({"coupling.n_dem", "10"});
  expect_in(check_of(one_grain + block, with), "  contact forces act on the bodies 0.00045 s late\n");
  expect_in(check_of(one_grain + block), "  coupled limit at block: from the contacts, as they press\n");
}

TEST(Check, StepAboveTheLimitIsRefused) {
  expect_in(check_of(one_grain, {{"time.dem_step", "1 s"}}), "time.dem_step = 1 s; must be at most the stable step ");
  expect_in(check_of(one_grain, {{"time.dem_step", "1 s"}, {"time.force_step", "true"}}), "at most 1 s is used");
}

}  // namespace
