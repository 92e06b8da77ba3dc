// The DEM core on Thrust's CUDA system: the same source as backend_omp.cpp.
#define TRACKBED_DEM_CUDA 1
#include <atomic>
#include <cstdio>
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

namespace {

std::atomic<int> wanted_device = 0;

/// The device that simulations take, or -1.
int device() {
  int devices = 0;
  if (cudaGetDeviceCount(&devices) == cudaSuccess && devices > 0) return wanted_device % devices;
  cudaGetLastError();
  return -1;
}

}  // namespace

void cuda_use_device(int number) { wanted_device = number < 0 ? 0 : number; }

std::string cuda_device_text() {
  cudaDeviceProp is{};
  const int number = device();
  if (number < 0 || cudaGetDeviceProperties(&is, number) != cudaSuccess) return "";
  char text[400];
  std::snprintf(text, sizeof text, "%s (device %d, %.0f GiB, compute capability %d.%d)", is.name, number,
                static_cast<double>(is.totalGlobalMem) / (1 << 30), is.major, is.minor);
  return text;
}

std::unique_ptr<Simulation> create_cuda(const Setup& setup) {
  cuda_system::require_device(cudaSetDevice(device()), "choosing the device");
  return std::make_unique<cuda_system::System>(setup, Backend::cuda);
}

/// Without making a context, which would take memory of a device that this rank may not be meant for.
bool cuda_device_present(std::string* why_not) {
  int devices = 0;
  const cudaError_t error = cudaGetDeviceCount(&devices);
  if (error == cudaSuccess && devices > 0) {
    constexpr int built_for[] = {__CUDA_ARCH_LIST__};  // 100 major + 10 minor, the lowest first
    int major = 0, minor = 0, mode = cudaComputeModeProhibited;
    cudaDeviceGetAttribute(&major, cudaDevAttrComputeCapabilityMajor, device());
    cudaDeviceGetAttribute(&minor, cudaDevAttrComputeCapabilityMinor, device());
    cudaDeviceGetAttribute(&mode, cudaDevAttrComputeMode, device());
    const bool new_enough = 100 * major + 10 * minor >= built_for[0];
    if (new_enough && mode != cudaComputeModeProhibited) return true;
    if (why_not)
      *why_not = new_enough ? "the device's compute mode is `prohibited`"
                            : "compute capability " + std::to_string(major) + "." + std::to_string(minor) +
                                  " of the device, at least " + std::to_string(built_for[0] / 100) + "." +
                                  std::to_string(built_for[0] / 10 % 10) + " is needed (TRACKBED_CUDA_ARCHITECTURES)";
    cudaGetLastError();
    return false;
  }
  int driver = 0;  // stays 0 where there is none, which the runtime calls an insufficient one
  const bool installed = cudaDriverGetVersion(&driver) == cudaSuccess && driver > 0;
  if (why_not)
    *why_not = !installed             ? "no NVIDIA driver on this machine"
               : error == cudaSuccess ? "no CUDA device"
                                      : cudaGetErrorString(error);
  cudaGetLastError();  // an error that has been dealt with must not be found by a later call
  return false;
}

}  // namespace dem
