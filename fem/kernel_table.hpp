#pragma once
// What a block of elements calls, one row per element and law, chosen once when the block is made.

namespace fem {

struct KernelArguments {
  const int* nodes;             // [batch][node][lane] local node numbers
  const double* geometry;       // [batch][number][lane], at a boundary of vectors
  const void* law;              // the law's parameters
  const double* displacements;  // [m] [node][component]
  const double* velocities;     // [m/s] [node][component]; null: at rest
  double* forces;               // [N] added to
  const double* history;        // [batch][number][lane] of the law
  double* new_history;          // where it is written to; null: not wanted
  double* losses;               // viscous power [W], plastic work since the last step [J]: added to; null: not wanted
  int elements, batches;        // in the block
  int first_batch, last_batch;  // to do now
};

using ForceKernel = void (*)(const KernelArguments&);

/// The force kernel of families.hpp's element and law by their place in the tables, for this machine's vectors.
ForceKernel portable_kernel(int element, int law);  // 2 lanes
ForceKernel avx2_kernel(int element, int law);      // 4 lanes; only where the processor has AVX2 and FMA
constexpr int portable_lanes = 2, avx2_lanes = 4;

}  // namespace fem
