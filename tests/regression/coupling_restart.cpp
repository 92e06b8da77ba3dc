// A run that is cut off anywhere and restarted repeats the uninterrupted one bit for bit on as many ranks and threads:
// rows of history.csv, pictures, ledger and results. A column left out of a checkpoint, a list in another order or a
// sample taken twice shows in the last digits. On another number of ranks the same to rounding.
#include <fmt/core.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <set>

#include "coupling/run_directory.hpp"
#include "tests/regression/background.hpp"
#include "tests/regression/restart_scenes.hpp"
#include "tests/regression/run_helper.hpp"

namespace {

using namespace regression;

Finished run(const fs::path& scene, const fs::path& out, const std::string& more, int ranks = 0) {
  return trackbed(fmt::format("run '{}' --out '{}' --threads 1 {}", scene.string(), out.string(), more), ranks);
}
Finished restart(const fs::path& scene, const fs::path& checkpoint, const std::string& more = "", int ranks = 0) {
  return trackbed(fmt::format("run '{}' --restart '{}' --threads 1 {}", scene.string(), checkpoint.string(), more),
                  ranks);
}

std::set<std::string> files_of(const fs::path& run) {
  std::set<std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(run)) {
    const std::string kind = entry.path().extension().string();
    if (kind == ".vtp" || kind == ".vtu" || kind == ".pvd" || kind == ".csv")
      files.insert(fs::relative(entry.path(), run).string());
  }
  return files;
}

void expect_same_bits(const fs::path& whole, const fs::path& restarted) {
  const auto files = files_of(whole);
  EXPECT_GE(files.size(), 4u);
  EXPECT_EQ(files, files_of(restarted));
  for (const auto& file : files) EXPECT_TRUE(slurp(whole / file) == slurp(restarted / file)) << file;
  const auto a = summary(whole), b = summary(restarted);
  for (const char* key :
       {"status", "time_simulated_s", "steps", "dt_s", "dt_limiter", "energy", "momentum_error", "results"})
    EXPECT_EQ(a[key], b[key]) << key;
  EXPECT_EQ(b["status"], "completed");
}

/// Whole, and cut off at `until` with checkpoints every `interval`, then restarted. `losses`: what the scene must have
/// lost energy by, so that what it is to show happens at all.
void expect_restart_repeats(const std::string& name, const std::string& text, const std::string& interval,
                            const std::string& until, int ranks, const std::vector<std::string>& losses = {},
                            const std::string& more = "") {
  const fs::path scene = write_scene(name, text);
  const fs::path whole = scratch() / (name + "_whole"), cut = scratch() / (name + "_cut");
  const auto uninterrupted = run(scene, whole, more, ranks);
  ASSERT_EQ(uninterrupted.status, 0) << uninterrupted.output;
  EXPECT_FALSE(fs::exists(whole / "checkpoint-0001.h5"));
  for (const auto& loss : losses) EXPECT_GT(summary(whole)["energy"][loss].get<double>(), 0) << loss;
  const auto first =
      run(scene, cut, fmt::format("--set 'output.checkpoint_interval={}' --until {}{}", interval, until, more), ranks);
  ASSERT_EQ(first.status, 0) << first.output;
  const auto second = restart(scene, cut, more, ranks);
  ASSERT_EQ(second.status, 0) << second.output;
  EXPECT_NE(second.output.find("goes on from"), std::string::npos) << second.output;
  expect_same_bits(whole, cut);
}

TEST(Restart, GrainsInTheFirstStage) { expect_restart_repeats("early", grains_scene(), "7 ms", "0.025", 0); }
TEST(Restart, GrainsInTheMeasuredStage) {
  expect_restart_repeats("late", grains_scene(), "11 ms", "0.071", 0,
                         {"loss_friction", "loss_rolling", "loss_breakage"});
}
TEST(Restart, BeamsOnOneRank) {
  expect_restart_repeats("beams", remembering_beams(), "30 ms", "0.11", 0, {"loss_viscous", "loss_plastic"});
}
TEST(Restart, BeamsOnTwoRanks) { expect_restart_repeats("beams2", remembering_beams(), "30 ms", "0.11", 2); }
TEST(Restart, CoupledOnOneRank) {
  expect_restart_repeats("coupled", coupled_scene(), "4 ms", "0.0195", 0, {"loss_friction", "loss_viscous"});
}
TEST(Restart, CoupledOnThreeRanks) { expect_restart_repeats("coupled3", coupled_scene(), "4 ms", "0.0195", 3); }
TEST(Restart, OverTheSeamOfAPeriodicBody) {
  expect_restart_repeats("seam", seam_scene(), "1.5 ms", "0.0065", 0, {"loss_friction"});
}

