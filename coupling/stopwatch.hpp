#pragma once
// Adds the time that it lives to a sum.
#include <chrono>

namespace coupling {

class Stopwatch {
 public:
  explicit Stopwatch(double& total) : total_(total) {}  // [s]
  ~Stopwatch() { total_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

 private:
  double& total_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace coupling
