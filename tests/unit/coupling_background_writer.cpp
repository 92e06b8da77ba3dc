// Files written beside the run: in the order of asking, one of a kind at a time, and no failure is lost.
#include <gtest/gtest.h>

#include <future>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "coupling/background_writer.hpp"

namespace {

using coupling::BackgroundWriter;

std::string message_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const base::MachineError& error) {
    return error.what();
  }
  return "";
}

// The caller goes on while a picture is being written; a checkpoint that is asked for meanwhile comes after it. A
// writer that wrote at once would wait here for ever.
TEST(BackgroundWriter, WritesInOrderWhileTheCallerGoesOn) {
  std::promise<void> disk;
  std::vector<std::string> written;
  BackgroundWriter files;
  files.start(BackgroundWriter::picture, [&, ready = disk.get_future().share()] {
    ready.wait();
    written.emplace_back("picture");
  });
  files.await(BackgroundWriter::checkpoint);
  files.start(BackgroundWriter::checkpoint, [&] { written.emplace_back("checkpoint"); });
  disk.set_value();
  files.await(BackgroundWriter::checkpoint);
  EXPECT_EQ(written, (std::vector<std::string>{"picture", "checkpoint"}));
  EXPECT_EQ(message_of([&] { files.check(); }), "");
}

// One of a kind in flight: the memory of a second one must not be asked for.
TEST(BackgroundWriter, ASecondPictureIsRefusedUntilTheFirstIsDone) {
  std::promise<void> disk;
  BackgroundWriter files;
  files.start(BackgroundWriter::picture, [ready = disk.get_future().share()] { ready.wait(); });
  EXPECT_THROW(files.start(BackgroundWriter::picture, [] {}), base::InternalError);
  disk.set_value();
  files.await(BackgroundWriter::picture);
  EXPECT_NO_THROW(files.start(BackgroundWriter::picture, [] {}));
}

// A checkpoint after a picture that the disk did not take would name a file that is not there.
TEST(BackgroundWriter, AFailureIsKeptAndWhatFollowsIsLeftOut) {
  std::promise<void> disk;
  bool written = false;
  BackgroundWriter files;
  files.start(BackgroundWriter::picture, [ready = disk.get_future().share()] {
    ready.wait();
    throw base::MachineError("the disk is full");
  });
  files.start(BackgroundWriter::checkpoint, [&] { written = true; });
  disk.set_value();
  files.await_all();
  EXPECT_FALSE(written);
  for (int turn = 0; turn < 2; ++turn) EXPECT_EQ(message_of([&] { files.check(); }), "the disk is full");
  EXPECT_EQ(message_of([&] { files.start(BackgroundWriter::picture, [] {}); }), "the disk is full");
}

TEST(BackgroundWriter, WaitsForItsFilesBeforeItGoes) {
  bool first = false, second = false;
  {
    BackgroundWriter files;
    files.start(BackgroundWriter::picture, [&] { first = true; });
    files.start(BackgroundWriter::checkpoint, [&] { second = true; });
  }
  EXPECT_TRUE(first && second);
}

// What was kept for a file (rows of a GPU on the host) is free when its kind is.
TEST(BackgroundWriter, LetsGoOfWhatItWroteBeforeItSaysSo) {
  BackgroundWriter files;
  auto rows = std::make_shared<int>(1);
  files.start(BackgroundWriter::picture, [rows] {});
  files.await(BackgroundWriter::picture);
  EXPECT_EQ(rows.use_count(), 1);
}

}  // namespace
