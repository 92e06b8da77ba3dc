// Whole runs as a user starts them: the quick scenes, forced instability, refused input.
#include <fmt/core.h>
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
  EXPECT_EQ(json["dem_ranks"], 1);
  EXPECT_EQ(json["fem_ranks"], 1);
  // What one side gives the other takes: only rounding may be lost.
  EXPECT_LE(json["momentum_error"].get<double>(), 1e-12);
  EXPECT_GT(json["momentum_error"].get<double>(), 0);
  EXPECT_LE(json["energy"]["relative_error"].get<double>(), 0.01);
  const auto& results = json["results"];
  EXPECT_GT(results["residual_settlement"]["value"].get<double>(), 0);
  EXPECT_LT(results["residual_settlement"]["value"].get<double>(), results["peak_settlement"]["value"].get<double>());
  EXPECT_GE(results["porosity"]["value"].get<double>(), 0.36);
  EXPECT_LE(results["porosity"]["value"].get<double>(), 0.45);
  // Raising the grains' modulus must not wedge the bed between the planes of symmetry.
  EXPECT_EQ(results["earth_pressure_ratio"]["within"], true) << results["earth_pressure_ratio"]["value"];
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

TEST(Runs, AGpuForASceneWithoutGrainsIsSaidToBeOfNoUse) {
  const auto said = trackbed("check " + scene("cantilever_step.toml") + " --backend cuda");
  EXPECT_EQ(said.status, 0) << said.output;
  EXPECT_EQ(said.output.find("--backend cuda: the scene has no grains, so no GPU is used\n"), 0u) << said.output;
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
  std::ofstream(file) << R"(
[grains]
friction = 0.5
restitution = 0.9
material = { young_modulus = "10 MPa", poisson_ratio = 0.2, density = 2700 }
[[grain]]
position = [0, 0, "19 mm"]
radius = "20 mm"
[[wall]]
name = "floor"
plane = { point = [0, 0, 0], normal = [0, 0, 1] }
[[stage]]
name = "rebound"
duration = "20 ms"
[output]
probe_interval = "1 ms"
)";
  const auto finished = trackbed("run '" + file.string() + "' --out " + out.string());
  ASSERT_EQ(finished.status, 0) << finished.output;
  EXPECT_LT(summary(out)["energy"]["relative_error"].get<double>(), 0.05);
}

TEST(Runs, ForcedStepFarAboveTheLimitStopsWithItsCause) {
  const fs::path out = scratch() / "unstable";
  const auto finished = trackbed("run " + scene("cantilever_step.toml") + " --out " + out.string() +
                                     " --set time.fem_step=2e-5 --set time.force_step=true",
                                 2);
  EXPECT_EQ(finished.status, 3) << finished.output;
  EXPECT_NE(finished.output.find("trackbed: error: "), std::string::npos) << finished.output;
  const auto json = summary(out);
  EXPECT_EQ(json["status"], "unstable");
  EXPECT_FALSE(json["message"].get<std::string>().empty());
  EXPECT_GT(fs::file_size(out / "history.csv"), 100u);
}

TEST(Runs, StepAboveTheLimitIsRefusedBeforeAnythingIsWritten) {
  const fs::path out = scratch() / "refused";
  const auto finished =
      trackbed("run " + scene("cantilever_step.toml") + " --out " + out.string() + " --set time.fem_step=2e-5", 2);
  EXPECT_EQ(finished.status, 2) << finished.output;
  EXPECT_NE(finished.output.find("time.fem_step = 2e-05 s; must be at most the stable step"), std::string::npos)
      << finished.output;
  EXPECT_FALSE(fs::exists(out));
}

TEST(Runs, ExistingResultsAreKept) {
  const fs::path out = scratch() / "kept";
  fs::create_directories(out);
  std::ofstream(out / "history.csv") << "precious";
  const auto finished = trackbed("run " + scene("cantilever_step.toml") + " --out " + out.string());
  EXPECT_EQ(finished.status, 2) << finished.output;
  EXPECT_NE(finished.output.find("the folder exists; nothing was written"), std::string::npos) << finished.output;
  EXPECT_EQ(slurp(out / "history.csv"), "precious");
}

const char* const two_grains = R"(
[grains]
friction = 0.5
restitution = 0.5
material = { young_modulus = "1 GPa", poisson_ratio = 0.2, density = 2700 }
[[grain]]
position = [0, 0, "0.05 m"]
radius = "20 mm"
[[grain]]
position = ["0.1 m", 0, "0.05 m"]
radius = "20 mm"
[[wall]]
name = "floor"
plane = { point = [0, 0, 0], normal = [0, 0, 1] }
[[stage]]
name = "fall"
duration = "7 ms"
)";

