#include "coupling/agree.hpp"

#include <chrono>
#include <new>
#include <thread>

#include "base/error.hpp"

namespace coupling {

FailureText caught(const std::function<void()>& work) {
  try {
    work();
    return {};
  } catch (const base::UserError& error) {
    return {Failure::user, error.what()};
  } catch (const base::UnstableError& error) {
    return {Failure::unstable, error.what()};
  } catch (const base::MachineError& error) {
    return {Failure::machine, error.what()};
  } catch (const base::InterruptedError& error) {
    return {Failure::interrupted, error.what()};
  } catch (const std::bad_alloc&) {
    return {Failure::machine, "out of memory; use fewer grains or a coarser mesh, or more ranks"};
  } catch (const std::exception& error) {
    return {Failure::internal, error.what()};
  }
}

void raise(const FailureText& failure) {
  switch (failure.kind) {
    case Failure::none:
      return;
    case Failure::user:
      throw base::UserError(failure.text);
    case Failure::unstable:
      throw base::UnstableError(failure.text);
    case Failure::machine:
      throw base::MachineError(failure.text);
    case Failure::interrupted:
      throw base::InterruptedError(failure.text);
    case Failure::internal:
      throw base::InternalError(failure.text);
  }
}

double wait_politely(MPI_Request& request) {
  // Within a window the answer comes in milliseconds and a sleeping rank would wake late: it only lets others go first.
  // A wait that lasts longer is for somebody's packing or output.
  constexpr std::chrono::milliseconds patience{5};
  const auto start = std::chrono::steady_clock::now();
  int done = 0;
  for (int tries = 0; !done; ++tries) {
    MPI_Test(&request, &done, MPI_STATUS_IGNORE);
    if (done || tries < 200) continue;
    if (std::chrono::steady_clock::now() - start < patience)
      std::this_thread::yield();
    else
      std::this_thread::sleep_for(std::chrono::microseconds(100));
  }
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void agree(MPI_Comm communicator, const std::function<void()>& work) {
  FailureText failure = caught(work);
  int rank = 0, size = 1;
  MPI_Comm_rank(communicator, &rank);
  MPI_Comm_size(communicator, &size);
  const int mine = failure.kind == Failure::none ? size : rank;
  int first = size;
  // One rank may be packing grains for minutes: the others must not burn its cores while they wait.
  MPI_Request request;
  MPI_Iallreduce(&mine, &first, 1, MPI_INT, MPI_MIN, communicator, &request);
  wait_politely(request);
  if (first == size) return;
  int header[2] = {static_cast<int>(failure.kind), static_cast<int>(failure.text.size())};
  MPI_Bcast(header, 2, MPI_INT, first, communicator);
  failure.kind = static_cast<Failure>(header[0]);
  failure.text.resize(static_cast<std::size_t>(header[1]));
  MPI_Bcast(failure.text.data(), header[1], MPI_CHAR, first, communicator);
  raise(failure);
}

}  // namespace coupling
