// The DEM core on Thrust's OpenMP system.
#include <memory>

#include "dem/backends.hpp"
#include "dem/core/system_advance.hpp"
#include "dem/core/system_bodies.hpp"
#include "dem/core/system_bonds.hpp"
#include "dem/core/system_growth.hpp"
#include "dem/core/system_measure.hpp"
#include "dem/core/system_setup.hpp"
#include "dem/core/system_state.hpp"

namespace dem {

std::unique_ptr<Simulation> create_omp(const Setup& setup) {
  return std::make_unique<omp_system::System>(setup, Backend::omp);
}

}  // namespace dem
