// Whole runs as a user starts them: the quick scenes, forced instability, refused input.
#include <gtest/gtest.h>

#include "tests/regression/run_helper.hpp"

namespace {

using namespace regression;

TEST(Runs, QuickSleeperFromPackingToResults) {
  const fs::path out = scratch() / "quick";
  const auto finished = trackbed("run " + scene("quick/one_sleeper.toml") + " --out " + out.string(), 2);
  ASSERT_EQ(finished.status, 0) << finished.output;
  const auto json = summary(out);
  EXPECT_EQ(json["status"], "completed");
  EXPECT_EQ(json["ranks"], 2);
  // What one side gives the other takes: only rounding may be lost.
  EXPECT_LE(json["momentum_error"].get<double>(), 1e-12);
  EXPECT_GT(json["momentum_error"].get<double>(), 0);
  EXPECT_LE(json["energy"]["relative_error"].get<double>(), 0.01);
  const auto& results = json["results"];
  EXPECT_GT(results["residual_settlement"]["value"].get<double>(), 0);
  EXPECT_LT(results["residual_settlement"]["value"].get<double>(), results["peak_settlement"]["value"].get<double>());
  EXPECT_GE(results["porosity"]["value"].get<double>(), 0.36);
  EXPECT_LE(results["porosity"]["value"].get<double>(), 0.45);
  for (const auto* file :
       {"scene.resolved.toml", "history.csv", "run.log", "grains.pvd", "sleeper.pvd", "ground.pvd", "contacts.pvd"})
    EXPECT_TRUE(fs::exists(out / file)) << file;
  EXPECT_NE(finished.output.find("k_sub"), std::string::npos) << finished.output;
}

TEST(Runs, CantileverStartsNoDem) {
  const fs::path out = scratch() / "cantilever";
  const auto finished =
      trackbed("run " + scene("cantilever_step.toml") + " --out " + out.string() + " --until 1e-3", 2);
  ASSERT_EQ(finished.status, 0) << finished.output;
  const auto json = summary(out);
  EXPECT_EQ(json["backend"], "none");
  EXPECT_EQ(json["grains"], 0);
  EXPECT_EQ(json["steps"]["dem"], 0);
  EXPECT_FALSE(json["wall_share"].contains("dem"));
  EXPECT_FALSE(json["wall_share"].contains("exchange"));
  EXPECT_FALSE(json.contains("dem_bytes"));
  EXPECT_FALSE(fs::exists(out / "grains.pvd"));
}

// Clumps: the floor carries the union of their spheres (the sum would be half as much again), and the pictures show
// every sphere.
TEST(Runs, StonesFallAndRestOnAPlane) {
  const fs::path out = scratch() / "stones";
  const auto finished = trackbed("run " + scene("clump_drop.toml") + " --out " + out.string());
  ASSERT_EQ(finished.status, 0) << finished.output;
  const auto json = summary(out);
  EXPECT_EQ(json["grains"], 4);
  EXPECT_EQ(json["spheres"], 66);
  EXPECT_LT(std::abs(json["results"]["weight"]["relative_error"].get<double>()), 0.005);
  EXPECT_EQ(json["results"]["kinetic_energy"]["within"], true);
  EXPECT_LT(json["energy"]["relative_error"].get<double>(), 0.02);
  EXPECT_NE(slurp(out / "grains" / "grains_0001.vtp").find("NumberOfPoints=\"66\""), std::string::npos);
}

// What a run starts from holds energy in its contacts: taken for nothing, it would look like energy from nowhere.
TEST(Runs, PressedContactsHoldEnergyFromTheStart) {
  const fs::path file = scratch() / "pressed.toml", out = scratch() / "pressed";
  std::ofstream(file) << two_grains;
  const std::string other = geteuid() == 0 ? "setpriv --reuid=65534 --regid=65534 --clear-groups " : "";
  const auto refuse = [&](const fs::path& out, const std::string& expected) {
    const std::string command = "cd / && " + other + "'" + program.string() + "' run '" + file.string() + "' --out '" +
                                out.string() + "' > '" + log.string() + "' 2>&1";
    const int status = std::system(command.c_str());
    const std::string text = slurp(log);
    EXPECT_EQ(WEXITSTATUS(status), 2) << text;
    EXPECT_NE(text.find(expected), std::string::npos) << text;
    EXPECT_TRUE(fs::is_empty(place));
  };
  refuse(place, place.string() + ": no permission to write there; choose a folder of yours");
  refuse(place / "results", "(Permission denied); choose a place you may write to");
  fs::permissions(place, fs::perms::owner_all);
}

TEST(Runs, OverlappingBodiesAreRefused) {
  const fs::path out = scratch() / "overlap";
  const auto finished = trackbed("run " + scene("quick/one_sleeper.toml") + " --out " + out.string() +
                                 " --set 'body.sleeper.translation=[0.3, 0.0, -0.1]'");
  EXPECT_EQ(finished.status, 2) << finished.output;
  EXPECT_NE(finished.output.find("bodies \"sleeper\" and \"ground\" overlap in the box"), std::string::npos)
      << finished.output;
  EXPECT_FALSE(fs::exists(out));
}

TEST(Runs, ResolvedSceneRunsAgain) {
  const fs::path first = scratch() / "once", second = scratch() / "again";
  auto finished = trackbed("run " + scene("cantilever_step.toml") + " --out " + first.string() + " --until 5e-4");
  ASSERT_EQ(finished.status, 0) << finished.output;
  finished =
      trackbed("run " + (first / "scene.resolved.toml").string() + " --out " + second.string() + " --until 5e-4");
  ASSERT_EQ(finished.status, 0) << finished.output;
  EXPECT_EQ(slurp(first / "history.csv"), slurp(second / "history.csv"));
}

TEST(Runs, CheckTellsWhatASceneSwitchesOn) {
  const auto cantilever = trackbed("check " + scene("cantilever_step.toml"));
  EXPECT_EQ(cantilever.status, 0) << cantilever.output;
  EXPECT_NE(cantilever.output.find("no neighbour search"), std::string::npos) << cantilever.output;
  const auto sleeper = trackbed("check " + scene("quick/one_sleeper.toml"));
  EXPECT_EQ(sleeper.status, 0) << sleeper.output;
  EXPECT_EQ(sleeper.output.find("no neighbour search"), std::string::npos) << sleeper.output;
}

TEST(Runs, MoreRanksThanAGrainSceneCanUseAreRefused) {
  const fs::path file = scratch() / "grains.toml";
  std::ofstream(file)
      << "title = \"one grain\"\n[grains]\nmaterial = { young_modulus = \"1 GPa\", poisson_ratio = 0.2, "
         "density = 2700 }\nfriction = 0.5\nrestitution = 0.5\n[[grain]]\nposition = [0, 0, 1]\nradius = "
         "0.02\n[[stage]]\nname = \"fall\"\n"
         "duration = \"1 ms\"\n";
  const auto one = trackbed("run " + file.string() + " --out " + (scratch() / "one_grain").string());
  EXPECT_EQ(one.status, 0) << one.output;
  EXPECT_FALSE(summary(scratch() / "one_grain")["wall_share"].contains("fem"));
  const auto two = trackbed("run " + file.string() + " --out " + (scratch() / "two").string(), 2);
  EXPECT_EQ(two.status, 2) << two.output;
  EXPECT_NE(two.output.find("one rank does all its work"), std::string::npos) << two.output;
}

}  // namespace
