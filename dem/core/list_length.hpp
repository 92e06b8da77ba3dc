#pragma once
// Lists count in 32 bits: half the memory, and more than a GPU holds. One that would be longer is refused.
#include <cstdint>
#include <limits>
#include <string>

#include "base/error.hpp"

namespace dem {

/// The length of a list of so many entries. Throws base::MachineError.
inline int list_length(std::int64_t entries) {
  constexpr std::int64_t most = std::numeric_limits<int>::max();
  if (entries > most)
    throw base::MachineError("a list of " + std::to_string(entries) + " neighbours is needed, at most " +
                             std::to_string(most) +
                             " are possible on one rank; share the grains out over more (--dem-ranks)");
  return static_cast<int>(entries);
}

}  // namespace dem