// Input that is found wrong only when everything is in place still costs nothing of an earlier run.
TEST(Runs, RefusedInputLeavesTheEarlierRunAlone) {
  const fs::path out = scratch() / "earlier", file = scratch() / "two_grains.toml", other = scratch() / "overlap.toml";
  std::ofstream(file) << two_grains;
  std::string overlapping = two_grains;
  overlapping.replace(overlapping.find("0.1 m"), 5, "10 mm");
  std::ofstream(other) << overlapping;
  const auto first = trackbed("run " + file.string() + " --out " + out.string());
  ASSERT_EQ(first.status, 0) << first.output;
  EXPECT_NEAR(summary(out)["time_simulated_s"].get<double>(), 7e-3, 1e-4);
  std::ofstream(out / "notes.txt") << "mine";
  const std::string before = slurp(out / "history.csv");
  for (const std::string& wrong : {file.string() + " --set time.dem_step=0.01", other.string()}) {
    const auto finished = trackbed("run " + wrong + " --overwrite --out " + out.string());
    EXPECT_EQ(finished.status, 2) << wrong << finished.output;
    EXPECT_EQ(slurp(out / "history.csv"), before) << wrong;
  }
  ASSERT_EQ(trackbed("run " + file.string() + " --overwrite --out " + out.string()).status, 0);
  EXPECT_EQ(slurp(out / "notes.txt"), "mine");
}

// Few samples do not hide an explosion: the last one is judged.
TEST(Runs, ForcedStepWithFewSamplesStopsToo) {
  const fs::path out = scratch() / "few";
  const auto finished = trackbed("run " + scene("cantilever_step.toml") + " --out " + out.string() +
                                 " --set time.fem_step=1e-4 --set time.force_step=true --set "
                                 "output.probe_interval=0.02");
  EXPECT_EQ(finished.status, 3) << finished.output;
}

// Two grains on a collision course that jump past each other: nothing touches, no energy is lost, and it is wrong.
TEST(Runs, ForcedStepOfGrainsThatMissEachOther) {
  const fs::path out = scratch() / "missed", file = scratch() / "missed.toml";
  std::ofstream(file) << R"([time]
dem_step = "0.1 s"
force_step = true
[grains]
material = { young_modulus = "16.8 GPa", poisson_ratio = 0.2, density = "2700 kg/m3" }
friction = 0.6
restitution = 0.4
[[grain]]
position = [0.0, 0.0, 0.0]
radius = "20 mm"
velocity = [1.0, 0.0, 0.0]
[[grain]]
position = [0.35, 0.0, 0.0]
radius = "20 mm"
velocity = [-1.5, 0.0, 0.0]
[[stage]]
name = "fly"
duration = "1 s"
)";
  const auto finished = trackbed("run " + file.string() + " --out " + out.string());
  EXPECT_EQ(finished.status, 3) << finished.output;
  EXPECT_NE(finished.output.find("moves 0.1"), std::string::npos) << finished.output;
}

// An interval that no step resolves asks for every step, and does not hang.
TEST(Runs, IntervalFarBelowTheStep) {
  const fs::path out = scratch() / "dense";
  const auto finished = trackbed("run " + scene("clump_drop.toml") + " --out " + out.string() +
                                 " --set output.probe_interval=1e-30 --until 1e-3");
  EXPECT_EQ(finished.status, 0) << finished.output;
  const auto json = summary(out);
  const std::string rows = slurp(out / "history.csv");
  EXPECT_GE(std::count(rows.begin(), rows.end(), '\n'), json["steps"]["dem"].get<int>());
}

