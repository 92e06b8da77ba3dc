// Checkpoint files: what is written is read; what has been damaged, or belongs to another run, is refused with the
// reason.
#include <sys/resource.h>

#include <csignal>

#include "base/version.hpp"
#include "coupling/checkpoint.hpp"
#include "coupling/column_file.hpp"
#include "coupling/scene_changes.hpp"
#include "tests/unit/coupling_scene_file.hpp"

namespace {

using namespace scene_tests;

base::Columns sample() {
  base::Columns columns;
  std::vector<double> reals;
  for (int k = 0; k < 300; ++k) reals.push_back(1.0 / (k + 1));
  columns["a/reals"] = reals;
  columns["a/deep/short"] = std::vector<float>{1.5F, -0.25F};
  columns["numbers"] = std::vector<int>{-1, 2147483647};
  columns["long"] = std::vector<std::int64_t>{-1, 9007199254740993};
  columns["text"] = std::string("two\nlines");
  columns["nothing"] = std::vector<double>();
  return columns;
}

class Checkpoint : public SceneFile {
 protected:
  static std::string error_of_reading(const fs::path& file) {
    try {
      coupling::read_columns(file, "");
    } catch (const base::UserError& error) {
      return error.what();
    }
    return "no error";
  }
  static std::string bytes(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  /// What --restart answers, for a scene that has been started with `started`.
  static std::string answer(const std::string& started, const std::string& now, base::Columns columns = {}) {
    const Scene before = read(started);
    coupling::CheckpointFolder(".").write(std::move(columns), before);
    const Scene scene = read(now);
    const coupling::Roles roles(MPI_COMM_WORLD, scene);
    coupling::RunOptions options;
    options.restart = "checkpoint-0001.h5";
    try {
      coupling::find_restart(options, scene, roles, "run");
    } catch (const base::UserError& error) {
      return error.what();
    }
    return "accepted";
  }
};

TEST_F(Checkpoint, ComesBackAsItWasWritten) {
  coupling::write_columns("c.h5", sample());
  EXPECT_EQ(coupling::read_columns("c.h5", ""), sample());
  EXPECT_FALSE(fs::exists("c.h5.part"));
  const auto group = coupling::read_columns("c.h5", "a/");
  EXPECT_EQ(group.size(), 2u);
  EXPECT_EQ(group, coupling::group_of(sample(), "a/"));
}

// CRC-32 finds every single flipped bit, wherever it lies.
TEST_F(Checkpoint, DamageAnywhereIsSeen) {
  coupling::write_columns("c.h5", sample());
  const std::string sound = bytes("c.h5");
  for (std::size_t at = 0; at < sound.size(); at += 41) {
    std::string damaged = sound;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    std::ofstream("d.h5", std::ios::binary) << damaged;
    EXPECT_EQ(error_of_reading("d.h5").substr(0, 27), "d.h5: cannot be used: it is") << "byte " << at;
  }
}

TEST_F(Checkpoint, TruncatedFilesAreRefused) {
  coupling::write_columns("c.h5", sample());
  const auto size = fs::file_size("c.h5");
  for (const std::uintmax_t left : {size - 1, size / 2, size / 10, std::uintmax_t{100}, std::uintmax_t{0}}) {
    fs::resize_file("c.h5", left);
    EXPECT_EQ(error_of_reading("c.h5"),
              "c.h5: cannot be used: it is truncated, or no checkpoint; name an earlier checkpoint");
  }
  EXPECT_EQ(error_of_reading("none.h5"), "none.h5: no such file; name a checkpoint-NNNN.h5");
}

TEST_F(Checkpoint, WhatCannotBeWrittenLeavesWhatWasThere) {
  coupling::write_columns("c.h5", sample());
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const rlimit small{1000, before.rlim_max};
  const auto heard = std::signal(SIGXFSZ, SIG_IGN);
  setrlimit(RLIMIT_FSIZE, &small);
  std::string text;
  try {
    coupling::write_columns("c.h5", sample());
  } catch (const base::MachineError& error) {
    text = error.what();
  }
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, heard);
  EXPECT_EQ(text, "c.h5.part: cannot be written (File too large)");
  EXPECT_FALSE(fs::exists("c.h5.part"));
  EXPECT_EQ(coupling::read_columns("c.h5", ""), sample());
}

TEST_F(Checkpoint, TheLastTwoAreKept) {
  const Scene scene = read(grains + one_grain + stage);
  coupling::CheckpointFolder folder(".");
  EXPECT_TRUE(folder.last().empty());
  for (int k = 0; k < 4; ++k) folder.write(sample(), scene);
  EXPECT_EQ(folder.last().filename(), "checkpoint-0004.h5");
  const auto files = coupling::checkpoints_in(".");
  ASSERT_EQ(files.size(), 2u);
  EXPECT_EQ(files[0].filename(), "checkpoint-0004.h5");
  EXPECT_EQ(files[1].filename(), "checkpoint-0003.h5");
}

TEST_F(Checkpoint, ItsScenesValuesAreNamedWhereTheyDiffer) {
  const std::string scene = grains + one_grain + stage;
  EXPECT_EQ(answer(scene, scene), "accepted");
  EXPECT_EQ(answer(scene, scene + "[output]\ncheckpoint_interval = \"1 ms\"\n"), "accepted");
  const std::string other = answer(scene, grains + one_grain + stage + "[time]\ndem_fraction = 0.1\n");
  EXPECT_NE(other.find("checkpoint-0001.h5: the scene is not the one that this run was started with: "
                       "time.dem_fraction = 0.1, was "),
            std::string::npos)
      << other;
  std::string longer = stage;
  longer.replace(longer.find("10 ms"), 5, "20 ms");
  const std::string shifted = answer(scene, grains + one_grain + longer);
  EXPECT_NE(shifted.find("stage.fall.duration = 0.02, was 0.01; restart with the scene as it was"), std::string::npos)
      << shifted;
}

TEST_F(Checkpoint, FilesOfTheSceneCountByTheirContent) {
  const std::string text = "[[wall]]\nname = \"w\"\nmesh = \"box.geo\"\n";
  const std::string before = coupling::scene_values(text);
  write("box.geo", "another surface");
  const auto changes = coupling::changed_values(before, coupling::scene_values(text));
  ASSERT_EQ(changes.size(), 1u);
  EXPECT_EQ(changes[0].substr(0, 19), "wall.w.mesh = conte");
  EXPECT_EQ(coupling::changed_values(before, ""),
            (std::vector<std::string>{"wall.w.mesh is gone, was " + before.substr(14, before.find('\n') - 14),
                                      "wall.w.name is gone, was 'w'"}));
}

TEST_F(Checkpoint, OfAnotherVersionIsRefused) {
  const Scene scene = read(grains + one_grain + stage);
  coupling::CheckpointFolder(".").write({}, scene);
  auto columns = coupling::read_columns("checkpoint-0001.h5", "");
  columns["run/code_version"] = std::string("0.0.9 (old)");
  coupling::write_columns("checkpoint-0001.h5", columns);
  const coupling::Roles roles(MPI_COMM_WORLD, scene);
  coupling::RunOptions options;
  options.restart = ".";
  std::string text;
  try {
    coupling::find_restart(options, scene, roles, "run");
  } catch (const base::UserError& error) {
    text = error.what();
  }
  EXPECT_EQ(text, "./checkpoint-0001.h5: written by Trackbed 0.0.9 (old), format " +
                      std::to_string(coupling::checkpoint_format) + ", this is " + std::string(base::code_version()) +
                      "; restart with that version, or start a new run without --restart");
}

// Of a folder the newest that can be read; `auto` in a folder without any: from the start.
TEST_F(Checkpoint, AFolderGivesItsNewestSoundOne) {
  const Scene scene = read(grains + one_grain + stage);
  coupling::CheckpointFolder folder(".");
  folder.write({}, scene);
  folder.write({}, scene);
  fs::resize_file("checkpoint-0002.h5", 1000);
  const coupling::Roles roles(MPI_COMM_WORLD, scene);
  coupling::RunOptions options;
  options.restart = ".";
  const auto found = coupling::find_restart(options, scene, roles, "run");
  ASSERT_TRUE(found);
  EXPECT_EQ(found->file.filename(), "checkpoint-0001.h5");
  options.restart = "auto";
  EXPECT_FALSE(coupling::find_restart(options, scene, roles, "run"));
  EXPECT_TRUE(coupling::find_restart(options, scene, roles, "."));
}

}  // namespace
