#pragma once
// What laws with moments are given besides a Touch, and what they answer: bonds (parallel_bond.hpp) and rolling
// resistance (rolling_models.hpp). A law that needs neither is not asked for them.
#include "dem/kernels/touch.hpp"

namespace dem::kernels {

/// How i and j turn, at the instant of the Touch.
template <class Real>
struct Turning {
  Vector3<Real> angular_velocity;  // [rad/s] of i relative to j
  Real spin;                       // [rad/s] of the pair about its normal: mean of i and j; only bonds read it
};

/// On top of what the contact force does with its arm.
template <class Real>
struct Moment {
  Vector3<Real> moment{};  // [N m] on i; j gets the opposite
  // Only with Ledger:
  Real elastic{};  // [J] stored now
  Real loss{};     // [J] in this step
};

}  // namespace dem::kernels
