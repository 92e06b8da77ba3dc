#pragma once
// Plain three-vector shared by host and device code. No allocation, no exceptions.
#include <cmath>

#if defined(__CUDACC__)
#define TRACKBED_HD __host__ __device__
#else
#define TRACKBED_HD
#endif

namespace base {

struct Vec3 {
  double x = 0, y = 0, z = 0;
  TRACKBED_HD double& operator[](int i) { return i == 0 ? x : (i == 1 ? y : z); }
  TRACKBED_HD double operator[](int i) const { return i == 0 ? x : (i == 1 ? y : z); }
  TRACKBED_HD Vec3& operator+=(const Vec3& o) {
    x += o.x;
    y += o.y;
    z += o.z;
    return *this;
  }
  TRACKBED_HD Vec3& operator-=(const Vec3& o) {
    x -= o.x;
    y -= o.y;
    z -= o.z;
    return *this;
  }
  TRACKBED_HD Vec3& operator*=(double s) {
    x *= s;
    y *= s;
    z *= s;
    return *this;
  }
};

TRACKBED_HD inline Vec3 operator+(Vec3 a, const Vec3& b) { return a += b; }
TRACKBED_HD inline Vec3 operator-(Vec3 a, const Vec3& b) { return a -= b; }
TRACKBED_HD inline Vec3 operator-(const Vec3& a) { return {-a.x, -a.y, -a.z}; }
TRACKBED_HD inline Vec3 operator*(Vec3 a, double s) { return a *= s; }
TRACKBED_HD inline Vec3 operator*(double s, Vec3 a) { return a *= s; }
TRACKBED_HD inline double dot(const Vec3& a, const Vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
TRACKBED_HD inline Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
TRACKBED_HD inline double norm2(const Vec3& a) { return dot(a, a); }
TRACKBED_HD inline double norm(const Vec3& a) { return std::sqrt(norm2(a)); }

}  // namespace base
