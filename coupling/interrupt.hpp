#pragma once
// A run that is asked to end (Ctrl-C, a queue's SIGTERM) ends at its next sample, with a checkpoint and results that
// can be read; one that is sent SIGUSR1 writes a checkpoint there and goes on.

namespace coupling {

/// While it lives, the first SIGINT or SIGTERM is remembered; the second one ends the process at once. A signal that
/// was ignored before stays ignored.
class InterruptWatch {
 public:
  InterruptWatch();
  ~InterruptWatch();
  InterruptWatch(const InterruptWatch&) = delete;
  InterruptWatch& operator=(const InterruptWatch&) = delete;

  /// Number of the signal that has come to this process; 0: none.
  static int signal();
  static const char* name(int signal);
};

/// While it lives, SIGUSR1 asks for a checkpoint, also where none can be taken yet.
class CheckpointWatch {
 public:
  CheckpointWatch();
  ~CheckpointWatch();
  CheckpointWatch(const CheckpointWatch&) = delete;
  CheckpointWatch& operator=(const CheckpointWatch&) = delete;

  static bool asked();
  static void answered();
};

}  // namespace coupling
