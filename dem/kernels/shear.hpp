#pragma once
// Tangential spring and dashpot on a Coulomb cone, for the stiffness k_t that the normal part gives:
//
//   F_te = (k_t < last k_t ? k_t / last k_t : 1) F_te(last) - k_t (tangential displacement)         (3.20)
//   c_t = c_n sqrt(k_t / k_n)                                                                       (3.26b)
//   |F_te + F_td| <= mu F_n                                                                         (3.23, 3.24)
// Source: Irazabal Gonzalez 2017 (PhD thesis, UPC Barcelona), section 3.2.3; the no-slip form is Thornton, Cummins,
// Cleary 2013 (doi:10.1016/j.powtec.2012.08.012).
//
// Where we differ from the source:
// - 3.20 asks whether the normal force falls; with a dashpot that is ambiguous. We ask whether k_t falls: k_t is
//   monotone in the overlap, so this is unloading of the contact patch, which is what Thornton's argument is about.
// - 3.22 takes k_n for c_t and 3.26b takes k_t; 3.26b is used.
// - 3.24 scales spring and dashpot together. Here the spring is held on the cone first and the dashpot gets what the
//   cone leaves: |F_te + lambda F_td| = mu F_n with lambda in [0, 1]. The total obeys 3.24 all the same, in full
//   sliding the two are equal, and neither part ever feeds energy back (scaling both can reverse the spring at high
//   slip speed).
//
// History: the spring's force carried ahead by half a step (touch.hpp, Interval), and k_t of the last instant. It
// follows the tilt of the contact plane at constant magnitude, not the spin of a pair about its common normal.
//
// Energy. Velocity Verlet changes the kinetic energy by the trapezoid work 1/2 (F_n + F_n+1) . displacement; summed
// over a contact that begins and ends without force this is sum F_n . v_n dt to second order, for springs and dashpots
// alike. What the spring took in, less what it stores now, is lost: slip, and the energy that a shrinking or growing
// patch gives up. A contact that ends loses what it stored.
#include "dem/kernels/normal_force.hpp"

namespace dem::kernels {

/// Factor that gives a force, once its part along `along` (the square of its component) is taken out, its magnitude
/// back: (1 - along / squared)^-1/2. A force that has come to point along the normal (the contact has turned by 90
/// degrees in one step) has no direction left: 0. The series holds to rounding up to a turn of 0.02 rad in one step.
template <class Real>
TRACKBED_HD TRACKBED_LANES Real magnitude_kept(Real along, Real squared) {
  const Real one = all<Real>(1);
  const auto is_there = squared > Real{};
  const Real e = along / choose(is_there, squared, one);
  if (!any(e > all<Real>(4e-4)))
    return one + e * (all<Real>(0.5) + e * (all<Real>(0.375) + e * (all<Real>(0.3125) + e * all<Real>(35.0 / 128))));
  const Real rest = one - e;
  const auto has_direction = rest > all<Real>(1e-12);
  return choose(has_direction, one / square_root(choose(has_direction, rest, one)), Real{});
}

/// Turns a tangential force into the plane normal to `normal`, keeping its magnitude.
template <class Real>
TRACKBED_HD TRACKBED_LANES Vector3<Real> turn_into_plane(const Vector3<Real>& force, const Vector3<Real>& normal) {
  const Real along = dot(force, normal);
  return magnitude_kept(along * along, norm2(force)) * (force - along * normal);
}

/// Share lambda in [0, 1] of `dashpot` that keeps |spring + lambda dashpot| <= limit, given |spring| <= limit.
template <class Real>
TRACKBED_HD TRACKBED_LANES Real dashpot_share(const Vector3<Real>& spring, const Vector3<Real>& dashpot, Real limit) {
  const auto beyond = norm2(spring + dashpot) > limit * limit;
  const Real one = all<Real>(1);
  const Real a = norm2(dashpot), b = dot(spring, dashpot);
  const Real room = larger(limit * limit - norm2(spring), Real{});
  const Real root = square_root(b * b + a * room);
  // The form without cancellation. A spring on the cone with a dashpot pushing outwards: room = 0, share = 0.
  const auto outwards = b > Real{};
  const Real divisor = choose(outwards, b + root, a);
  const Real share = choose(outwards, room, root - b) / choose(divisor > Real{}, divisor, one);
  return choose(beyond, smaller(share, one), one);
}

/// Adds the tangential force and the normal one to `result`. `friction` is mu of every lane.
template <bool Ledger, class Real>
TRACKBED_HD TRACKBED_LANES Reaction<Real> sheared(const NormalForce<Real>& normal, Real friction, double damping_share,
                                                  const Touch<Real>& touch, const Interval& time, Real* history) {
  const auto touching = touch.overlap > all<Real>(0);
  const Vector3<Real>& n = touch.normal;
  const Real k_t = normal.shear_stiffness;
  const Vector3<Real> velocity = touch.velocity - normal.separation * n;

  const Vector3<Real> kept{history[0], history[1], history[2]};
  const Real last_k_t = history[3];
  const auto unloads = k_t < last_k_t;
  const Real rescale = choose(unloads, k_t, all<Real>(1)) / choose(unloads, last_k_t, all<Real>(1));
  const Vector3<Real> last = rescale * turn_into_plane(kept, n);
  const Vector3<Real> trial = last - (k_t * all<Real>(time.before)) * velocity;

  const Real force = choose(touching, normal.force, Real{});
  const Real limit = friction * force;
  const Real c_t = all<Real>(damping_share) * normal.damping;
  const Vector3<Real> dashpot = -c_t * velocity;
  Vector3<Real> spring = trial;
  Real share = all<Real>(1);
  const Real squared = norm2(trial), cone = limit * limit;
  const auto slips = squared > cone;
  if (any(either(slips, norm2(trial + dashpot) > cone))) {
    spring = choose(slips, limit / square_root(choose(slips, squared, all<Real>(1))), all<Real>(1)) * trial;
    share = dashpot_share(spring, dashpot, limit);
  }

  Reaction<Real> result;
  result.normal_force = force;
  result.force = choose(touching, force * n + spring + share * dashpot, Vector3<Real>{});
  const Vector3<Real> ahead = spring - (k_t * all<Real>(time.ahead)) * velocity;
  history[0] = choose(touching, ahead.x, Real{});
  history[1] = choose(touching, ahead.y, Real{});
  history[2] = choose(touching, ahead.z, Real{});
  history[3] = choose(touching, k_t, Real{});
  if constexpr (Ledger) {
    const Real step = all<Real>(time.before + time.ahead);
    const auto springs = k_t > Real{};  // a law may have none
    const Real stored = choose(springs, norm2(spring) / choose(springs, all<Real>(2) * k_t, all<Real>(1)), Real{});
    result.elastic_normal = choose(touching, normal.stored, Real{});
    result.elastic_shear = stored;
    const Real taken_in = -dot(spring, velocity) * step;
    result.loss_friction = history[4] - stored + choose(touching, taken_in, Real{});
    result.loss_damping = choose(touching, step * (normal.lost_power + share * c_t * norm2(velocity)), Real{});
    history[4] = stored;
  }
  return result;
}

}  // namespace dem::kernels
