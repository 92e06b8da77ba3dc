#include "coupling/progress.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace coupling {

Progress::Progress() : terminal_(isatty(STDERR_FILENO) != 0), start_(std::chrono::steady_clock::now()), last_(start_) {}

Progress::~Progress() { clear(); }

void Progress::show(const std::string& stage, double time, double share, double speed, double energy_error) {
  if (!terminal_) return;
  const auto now = std::chrono::steady_clock::now();
  if (drawn_ && now - last_ < std::chrono::milliseconds(200)) return;
  last_ = now;
  drawn_ = true;
  const double elapsed = std::chrono::duration<double>(now - start_).count();
  const int left = share > 0 ? static_cast<int>(std::min(elapsed * (1 - share) / share, 359999.0)) : 0;
  fmt::print(stderr,
             "\r\033[K{:<8} {:>3.0f} %  t = {:.4f} s  {:.0f} steps/s  left {:d}:{:02d}:{:02d}  energy error {:.2g}",
             stage, 100 * share, time, speed, left / 3600, left / 60 % 60, left % 60, energy_error);
  std::fflush(stderr);
}

void Progress::clear() {
  if (drawn_) fmt::print(stderr, "\r\033[K");
  drawn_ = false;
}

}  // namespace coupling
