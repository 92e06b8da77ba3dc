// Scenes of the implicit solvers as a user starts them.
#include <gtest/gtest.h>
#include <vtkDataArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkSmartPointer.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLUnstructuredGridReader.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "tests/regression/run_helper.hpp"

namespace {

using namespace regression;

double relative_error(const nlohmann::json& json, const char* name) {
  return json["results"][name]["relative_error"].get<double>();
}

vtkSmartPointer<vtkUnstructuredGrid> picture(const fs::path& file) {
  vtkNew<vtkXMLUnstructuredGridReader> reader;
  reader->SetFileName(file.c_str());
  reader->Update();
  return reader->GetOutput();
}

TEST(Solvers, CantileverInEquilibrium) {
  const fs::path out = scratch() / "cantilever_static";
  const auto finished = trackbed("run " + scene("cantilever_static.toml") + " --out " + out.string(), 2);
  ASSERT_EQ(finished.status, 0) << finished.output;
  const auto json = summary(out);
  EXPECT_EQ(json["solver"], "static");
  EXPECT_EQ(json["steps"]["fem"], 1);
  for (const char* tip : {"tip_tet4", "tip_hex8", "tip_bbar"})
    EXPECT_LT(std::abs(relative_error(json, tip)), 1e-4) << tip;
  EXPECT_LT(std::abs(relative_error(json, "clamp_bbar")), 1e-8);
  EXPECT_LT(json["energy"]["relative_error"].get<double>(), 1e-8);
  EXPECT_TRUE(fs::exists(out / "bbar.pvd"));
  // The picture: reactions are those of the 200 N and stand at the clamp only; the largest von Mises of the nodes' mean
  // stress is 190.87 kPa on these tetrahedra (CalculiX, FrontISTR). Means of the elements' von Mises would differ.
  const auto grid = picture(out / "tet4" / "tet4_0001.vtu");
  auto* const nodes = grid->GetPointData();
  for (const char* name : {"displacement", "velocity", "acceleration", "reaction", "nodal_stress", "nodal_von_mises",
                           "nodal_principal_stress"})
    ASSERT_NE(nodes->GetArray(name), nullptr) << name;
  std::array<double, 3> reaction{};
  double largest = 0, trace = 0;
  for (vtkIdType i = 0; i < grid->GetNumberOfPoints(); ++i) {
    std::array<double, 3> here{}, principal{};
    std::array<double, 6> stress{};
    nodes->GetArray("reaction")->GetTuple(i, here.data());
    nodes->GetArray("nodal_stress")->GetTuple(i, stress.data());
    nodes->GetArray("nodal_principal_stress")->GetTuple(i, principal.data());
    for (int c = 0; c < 3; ++c) {
      reaction[c] += here[c];
      EXPECT_TRUE(here[c] == 0 || grid->GetPoint(i)[0] < 1e-9);
    }
    const double mises = nodes->GetArray("nodal_von_mises")->GetComponent(i, 0);
    largest = std::max(largest, mises);
    trace = std::max(trace, std::abs(principal[0] + principal[1] + principal[2] - stress[0] - stress[1] - stress[2]));
  }
  EXPECT_NEAR(largest, 190.87e3, 1e-4 * 190.87e3);
  EXPECT_LT(trace, 1e-9 * largest);
  EXPECT_NEAR(reaction[0], 0, 1e-6);
  EXPECT_NEAR(reaction[2], 200, 1e-6);
}

// A block that falls: every node of the picture has the acceleration of gravity, on two ranks too, and no reaction.
TEST(Solvers, PictureOfAFall) {
  const fs::path file = scratch() / "fall.toml", out = scratch() / "fall";
  std::ofstream(file) << "gravity = [1, -2, -9.81]\n[[body]]\nname = \"block\"\nmesh = \"" << TRACKBED_SOURCE_FOLDER
                      << "/meshes/box.geo\"\nmesh_parameters = { cells_x = 6, cells_y = 2, cells_z = 2 }\n"
                         "[[body.material]]\nyoung_modulus = 1e9\npoisson_ratio = 0.2\ndensity = 2000\n"
                         "[[stage]]\nname = \"fall\"\nduration = 1e-2\n";
  const auto finished = trackbed("run " + file.string() + " --out " + out.string(), 2);
  ASSERT_EQ(finished.status, 0) << finished.output;
  const auto grid = picture(out / "block" / "block_0001.vtu");
  auto* const acceleration = grid->GetPointData()->GetArray("acceleration");
  auto* const reaction = grid->GetPointData()->GetArray("reaction");
  ASSERT_TRUE(acceleration && reaction);
  ASSERT_EQ(grid->GetNumberOfPoints(), 63);
  constexpr std::array gravity{1.0, -2.0, -9.81};
  for (vtkIdType i = 0; i < grid->GetNumberOfPoints(); ++i) {
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(acceleration->GetComponent(i, c), gravity[c], 1e-8);
      EXPECT_EQ(reaction->GetComponent(i, c), 0);
    }
  }
}

