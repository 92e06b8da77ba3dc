#pragma once
// How the nodes of walls move within a step.
#include "dem/core/rows.hpp"
#include "dem/kernels/rotation.hpp"

namespace dem::TRACKBED_DEM_SYSTEM {

/// Node positions, velocities and displacement of the step for a mesh on its way to a target: x = from + s (to - from)
/// + s (1 - s) bow over the share s of the way. On a parabola bow = T v - (to - from), v the velocity at the start and
/// T the time of the way, and to_velocity = v - 2 bow / T: the velocity is the derivative of x.
struct MoveToTarget {
  Vec3 *position, *velocity, *displacement;
  const Vec3 *from_position, *from_velocity, *to_position, *to_velocity;
  const Vec3* bow;  // [m] null: straight
  int first;
  double share, step_share;  // of the way: after this step, in this step
  TRACKBED_HD void operator()(int index) const {
    const int node = first + index;
    const Vec3 way = to_position[node] - from_position[node];
    position[node] = share < 1 ? from_position[node] + share * way : to_position[node];
    velocity[node] = from_velocity[node] + share * (to_velocity[node] - from_velocity[node]);
    displacement[node] = step_share * way;
    if (!bow) return;
    position[node] += share * (1 - share) * bow[node];
    displacement[node] += step_share * (1 - 2 * share + step_share) * bow[node];
  }
};

/// What a way to a target starts from.
struct StartWay {
  const Vec3 *position, *velocity;
  Vec3 *from_position, *from_velocity;
  int first;
  TRACKBED_HD void operator()(int index) const {
    from_position[first + index] = position[first + index];
    from_velocity[first + index] = velocity[first + index];
  }
};

/// Rigid translation; with velocity zero the wall stands still.
struct MoveRigidly {
  Vec3 *position, *velocity, *displacement;
  int first;
  Vec3 wall_velocity;
  double dt;
  TRACKBED_HD void operator()(int index) const {
    const int node = first + index;
    velocity[node] = wall_velocity;
    displacement[node] = dt * wall_velocity;
    position[node] += displacement[node];
  }
};

/// Nodes of a rigid body.
struct MoveBody {
  Vec3 *position, *velocity, *displacement;
  const Vec3* offset;  // from the centre, in the body's axes
  int first;
  Vec3 centre, centre_velocity, angular_velocity;
  kernels::Quaternion orientation;
  TRACKBED_HD void operator()(int index) const {
    const int node = first + index;
    const Vec3 arm = to_space(orientation, offset[node]), now = centre + arm;
    displacement[node] = now - position[node];
    position[node] = now;
    velocity[node] = centre_velocity + cross(angular_velocity, arm);
  }
};

}  // namespace dem::TRACKBED_DEM_SYSTEM
