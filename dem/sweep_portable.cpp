// Sweeps for the vectors that every x86-64 processor has: two pairs at once.
#include "dem/leap_rows.hpp"
#include "dem/plane_rows.hpp"
#include "dem/sweep_rows.hpp"

namespace dem {

Sweep portable_sweep(const SweepChoice& choice) { return sweep_of<double, 2>(choice); }
Leap portable_leap(const LeapChoice& choice) { return leaping::pick<2>(choice); }
PlaneSweep portable_plane_sweep(bool ledger, bool turns) { return sweeping::pick_planes<2>(ledger, turns); }

}  // namespace dem
