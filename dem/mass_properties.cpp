#include "dem/mass_properties.hpp"

#include <vtkMath.h>

#include <array>
#include <cmath>

namespace dem {
namespace {

/// The turn whose matrix has these columns. Taken from its largest component, so that nothing is divided by zero.
kernels::Quaternion quaternion_of(const std::array<Vec3, 3>& axis) {
  const double xx = axis[0].x, yy = axis[1].y, zz = axis[2].z;
  kernels::Quaternion q;
  if (xx + yy + zz > 0) {
    q = {1 + xx + yy + zz, axis[1].z - axis[2].y, axis[2].x - axis[0].z, axis[0].y - axis[1].x};
  } else if (xx >= yy && xx >= zz) {
    q = {axis[1].z - axis[2].y, 1 + xx - yy - zz, axis[1].x + axis[0].y, axis[2].x + axis[0].z};
  } else if (yy >= zz) {
    q = {axis[2].x - axis[0].z, axis[1].x + axis[0].y, 1 - xx + yy - zz, axis[2].y + axis[1].z};
  } else {
    q = {axis[0].y - axis[1].x, axis[2].x + axis[0].z, axis[2].y + axis[1].z, 1 - xx - yy + zz};
  }
  return kernels::normalised(q);
}

Vec3 with_positive_largest(const Vec3& v) {
  double largest = v.x;
  if (std::fabs(v.y) > std::fabs(largest)) largest = v.y;
  if (std::fabs(v.z) > std::fabs(largest)) largest = v.z;
  return largest < 0 ? -v : v;
}

}  // namespace

MassProperties mass_properties(const VolumeMoments& m, const Vec3& origin) {
  const Vec3 c = (1.0 / m.volume) * m.first;
  const auto central = [&](double second, double a, double b) { return second / m.volume - a * b; };
  const double xx = central(m.second.xx, c.x, c.x), yy = central(m.second.yy, c.y, c.y);
  const double zz = central(m.second.zz, c.z, c.z);
  const SymmetricTensor inertia{yy + zz,
                                xx + zz,
                                xx + yy,
                                -central(m.second.xy, c.x, c.y),
                                -central(m.second.xz, c.x, c.z),
                                -central(m.second.yz, c.y, c.z)};
  return {m.volume, origin + c, inertia};
}

PrincipalAxes principal_axes(const SymmetricTensor& t) {
  double rows[3][3] = {{t.xx, t.xy, t.xz}, {t.xy, t.yy, t.yz}, {t.xz, t.yz, t.zz}};
  double vectors[3][3], moments[3];
  double *row_pointers[3] = {rows[0], rows[1], rows[2]}, *vector_pointers[3] = {vectors[0], vectors[1], vectors[2]};
  vtkMath::Jacobi(row_pointers, moments, vector_pointers);  // moments fall; vectors are columns
  if (moments[0] == moments[2]) return {{moments[0], moments[0], moments[0]}, {}};
  const auto column = [&](int i) { return with_positive_largest({vectors[0][i], vectors[1][i], vectors[2][i]}); };
  const Vec3 x = column(2), y = column(1);
  return {{moments[2], moments[1], moments[0]}, quaternion_of({x, y, cross(x, y)})};
}

}  // namespace dem
