// Compiled with AVX2 and FMA (see CMakeLists.txt); called only where the processor has them.
#include "fem/kernel_rows.hpp"

namespace fem {

ForceKernel avx2_kernel(int element, int law) { return kernel_of<avx2_lanes>(element, law); }

}  // namespace fem