// Nobody stops root: as root the program is copied to where everybody may read it and started as another user.
TEST(Runs, FolderWithoutWritePermissionIsRefused) {
  const fs::path place = scratch() / "locked", program = scratch() / "trackbed_for_all";
  fs::create_directories(place);
  fs::permissions(place, fs::perms::owner_read | fs::perms::owner_exec | fs::perms::group_read | fs::perms::group_exec |
                             fs::perms::others_read | fs::perms::others_exec);
  fs::copy_file(TRACKBED_PROGRAM, program, fs::copy_options::overwrite_existing);
  const fs::path file = scratch() / "one_grain.toml", log = scratch() / "locked.txt";
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
  EXPECT_NE(finished.output.find(": body \"ground\" overlaps body \"sleeper\" ("), std::string::npos)
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

TEST(Runs, AllRanksOfAGrainSceneHoldGrains) {
  const auto write = [](const std::string& name, int grains) {
    std::ofstream(scratch() / name) << fmt::format(R"(title = "grains"
[grains]
material = {{ young_modulus = "1 GPa", poisson_ratio = 0.2, density = 2700 }}
friction = 0.5
restitution = 0.5
[[grain]]
position = [0, 0, 1]
radius = 0.02
repeat = [{}, 1, 1]
spacing = [0.05, 0, 0]
[[stage]]
name = "fall"
duration = "1 ms"
)",
                                                   grains);
    return "run " + name + " --out ";
  };
  const std::string run = write("grains.toml", 6);
  const auto one = trackbed(run + "one_rank");
  EXPECT_EQ(one.status, 0) << one.output;
  EXPECT_FALSE(summary(scratch() / "one_rank")["wall_share"].contains("fem"));
  const auto two = trackbed(run + "two_ranks", 2);
  EXPECT_EQ(two.status, 0) << two.output;
  const auto two_ranks = summary(scratch() / "two_ranks");
  EXPECT_EQ(two_ranks["ranks"], 2);
  EXPECT_EQ(two_ranks["dem_ranks"], 2);
  EXPECT_EQ(two_ranks["grains"], 6);
  const auto other = trackbed(run + "other --dem-ranks 1", 2);
  EXPECT_EQ(other.status, 2) << other.output;
  EXPECT_NE(other.output.find("no deformable body, so all of 2 ranks hold grains"), std::string::npos) << other.output;
  const auto thin = trackbed(write("pair.toml", 2) + "thin", 2);
  EXPECT_EQ(thin.status, 2) << thin.output;
  EXPECT_NE(thin.output.find("cannot be cut into 2 slabs"), std::string::npos) << thin.output;
}

// Parts of one mpirun line, each with its role; the solids' first. The same run as by numbers.
TEST(Runs, RolesGivenOnTheCommandLine) {
  const std::string run = "run " + scene("grain_on_block.toml") + " --until 1e-3 --threads 1 --out ";
  const auto by_number = trackbed(run + (scratch() / "by_number").string(), 2);
  ASSERT_EQ(by_number.status, 0) << by_number.output;
  const std::string with_roles = run + (scratch() / "by_role").string();
  const auto by_role =
      trackbed(with_roles + " --role fem : -n 1 '" + TRACKBED_PROGRAM + "' " + with_roles + " --role dem", 1);
  ASSERT_EQ(by_role.status, 0) << by_role.output;
  EXPECT_EQ(slurp(scratch() / "by_role" / "history.csv"), slurp(scratch() / "by_number" / "history.csv"));
  const auto alone = trackbed(with_roles + " --overwrite --role fem", 2);
  EXPECT_EQ(alone.status, 2) << alone.output;
  EXPECT_NE(alone.output.find("all of 2 ranks have the role fem"), std::string::npos) << alone.output;
}

// The grains of a coupled scene on two ranks; a failure ends all ranks with its own status.
TEST(Runs, FailuresOfSeveralDemRanksEndAllRanks) {
  const std::string run =
      "run " + scene("grain_on_block.toml") + " --dem-ranks 2 --overwrite --out " + (scratch() / "slabs").string();
  const auto late = trackbed(run + " --restart nowhere.h5", 3);
  EXPECT_EQ(late.status, 2) << late.output;
  EXPECT_NE(late.output.find("nowhere.h5"), std::string::npos) << late.output;
  const auto few = trackbed(run, 2);
  EXPECT_EQ(few.status, 2) << few.output;
  EXPECT_NE(few.output.find("start mpirun with -n 3 or more"), std::string::npos) << few.output;
}

// A signal in the middle of a run: summary and pictures are there and can be read.
TEST(Runs, InterruptedRunLeavesItsResults) {
  const fs::path out = scratch() / "interrupted", log = scratch() / "interrupted.txt";
  const std::string wait_for_rows = "until [ \"$(cat '" + (out / "history.csv").string() +
                                    "' 2>/dev/null | wc -l)\" -ge 3 ]; do sleep 0.1; kill -0 $p || break; done";
  const std::string command = "cd '" + scratch().string() + "'; '" + TRACKBED_PROGRAM + "' run " +
                              scene("clump_drop.toml") + " --set 'stage.fall.duration=1000 s' --out '" + out.string() +
                              "' > '" + log.string() + "' 2>&1 & p=$!; " + wait_for_rows + "; kill -TERM $p; wait $p";
  const int status = std::system(command.c_str());
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 130) << slurp(log);
  EXPECT_NE(slurp(log).find("trackbed: interrupted: t = "), std::string::npos) << slurp(log);
  const auto json = summary(out);
  EXPECT_EQ(json["status"], "interrupted");
  EXPECT_GT(json["time_simulated_s"].get<double>(), 0);
  EXPECT_TRUE(fs::exists(out / "grains" / "grains_0001.vtp"));
}

}  // namespace
