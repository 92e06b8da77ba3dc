#pragma once
// How the nodes of walls move within a step.
#include "dem/core/rows.hpp"
#include "dem/kernels/rotation.hpp"

namespace dem::TRACKBED_DEM_SYSTEM {

/// Node positions, velocities and displacement of the step for a mesh on its way to a target.
struct MoveToTarget {
  Vec3 *position, *velocity, *displacement;
  const Vec3 *from_position, *from_velocity, *to_position, *to_velocity;
  int first;
  double share, step_share;  // of the way: after this step, in this step
  TRACKBED_HD void operator()(int index) const {
    const int node = first + index;
    const Vec3 way = to_position[node] - from_position[node];
    position[node] = share < 1 ? from_position[node] + share * way : to_position[node];
    velocity[node] = from_velocity[node] + share * (to_velocity[node] - from_velocity[node]);
    displacement[node] = step_share * way;
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
