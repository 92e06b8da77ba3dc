#include "dem/sweep.hpp"

#include "base/error.hpp"
#include "dem/leap_rows.hpp"
#include "dem/plane_rows.hpp"
#include "dem/sweep_rows.hpp"

namespace dem {

int sweep_lanes() {
#if defined(__x86_64__)
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") ? 4 : 2;
#else
  return 2;
#endif
}

Sweep find_sweep(const SweepChoice& choice, int lanes) {
  const Sweep found = choice.mixed ? (lanes == 4 ? avx2_mixed_sweep(choice) : portable_mixed_sweep(choice))
                                   : (lanes == 4 ? avx2_sweep(choice) : portable_sweep(choice));
  base::require_internal(found != nullptr, "no sweep for this law and vector width");
  return found;
}

Leap find_leap(const LeapChoice& choice, int lanes) {
  const Leap found = lanes == 4 ? avx2_leap(choice) : portable_leap(choice);
  base::require_internal(found != nullptr, "no pass of the integrator for this vector width");
  return found;
}

PlaneSweep find_plane_sweep(bool ledger, bool turns, int lanes) {
  const PlaneSweep found = lanes == 4 ? avx2_plane_sweep(ledger, turns) : portable_plane_sweep(ledger, turns);
  base::require_internal(found != nullptr, "no sweep over planes for this vector width");
  return found;
}

}  // namespace dem
