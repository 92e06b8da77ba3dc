#pragma once
// Velocity Verlet (Irazabal2017 3.44-3.53), first half and the moving walls.
//   v_half = v + dt/2 a,  x += dt v_half      (rotation likewise, without an orientation: spheres)
#include "dem/core/rows.hpp"

namespace dem::TRACKBED_DEM_SYSTEM {

/// Also returns the squared displacement since the neighbour list was built, infinite when the state is not finite.
struct FirstHalf {
  Place* place;
  Translation* translation;
  Rotation* rotation;  // may be null
  const Vec3* listed;  // positions at which the list was built
  double dt;
  TRACKBED_HD double operator()(int g) const {
    Translation& t = translation[g];
    t.velocity += (0.5 * dt) * t.acceleration;
    place[g].position += dt * t.velocity;
    const double squared = norm2(place[g].position - listed[g]);
    bool finite = squared < 1e100;
    if (rotation) {
      Rotation& r = rotation[g];
      r.velocity += (0.5 * dt) * r.acceleration;
      finite = finite && norm2(r.velocity) < 1e200;
    }
    return finite ? squared : HUGE_VAL;
  }
};

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

}  // namespace dem::TRACKBED_DEM_SYSTEM
