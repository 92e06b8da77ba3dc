#pragma once
// Rotation of a rigid body: unit quaternions, and three schemes that move {orientation, angular velocity} over one
// step.
//
// Model: Euler's equations in the body frame, whose axes are the principal axes of inertia,
//   I' domega'/dt + omega' x (I' omega') = T',    dq/dt = 1/2 omega q,    v = q v' q^-1   (v in space, v' in the body)
// Source: Irazabal Gonzalez 2017 (PhD thesis, UPC Barcelona), section 5.3.1, eqs. 5.22-5.55.
//   ZhaoVanWachem  eqs. 5.47-5.54: orientation by direct multiplication with a predicted mid-step velocity (Zhao and
//                  van Wachem 2013, doi:10.1007/s00707-013-0914-2); second order; the default
//   RungeKutta     eqs. 5.41-5.46: constant angular momentum within the step, mean of four velocities (Munjiza et al.
//                  2003, doi:10.1002/nme.552); fourth order in free flight
//   Direct         eqs. 3.34, 3.35, 5.40: forward Euler; first order, gains energy in every step; only to be compared
//   with
//
// When the torque is evaluated: once per step, with velocity Verlet (3.44-3.53). T(n) is the torque at the positions,
// orientations and contact velocities of instant n.
//   begin_step<Scheme>(T(n)):     half of T(n) dt is given to the angular momentum, then the body turns freely over dt;
//                                 orientation is now that of n+1, angular_velocity that of the mid-step momentum there
//   the caller finds T(n+1) from these
//   finish_step<Scheme>(T(n+1)):  half of T(n+1) dt is given; angular_velocity is that of instant n+1
// Symplectic Euler is begin_step with 2 T(n) and no finish_step. Direct spends all of T(n) in begin_step.
//
// Where we differ from the source:
// - the torque acts as two half impulses around a free flight, in space coordinates, so that the angular momentum
// changes
//   by exactly the torque's impulse and elastic contacts keep their energy. The source puts T(n) inside 5.48 and leaves
//   the instant of T in 5.54 open; 5.41 gives the whole impulse before the flight, which is first order.
// - 5.54a is printed with omega(n) in space on its right side: omega'(n) is meant.
// - RungeKutta: as printed, 5.44c averages velocities that belong to different orientations, and its rotation is of
//   second order only. Each velocity is carried back to the step's start (inverse of the exponential's differential,
//   Munthe-Kaas 1999, doi:10.1016/S0168-9274(98)00030-0), which makes it the fourth order that its name says.
//
// Validity: principal moments > 0; a turn per step well below one radian (a DEM step turns a grain by 1e-4).
#include "base/vec3.hpp"

