#include <cuda_runtime.h>
#if defined(TRACKBED_WITH_CUPTI)
#include <cupti.h>
#endif

#include <algorithm>
#include <cstdlib>
#include <map>

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

#if defined(TRACKBED_WITH_CUPTI)
#if CUPTI_API_VERSION >= 130000
using KernelRecord = CUpti_ActivityKernel10;
#else
using KernelRecord = CUpti_ActivityKernel9;
#endif
std::map<std::string, double> seconds_by_kernel;

void CUPTIAPI give_buffer(std::uint8_t** buffer, std::size_t* size, std::size_t* records) {
  *size = 8 << 20;
  *buffer = static_cast<std::uint8_t*>(std::aligned_alloc(8, *size));
  *records = 0;
}
void CUPTIAPI read_buffer(CUcontext, std::uint32_t, std::uint8_t* buffer, std::size_t, std::size_t valid) {
  CUpti_Activity* record = nullptr;
  while (cuptiActivityGetNextRecord(buffer, valid, &record) == CUPTI_SUCCESS) {
    if (record->kind != CUPTI_ACTIVITY_KIND_CONCURRENT_KERNEL) continue;
    const auto* kernel = reinterpret_cast<const KernelRecord*>(record);
    seconds_by_kernel[kernel->name] += 1e-9 * static_cast<double>(kernel->end - kernel->start);
  }
  std::free(buffer);
}
#endif

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

void give_back_pooled_memory() {
  int number = 0;
  cudaMemPool_t pool = nullptr;
  check(cudaGetDevice(&number));
  check(cudaDeviceSynchronize());
  if (cudaDeviceGetDefaultMemPool(&pool, number) == cudaSuccess) check(cudaMemPoolTrimTo(pool, 0));
}

double device_memory_in_use() {
  std::size_t free = 0, total = 0;
  check(cudaDeviceSynchronize());
  check(cudaMemGetInfo(&free, &total));
  return static_cast<double>(total - free);
}

std::vector<KernelTime> kernel_times([[maybe_unused]] const std::function<void()>& work) {
  std::vector<KernelTime> times;
#if defined(TRACKBED_WITH_CUPTI)
  seconds_by_kernel.clear();
  if (cuptiActivityRegisterCallbacks(give_buffer, read_buffer) != CUPTI_SUCCESS ||
      cuptiActivityEnable(CUPTI_ACTIVITY_KIND_CONCURRENT_KERNEL) != CUPTI_SUCCESS)
    return times;
  work();
  check(cudaDeviceSynchronize());
  cuptiActivityFlushAll(CUPTI_ACTIVITY_FLAG_FLUSH_FORCED);
  cuptiActivityDisable(CUPTI_ACTIVITY_KIND_CONCURRENT_KERNEL);
  for (const auto& [name, seconds] : seconds_by_kernel) times.push_back({name, seconds});
#endif
  return times;
}

}  // namespace benchmarks