TEST(Restart, SlabsOnThreeRanks) {
  expect_restart_repeats("slabs", coupled_scene(), "4 ms", "0.0195", 3, {}, " --dem-ranks 2");
}

// Grains leave the skin nodes that their part knows, and it is told of others, before the cut and after it.
TEST(Restart, SlabsThatTravelOnThreeRanks) {
  expect_restart_repeats("travelling", travelling_scene(), "31 ms", "0.1", 3, {"loss_friction"}, " --dem-ranks 2");
}

// Impulses that wait for their window, skins on parabolas, and Newmark's steps under grains.
TEST(Restart, ConcurrentOnOneRank) {
  const std::string late = "[coupling]\nscheme = \"concurrent\"\nskin_motion = \"quadratic\"\nn_fem = 3\n";
  expect_restart_repeats("late_forces", coupled_scene() + late, "4 ms", "0.0195", 0, {"loss_friction"});
}
TEST(Restart, ConcurrentOnThreeRanks) {
  const std::string late = "[coupling]\nscheme = \"concurrent\"\nskin_motion = \"quadratic\"\nn_dem = 5\n";
  expect_restart_repeats("late_forces3", coupled_scene() + late, "4 ms", "0.0195", 3);
}
TEST(Restart, NewmarkUnderGrains) {
  std::string text =
      coupled_scene() + "[fem]\nsolver = \"newmark\"\n[time]\nfem_step = \"0.2 ms\"\n[coupling]\nn_dem = 40\n";
  const std::string hold = "hold = [\"plate\"]\n";
  text.replace(text.find(hold), hold.size(), "");
  expect_restart_repeats("newmark_grains", text, "4 ms", "0.0195", 0);
}

TEST(Restart, ImplicitSteps) {
  const std::string newmark = "[fem]\nsolver = \"newmark\"\n[time]\nfem_step = \"2 ms\"\n";
  expect_restart_repeats("newmark", beams_scene(newmark, {{"one", ""}, {"other", ""}}, false), "30 ms", "0.11", 0);
}

/// Largest difference of any column of history.csv, over the column's largest value; rounding alone is left out.
double largest_difference(const fs::path& one, const fs::path& other) {
  const auto a = coupling::read_history(one / "history.csv"), b = coupling::read_history(other / "history.csv");
  double largest = 0;
  EXPECT_EQ(a.columns.size(), b.columns.size());
  for (std::size_t c = 0; c < a.columns.size(); ++c) {
    const auto &x = a.columns[c], &y = b.columns[c];
    EXPECT_EQ(x.values.size(), y.values.size());
    if (x.name == "energy_residual" || x.name == "momentum_error") continue;
    double scale = 0, apart = 0;
    for (std::size_t k = 0; k < std::min(x.values.size(), y.values.size()); ++k) {
      scale = std::max(scale, std::abs(x.values[k]));
      apart = std::max(apart, std::abs(x.values[k] - y.values[k]));
    }
    if (scale > 0) largest = std::max(largest, apart / scale);
  }
  return largest;
}

