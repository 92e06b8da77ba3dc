#pragma once
// The GPU that a benchmark runs on, asked through the CUDA runtime (device.cu). Only in builds with CUDA.
#include <functional>
#include <string>
#include <vector>

#include "tests/benchmarks/gpu_report.hpp"

namespace benchmarks {

struct Device {
  std::string name;
  int driver = 0, runtime = 0;  // CUDA version that the driver knows, and the runtime's: 13000 is 13.0
  double memory = 0;            // [B]
  int multiprocessors = 0;
};
/// The current device; throws base::MachineError.
Device this_device();

/// [B/s] read plus written by a kernel that copies one array to another, the best of ten.
double device_copy_bandwidth();

/// [B] of the device's memory that are not free, whoever has them; what the driver's pool only keeps counts too, until
/// it is given back.
double device_memory_in_use();
void give_back_pooled_memory();

/// Times of all kernels that `work` starts, those of graphs one by one; empty where the build has no CUPTI, or it
/// is not let near the device.
std::vector<KernelTime> kernel_times(const std::function<void()>& work);

}  // namespace benchmarks
