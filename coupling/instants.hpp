#pragma once
#include <cmath>

namespace coupling {

/// The first of the instants that come after `now`; an interval shorter than the steps asks for every step.
inline double next_instant(double instant, double now, double interval) {
  return instant > now ? instant : instant + interval * (std::floor((now - instant) / interval) + 1);
}

}  // namespace coupling