// The box's bending against Timoshenko's beam: 0.5 %.
TEST(Solvers, SleeperModes) {
  const fs::path out = scratch() / "sleeper_modes";
  const auto finished = trackbed("run " + scene("sleeper_modes.toml") + " --out " + out.string());
  ASSERT_EQ(finished.status, 0) << finished.output;
  const auto json = summary(out);
  EXPECT_EQ(json["modes"]["sleeper"]["rigid_motions"], 6);
  EXPECT_EQ(json["modes"]["sleeper"]["modes"].size(), 8u);
  for (const char* mode : {"bending_1", "bending_2", "bending_3"})
    EXPECT_LT(std::abs(relative_error(json, mode)), 0.005) << mode;
  EXPECT_NE(finished.output.find("body sleeper: 8 elastic modes, 6 rigid motions"), std::string::npos);
  EXPECT_TRUE(fs::exists(out / "sleeper" / "sleeper_0007.vtu"));
}

TEST(Solvers, SubgradeBlock) {
  const fs::path out = scratch() / "subgrade_block";
  const auto finished = trackbed("run " + scene("subgrade_block.toml") + " --out " + out.string());
  ASSERT_EQ(finished.status, 0) << finished.output;
  const auto json = summary(out);
  EXPECT_LT(std::abs(relative_error(json, "middle")), 0.003);
  EXPECT_LT(std::abs(relative_error(json, "corner")), 0.003);
  EXPECT_LT(std::abs(relative_error(json, "base")), 1e-6);
}

TEST(Solvers, PlateOnLedges) {
  const fs::path out = scratch() / "plate_static";
  const auto finished = trackbed("run " + scene("plate_static.toml") + " --out " + out.string());
  ASSERT_EQ(finished.status, 0) << finished.output;
  const auto json = summary(out);
  for (const char* place : {"deflection_0m", "deflection_1m", "deflection_2m"})
    EXPECT_LT(std::abs(relative_error(json, place)), 1e-4) << place;
}

// Against the closed forms; the paper's eq. 14, with mu for 2 mu, would be off by a tenth and more.
TEST(Solvers, CreepAndRecovery) {
  const fs::path out = scratch() / "creep_recovery";
  const auto finished = trackbed("run " + scene("creep_recovery.toml") + " --out " + out.string());
  ASSERT_EQ(finished.status, 0) << finished.output;
  const auto json = summary(out);
  for (const char* name : {"creep_held", "recovery_held", "creep_slip", "recovery_slip"})
    EXPECT_LT(std::abs(relative_error(json, name)), 0.01) << name;
  for (const char* name : {"creep_fixed", "recovery_fixed"})
    EXPECT_TRUE(json["results"][name]["within"].get<bool>()) << name;
}

TEST(Solvers, DampedBar) {
  const fs::path out = scratch() / "damped_bar";
  const auto finished = trackbed("run " + scene("damped_bar.toml") + " --out " + out.string());
  ASSERT_EQ(finished.status, 0) << finished.output;
  const auto json = summary(out);
  for (const char* name : {"rate_low", "rate_middle", "rate_high"})
    EXPECT_LT(std::abs(relative_error(json, name)), 0.005) << name;
  EXPECT_LT(std::abs(relative_error(json, "frequency")), 0.002);
}

TEST(Solvers, WaveInABar) {
  const fs::path out = scratch() / "wave_bar";
  const auto finished = trackbed("run " + scene("wave_bar.toml") + " --out " + out.string());
  ASSERT_EQ(finished.status, 0) << finished.output;
  const auto json = summary(out);
  for (const char* name : {"plateau_free", "plateau_fine", "plateau_rollers"})
    EXPECT_LT(std::abs(relative_error(json, name)), 0.002) << name;
  // Half height, in cells that would not lag: 1.5 and 0.8 % earlier.
  for (const char* name : {"arrival_free", "arrival_fine", "arrival_rollers"})
    EXPECT_LT(std::abs(relative_error(json, name)), 0.002) << name;
  for (const char* name : {"overshoot_free", "overshoot_fine", "overshoot_rollers"})
    EXPECT_LT(std::abs(relative_error(json, name)), 0.02) << name;
}

TEST(Solvers, ColumnWithAnAbsorbingFoot) {
  const fs::path out = scratch() / "absorbing_column";
  const auto finished = trackbed("run " + scene("absorbing_column.toml") + " --out " + out.string());
  ASSERT_EQ(finished.status, 0) << finished.output;
  const auto json = summary(out);
  EXPECT_TRUE(json["results"]["echo_absorbing"]["within"].get<bool>());
  EXPECT_LT(std::abs(relative_error(json, "echo_free")), 0.02);
}

