#pragma once
// The laws that a sweep can be made of, for one kind of vector.
#include "dem/laws.hpp"
#include "dem/sweep_kernel.hpp"

namespace dem {

template <class Number, int W>
Sweep sweep_of(const SweepChoice& choice) {
  return with_law_number(choice.law,
                         [&](auto law) { return sweeping::pick<decltype(law), kernels::Pack<Number, W>>(choice); });
}

Sweep portable_sweep(const SweepChoice&);
Sweep avx2_sweep(const SweepChoice&);
Sweep portable_mixed_sweep(const SweepChoice&);
Sweep avx2_mixed_sweep(const SweepChoice&);

}  // namespace dem
