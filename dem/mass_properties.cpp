#include "dem/mass_properties.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

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

/// Eigenvalues, falling, and their unit vectors.
struct Diagonal {
  std::array<double, 3> value;
  std::array<Vec3, 3> vector;
};

/// Cyclic Jacobi: each turn zeroes one element off the diagonal (Golub, Van Loan, Matrix Computations, 8.5), until none
/// matters. Three by three, symmetric: five rounds at most in practice.
Diagonal turn_to_diagonal(const SymmetricTensor& t) {
  double a[3][3] = {{t.xx, t.xy, t.xz}, {t.xy, t.yy, t.yz}, {t.xz, t.yz, t.zz}};
  double v[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};  // columns
  for (int round = 0; round < 50; ++round) {
    bool turned = false;
    for (const auto& [p, q] : {std::pair{0, 1}, std::pair{0, 2}, std::pair{1, 2}}) {
      const double off = a[p][q], gap = a[q][q] - a[p][p];
      if (std::fabs(a[p][p]) + std::fabs(off) == std::fabs(a[p][p]) &&
          std::fabs(a[q][q]) + std::fabs(off) == std::fabs(a[q][q]))
        continue;
      turned = true;
      const double ratio = gap / (2 * off);
      const double tangent = (ratio < 0 ? -1 : 1) / (std::fabs(ratio) + std::sqrt(1 + ratio * ratio));
      const double cosine = 1 / std::sqrt(1 + tangent * tangent), sine = tangent * cosine;
      const int r = 3 - p - q;  // the third
      a[p][p] -= tangent * off;
      a[q][q] += tangent * off;
      a[p][q] = a[q][p] = 0;
      const double rp = a[r][p], rq = a[r][q];
      a[r][p] = a[p][r] = cosine * rp - sine * rq;
      a[r][q] = a[q][r] = sine * rp + cosine * rq;
      for (auto& row : v) {
        const double vp = row[p], vq = row[q];
        row[p] = cosine * vp - sine * vq;
        row[q] = sine * vp + cosine * vq;
      }
    }
    if (!turned) break;
  }
  std::array<int, 3> order{0, 1, 2};
  std::stable_sort(order.begin(), order.end(), [&](int i, int j) { return a[i][i] > a[j][j]; });
  Diagonal e;
  for (std::size_t k = 0; k < 3; ++k) {
    const int i = order[k];
    e.value[k] = a[i][i];
    e.vector[k] = {v[0][i], v[1][i], v[2][i]};
  }
  return e;
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
  const Diagonal e = turn_to_diagonal(t);
  if (e.value[0] == e.value[2]) return {{e.value[0], e.value[0], e.value[0]}, {}};
  const Vec3 x = with_positive_largest(e.vector[2]), y = with_positive_largest(e.vector[1]);
  return {{e.value[2], e.value[1], e.value[0]}, quaternion_of({x, y, cross(x, y)})};
}

}  // namespace dem
