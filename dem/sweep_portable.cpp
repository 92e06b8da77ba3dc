// Sweeps for the vectors that every x86-64 processor has: two pairs at once.
#include "dem/sweep_rows.hpp"

namespace dem {

Sweep portable_sweep(const SweepChoice& choice) { return sweep_of<double, 2>(choice); }

}  // namespace dem