// State by global numbers: whichever ranks write it, any can go on. A node or element given to the wrong place is an
// error of the size of the motion.
TEST(Restart, OnAnotherNumberOfRanks) {
  struct Case {
    const char *name, *interval, *until;
    std::string text;
    int from, to;
    std::string dem_from, dem_to;
  };
  const std::string two = " --dem-ranks 2", three = " --dem-ranks 3";
  for (const auto& [name, interval, until, text, from, to, dem_from, dem_to] :
       {Case{"coupled_ranks", "4 ms", "0.0195", coupled_scene(), 2, 3, "", ""},
        Case{"more_slabs", "4 ms", "0.0195", coupled_scene(), 2, 4, "", three},
        Case{"fewer_slabs", "4 ms", "0.0195", coupled_scene(), 3, 0, two, ""},
        Case{"travelling_ranks", "31 ms", "0.1", travelling_scene(), 3, 4, two, three},
        Case{"travelling_together", "31 ms", "0.1", travelling_scene(), 3, 0, two, ""},
        Case{"travelling_apart", "31 ms", "0.1", travelling_scene(), 2, 3, "", two},
        Case{"beams_ranks", "30 ms", "0.11", remembering_beams(), 3, 2, "", ""}}) {
    const fs::path scene = write_scene(name, text), out = scratch() / (std::string(name) + "_first");
    const fs::path whole = scratch() / (std::string(name) + "_whole"),
                   other = scratch() / (std::string(name) + "_other");
    const std::string checkpoints = fmt::format("--set 'output.checkpoint_interval={}'", interval);
    ASSERT_EQ(run(scene, whole, checkpoints + dem_from, from).status, 0);
    ASSERT_EQ(run(scene, out, fmt::format("{} --until {}{}", checkpoints, until, dem_from), from).status, 0);
    const auto finished = restart(scene, out, fmt::format("--out '{}' {}{}", other.string(), checkpoints, dem_to), to);
    ASSERT_EQ(finished.status, 0) << finished.output;
    EXPECT_LT(largest_difference(whole, other), 1e-9) << name;
    EXPECT_EQ(files_of(whole), files_of(other));
    EXPECT_TRUE(fs::exists(out / "checkpoint-0003.h5"));  // the first run's folder is as it was
  }
}

// kill -9 at twenty random moments: the last checkpoint is whole, no more than an interval is lost, history.csv can be
// read, and what has been restarted twenty times ends as the whole run.
TEST(Restart, AfterTwentyTimesKillNine) {
  const fs::path scene = write_scene("killed", long_grains_scene()), whole = scratch() / "killed_whole";
  ASSERT_EQ(run(scene, whole, "").status, 0);
  const fs::path out = scratch() / "killed", log = scratch() / "killed.txt";
  constexpr double interval = 2e-3;
  const auto rows = static_cast<int>(coupling::read_history(whole / "history.csv").time().size());
  std::mt19937 random(std::random_device{}());
  std::vector<int> moments(20);
  for (int& moment : moments) moment = std::uniform_int_distribution<int>(5, rows - 30)(random);
  std::sort(moments.begin(), moments.end());
  double killed_at = 0;
  for (std::size_t k = 0; k < moments.size(); ++k) {
    const std::string go_on = k == 0 ? "" : fmt::format("--restart '{}'", out.string());
    // Every third life writes by the clock.
    const std::string checkpoints = k % 3 == 2 ? "--set output.checkpoint_wall_time=1e-3 "
                                               : fmt::format("--set output.checkpoint_interval={} ", interval);
    fs::remove(log);
    Background life(
        fmt::format("run '{}' --threads 1 --out '{}' {} {}", scene.string(), out.string(), checkpoints, go_on), 0, log);
    if (k > 0) life.await_text(log, "goes on from");  // until then history.csv is the life before's
    life.await_rows(out, moments[k]);
    kill(life.process(), SIGKILL);
    const auto status = life.wait(30);
    ASSERT_TRUE(status && WIFSIGNALED(*status)) << "the run was over before it was killed: " << slurp(log);
    const std::string said = slurp(log), mark = "at t = ";
    if (const auto at = said.find(mark); k > 0 && k % 3 != 0 && at != std::string::npos) {  // k - 1 wrote by time
      EXPECT_GE(std::stod(said.substr(at + mark.size())), killed_at - 1.5 * interval) << said;
    }
    killed_at = coupling::read_history(out / "history.csv").time().back();
  }
  const auto finished = restart(scene, out);
  ASSERT_EQ(finished.status, 0) << finished.output;
  expect_same_bits(whole, out);
}

