#pragma once
// Files that are written while the next steps run. One thread, which starts with the first of them, writes one after
// the other in the order of asking, so that a checkpoint never knows of a picture that is not on the disk. It calls no
// MPI: what ranks have to gather, they gather before.
#include <array>
#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>

#include "coupling/agree.hpp"

namespace coupling {

class BackgroundWriter {
 public:
  enum Kind { picture, checkpoint, kinds };

  BackgroundWriter() = default;
  /// Waits for what has been asked for; a failure that nobody has asked about is lost.
  ~BackgroundWriter();
  BackgroundWriter(const BackgroundWriter&) = delete;
  BackgroundWriter& operator=(const BackgroundWriter&) = delete;

  /// Waits until nothing of this kind is being written any more: the memory of one is enough.
  void await(Kind);
  void await_all();
  /// After await(): throws what writing has thrown, or hands over the next.
  void start(Kind, std::function<void()> write);
  /// Throws what writing has thrown so far, every time it is asked; does not wait. What was to be written after a
  /// failure is left out.
  void check();

 private:
  struct Work {
    Kind kind;
    std::function<void()> write;
  };
  void serve();

  std::mutex guard_;
  std::condition_variable news_;
  std::deque<Work> waiting_;
  std::array<bool, kinds> busy_{};
  FailureText failure_;
  bool ends_ = false;
  std::thread thread_;
};

}  // namespace coupling
