#pragma once
// Walls that move, as the backend moves them within a window of queued steps: what each step does to them, and to their
// nodes. The host has the same rows between windows.
#include "dem/core/control.hpp"
#include "dem/core/motion.hpp"
#include "dem/core/wall_body.hpp"

namespace dem::TRACKBED_DEM_SYSTEM {

enum class WallMotion { fixed, rigid, target, body };

/// How a wall moves, and how far it has come.
struct WallWay {
  int first_node = 0, nodes = 0;
  WallMotion motion = WallMotion::fixed;
  bool fresh_target = false;            // set since the last advance()
  Vec3 velocity{};                      // [m/s] of a rigid motion
  Vec3 rigid_shift{};                   // [m] since the last list build
  Vec3 moved{};                         // [m] by rigid motions so far
  MeshWay way = MeshWay::line;          // of the present target motion
  double shift_from = 0, shift_to = 0;  // [m] farthest that it has come since the list build, at the ends of the way
  double largest_bow = 0;               // [m] see MoveToTarget

  TRACKBED_HD void move_rigidly(double dt) {
    rigid_shift += dt * velocity;
    moved += dt * velocity;
  }
  /// Bound of the largest displacement since the list build. The nodes of a target motion move on straight lines, along
  /// which a distance is convex, or beside them by at most s (1 - s) bow.
  TRACKBED_HD double shift(double share) const {
    const bool target = motion == WallMotion::target;
    const double come = target && !fresh_target ? (1 - share) * shift_from + share * shift_to : shift_from;
    return come + share * (1 - share) * largest_bow + norm(rigid_shift);
  }
};

struct DrivenWall : WallWay {
  MovingBody body{};     // of WallMotion::body
  WallBodyState seen{};  // of the body, by contacts at the end of the present step
};

/// Rows of the walls' nodes.
struct WallNodes {
  const int* wall;  // of each node
  Vec3 *position, *velocity, *displacement;
  const Vec3 *from_position, *from_velocity, *to_position, *to_velocity;
  const Vec3* bow;
  const Vec3* body_offset;

  TRACKBED_HD void move(int node, const DrivenWall* walls, const Control& control) const {
    const DrivenWall& w = walls[wall[node]];
    if (w.motion == WallMotion::rigid) {
      MoveRigidly{position, velocity, displacement, 0, w.velocity, control.dt}(node);
    } else if (w.motion == WallMotion::target) {
      MoveToTarget{position,
                   velocity,
                   displacement,
                   from_position,
                   from_velocity,
                   to_position,
                   to_velocity,
                   w.way == MeshWay::parabola ? bow : nullptr,
                   0,
                   control.step < control.steps ? control.share() : 1.0,
                   1.0 / control.steps}(node);
    } else if (w.motion == WallMotion::body) {
      MoveBody{position,
               velocity,
               displacement,
               body_offset,
               0,
               w.seen.centre,
               w.seen.velocity,
               w.seen.angular_velocity,
               w.seen.orientation}(node);
    }
  }
};

/// One thread: counts the step, unless the last one has ended the run of steps, and starts the walls' step.
struct BeginStep {
  Control* control;
  DrivenWall* wall;
  int walls;  // 0: none moves
  TRACKBED_HD void operator()(int) const {
    Control& c = *control;
    c.halts = c.ends_here();
    if (c.halts) return;
    ++c.step;
    c.moved = 0;
    c.wall_shift = walls > 0 ? 0 : c.still_shift;
    for (int k = 0; k < walls; ++k) {
      DrivenWall& w = wall[k];
      if (w.motion == WallMotion::body) {
        w.seen = w.body.begin_step(c.dt, c.gravity);
        w.shift_from += c.dt * w.body.fastest();
      } else if (w.motion == WallMotion::rigid) {
        w.move_rigidly(c.dt);
      }
      c.wall_shift = std::fmax(c.wall_shift, w.shift(c.share()));
    }
  }
};

/// Grains and nodes of walls in one pass; returns the squared displacement of a grain since the lists were made.
template <class Leap>
struct MoveAll {
  const Control* control;
  Leap leap;
  int grains;
  WallNodes nodes;
  const DrivenWall* walls;
  TRACKBED_FLATTEN TRACKBED_HD double operator()(int index) const {
    if (control->halts) return 0;
    if (index < grains) return leap.pass(index, {.ends = control->step > 1, .ended = control->dt, .begins = true});
    nodes.move(index - grains, walls, *control);
    return 0;
  }
};

/// The second half of the last step of a window, or (ended = 0) the forces at the start of a run.
template <class Leap>
struct EndSteps {
  const Control* control;
  Leap leap;
  double ended;  // [s]
  TRACKBED_FLATTEN TRACKBED_HD void operator()(int g) const {
    if (!control->ends_here()) leap.pass(g, {.ends = true, .ended = ended, .begins = false});
  }
};

/// Force of the grains on a wall, and its torque about a point.
struct SumWallForce {
  const WallState* state;
  const int *candidate, *grain_of;  // of each candidate: facet, grain
  const Facet* facet;
  const Place* place;
  int wall;
  Vec3 about;
  TRACKBED_HD void operator()(int c, Sums<6>& s) const {
    const WallState& t = state[c];
    if (!(t.overlap > 0) || facet[candidate[c]].wall != wall) return;
    const Place& p = place[grain_of[c]];
    const Vec3 arm = p.position - (p.radius - t.overlap) * t.normal - about, torque = cross(arm, t.force);
    for (int k = 0; k < 3; ++k) {
      s.value[k] -= t.force[k];
      s.value[3 + k] -= torque[k];
    }
  }
};

/// Forces of the grains on each wall that is a body, and the second half of its step.
struct FinishWalls {
  const Control* control;
  SumWallForce sum;
  const int* number;  // of the walls that are bodies
  DrivenWall* wall;
  TRACKBED_HD bool skip(int) const { return control->ends_here(); }
  TRACKBED_HD void operator()(int k, int candidate, Sums<6>& sums) const {
    SumWallForce of_this = sum;
    of_this.wall = number[k];
    of_this.about = wall[number[k]].body.state.centre;
    of_this(candidate, sums);
  }
  TRACKBED_HD void finish(int k, const Sums<6>& sums) const {
    MovingBody& body = wall[number[k]].body;
    body.state.contact_force = {sums.value[0], sums.value[1], sums.value[2]};
    body.state.contact_torque = {sums.value[3], sums.value[4], sums.value[5]};
    body.finish_step(control->dt, control->gravity);
  }
};

}  // namespace dem::TRACKBED_DEM_SYSTEM
