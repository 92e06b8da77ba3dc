// The DEM core on Thrust's CUDA system: the same source as backend_omp.cpp.
#define TRACKBED_DEM_CUDA 1
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

std::unique_ptr<Simulation> create_cuda(const Setup& setup) {
  return std::make_unique<cuda_system::System>(setup, Backend::cuda);
}

bool cuda_device_present(std::string* why_not) {
  int devices = 0;
  const cudaError_t error = cudaGetDeviceCount(&devices);
  if (error == cudaSuccess && devices > 0) return true;
  if (why_not) *why_not = error == cudaSuccess ? "no CUDA device" : cudaGetErrorString(error);
  cudaGetLastError();  // an error that has been dealt with must not be found by a later call
  return false;
}

}  // namespace dem
