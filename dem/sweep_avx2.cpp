// Sweeps for processors with AVX2 and FMA: four pairs at once. Called only where the processor has them (sweep.cpp).
#include "dem/sweep_rows.hpp"

namespace dem {

#if defined(__AVX2__)
Sweep avx2_sweep(const SweepChoice& choice) { return sweep_of<double, 4>(choice); }
#else
Sweep avx2_sweep(const SweepChoice&) { return nullptr; }
#endif

}  // namespace dem
