#pragma once
// A wall as a rigid body under velocity Verlet, one step in two calls (Irazabal2017 3.44-3.53; rotation as that of
// clumps, kernels/rotation.hpp). Directions in which it is not free are driven: their velocity is given, and the drive
// does what work that takes.
#include "dem/core/backend.hpp"
#include "dem/dem.hpp"

namespace dem::TRACKBED_DEM_SYSTEM {

/// Between two calls of advance() the velocities are those of the instant, within one those of the half step.
struct MovingBody {
  WallBody is;
  bool moves[3] = {}, turns[3] = {};  // of `is`, as device code reads them
  WallBodyState state;
  Vec3 force, torque;  // [N], [N m] load
  double reach = 0;    // [m] of the farthest node from the centre
  double work_loads = 0, work_gravity = 0, work_drive = 0, loss_damping = 0;  // [J] since the last flush

  MovingBody() = default;
  explicit MovingBody(const WallBody& body) : is(body) {
    std::copy_n(is.moves.data(), 3, moves);
    std::copy_n(is.turns.data(), 3, turns);
    state.centre = is.centre;
  }

  /// Where it is not free.
  void drive(const Vec3& velocity) {
    const double before = norm2(state.velocity);
    for (int d = 0; d < 3; ++d)
      if (!moves[d]) state.velocity[d] = velocity[d];
    work_drive += 0.5 * is.mass * (norm2(state.velocity) - before);
  }

  /// First half: the place at the step's end. Returns the velocities that contacts see there.
  TRACKBED_HD WallBodyState begin_step(double dt, const Vec3& gravity) {
    const double half = 0.5 * dt;
    const Vec3 all = pull(gravity);
    const Vec3 acceleration = free_part(1 / is.mass * all - is.damping * state.velocity);
    work_drive -= half * dot(all, driven_part(state.velocity));
    state.velocity += half * acceleration;
    state.centre += dt * state.velocity;
    WallBodyState seen = state;
    seen.velocity += half * acceleration;
    if (turns_at_all()) {
      const Vec3 damping = is.damping * kernels::angular_momentum(turning(), moments());
      const Vec3 twist = masked(state.contact_torque + torque - damping, turns);
      auto now = turning();
      kernels::ZhaoVanWachem::begin_step(now, moments(), twist, dt);
      state.orientation = seen.orientation = now.orientation;
      state.angular_velocity = masked(now.angular_velocity, turns);
      kernels::ZhaoVanWachem::finish_step(now, moments(), twist, dt);
      seen.angular_velocity = masked(now.angular_velocity, turns);
    }
    work_loads += dt * (dot(force, state.velocity) + dot(torque, state.angular_velocity));
    if (is.weighs) work_gravity += dt * is.mass * dot(gravity, state.velocity);
    return seen;
  }

  /// Second half, with the contact force and torque of the new instant. The damping is implicit, as that of grains is.
  TRACKBED_HD void finish_step(double dt, const Vec3& gravity) {
    const double half = 0.5 * dt, hold = 1 / (1 + is.damping * half);
    const Vec3 all = pull(gravity), driven = driven_part(state.velocity);
    state.velocity = driven + hold * free_part(state.velocity + half / is.mass * all);
    work_drive -= half * dot(all, driven);
    loss_damping += dt * is.damping * is.mass * norm2(free_part(state.velocity));
    if (!turns_at_all()) return;
    auto now = turning();
    kernels::ZhaoVanWachem::finish_step(now, moments(), masked(state.contact_torque + torque, turns), dt);
    state.angular_velocity = hold * masked(now.angular_velocity, turns);
    loss_damping += 2 * dt * is.damping * kernels::rotational_energy(turning(), moments());
  }

  double kinetic() const {
    return 0.5 * is.mass * norm2(state.velocity) +
           (turns_at_all() ? kernels::rotational_energy(turning(), moments()) : 0);
  }
  /// Smallest moment of inertia [kg m2] about a free axis; 0: it does not turn.
  double least_moment() const {
    double least = 0;
    for (int d = 0; d < 3; ++d)
      if (turns[d] && (least == 0 || is.inertia[d] < least)) least = is.inertia[d];
    return least;
  }
  Vec3 displacement() const { return state.centre - is.centre; }
  /// Bound of the speed of its points [m/s].
  TRACKBED_HD double fastest() const { return norm(state.velocity) + reach * norm(state.angular_velocity); }

 private:
  /// All forces but the damping [N].
  TRACKBED_HD Vec3 pull(const Vec3& gravity) const {
    return state.contact_force + force + (is.weighs ? is.mass * gravity : Vec3{});
  }
  TRACKBED_HD kernels::RigidRotation turning() const { return {state.orientation, state.angular_velocity}; }
  /// Moments of inertia, 1 where nothing turns.
  TRACKBED_HD Vec3 moments() const {
    return {turns[0] ? is.inertia.x : 1, turns[1] ? is.inertia.y : 1, turns[2] ? is.inertia.z : 1};
  }
  TRACKBED_HD bool turns_at_all() const { return turns[0] || turns[1] || turns[2]; }
  TRACKBED_HD Vec3 free_part(const Vec3& v) const { return masked(v, moves); }
  TRACKBED_HD Vec3 driven_part(const Vec3& v) const { return v - free_part(v); }
  TRACKBED_HD static Vec3 masked(const Vec3& v, const bool* kept) {
    return {kept[0] ? v.x : 0, kept[1] ? v.y : 0, kept[2] ? v.z : 0};
  }
};

}  // namespace dem::TRACKBED_DEM_SYSTEM
