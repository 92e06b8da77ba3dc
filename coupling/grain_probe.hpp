#pragma once
// What a probe of grains looks at, beside what it shares with other probes.
#include <optional>

#include "dem/measure/heap.hpp"
#include "dem/measure/region.hpp"

namespace coupling {

enum class StressPart { xx, yy, zz, xy, yz, zx, pressure, von_mises };

struct GrainProbe {
  std::optional<dem::Region> region;  // absent: all grains
  int fewest = 2;                     // contacts of a grain that is no rattler
  bool walls = false;                 // contacts with walls count too
  double share = 0;                   // of the contacts, for a quantile
  StressPart stress = StressPart::zz;
  dem::HeapView heap;
  bool scatter = false;  // of a heap's angle, instead of the angle
  double sieve = 0;      // [m] size
};

}  // namespace coupling
