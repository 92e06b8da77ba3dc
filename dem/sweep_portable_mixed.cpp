// Mixed precision with the vectors that every x86-64 processor has: four pairs at once.
#include "dem/sweep_rows.hpp"

namespace dem {

Sweep portable_mixed_sweep(const SweepChoice& choice) { return sweep_of<float, 4>(choice); }

}  // namespace dem
