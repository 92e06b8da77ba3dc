#pragma once
// A run that a test sends signals to.
#include <fmt/core.h>
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <optional>
#include <sstream>
#include <thread>
#include <vector>

#include "tests/regression/run_helper.hpp"

namespace regression {

/// A run in the background; it is killed when the test leaves it.
class Background {
 public:
  Background(const std::string& arguments, int ranks, const fs::path& log) {
    const std::string launcher = ranks > 0 ? fmt::format("{} -n {} ", TRACKBED_MPIRUN, ranks) : "";
    const std::string command = fmt::format("cd '{}'; exec {}'{}' {} > '{}' 2>&1", scratch().string(), launcher,
                                            TRACKBED_PROGRAM, arguments, log.string());
    process_ = fork();
    if (process_ == 0) {
      execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
      _exit(127);
    }
  }
  ~Background() {
    if (process_ > 0) {
      kill(process_, SIGKILL);
      waitpid(process_, nullptr, 0);
    }
  }
  Background(const Background&) = delete;
  Background& operator=(const Background&) = delete;

  pid_t process() const { return process_; }
  /// Processes that it has started.
  std::vector<pid_t> children() const {
    std::istringstream in(slurp(fmt::format("/proc/{0}/task/{0}/children", process_)));
    std::vector<pid_t> all;
    for (pid_t child = 0; in >> child;) all.push_back(child);
    return all;
  }
  /// Its wait status; nothing when it still runs after so many seconds.
  std::optional<int> wait(int seconds) {
    int status = 0;
    for (int k = 0; k < 100 * seconds; ++k) {
      if (waitpid(process_, &status, WNOHANG) == process_) {
        process_ = -1;
        return status;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return std::nullopt;
  }
  /// Waits until a file has this text, or the run is over.
  void await_text(const fs::path& file, const std::string& text) const {
    while (slurp(file).find(text) == std::string::npos && !over())
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  /// Waits until history.csv of its run has so many rows, or the run is over.
  void await_rows(const fs::path& out, int rows) const {
    const auto lines = [&] {
      const std::string text = slurp(out / "history.csv");
      return std::count(text.begin(), text.end(), '\n');
    };
    while (lines() <= rows && !over()) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }

 private:
  bool over() const {
    siginfo_t news{};
    waitid(P_PID, static_cast<id_t>(process_), &news, WEXITED | WNOHANG | WNOWAIT);
    return news.si_pid == process_;
  }
  pid_t process_;
};

}  // namespace regression