TEST(Solvers, SoilInTriaxialCompression) {
  const fs::path out = scratch() / "drucker_prager_triaxial";
  const auto finished = trackbed("run " + scene("drucker_prager_triaxial.toml") + " --out " + out.string());
  ASSERT_EQ(finished.status, 0) << finished.output;
  const auto json = summary(out);
  for (const char* name : {"stress_02", "stress_05", "stress_10", "lateral_02", "lateral_05", "lateral_10"})
    EXPECT_LT(std::abs(relative_error(json, name)), 1e-3) << name;
}

TEST(Solvers, AMechanismIsTheUsersMistake) {
  const fs::path file = scratch() / "loose.toml", out = scratch() / "loose";
  std::ofstream(file) << "[fem]\nsolver = \"static\"\n[[body]]\nname = \"beam\"\nmesh = \"" << TRACKBED_SOURCE_FOLDER
                      << "/meshes/box.geo\"\n[[body.material]]\nyoung_modulus = 1e9\npoisson_ratio = 0.2\n"
                         "density = 2000\n[[body.support]]\ngroup = \"z_min\"\nfix = [\"z\"]\n"
                         "[[stage]]\nname = \"rest\"\nduration = 1\n";
  for (const int ranks : {0, 2}) {
    const auto finished = trackbed("run '" + file.string() + "' --out " + out.string(), ranks);
    EXPECT_EQ(finished.status, 2) << finished.output;
    EXPECT_NE(finished.output.find("loose.toml:3: body \"beam\": nothing holds it against translation along x, "
                                   "translation along y, rotation about z through (1.2, 0, 0) m; there is no "
                                   "equilibrium, the static system is singular; add a [[body.support]] that fixes it"),
              std::string::npos)
        << finished.output;
    EXPECT_FALSE(fs::exists(out));
  }
}

// Mobility as in Nishiura2017 4.2: spectrum of a velocity over that of the load, both smoothed by Parzen's window, 20
// Hz wide. The middle of a free block of mass m, damped by alpha, has 1 / (m sqrt(alpha^2 + omega^2)), whatever the
// pulse.
TEST(Solvers, MobilityOfAFreeBlock) {
  const fs::path file = scratch() / "mobility.toml", out = scratch() / "mobility";
  std::ofstream(file)
      << "gravity = [0, 0, 0]\n[[body]]\nname = \"block\"\nmesh = \"" << TRACKBED_SOURCE_FOLDER
      << "/meshes/box.geo\"\nmesh_parameters = { length = 1, width = 1, height = 1, cells_x = 1, cells_y "
         "= 1, cells_z = 1 }\ndamping = 60\n[[body.material]]\nyoung_modulus = 30e9\npoisson_ratio = "
         "0.2\ndensity = 2000\n[[body.load]]\nname = \"hammer\"\ngroup = \"z_max\"\nkind = "
         "\"face_total\"\ndirection = [0, 0, -1]\nhistory = { kind = \"table\", times = [0, 1e-3, 2e-3], "
         "values = [0, 1e4, 0] }\n[[stage]]\nname = \"blow\"\nduration = 0.4\n"
         "[[probe]]\nname = \"v\"\nkind = \"velocity\"\nbody = \"block\"\ngroup = \"solid\"\n"
         "[[probe]]\nname = \"force\"\nkind = \"load\"\nload = \"hammer\"\n"
         "[[spectrum]]\nname = \"mobility\"\nprobe = \"v\"\nover = \"force\"\nbandwidth = 20\n";
  const auto finished = trackbed("run '" + file.string() + "' --out " + out.string());
  ASSERT_EQ(finished.status, 0) << finished.output;
  std::istringstream lines(slurp(out / "spectra.csv"));
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "frequency [Hz],mobility [m/s/(N)]");
  int compared = 0;
  double frequency = 0, mobility = 0;
  while (std::getline(lines, line) && std::sscanf(line.c_str(), "%lf,%lf", &frequency, &mobility) == 2) {
    if (frequency < 100 || frequency > 250) continue;  // below, 20 Hz are wide
    const double expected = 1 / (2000 * std::hypot(60, 2 * std::numbers::pi * frequency));
    EXPECT_NEAR(mobility, expected, 0.02 * expected) << frequency << " Hz";
    ++compared;
  }
  EXPECT_GT(compared, 40);
}

