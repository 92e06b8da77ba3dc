#pragma once
// The two compilations of the DEM core, as simulation.cpp sees them.
#include <memory>
#include <string>

#include "dem/dem.hpp"

namespace dem {

std::unique_ptr<Simulation> create_omp(const Setup&);
std::unique_ptr<Simulation> create_cuda(const Setup&);
/// Asks the CUDA runtime for a device; never throws.
bool cuda_device_present(std::string* why_not);
/// As dem::use_device() and dem::device_text(), which see.
void cuda_use_device(int number);
std::string cuda_device_text();

}  // namespace dem
