#pragma once
// One line on a terminal that tells how a run goes; silent when standard error is no terminal.
#include <chrono>
#include <string>

namespace coupling {

class Progress {
 public:
  Progress();
  ~Progress();
  /// Redraws at most five times a second. `share` in [0, 1]; `speed` in steps per second.
  void show(const std::string& stage, double time, double share, double speed, double energy_error);
  /// Wipes the line.
  void clear();

 private:
  bool terminal_;
  bool drawn_ = false;
  std::chrono::steady_clock::time_point start_, last_;
};

}  // namespace coupling
