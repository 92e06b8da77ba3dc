#pragma once
// Three-vectors shared by host and device code. No allocation, no exceptions. Vec3 is the plain one; Vector3<Real> also
// takes a float or a SIMD pack (dem/kernels/lanes.hpp), so that a kernel is written once.
#include <cmath>
#include <type_traits>

#if defined(__CUDACC__)
#define TRACKBED_HD __host__ __device__
#else
#define TRACKBED_HD
#endif

namespace base {

template <class Real>
struct Vector3 {
  Real x{}, y{}, z{};
  TRACKBED_HD Real& operator[](int i) { return i == 0 ? x : (i == 1 ? y : z); }
  TRACKBED_HD Real operator[](int i) const { return i == 0 ? x : (i == 1 ? y : z); }
  TRACKBED_HD Vector3& operator+=(const Vector3& o) {
    x += o.x;
    y += o.y;
    z += o.z;
    return *this;
  }
  TRACKBED_HD Vector3& operator-=(const Vector3& o) {
    x -= o.x;
    y -= o.y;
    z -= o.z;
    return *this;
  }
  TRACKBED_HD Vector3& operator*=(Real s) {
    x *= s;
    y *= s;
    z *= s;
    return *this;
  }
};
using Vec3 = Vector3<double>;

/// The scalar or second vector of an operation: what it is follows from the first vector.
template <class Real>
using Scalar = std::type_identity_t<Real>;
template <class Real>
using Other = std::type_identity_t<Vector3<Real>>;

template <class Real>
TRACKBED_HD inline Vector3<Real> operator+(Vector3<Real> a, const Other<Real>& b) {
  return a += b;
}
template <class Real>
TRACKBED_HD inline Vector3<Real> operator-(Vector3<Real> a, const Other<Real>& b) {
  return a -= b;
}
template <class Real>
TRACKBED_HD inline Vector3<Real> operator-(const Vector3<Real>& a) {
  return {-a.x, -a.y, -a.z};
}
template <class Real>
TRACKBED_HD inline Vector3<Real> operator*(Vector3<Real> a, Scalar<Real> s) {
  return a *= s;
}
template <class Real>
TRACKBED_HD inline Vector3<Real> operator*(Scalar<Real> s, Vector3<Real> a) {
  return a *= s;
}
template <class Real>
TRACKBED_HD inline Real dot(const Vector3<Real>& a, const Other<Real>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class Real>
TRACKBED_HD inline Vector3<Real> cross(const Vector3<Real>& a, const Other<Real>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class Real>
TRACKBED_HD inline Real norm2(const Vector3<Real>& a) {
  return dot(a, a);
}
TRACKBED_HD inline double norm(const Vec3& a) { return std::sqrt(norm2(a)); }

}  // namespace base
