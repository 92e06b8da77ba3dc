#pragma once
// The laws that a sweep can be made of, for one vector width; the order is that of the table in laws.hpp.
#include "dem/kernels/hertz_mindlin.hpp"
#include "dem/sweep_kernel.hpp"

namespace dem {

template <int W>
Sweep sweep_of(const SweepChoice& choice) {
  switch (choice.law) {
    case 0:
      return sweeping::pick<kernels::HertzMindlin, W>(choice);
    case 1:
      return sweeping::pick<kernels::HertzSmooth, W>(choice);
    default:
      return nullptr;
  }
}

Sweep portable_sweep(const SweepChoice&);
Sweep avx2_sweep(const SweepChoice&);

}  // namespace dem
