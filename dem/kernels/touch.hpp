#pragma once
// What a contact law is given and what it answers. A law is a type with
//
//   static constexpr int history;    numbers that one contact keeps from step to step, all zero while it carries
//   nothing template <bool Ledger, class Real> static Reaction<Real> press(const PairParameters&, const Touch<Real>&,
//   const Interval&, Real* history);
//
// and is listed in dem/laws.hpp. Real is a double, a float or a SIMD pack of them (lanes.hpp): no branch may depend on
// one lane. Where `overlap` <= 0 the law answers zero and clears the history. With Ledger the contact keeps one number
// more, history[history]: the shear energy it stored at the last instant [J].
//
// Parts that laws are put together from: hertz.hpp, linear.hpp ... (normal), shear.hpp (tangential and friction).
#include "dem/kernels/lanes.hpp"

namespace dem::kernels {

/// The sphere pair (or sphere and wall) at one instant; i and j as in "force on i".
template <class Real>
struct Touch {
  Real overlap;            // [m] > 0 when touching
  Real effective_radius;   // [m] R* = R_i R_j / (R_i + R_j); walls: R_i
  Real effective_mass;     // [kg] m* = m_i m_j / (m_i + m_j); walls: m_i
  Vector3<Real> normal;    // [-] unit vector from j to i
  Vector3<Real> velocity;  // [m/s] of i relative to j at the contact point, at this instant
};

/// A shear spring moves with the relative velocity of this instant for half the step that ends here and half the step
/// that begins here: summed over the steps this is the displacement of velocity Verlet to second order. Symplectic
/// Euler moves with the velocity of a step's end: it moves springs for all of the step that ends, and none of the next.
struct Interval {
  double before;              // [s] half the step that ends now; 0 when a run starts
  double ahead;               // [s] half the step that begins now
  double ended = 2 * before;  // [s] the step that ends now
};

template <class Real>
struct Reaction {
  Vector3<Real> force{};  // [N] on i; j gets the opposite
  Real normal_force{};    // [N] its part along the normal, > 0 pushes i away
  // Only with Ledger:
  Real elastic_normal{}, elastic_shear{};  // [J] stored now
  Real loss_friction{}, loss_damping{};    // [J] in this step
};

}  // namespace dem::kernels
