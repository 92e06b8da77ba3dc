#pragma once
// Small helpers over one communicator: hand a value to every rank, add numbers up, and let all ranks fail together.
#include <mpi.h>

#include <cstdint>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "base/error.hpp"

namespace fem {

template <class T>
void broadcast(MPI_Comm comm, T& value) requires std::is_arithmetic_v<T> {
  MPI_Bcast(&value, sizeof(T), MPI_BYTE, 0, comm);
}

template <class T>
void broadcast(MPI_Comm comm, std::vector<T>& values) requires std::is_trivially_copyable_v<T> {
  std::int64_t count = static_cast<std::int64_t>(values.size());
  MPI_Bcast(&count, 1, MPI_INT64_T, 0, comm);
  values.resize(count);
  constexpr std::int64_t chunk = (1 << 30) / sizeof(T);  // MPI counts are 32 bits
  for (std::int64_t first = 0; first < count; first += chunk) {
    const std::int64_t length = std::min(chunk, count - first);
    MPI_Bcast(values.data() + first, static_cast<int>(length * sizeof(T)), MPI_BYTE, 0, comm);
  }
}

enum class Outcome : int { good, user, unstable, machine, internal };

/// If the outcome of any rank is not good, all ranks throw: the message of the first such rank.
inline void agree(MPI_Comm comm, Outcome outcome, const std::string& message) {
  int rank = 0, size = 1;
  MPI_Comm_rank(comm, &rank);
  MPI_Comm_size(comm, &size);
  int failing = outcome == Outcome::good ? size : rank;
  MPI_Allreduce(MPI_IN_PLACE, &failing, 1, MPI_INT, MPI_MIN, comm);
  if (failing == size) return;
  int kind = static_cast<int>(outcome), length = static_cast<int>(message.size());
  MPI_Bcast(&kind, 1, MPI_INT, failing, comm);
  MPI_Bcast(&length, 1, MPI_INT, failing, comm);
  std::string text = message;
  text.resize(length);
  MPI_Bcast(text.data(), length, MPI_CHAR, failing, comm);
  switch (static_cast<Outcome>(kind)) {
    case Outcome::user:
      throw base::UserError(text);
    case Outcome::unstable:
      throw base::UnstableError(text);
    case Outcome::machine:
      throw base::MachineError(text);
    default:
      throw base::InternalError(text);
  }
}

/// Runs a call and turns what it throws into an outcome that agree() can share.
template <class Call>
Outcome outcome_of(Call&& call, std::string& message) {
  try {
    call();
    return Outcome::good;
  } catch (const base::UserError& error) {
    message = error.what();
    return Outcome::user;
  } catch (const base::UnstableError& error) {
    message = error.what();
    return Outcome::unstable;
  } catch (const base::MachineError& error) {
    message = error.what();
    return Outcome::machine;
  } catch (const std::bad_alloc&) {
    message = "out of memory";
    return Outcome::machine;
  } catch (const std::exception& error) {
    message = error.what();
    return Outcome::internal;
  }
}

/// Runs a call on the first rank; what it throws there is thrown on every rank.
template <class Call>
void on_first_rank(MPI_Comm comm, Call&& call) {
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  std::string message;
  const Outcome outcome = rank == 0 ? outcome_of(call, message) : Outcome::good;
  agree(comm, outcome, message);
}

/// All ranks' numbers one after another, on the first rank.
template <class T>
std::vector<T> gathered(MPI_Comm comm, std::span<const T> values, MPI_Datatype type) {
  int rank = 0, ranks = 1;
  MPI_Comm_rank(comm, &rank);
  MPI_Comm_size(comm, &ranks);
  const int count = static_cast<int>(values.size());
  std::vector<int> counts(ranks), starts(ranks + 1, 0);
  MPI_Gather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, 0, comm);
  for (int r = 0; r < ranks; ++r) starts[r + 1] = starts[r] + counts[r];
  std::vector<T> all(rank == 0 ? starts.back() : 0);
  MPI_Gatherv(values.data(), count, type, all.data(), counts.data(), starts.data(), type, 0, comm);
  return all;
}

inline void sum(MPI_Comm comm, double* values, int count) {
  MPI_Allreduce(MPI_IN_PLACE, values, count, MPI_DOUBLE, MPI_SUM, comm);
}

}  // namespace fem