// A layer under shear, periodic along the track, on one rank and on two: u = tau h / mu at the top, however short it
// is.
TEST(Solvers, LayerWithoutEnds) {
  const fs::path file = scratch() / "layer.toml", out = scratch() / "layer";
  std::ofstream(file)
      << "[fem]\nsolver = \"static\"\n[[body]]\nname = \"layer\"\nmesh = \"" << TRACKBED_SOURCE_FOLDER
      << "/meshes/box.geo\"\ngravity = false\nmesh_parameters = { length = 1, width = 0.5, height = 0.5, "
         "cells_x = 4, cells_y = 2, cells_z = 2 }\n[[body.material]]\nyoung_modulus = 24e6\npoisson_ratio "
         "= 0.2\ndensity = 2000\n[[body.support]]\ngroup = \"z_min\"\nfix = [\"x\", \"y\", \"z\"]\n"
         "[[body.periodic]]\nfirst = \"x_min\"\nsecond = \"x_max\"\n"
         "[[body.load]]\nname = \"shear\"\ngroup = \"z_max\"\nkind = \"traction\"\ndirection = [1, 0, "
         "0]\nhistory = { kind = \"constant\", value = 1e4 }\n[[stage]]\nname = \"rest\"\nduration = 1\n"
         "[[probe]]\nname = \"top\"\nkind = \"displacement\"\nbody = \"layer\"\npoint = [1, 0.25, "
         "0.25]\ncomponent = \"x\"\n[[result]]\nname = \"top\"\nprobe = \"top\"\nexpected = 5e-4\n";
  const auto checked = trackbed("check " + file.string());
  EXPECT_NE(checked.output.find("periodic: x_min and x_max are one"), std::string::npos) << checked.output;
  for (const int ranks : {0, 2}) {
    const auto finished = trackbed("run " + file.string() + " --overwrite --out " + out.string(), ranks);
    ASSERT_EQ(finished.status, 0) << finished.output;
    EXPECT_LT(std::abs(relative_error(summary(out), "top")), 1e-8);
  }
}

// A grain slides round a periodic slab of the same period. Over the seam it stays where it is: without a skin beyond
// the face it would sink by its overlap, 4 um, until it comes in at the other side.
TEST(Solvers, GrainCrossesTheSeam) {
  const fs::path file = scratch() / "seam_crossed.toml", out = scratch() / "seam_crossed";
  std::ofstream(file) << R"([grains]
law = "hertz_mindlin"
restitution = 0.3
friction = 0.0
[grains.material]
young_modulus = "1 GPa"
poisson_ratio = 0.2
density = 2600
[[grains.periodic]]
axis = "x"
lower = 0.0
upper = 0.4
[[grain]]
position = [0.3, 0.02, 0.069996]
radius = 0.02
velocity = [1.0, 0.0, 0.0]
[[body]]
name = "slab"
mesh = ")" << TRACKBED_SOURCE_FOLDER
                      << R"(/meshes/box.geo"
mesh_parameters = { length = 0.4, width = 0.2, height = 0.1, cells_x = 8, cells_y = 4, cells_z = 2 }
element = "hex8_bbar"
gravity = false
skin = ["z_max"]
[[body.material]]
young_modulus = "1 GPa"
poisson_ratio = 0.2
density = 2000
[[body.support]]
group = "z_min"
fix = ["x", "y", "z"]
[[body.periodic]]
first = "x_min"
second = "x_max"
[[stage]]
name = "settle"
duration = 0.06
[[stage]]
name = "slide"
duration = 0.08
measure = true
[[probe]]
name = "height"
kind = "grain_position"
grain = 0
component = "z"
[[probe]]
name = "speed"
kind = "grain_velocity"
grain = 0
component = "x"
[[result]]
name = "height"
probe = "height"
take = "range"
[[result]]
name = "speed"
probe = "speed"
expected = 1.0
)";
  for (const int ranks : {0, 3}) {
    const auto finished = trackbed("run " + file.string() + " --overwrite --out " + out.string(), ranks);
    ASSERT_EQ(finished.status, 0) << finished.output;
    const auto json = summary(out);
    EXPECT_LT(json["results"]["height"]["value"].get<double>(), 1e-7);
    EXPECT_LT(std::abs(relative_error(json, "speed")), 1e-4);
    EXPECT_LT(json["momentum_error"].get<double>(), 1e-12);
  }
}

TEST(Solvers, CheckSaysHowBodiesAreSolved) {
  const auto modal = trackbed("check " + scene("sleeper_modes.toml"));
  EXPECT_EQ(modal.status, 0) << modal.output;
  EXPECT_NE(modal.output.find("bodies: modal"), std::string::npos) << modal.output;
  EXPECT_NE(modal.output.find("modes: 8 of every body"), std::string::npos) << modal.output;
  const auto still = trackbed("check " + scene("cantilever_static.toml"));
  EXPECT_NE(still.output.find("stage equilibrium: 1 s in 1 implicit steps"), std::string::npos) << still.output;
}

}  // namespace
