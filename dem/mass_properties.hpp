#pragma once
// Volume, centroid and inertia of a body of uniform density, and its principal axes.
#include <array>

#include "base/vec3.hpp"
#include "dem/kernels/rotation.hpp"

namespace dem {
using base::Vec3;

/// Symmetric 3 x 3 tensor.
struct SymmetricTensor {
  double xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0;
};

/// Integrals over a body, from which the rest follows.
struct VolumeMoments {
  double volume = 0;       // [m3] integral of 1
  Vec3 first{};            // [m4] integral of x
  SymmetricTensor second;  // [m5] integral of x x
};

struct MassProperties {
  double volume = 0;        // [m3]
  Vec3 centroid{};          // [m]
  SymmetricTensor inertia;  // [m2] inertia tensor about the centroid / mass (Irazabal2017 5.12, 5.13: -integral of x y)
};
/// `origin`: the point [m] from which the moments were taken.
MassProperties mass_properties(const VolumeMoments&, const Vec3& origin);

struct PrincipalAxes {
  Vec3 inertia{};  // [m2] principal moments / mass, rising: x is the axis of least inertia, the long one
  kernels::Quaternion orientation;  // principal frame to the tensor's frame
};
/// Right-handed; each of the first two axes has its largest component positive. A multiple of unity keeps its frame.
PrincipalAxes principal_axes(const SymmetricTensor& inertia);

}  // namespace dem