// A rank that dies takes the job with it, and the job can go on.
void expect_job_ends_with_a_rank(const std::string& name, int ranks, const std::string& more) {
  std::string text = coupled_scene();
  const std::string end = "duration = \"20 ms\"";
  const fs::path scene = write_scene(name, text.replace(text.find(end), end.size(), "duration = \"200 ms\""));
  const fs::path whole = scratch() / (name + "_whole"), out = scratch() / name, log = scratch() / (name + ".txt");
  ASSERT_EQ(run(scene, whole, more, ranks).status, 0);
  Background life(fmt::format("run '{}' --threads 1 --out '{}' --set 'output.checkpoint_interval=4 ms'{}",
                              scene.string(), out.string(), more),
                  ranks, log);
  life.await_rows(out, 60);
  const auto processes = life.children();
  ASSERT_EQ(processes.size(), static_cast<std::size_t>(ranks));
  kill(processes[1], SIGKILL);
  const auto status = life.wait(30);
  ASSERT_TRUE(status) << "the job hangs";
  EXPECT_FALSE(WIFEXITED(*status) && WEXITSTATUS(*status) == 0) << slurp(log);
  const auto finished = restart(scene, out, more, ranks);
  ASSERT_EQ(finished.status, 0) << finished.output;
  expect_same_bits(whole, out);
}
TEST(Restart, AfterARankOfElementsWasKilled) { expect_job_ends_with_a_rank("lost", 2, ""); }
TEST(Restart, AfterARankOfGrainsWasKilled) { expect_job_ends_with_a_rank("lost_slab", 3, " --dem-ranks 2"); }

TEST(Restart, SignalsLeaveCheckpoints) {
  const fs::path scene = write_scene("signals", long_grains_scene()), whole = scratch() / "signals_whole";
  ASSERT_EQ(run(scene, whole, "").status, 0);
  const fs::path out = scratch() / "signals", log = scratch() / "signals.txt";
  {
    Background life(fmt::format("run '{}' --threads 1 --out '{}'", scene.string(), out.string()), 0, log);
    life.await_rows(out, 40);
    kill(life.process(), SIGUSR1);
    life.await_text(log, "checkpoint-0001.h5");
    life.await_rows(out, 80);
    EXPECT_TRUE(fs::exists(out / "checkpoint-0001.h5")) << slurp(log);
    kill(life.process(), SIGTERM);
    const auto status = life.wait(30);
    ASSERT_TRUE(status && WIFEXITED(*status));
    EXPECT_EQ(WEXITSTATUS(*status), 130) << slurp(log);
  }
  EXPECT_NE(slurp(log).find("; to go on: trackbed run " + scene.string() + " --restart " +
                            (out / "checkpoint-0002.h5").string()),
            std::string::npos)
      << slurp(log);
  const auto finished = restart(scene, "auto", fmt::format("--out '{}'", out.string()));
  ASSERT_EQ(finished.status, 0) << finished.output;
  expect_same_bits(whole, out);
}

// ---- files in the background
/// Goes on with a run whose first life has ended, once `plant` has been at its folder.
Finished restart_after(const std::string& name, const std::string& text, const std::string& first_life, int ranks,
                       const std::function<void(const fs::path&)>& plant) {
  const fs::path scene = write_scene(name, text), out = scratch() / name;
  EXPECT_EQ(run(scene, out, first_life, ranks).status, 0);
  plant(out);
  return restart(scene, out, "", ranks);
}

