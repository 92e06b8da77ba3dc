#pragma once
// The loop behind leap.hpp, compiled once per vector width; sweep_kernel.hpp says what that forbids.
#include "dem/kernels/lanes.hpp"
#include "dem/leap.hpp"
#include "dem/sweep_access.hpp"

namespace dem {
namespace leaping {

using kernels::Pack;

/// Four numbers: a vector and a number beside it.
template <int W>
struct Row {
  using Part = Pack<double, W>;
  static constexpr int parts = 4 / W;
  Part part[parts];

  TRACKBED_LANES static Row load(const double* from) {
    Row row;
    for (int k = 0; k < parts; ++k) row.part[k] = sweeping::load<Part>(from + k * W);
    return row;
  }
  TRACKBED_LANES static Row all(double number) {
    Row row;
    for (int k = 0; k < parts; ++k) row.part[k] = kernels::all<Part>(number);
    return row;
  }
  TRACKBED_LANES void store(double* to) const {
    for (int k = 0; k < parts; ++k) sweeping::store(to + k * W, part[k]);
  }
  TRACKBED_LANES double number() const { return part[parts - 1][W - 1]; }
  /// This vector with the other's number.
  TRACKBED_LANES Row beside(const Row& other) const {
    Row row = *this;
    if constexpr (W == 4)
      row.part[0] = __builtin_shufflevector(part[0], other.part[0], 0, 1, 2, 7);
    else
      row.part[1] = __builtin_shufflevector(part[1], other.part[1], 0, 3);
    return row;
  }
  /// The number in all places.
  TRACKBED_LANES Row spread() const {
    Row row;
    for (int k = 0; k < parts; ++k) {
      if constexpr (W == 4)
        row.part[k] = __builtin_shufflevector(part[0], part[0], 3, 3, 3, 3);
      else
        row.part[k] = __builtin_shufflevector(part[1], part[1], 1, 1);
    }
    return row;
  }
  TRACKBED_LANES double dot(const Row& other) const {
    Row product = *this * other;
    return product.part[0][0] + product.part[0][1] + product.part[2 / W][2 % W];
  }
  TRACKBED_LANES Row operator+(const Row& other) const {
    Row row;
    for (int k = 0; k < parts; ++k) row.part[k] = part[k] + other.part[k];
    return row;
  }
  TRACKBED_LANES Row operator-(const Row& other) const {
    Row row;
    for (int k = 0; k < parts; ++k) row.part[k] = part[k] - other.part[k];
    return row;
  }
  TRACKBED_LANES Row operator*(const Row& other) const {
    Row row;
    for (int k = 0; k < parts; ++k) row.part[k] = part[k] * other.part[k];
    return row;
  }
};

/// Brakes: bounded rolling friction (kernels/rolling.hpp) of grains whose contacts resist rolling.
template <int W, bool Turns, bool Brakes, bool Ledger, bool Ends, bool Begins>
double leap(const LeapInput& in, int begin, int end) {
  using R = Row<W>;
  constexpr int stride = Turns ? 8 : 4;
  const double half = in.end_share * in.ended;
  const R hold = R::all(1 / (1 + in.alpha * half)), at_end = R::all(half), alpha = R::all(in.alpha);
  const R kick = R::all(in.kick), seen = R::all(in.seen), dt = R::all(in.dt), nothing = R::all(0);
  const double down[4] = {in.gravity.x, in.gravity.y, in.gravity.z, 0};
  R gravity;
  for (int k = 0; k < 4; ++k) gravity.part[k / W][k % W] = down[k];
  double most = 0;
  bool finite = true;
  for (int g = begin; g < end; ++g) {
    const long at = static_cast<long>(stride) * g;
    R force = R::load(in.pull + at), torque = nothing;
    if constexpr (Turns) torque = R::load(in.pull + at + 4);
    R velocity = R::load(in.state + at), spin = nothing;
    const R inverse_mass = velocity.spread();
    const R translation = velocity;
    R rotation = nothing;
    if constexpr (Turns) rotation = spin = R::load(in.state + at + 4);
    if constexpr (Ends) {
      if (in.wall_slot && in.wall_slot[g] >= 0) {
        const double* wall = in.wall_sum + 8L * in.wall_slot[g];
        force = force + R::load(wall);
        if constexpr (Turns) torque = torque + R::load(wall + 4);
      }
      const double limit = force.number();
      const R free = inverse_mass * force + gravity;
      velocity = hold * (velocity + at_end * free);
      force = free - alpha * velocity;
      double lost_damping = 0, lost_rolling = 0;
      if constexpr (Ledger) lost_damping = in.alpha * in.ended / translation.number() * velocity.dot(velocity);
      if constexpr (Turns) {
        R braking = nothing;
        if constexpr (Brakes) {  // a grain at rest must stay so to the last bit
          const R stop = torque + R::all(1 / (rotation.number() * in.dt)) * spin;
          const double needed = stop.dot(stop);
          braking = R::all(needed > limit * limit ? -limit / __builtin_sqrt(needed) : -1) * stop;
          torque = torque + braking;
        }
        const R turn = rotation.spread() * torque;
        spin = hold * (spin + at_end * turn);
        torque = turn - alpha * spin;
        if constexpr (Ledger) {
          lost_damping += in.alpha * in.ended / rotation.number() * spin.dot(spin);
          if constexpr (Brakes) lost_rolling = -in.ended * braking.dot(spin);
        }
      }
      if constexpr (Ledger) {
        in.ledger[2L * g] += lost_rolling;
        in.ledger[2L * g + 1] += lost_damping;
      }
    }
    if constexpr (!Begins) {
      velocity.beside(translation).store(in.state + at);
      force.beside(nothing).store(in.pull + at);
      if constexpr (Turns) {
        spin.beside(rotation).store(in.state + at + 4);
        torque.beside(nothing).store(in.pull + at + 4);
      }
      continue;
    }
    velocity = velocity + kick * force;
    const R before = R::load(in.place + 4L * g);
    const R place = before + dt * velocity;
    place.beside(before).store(in.place + 4L * g);
    (velocity + seen * force).beside(R::load(in.motion + at)).store(in.motion + at);
    velocity.beside(translation).store(in.state + at);
    nothing.store(in.pull + at);
    if constexpr (Turns) {
      spin = spin + kick * torque;
      (spin + seen * torque).beside(R::load(in.motion + at + 4)).store(in.motion + at + 4);
      spin.beside(rotation).store(in.state + at + 4);
      nothing.store(in.pull + at + 4);
      finite &= spin.dot(spin) < 1e200;
    }
    const double* listed = in.listed + 3L * g;
    double way[3];
    for (int k = 0; k < 3; ++k) way[k] = place.part[k / W][k % W] - listed[k];
    const double squared = way[0] * way[0] + way[1] * way[1] + way[2] * way[2];
    finite &= squared < 1e100;
    most = squared > most ? squared : most;
  }
  return finite ? most : __builtin_huge_val();
}

template <int W, bool Turns, bool Brakes, bool Ledger>
Leap pick(const LeapChoice& c) {
  if (!c.ends) return leap<W, Turns, Brakes, Ledger, false, true>;
  return c.begins ? leap<W, Turns, Brakes, Ledger, true, true> : leap<W, Turns, Brakes, Ledger, true, false>;
}
template <int W>
Leap pick(const LeapChoice& c) {
  if (!c.turns) return c.ledger ? pick<W, false, false, true>(c) : pick<W, false, false, false>(c);
  if (c.brakes) return c.ledger ? pick<W, true, true, true>(c) : pick<W, true, true, false>(c);
  return c.ledger ? pick<W, true, false, true>(c) : pick<W, true, false, false>(c);
}

}  // namespace leaping

Leap portable_leap(const LeapChoice&);
Leap avx2_leap(const LeapChoice&);

}  // namespace dem
