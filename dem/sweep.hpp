#pragma once
// The contact sweep of a processor: forces of a list of sphere pairs, several pairs at once (SIMD), added to the rows
// of their grains. One function per law, number of lanes and set of features: what a scene lacks is not in its loop.
// Deterministic: pairs are taken in the order of the list.
//
// Mixed precision (sweep_access.hpp): the law and what contacts keep are single precision, twice as many pairs at once.
#include "dem/kernels/pair_parameters.hpp"
#include "dem/kernels/touch.hpp"

namespace dem {

/// Pairs past the last block that the lists must still name, by rows that exist.
constexpr int sweep_looks_ahead = 16;

/// Blocks of `lanes` pairs. Rows are four numbers, eight where grains turn. A lane that holds no pair names a row whose
/// radius is -1 twice.
struct SweepInput {
  const double* place;              // [m] x, y, z, radius
  const double* motion;             // [m/s] velocity, [kg] mass; [rad/s] angular velocity, -
  double* pull;                     // [N] force, [N m] rolling resistance; [N m] torque, -
  const int *first, *second;        // rows read, per lane
  const int *to_first, *to_second;  // rows added to
  void* history;                    // [block][number][lane], double; float in mixed precision
  int blocks;
  const kernels::PairParameters* parameters;
  kernels::Interval time;
  double maximum_overlap;  // share of the smaller radius
};

struct SweepSums {
  double elastic_normal = 0, elastic_shear = 0;                  // [J] now; rolling springs count as shear
  double loss_friction = 0, loss_damping = 0, loss_rolling = 0;  // [J] in this step
  bool overlap_too_large = false;
};

using Sweep = void (*)(const SweepInput&, SweepSums&);

struct SweepChoice {
  int law = 0;      // row of the table in laws.hpp
  int rolling = 0;  // row of the table in laws.hpp
  bool ledger = false, turns = true;
  bool mixed = false;  // precision
};

/// Doubles in a vector of this machine: 4 with AVX2, otherwise 2.
int sweep_lanes();
/// `lanes` is 2 or 4, doubles in a vector; in mixed precision the sweep takes twice as many pairs at once.
Sweep find_sweep(const SweepChoice&, int lanes);

}  // namespace dem