// A disk that takes no more bytes, met while the run goes on: the same message and status as if the run had waited, at
// the latest with the next picture; what was written before can be read.
TEST(Restart, AFullDiskBehindThePicturesStopsTheRun) {
  const fs::path out = scratch() / "full_disk";
  const auto stopped = restart_after(
      "full_disk", long_grains_scene(), "--set 'output.checkpoint_interval=40 ms' --until 0.045", 0,
      [](const fs::path& run) { fs::create_symlink("/dev/full", run / "grains" / "grains_0002.vtp.part"); });
  EXPECT_EQ(stopped.status, 4) << stopped.output;
  EXPECT_NE(stopped.output.find(
                "cannot write " + (out / "grains" / "grains_0002.vtp").string() +
                ": is the disk full or read-only?; last good checkpoint: " + (out / "checkpoint-0001.h5").string()),
            std::string::npos)
      << stopped.output;
  EXPECT_EQ(summary(out)["status"], "failed");
  const double end = coupling::read_history(out / "history.csv").time().back();
  EXPECT_GE(end, 0.069);  // the picture was due at 70 ms,
  EXPECT_LE(end, 0.091);  // the next one at 90 ms
  EXPECT_NE(slurp(out / "grains.pvd").find("grains_0001.vtp"), std::string::npos);
  EXPECT_EQ(slurp(out / "grains.pvd").find("grains_0002.vtp"), std::string::npos);
}

// The last picture of all: nothing comes after it that could ask.
TEST(Restart, AFolderThatTakesNoFileStopsTheRunAtItsEnd) {
  const fs::path out = scratch() / "full_at_end";
  const auto stopped =
      restart_after("full_at_end", grains_scene(), "--set 'output.checkpoint_interval=40 ms' --until 0.045", 0,
                    [](const fs::path& run) { fs::create_directories(run / "grains" / "grains_0003.vtp" / "full"); });
  EXPECT_EQ(stopped.status, 4) << stopped.output;
  EXPECT_NE(stopped.output.find("cannot write " + (out / "grains" / "grains_0003.vtp").string()), std::string::npos)
      << stopped.output;
  EXPECT_EQ(summary(out)["status"], "failed");
}

// The bodies' pictures are written by another rank, beside its steps: all ranks stop for it.
TEST(Restart, AFullDiskOfTheOtherRankStopsBoth) {
  const fs::path out = scratch() / "full_bodies";
  const auto stopped = restart_after(
      "full_bodies", coupled_scene(), "--set 'output.checkpoint_interval=4 ms' --until 0.014", 2,
      [](const fs::path& run) { fs::create_symlink("/dev/full", run / "plate" / "plate_0002.vtu.part"); });
  EXPECT_NE(stopped.status, 0) << stopped.output;  // mpirun's own
  EXPECT_NE(stopped.output.find("cannot write " + (out / "plate" / "plate_0002.vtu").string()), std::string::npos)
      << stopped.output;
  EXPECT_EQ(summary(out)["status"], "failed");
}

// The disk is slow (a pipe that nobody reads yet), and the run goes on past the picture; a signal in this state ends it
// as ever, with the picture, a checkpoint behind it and results that a restart goes on from to the bits of the whole
// run.
TEST(Restart, AnInterruptWhileAPictureIsBeingWritten) {
  const fs::path scene = write_scene("slow_disk", long_grains_scene()), whole = scratch() / "slow_disk_whole";
  const fs::path out = scratch() / "slow_disk", log = scratch() / "slow_disk.txt";
  ASSERT_EQ(run(scene, whole, "").status, 0);
  ASSERT_EQ(run(scene, out, "--set 'output.checkpoint_interval=40 ms' --until 0.045").status, 0);
  const fs::path pipe = out / "grains.pvd.part";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  const std::string before = slurp(out / "grains.pvd");
  {
    Background life(fmt::format("run '{}' --restart '{}' --threads 1", scene.string(), out.string()), 0, log);
    // The picture is due at 50 ms; one that was waited for would hold the run there. The next is due at 70 ms.
    const auto reached = [&] {
      const std::string rows = slurp(out / "history.csv");
      const auto line = rows.rfind('\n', rows.size() - 2);
      return line == std::string::npos ? 0 : std::atof(rows.c_str() + line + 1);
    };
    for (int k = 0; k < 3000 && !(reached() > 0.055 && slurp(log).find("goes on from") != std::string::npos); ++k)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    EXPECT_GT(reached(), 0.055) << slurp(log);
    EXPECT_EQ(slurp(out / "grains.pvd"), before);
    kill(life.process(), SIGTERM);
    const std::string piped = slurp(pipe);  // from here on the disk takes it
    EXPECT_NE(piped.find("grains_0001.vtp"), std::string::npos) << piped;
    const auto status = life.wait(30);
    ASSERT_TRUE(status && WIFEXITED(*status)) << slurp(log);
    EXPECT_EQ(WEXITSTATUS(*status), 130) << slurp(log);
  }
  EXPECT_NE(slurp(log).find("--restart " + (out / "checkpoint-0002.h5").string()), std::string::npos) << slurp(log);
  EXPECT_NE(slurp(out / "grains.pvd").find("grains_0002.vtp"), std::string::npos);
  const auto finished = restart(scene, out);
  ASSERT_EQ(finished.status, 0) << finished.output;
  expect_same_bits(whole, out);
}

