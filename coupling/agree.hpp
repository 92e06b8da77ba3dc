#pragma once
// All ranks agree on a failure before anybody goes on: what one rank throws, every rank throws.
#include <mpi.h>

#include <functional>
#include <string>

namespace coupling {

enum class Failure : int { none = 0, internal = 1, user = 2, unstable = 3, machine = 4, interrupted = 130 };

struct FailureText {
  Failure kind = Failure::none;
  std::string text;
};

/// Runs `work` and turns what it throws into a value; never throws itself.
FailureText caught(const std::function<void()>& work);
/// Throws the base:: error that `failure` describes; does nothing for Failure::none.
void raise(const FailureText& failure);
/// Runs `work` on every rank of the communicator. If it throws anywhere, every rank throws the error of the lowest
/// failing rank. `work` must not leave other ranks waiting inside it when it throws. Collective.
void agree(MPI_Comm communicator, const std::function<void()>& work);

/// Waits for a message without burning the core that the other side may need. Returns the seconds waited.
double wait_politely(MPI_Request& request);

}  // namespace coupling
