#pragma once
// What decides on the backend itself whether a step may be done. A window of steps is queued at once; every kernel of a
// step first looks here. Where the lists have become stale, or a pass has given up, the rest of what is queued does
// nothing, and the host, which looks once, makes new lists or stops the run, with everything as it was then.
//
// Order of one step: BeginStep, one thread; grains and nodes of walls move (`moved`); contacts and walls (`trouble`);
// walls that are bodies take their forces. Stale lists are known after the motion, trouble after the forces.
#include "dem/core/queue.hpp"
#include "dem/core/rows.hpp"

namespace dem::TRACKBED_DEM_SYSTEM {

struct Control {
  // of the window and the lists, from the host
  int steps = 0;
  double dt = 0;           // [s]
  Vec3 gravity;            // [m/s2]
  double tight = 0;        // [m] twice what a grain may move
  double skin = 0;         // [m] what grains and walls together may move
  int walls = 0;           // there are walls that grains may meet
  double still_shift = 0;  // [m] wall_shift where no wall moves
  // of the steps
  int step = 0;           // begun so far
  int halts = 0;          // this step is not done
  NumberBits moved = 0;   // [m2] largest square that a grain has moved since the lists were made; infinite: not finite
  double wall_shift = 0;  // [m] bound of what walls have moved since then
  int trouble = 0;        // Trouble: all that write it write the same

  TRACKBED_HD bool finite() const { return number_of(moved) < HUGE_VAL; }
  TRACKBED_HD bool lists_are_stale() const {
    const double way = std::sqrt(number_of(moved));
    return !(2 * way <= tight) || (walls && way + wall_shift > skin);
  }
  TRACKBED_HD bool stays() const { return halts || lists_are_stale(); }
  TRACKBED_HD bool ends_here() const { return stays() || trouble; }
  /// Of the window's way, when this step is done.
  TRACKBED_HD double share() const { return static_cast<double>(step) / steps; }
};

/// A pass that is part of a step after its motion; where it notes sums down, for Queue::launch_groups().
template <class Functor>
struct UnlessStale {
  const Control* control;
  Functor functor;
  TRACKBED_HD void operator()(int index) const {
    if (!control->stays()) functor(index);
  }
  TRACKBED_HD bool idle() const { return control->stays(); }
  template <int N>
  TRACKBED_HD void operator()(int index, Sums<N>& sums) const {
    functor(index, sums);
  }
  template <int N>
  TRACKBED_HD void book(int group, const Sums<N>& sums) const {
    functor.book(group, sums);
  }
};
template <class Functor>
UnlessStale<Functor> unless_stale(const Control* control, const Functor& functor) {
  return {control, functor};
}

}  // namespace dem::TRACKBED_DEM_SYSTEM
