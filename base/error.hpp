#pragma once
// The ways a run can end before its time, and who is to blame. The exit status is part of the command line's contract.
#include <stdexcept>
#include <string>

namespace base {

/// The user's input is wrong (exit 2). The message holds file:line, key, value found, rule, remedy.
struct UserError : std::runtime_error {
  using std::runtime_error::runtime_error;
};
/// The run became unstable (exit 3). The message holds cause, place (grain or element, position), step.
struct UnstableError : std::runtime_error {
  using std::runtime_error::runtime_error;
};
/// The machine failed the run (exit 4): a full disk, a lost rank, no memory.
struct MachineError : std::runtime_error {
  using std::runtime_error::runtime_error;
};
/// The run was asked to end, by Ctrl-C or SIGTERM (exit 130). Its results up to there are written.
struct InterruptedError : std::runtime_error {
  using std::runtime_error::runtime_error;
};
/// A broken promise inside Trackbed: always a bug of ours (exit 1).
struct InternalError : std::logic_error {
  using std::logic_error::logic_error;
};

inline void require_user(bool condition, const std::string& message) {
  if (!condition) throw UserError(message);
}
inline void require_internal(bool condition, const char* message) {
  if (!condition) throw InternalError(message);
}

}  // namespace base
