// Sweeps for processors with AVX2 and FMA: four pairs at once. Called only where the processor has them (sweep.cpp).
#include "dem/leap_rows.hpp"
#include "dem/plane_rows.hpp"
#include "dem/sweep_rows.hpp"

namespace dem {

#if defined(__AVX2__)
Sweep avx2_sweep(const SweepChoice& choice) { return sweep_of<double, 4>(choice); }
Leap avx2_leap(const LeapChoice& choice) { return leaping::pick<4>(choice); }
PlaneSweep avx2_plane_sweep(bool ledger, bool turns) { return sweeping::pick_planes<4>(ledger, turns); }
#else
Sweep avx2_sweep(const SweepChoice&) { return nullptr; }
Leap avx2_leap(const LeapChoice&) { return nullptr; }
PlaneSweep avx2_plane_sweep(bool, bool) { return nullptr; }
#endif

}  // namespace dem