namespace dem::kernels {
using base::Vec3;

/// Unit quaternion q = [w, (x, y, z)]; turns body coordinates into space coordinates.
struct Quaternion {
  double w = 1, x = 0, y = 0, z = 0;
};

/// The turn b followed by the turn a (5.34).
TRACKBED_HD inline Quaternion operator*(const Quaternion& a, const Quaternion& b) {
  return {a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + b.w * a.x + a.y * b.z - a.z * b.y,
          a.w * b.y + b.w * a.y + a.z * b.x - a.x * b.z, a.w * b.z + b.w * a.z + a.x * b.y - a.y * b.x};
}

TRACKBED_HD inline Quaternion conjugate(const Quaternion& q) { return {q.w, -q.x, -q.y, -q.z}; }

/// q / |q|; the turn that does nothing where q is zero.
TRACKBED_HD inline Quaternion normalised(const Quaternion& q) {
  const double squared = q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z;
  if (!(squared > 0)) return {};
  const double scale = 1.0 / std::sqrt(squared);
  return {scale * q.w, scale * q.x, scale * q.y, scale * q.z};
}

/// q v q^-1 (5.35, 5.36): body coordinates to space coordinates.
TRACKBED_HD inline Vec3 to_space(const Quaternion& q, const Vec3& v) {
  const Vec3 axis{q.x, q.y, q.z};
  const Vec3 t = 2.0 * cross(axis, v);
  return v + q.w * t + cross(axis, t);
}
/// q^-1 v q: space coordinates to body coordinates.
TRACKBED_HD inline Vec3 to_body(const Quaternion& q, const Vec3& v) { return to_space(conjugate(q), v); }

/// The turn by the angle |turn| [rad] about the direction of `turn` (5.39). Below 0.2 rad by the series of cos and
/// sin(h)/h, exact to rounding there: no trigonometry in a DEM step and nothing divided by a zero angle.
TRACKBED_HD inline Quaternion turn_by(const Vec3& turn) {
  const double h2 = 0.25 * norm2(turn);  // half angle squared
  double cosine, half_sinc;
  if (h2 < 0.01) {
    cosine = 1 - h2 / 2 * (1 - h2 / 12 * (1 - h2 / 30 * (1 - h2 / 56 * (1 - h2 / 90))));
    half_sinc = 0.5 - h2 / 12 * (1 - h2 / 20 * (1 - h2 / 42 * (1 - h2 / 72 * (1 - h2 / 110))));
  } else {
    const double h = std::sqrt(h2);
    cosine = std::cos(h);
    half_sinc = 0.5 * std::sin(h) / h;
  }
  return {cosine, half_sinc * turn.x, half_sinc * turn.y, half_sinc * turn.z};
}

/// Component by component, in the body frame: I' omega' and I'^-1 L'.
TRACKBED_HD inline Vec3 times(const Vec3& a, const Vec3& b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
TRACKBED_HD inline Vec3 over(const Vec3& a, const Vec3& b) { return {a.x / b.x, a.y / b.y, a.z / b.z}; }

struct RigidRotation {
  Quaternion orientation;   // body to space
  Vec3 angular_velocity{};  // [rad/s] in space coordinates
};

/// `inertia` here and below: principal moments [kg m2] > 0 in the body frame.
TRACKBED_HD inline Vec3 angular_momentum(const RigidRotation& r, const Vec3& inertia) {
  return to_space(r.orientation, times(inertia, to_body(r.orientation, r.angular_velocity)));
}
TRACKBED_HD inline double rotational_energy(const RigidRotation& r, const Vec3& inertia) {
  const Vec3 omega = to_body(r.orientation, r.angular_velocity);
  return 0.5 * dot(omega, times(inertia, omega));
}
/// omega that belongs to an angular momentum at an orientation (5.43), space coordinates.
TRACKBED_HD inline Vec3 velocity_of(const Vec3& momentum, const Quaternion& q, const Vec3& inertia) {
  return to_space(q, over(to_body(q, momentum), inertia));
}
/// domega'/dt (5.49), body coordinates.
TRACKBED_HD inline Vec3 body_acceleration(const Vec3& omega, const Vec3& torque, const Vec3& inertia) {
  return over(torque - cross(omega, times(inertia, omega)), inertia);
}
/// Gives the body an angular impulse [N m s], in space coordinates.
TRACKBED_HD inline void kick(RigidRotation& r, const Vec3& inertia, const Vec3& impulse) {
  r.angular_velocity += velocity_of(impulse, r.orientation, inertia);
}

/// A scheme is begin_step() and finish_step(); these two share them around a free flight over dt.
template <class Flight>
struct KickedFlight {
  static constexpr bool halves = true;  // begin_step() gives half of the torque's impulse
  TRACKBED_HD static void begin_step(RigidRotation& r, const Vec3& inertia, const Vec3& torque, double dt) {
    kick(r, inertia, (0.5 * dt) * torque);
    Flight::fly(r, inertia, dt);
  }
  TRACKBED_HD static void finish_step(RigidRotation& r, const Vec3& inertia, const Vec3& torque, double dt) {
    kick(r, inertia, (0.5 * dt) * torque);
  }
};

struct ZhaoVanWachem : KickedFlight<ZhaoVanWachem> {
  TRACKBED_HD static void fly(RigidRotation& r, const Vec3& inertia, double dt) {
    const Quaternion q = r.orientation;
    const Vec3 omega = to_body(q, r.angular_velocity);                         // 5.47a
    const Vec3 acceleration = body_acceleration(omega, {}, inertia);           // 5.49
    const Vec3 quarter = omega + (0.25 * dt) * acceleration;                   // 5.48a
    const Vec3 half = omega + (0.5 * dt) * acceleration;                       // 5.48b
    const Quaternion middle = turn_by((0.5 * dt) * to_space(q, quarter)) * q;  // 5.50, 5.51
    r.orientation = normalised(turn_by(dt * to_space(middle, half)) * q);      // 5.52, 5.53
    const Vec3 end = omega + dt * body_acceleration(half, {}, inertia);        // 5.54a
    r.angular_velocity = to_space(r.orientation, end);                         // 5.54b
  }
};

struct RungeKutta : KickedFlight<RungeKutta> {
  TRACKBED_HD static void fly(RigidRotation& r, const Vec3& inertia, double dt) {
    const Quaternion q = r.orientation;
    const Vec3 momentum = angular_momentum(r, inertia);
    const Vec3 k1 = r.angular_velocity;                                                     // 5.44a
    const Vec3 k2 = carried_back(0.5 * dt * k1, momentum, q, inertia);                      // 5.44b, 5.45a
    const Vec3 k3 = carried_back(0.5 * dt * k2, momentum, q, inertia);                      // 5.45b
    const Vec3 k4 = carried_back(dt * k3, momentum, q, inertia);                            // 5.45c
    r.orientation = normalised(turn_by((dt / 6.0) * (k1 + 2.0 * k2 + 2.0 * k3 + k4)) * q);  // 5.44c, 5.46a
    r.angular_velocity = velocity_of(momentum, r.orientation, inertia);                     // 5.46b
  }
  /// omega after the turn u, carried back to the step's start: omega - u x omega / 2 + u x (u x omega) / 12.
  TRACKBED_HD static Vec3 carried_back(const Vec3& u, const Vec3& momentum, const Quaternion& q, const Vec3& inertia) {
    const Vec3 omega = velocity_of(momentum, turn_by(u) * q, inertia);
    const Vec3 turned = cross(u, omega);
    return omega - 0.5 * turned + (1.0 / 12.0) * cross(u, turned);
  }
};

struct Direct {
  static constexpr bool halves = false;
  TRACKBED_HD static void begin_step(RigidRotation& r, const Vec3& inertia, const Vec3& torque, double dt) {
    const Quaternion q = r.orientation;
    const Vec3 omega = to_body(q, r.angular_velocity);
    const Vec3 end = omega + dt * body_acceleration(omega, to_body(q, torque), inertia);  // 3.34, 5.40
    r.orientation = normalised(turn_by(dt * r.angular_velocity) * q);                     // 3.35
    r.angular_velocity = to_space(r.orientation, end);
  }
  TRACKBED_HD static void finish_step(RigidRotation&, const Vec3&, const Vec3&, double) {}
};

enum class RotationScheme { quaternion, runge_kutta, direct };

/// Calls use(Scheme{}) with the type that the name stands for: the choice is made once, outside the loop.
template <class Use>
decltype(auto) with_rotation_scheme(RotationScheme scheme, Use&& use) {
  switch (scheme) {
    case RotationScheme::runge_kutta:
      return use(RungeKutta{});
    case RotationScheme::direct:
      return use(Direct{});
    case RotationScheme::quaternion:
      break;
  }
  return use(ZhaoVanWachem{});
}

}  // namespace dem::kernels
