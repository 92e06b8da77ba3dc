#pragma once
// What rolling models (rolling_models.hpp) answer.
#include "dem/kernels/touch.hpp"

namespace dem::kernels {

/// On top of what the contact force does with its arm.
template <class Real>
struct Moment {
  Vector3<Real> moment{};  // [N m] on i; j gets the opposite
  // Only with Ledger:
  Real elastic{};  // [J] stored now
  Real loss{};     // [J] in this step
};

}  // namespace dem::kernels
