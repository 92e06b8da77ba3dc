#pragma once
// A run that is asked to end (Ctrl-C, a queue's SIGTERM) ends at its next sample and leaves results that can be read.

namespace coupling {

/// While it lives, the first SIGINT or SIGTERM is remembered; the second one ends the process at once. A signal that
/// was ignored before stays ignored.
class InterruptWatch {
 public:
  InterruptWatch();
  ~InterruptWatch();
  InterruptWatch(const InterruptWatch&) = delete;
  InterruptWatch& operator=(const InterruptWatch&) = delete;

  /// Name of the signal that has come to this process; null: none.
  static const char* signal();
};

}  // namespace coupling