TEST(Restart, RefusedWithItsReasonAndNothingTouched) {
  const fs::path scene = write_scene("refused", coupled_scene()), out = scratch() / "refused_run";
  ASSERT_EQ(run(scene, out, "--set 'output.checkpoint_interval=4 ms' --until 9e-3").status, 0);
  const std::string before = slurp(out / "history.csv");
  const auto changed = restart(scene, out, "--set grains.friction=0.3 --set body.plate.damping=2");
  EXPECT_EQ(changed.status, 2);
  EXPECT_NE(
      changed.output.find("the scene is not the one that this run was started with: body.plate.contact.friction = "
                          "0.3, was 0.4; body.plate.damping = 2, was 0; grains.friction = 0.3, was 0.4; restart "
                          "with the scene as it was"),
      std::string::npos)
      << changed.output;
  const auto overwrite = restart(scene, out, "--overwrite");
  EXPECT_EQ(overwrite.status, 2);
  EXPECT_NE(overwrite.output.find("--overwrite: the run in "), std::string::npos) << overwrite.output;
  const auto past = restart(scene, out, "--until 1e-3", 2);
  EXPECT_EQ(past.status, 2);
  EXPECT_NE(past.output.find("--until 0.001 s: "), std::string::npos) << past.output;
  EXPECT_NE(past.output.find("already; give a later time"), std::string::npos) << past.output;
  const auto missing = restart(scene, scratch() / "nowhere");
  EXPECT_EQ(missing.status, 2);
  EXPECT_NE(missing.output.find("no such file; name a checkpoint-NNNN.h5"), std::string::npos) << missing.output;
  fs::resize_file(out / "checkpoint-0002.h5", 3000);
  const auto cut = restart(scene, out / "checkpoint-0002.h5", "", 2);
  EXPECT_EQ(cut.status, 2);
  EXPECT_NE(cut.output.find("checkpoint-0002.h5: cannot be used: it is truncated"), std::string::npos) << cut.output;
  EXPECT_EQ(slurp(out / "history.csv"), before);
}

TEST(Restart, FailuresNameTheLastCheckpoint) {
  const fs::path scene = write_scene("failing", grains_scene()), out = scratch() / "failing";
  ASSERT_EQ(run(scene, out, "--set 'output.checkpoint_interval=5 ms' --until 12e-3").status, 0);
  fs::create_directory(out / "checkpoint-0003.h5.part");  // cannot be written over
  const auto failed = restart(scene, out, "--set 'output.checkpoint_interval=5 ms'");
  EXPECT_EQ(failed.status, 4) << failed.output;
  EXPECT_NE(failed.output.find("checkpoint-0003.h5.part: cannot be written (Is a directory); last good checkpoint: " +
                               (out / "checkpoint-0002.h5").string()),
            std::string::npos)
      << failed.output;
  EXPECT_EQ(summary(out)["status"], "failed");
  EXPECT_GT(coupling::read_history(out / "history.csv").time().size(), 10u);

  const fs::path beams =
      write_scene("exploding", remembering_beams("[time]\nfem_step = \"1 ms\"\nforce_step = true\n"));
  const auto unstable = run(beams, scratch() / "exploding", "--set 'output.checkpoint_interval=2 ms'");
  EXPECT_EQ(unstable.status, 3) << unstable.output;
  EXPECT_NE(unstable.output.find("; last good checkpoint: "), std::string::npos) << unstable.output;
}

}  // namespace
