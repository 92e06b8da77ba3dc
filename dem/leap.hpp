#pragma once
// The pass of velocity Verlet (core/leapfrog.hpp has the equations) over the rows of spheres, several numbers at once
// (SIMD); OpenMP system only. One function per width of vector and set of features: what a scene lacks is not in it.
#include "base/vec3.hpp"

namespace dem {

/// Rows as in sweep.hpp; all of them start on multiples of their length.
struct LeapInput {
  double* place;           // [m] x, y, z, radius
  double* state;           // [m/s], [1/kg] inverse mass; where grains turn [rad/s], [1/(kg m2)] inverse inertia
  double* motion;          // what contacts see
  double* pull;            // forces, or accelerations where nothing ends
  const double* listed;    // [m] x, y, z at the list
  const int* wall_slot;    // null: no walls; -1: none near this grain
  const double* wall_sum;  // rows of eight: force, rolling resistance, torque, -
  double* ledger;          // pairs: rolling, damping [J]; null: not kept
  base::Vec3 gravity;      // [m/s2]
  double alpha;            // [1/s] damping of grains
  double dt;               // [s] step of the run
  double ended;            // [s] the step that ends, or 0
  double end_share;        // of the impulse of the step that ends
  double kick;             // [N s] per newton with which a step starts
  double seen;             // the same for the rest of the step, which contacts see beforehand
};

/// Grains begin … end - 1. Returns the largest squared displacement since the list, infinite when a state is not
/// finite; 0 where no step begins.
using Leap = double (*)(const LeapInput&, int begin, int end);

struct LeapChoice {
  bool turns = true, brakes = false, ledger = false;
  bool ends = true, begins = true;  // one of them at least
};

/// `lanes` is 2 or 4, doubles in a vector.
Leap find_leap(const LeapChoice&, int lanes);

}  // namespace dem
