#include "fem/kernel_rows.hpp"

namespace fem {

ForceKernel portable_kernel(int element, int law) { return kernel_of<portable_lanes>(element, law); }

}  // namespace fem
