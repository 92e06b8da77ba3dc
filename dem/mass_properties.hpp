#pragma once
// Volume, centroid and inertia of a body of uniform density, and its principal axes.
#include "base/vec3.hpp"
#include "dem/kernels/rotation.hpp"

namespace dem {
using base::Vec3;

/// Symmetric 3 x 3 tensor.
struct SymmetricTensor {
  double xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0;
};

/// t += factor (a b + b a) / 2.
inline void add_product(SymmetricTensor& t, double factor, const Vec3& a, const Vec3& b) {
  t.xx += factor * a.x * b.x;
  t.yy += factor * a.y * b.y;
  t.zz += factor * a.z * b.z;
  t.xy += 0.5 * factor * (a.x * b.y + a.y * b.x);
  t.xz += 0.5 * factor * (a.x * b.z + a.z * b.x);
  t.yz += 0.5 * factor * (a.y * b.z + a.z * b.y);
}
/// t += factor other.
inline void add(SymmetricTensor& t, double factor, const SymmetricTensor& other) {
  t.xx += factor * other.xx;
  t.yy += factor * other.yy;
  t.zz += factor * other.zz;
  t.xy += factor * other.xy;
  t.xz += factor * other.xz;
  t.yz += factor * other.yz;
}

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
