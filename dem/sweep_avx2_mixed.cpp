// Mixed precision for processors with AVX2 and FMA: eight pairs at once. Called only where the processor has them.
#include "dem/sweep_rows.hpp"

namespace dem {

#if defined(__AVX2__)
Sweep avx2_mixed_sweep(const SweepChoice& choice) { return sweep_of<float, 8>(choice); }
#else
Sweep avx2_mixed_sweep(const SweepChoice&) { return nullptr; }
#endif

}  // namespace dem
