#pragma once
// The backend that the tests of the DEM run on. All simulations of tests/*/dem_*.cpp are made here, so that one
// variable runs all of these tests on a GPU:
//   TRACKBED_TEST_BACKEND=cuda build/release/bin/unit_dem
// Not set, or omp: the processor. one_by_one: the processor with contacts taken one by one, which is the source of the
// GPU's kernels; part of the suite. tests/dem_main.cpp refuses to start with cuda where no device can be used, and
// names the tests that only make sense on a processor.
#include <memory>

#include "dem/dem.hpp"

namespace dem_test {

/// Both throw base::UserError when the variable names none of these.
dem::Backend backend();
bool one_by_one();

/// A simulation on backend(). Setup::lanes, which belongs to the processor, means nothing on a GPU.
inline std::unique_ptr<dem::Simulation> create(dem::Setup setup) {
  if (one_by_one()) setup.lanes = 1;
  return dem::Simulation::create(setup, backend());
}

}  // namespace dem_test
