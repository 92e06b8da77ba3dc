#pragma once
// Contacts of grains with planes at rest, several at once (SIMD), on a processor, for grains that are near no other
// wall: what core/wall_pass.hpp does for one grain after the other. Law: hertz_mindlin.
#include "dem/kernels/pair_parameters.hpp"
#include "dem/kernels/touch.hpp"

namespace dem {

/// Contact c is of grain row[c] with the plane normal . x = offset. What the contact leaves goes to the rows of its
/// candidate, as core/rows.hpp has them, and to the sum of its grain.
struct PlaneInput {
  const double* place;     // rows as in sweep.hpp
  const double* motion;    // rows as in sweep.hpp
  const int* row;          // of the grain
  const double* plane;     // rows of four: normal, offset [m]
  const int* candidate;    // row of all that follows but `sum`
  const int* slot;         // row in `sum`
  double* history;         // the law's numbers, and one more with the ledger
  double* state;           // rows of eleven (WallState)
  double* impulse;         // [N s] rows of three
  double* ledger;          // rows of six (WallLedger); null: not tracked
  double* sum;             // rows of eight (WallSum)
  double rolling;          // [-] coefficient of bounded rolling friction, or 0
  double maximum_overlap;  // share of the radius
  const kernels::PairParameters* parameters;
  kernels::Interval time;
  double ended;  // [s] the step that ends now
};

/// Contacts begin … end - 1. Returns whether an overlap is too large.
using PlaneSweep = bool (*)(const PlaneInput&, int begin, int end);

/// `lanes` is 2 or 4, doubles in a vector.
PlaneSweep find_plane_sweep(bool ledger, bool turns, int lanes);

}  // namespace dem
