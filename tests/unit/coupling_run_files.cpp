// The run folder: what is refused, and that refusing writes nothing.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "base/error.hpp"
#include "coupling/run_files.hpp"

namespace {

namespace fs = std::filesystem;

class RunFiles : public testing::Test {
 protected:
  void SetUp() override {
    root_ = fs::temp_directory_path() / ("trackbed_run_files_" + std::to_string(getpid()));
    fs::remove_all(root_);
    fs::create_directories(root_);
  }
  void TearDown() override { fs::remove_all(root_); }
  static std::string message(const fs::path& directory, bool overwrite) {
    try {
      coupling::make_run_directory(directory, overwrite);
    } catch (const base::UserError& error) {
      return error.what();
    }
    return "accepted";
  }
  static void touch(const fs::path& file) { std::ofstream(file) << "kept"; }
  fs::path root_;
};

TEST_F(RunFiles, MakesNestedFolders) {
  EXPECT_EQ(message(root_ / "a" / "b", false), "accepted");
  EXPECT_TRUE(fs::is_directory(root_ / "a" / "b"));
}

TEST_F(RunFiles, RefusesAnExistingRunUnlessToldAndKeepsIt) {
  touch(root_ / "scene.resolved.toml");
  touch(root_ / "history.csv");
  const auto text = message(root_, false);
  EXPECT_NE(text.find("the folder exists; nothing was written; give another --out, or --overwrite"), std::string::npos)
      << text;
  EXPECT_TRUE(fs::exists(root_ / "history.csv"));
  EXPECT_EQ(message(root_, true), "accepted");
  EXPECT_TRUE(fs::is_empty(root_));
}

TEST_F(RunFiles, OverwriteNeverEmptiesAFolderThatIsNoRun) {
  touch(root_ / "thesis.tex");
  const auto text = message(root_, true);
  EXPECT_NE(text.find("holds no Trackbed run"), std::string::npos) << text;
  EXPECT_TRUE(fs::exists(root_ / "thesis.tex"));
}

TEST_F(RunFiles, RefusesAFile) {
  touch(root_ / "file");
  EXPECT_NE(message(root_ / "file", true).find("is a file; name a folder"), std::string::npos);
}

TEST_F(RunFiles, CannotBeMadeBelowAFile) {
  touch(root_ / "file");
  const auto text = message(root_ / "file" / "run", false);
  EXPECT_NE(text.find("cannot be made"), std::string::npos) << text;
}

TEST_F(RunFiles, FullDiskIsTheMachinesFault) {
  // /dev/full takes every write and fails each with "no space left".
  const std::vector<std::string> columns{"time [s]"};
  EXPECT_THROW(coupling::HistoryFile("/dev/full", columns), base::MachineError);
}

TEST_F(RunFiles, HistoryRowsAreOnDiskAtOnce) {
  const std::vector<std::string> columns{"time [s]", "load [N]"};
  coupling::HistoryFile file(root_ / "history.csv", columns);
  file.row(std::vector<double>{0.5, 1e-3});
  std::ifstream in(root_ / "history.csv");
  std::string header, row;
  std::getline(in, header);
  std::getline(in, row);
  EXPECT_EQ(header, "time [s],load [N]");
  EXPECT_EQ(row, "0.5,0.001");
}

}  // namespace
