#include <cuda_runtime.h>

#include <algorithm>

#include "base/error.hpp"
#include "tests/benchmarks/device.hpp"

namespace benchmarks {
namespace {

void check(cudaError_t error) {
  if (error != cudaSuccess) throw base::MachineError(std::string("CUDA: ") + cudaGetErrorString(error));
}

__global__ void copy_rows(const double2* from, double2* to, long n) {
  const long stride = static_cast<long>(gridDim.x) * blockDim.x;
  for (long k = static_cast<long>(blockIdx.x) * blockDim.x + threadIdx.x; k < n; k += stride) to[k] = from[k];
}

}  // namespace

Device this_device() {
  Device device;
  int number = 0;
  cudaDeviceProp is{};
  check(cudaGetDevice(&number));
  check(cudaGetDeviceProperties(&is, number));
  check(cudaDriverGetVersion(&device.driver));
  check(cudaRuntimeGetVersion(&device.runtime));
  device.name = is.name;
  device.memory = static_cast<double>(is.totalGlobalMem);
  device.multiprocessors = is.multiProcessorCount;
  return device;
}

double device_copy_bandwidth() {
  const long bytes = 512L << 20, n = bytes / static_cast<long>(sizeof(double2));
  double2 *from = nullptr, *to = nullptr;
  cudaEvent_t begin{}, end{};
  check(cudaMalloc(&from, bytes));
  check(cudaMalloc(&to, bytes));
  check(cudaMemset(from, 0, bytes));
  check(cudaEventCreate(&begin));
  check(cudaEventCreate(&end));
  const int blocks = 16 * this_device().multiprocessors;
  float best = 0;
  for (int turn = 0; turn < 10; ++turn) {
    float milliseconds = 0;
    check(cudaEventRecord(begin));
    copy_rows<<<blocks, 256>>>(from, to, n);
    check(cudaGetLastError());
    check(cudaEventRecord(end));
    check(cudaEventSynchronize(end));
    check(cudaEventElapsedTime(&milliseconds, begin, end));
    best = turn == 0 ? milliseconds : std::min(best, milliseconds);
  }
  check(cudaEventDestroy(begin));
  check(cudaEventDestroy(end));
  check(cudaFree(from));
  check(cudaFree(to));
  return 2e3 * static_cast<double>(bytes) / best;
}

}  // namespace benchmarks
