#pragma once
// The GPU that a benchmark runs on, asked through the CUDA runtime (device.cu). Only in builds with CUDA.
#include <string>

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

}  // namespace benchmarks
