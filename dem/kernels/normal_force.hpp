#pragma once
// What the normal part of a law hands to its tangential part.
#include "dem/kernels/touch.hpp"

namespace dem::kernels {

template <class Real>
struct NormalForce {
  Real force;            // [N] total, >= 0: dry stones do not attract
  Real shear_stiffness;  // [N/m] k_t that goes with it; 0 when not touching
  Real damping;          // [N s/m] c_n
  Real separation;       // [m/s] normal part of the relative velocity, > 0 apart
  Real stored;           // [J] elastic
  Real lost_power;       // [W] in the dashpot
};

}  // namespace dem::kernels
