#pragma once
// What the tests of contact laws share: two spheres, or a sphere and a plane, that nothing but one law acts on, moved
// by velocity Verlet. Contacts see the velocity of their instant but for the change of the acceleration within the
// step.
#include <array>
#include <cmath>
#include <numbers>

#include "dem/laws.hpp"

namespace dem_test {
using base::Vec3;
using namespace dem::kernels;

struct Body {
  double radius = 0, mass = 0;      // [m], [kg]
  Vec3 position, velocity, spin{};  // [m], [m/s], [rad/s]
  double inertia() const { return 0.4 * mass * radius * radius; }
  double kinetic() const { return 0.5 * mass * norm2(velocity) + 0.5 * inertia() * norm2(spin); }
};

inline double sphere_mass(double radius, double density) {
  return 4.0 / 3.0 * std::numbers::pi * radius * radius * radius * density;
}

/// Rotation by `angle` about a unit axis (Rodrigues).
inline Vec3 rotated(const Vec3& v, const Vec3& axis, double angle) {
  return std::cos(angle) * v + std::sin(angle) * cross(axis, v) + (1 - std::cos(angle)) * dot(axis, v) * axis;
}

/// Reaction of any law. Packs are passed by reference: their place in registers depends on the processor that the
/// compiler works for.
template <class Law, bool Ledger, class Real>
void press(const PairParameters& pair, const Touch<Real>& touch, const Interval& time, Real* history,
           Reaction<Real>& result) {
  result = Law::template press<Ledger>(pair, touch, time, history);
}

template <class Law>
struct Pair {
  PairParameters parameters;
  Body i, j;  // j without mass: the plane z = 0, and the arm of i is its radius
  std::array<double, Law::history + 1> history{};

  Reaction<double> reaction{};
  Vec3 torque_i{}, torque_j{};
  double loss_friction = 0, loss_damping = 0;  // [J] so far

  bool on_plane() const { return j.mass == 0; }
  double stored() const { return reaction.elastic_normal + reaction.elastic_shear; }
  double energy() const { return i.kinetic() + j.kinetic() + stored() + loss_friction + loss_damping; }

  /// The law at this instant, with the velocities that it sees.
  void meet(const Body& a, const Body& b, const Interval& time) {
    const Vec3 between = on_plane() ? Vec3{0, 0, a.position.z} : a.position - b.position;
    const double distance = norm(between);
    Touch<double> touch;
    touch.overlap = a.radius + b.radius - distance;
    touch.normal = (1 / distance) * between;
    touch.effective_radius = on_plane() ? a.radius : a.radius * b.radius / (a.radius + b.radius);
    touch.effective_mass = on_plane() ? a.mass : a.mass * b.mass / (a.mass + b.mass);
    const Vec3 arm_i = -(a.radius - (on_plane() ? 0 : 0.5 * touch.overlap)) * touch.normal;
    const Vec3 arm_j = (b.radius - 0.5 * touch.overlap) * touch.normal;
    touch.velocity = a.velocity + cross(a.spin, arm_i);
    if (!on_plane()) touch.velocity -= b.velocity + cross(b.spin, arm_j);
    reaction = Law::template press<true>(parameters, touch, time, history.data());
    torque_i = cross(arm_i, reaction.force);
    torque_j = -cross(arm_j, reaction.force);
    loss_friction += reaction.loss_friction;
    loss_damping += reaction.loss_damping;
  }

  void step(double dt) {
    const auto half = [dt](Body& body, const Vec3& force, const Vec3& torque) {
      if (body.mass == 0) return;
      body.velocity += (0.5 * dt / body.mass) * force;
      body.spin += (0.5 * dt / body.inertia()) * torque;
    };
    half(i, reaction.force, torque_i);
    half(j, -reaction.force, torque_j);
    i.position += dt * i.velocity;
    j.position += dt * j.velocity;
    Body seen_i = i, seen_j = j;
    half(seen_i, reaction.force, torque_i);
    half(seen_j, -reaction.force, torque_j);
    meet(seen_i, seen_j, {0.5 * dt, 0.5 * dt});
    half(i, reaction.force, torque_i);
    half(j, -reaction.force, torque_j);
  }

  double gap() const {
    return on_plane() ? i.position.z - i.radius : norm(i.position - j.position) - i.radius - j.radius;
  }

  bool approach() const {
    return on_plane() ? i.velocity.z < 0 : dot(i.velocity - j.velocity, i.position - j.position) < 0;
  }

  /// Steps until the two are apart again; calls each(*this) after every step.
  template <class Each>
  void collide(double dt, Each&& each) {
    do {
      step(dt);
      each(*this);
    } while (gap() < 0 || approach());
    step(dt);
  }
  void collide(double dt) {
    collide(dt, [](const Pair&) {});
  }
};

/// Duration of a Hertz impact, 2.94327 d_max / v [s], with d_max = (15 m* v^2 / (16 E* sqrt(R*)))^(2/5).
struct HertzImpact {
  double effective_young_modulus, effective_radius, effective_mass, speed;
  double overlap() const {
    return std::pow(15 * effective_mass * speed * speed / (16 * effective_young_modulus * std::sqrt(effective_radius)),
                    0.4);
  }
  double force() const {
    return 4.0 / 3.0 * effective_young_modulus * std::sqrt(effective_radius) * std::pow(overlap(), 1.5);
  }
  double duration() const { return 2.94327 * overlap() / speed; }
};

}  // namespace dem_test
