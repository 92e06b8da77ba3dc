#pragma once
// The six motions of a rigid body, and which of them a body's supports leave free: a static system with such a motion
// (a mechanism) is singular, a free vibration has it at 0 Hz.
//   u(x) = t + w x (x - c);  a motion is free when u has no component that a support holds, at no node
// It is looked for part by part (a mesh may fall into parts that share no node) as the null space of
// G = sum over held components of r r^T, r the row of the six motions there, rotations scaled by the part's size.
// Nodes that share their unknowns (periodic.hpp) add the difference of their rows: it must be nought too.
#include <array>
#include <string>
#include <vector>

#include "fem/mesh.hpp"

namespace fem {

/// Motion k [m per m, m per rad] at a place relative to the centre: translations x, y, z, rotations about x, y, z.
Vec3 rigid_motion(int k, const Vec3& from_centre);

struct Mechanism {
  int part = 0;            // number of the part, from its smallest node upwards
  Vec3 translation, spin;  // u = translation + spin x (x - centre)
  Vec3 centre;             // [m]
  double size = 1;         // [m] of the part: farthest node from the centre
  Vec3 at(const Vec3& place) const { return translation + base::cross(spin, place - centre); }
};

struct Mechanisms {
  std::vector<int> part_of_node;
  std::vector<Mechanism> free;  // independent of each other
};

/// `held`: per node, the components that supports hold.
Mechanisms find_mechanisms(const Mesh&, const std::vector<std::array<bool, 3>>& held);

/// "translation along y, rotation about x through (0, 0, 0.1) m": what the free motions of the part are, in words.
std::string describe(const Mechanisms&, int part);

}  // namespace fem
