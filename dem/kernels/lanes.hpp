#pragma once
// Numbers that a kernel may be written for: double, float, or a pack of W of them side by side (SIMD), so that one law
// serves a GPU thread, a wall contact and W contacts at once. Packs are the vector extensions of GCC and Clang (nvcc's
// device code uses plain numbers only). A branch on a number becomes choose(): every lane goes the same way.
#include <cmath>
#include <cstdint>
#include <cstring>
#include <type_traits>

#include "base/vec3.hpp"

namespace dem::kernels {
using base::Vec3;
using base::Vector3;

// ---- plain numbers
TRACKBED_HD inline double choose(bool condition, double yes, double no) { return condition ? yes : no; }
TRACKBED_HD inline float choose(bool condition, float yes, float no) { return condition ? yes : no; }
TRACKBED_HD inline double square_root(double x) { return std::sqrt(x); }
TRACKBED_HD inline float square_root(float x) { return std::sqrt(x); }
TRACKBED_HD inline double power(double x, double exponent) { return std::pow(x, exponent); }
TRACKBED_HD inline float power(float x, float exponent) { return std::pow(x, exponent); }
TRACKBED_HD inline bool both(bool a, bool b) { return a && b; }
TRACKBED_HD inline bool either(bool a, bool b) { return a || b; }
TRACKBED_HD inline bool any(bool condition) { return condition; }

/// The plain number that a pack consists of, and how many.
template <class Real>
struct LanesOf {
  using Number = Real;
  static constexpr int width = 1;
};

#if !defined(__CUDACC__)
// ---- packs
template <class Number, int W>
struct PackOf {
  typedef Number type __attribute__((vector_size(sizeof(Number) * W)));
};
template <class Number>
struct PackOf<Number, 1> {
  typedef Number type;
};
template <class Number, int W>
using Pack = typename PackOf<Number, W>::type;

template <>
struct LanesOf<Pack<double, 2>> {
  using Number = double;
  static constexpr int width = 2;
};
template <>
struct LanesOf<Pack<double, 4>> {
  using Number = double;
  static constexpr int width = 4;
};
template <>
struct LanesOf<Pack<float, 4>> {
  using Number = float;
  static constexpr int width = 4;
};
template <>
struct LanesOf<Pack<float, 8>> {
  using Number = float;
  static constexpr int width = 8;
};

template <class Real>
concept IsPack = (LanesOf<Real>::width > 1);

#define TRACKBED_LANES inline __attribute__((always_inline))
template <class Mask, IsPack Real>
TRACKBED_LANES Real choose(Mask condition, Real yes, Real no) {
  return condition ? yes : no;
}
template <IsPack Real>
TRACKBED_LANES Real square_root(Real x) {
#if defined(__SSE2__)
  if constexpr (std::is_same_v<Real, Pack<double, 2>>) return __builtin_ia32_sqrtpd(x);
#endif
#if defined(__AVX2__)
  if constexpr (std::is_same_v<Real, Pack<double, 4>>) return __builtin_ia32_sqrtpd256(x);
  if constexpr (std::is_same_v<Real, Pack<float, 8>>) return __builtin_ia32_sqrtps256(x);
#endif
  Real root{};
  for (int k = 0; k < LanesOf<Real>::width; ++k) root[k] = std::sqrt(x[k]);
  return root;
}
template <IsPack Real>
TRACKBED_LANES Real power(Real x, std::type_identity_t<Real> exponent) {
  Real result{};
  for (int k = 0; k < LanesOf<Real>::width; ++k) result[k] = std::pow(x[k], exponent[k]);
  return result;
}
template <class Mask>
requires(!std::is_same_v<Mask, bool>) TRACKBED_LANES Mask both(Mask a, Mask b) { return a & b; }
template <class Mask>
requires(!std::is_same_v<Mask, bool>) TRACKBED_LANES Mask either(Mask a, Mask b) { return a | b; }
template <class Mask>
requires(!std::is_same_v<Mask, bool>) TRACKBED_LANES bool any(Mask mask) {
#if defined(__AVX2__)
  typedef long long Bits __attribute__((vector_size(32)));
  if constexpr (sizeof(Mask) == 32)
    return !__builtin_ia32_ptestz256(reinterpret_cast<Bits>(mask), reinterpret_cast<Bits>(mask));
#endif
#if defined(__SSE2__)
  typedef char Bytes __attribute__((vector_size(16)));
  if constexpr (sizeof(Mask) == 16) return __builtin_ia32_pmovmskb128(reinterpret_cast<Bytes>(mask)) != 0;
#endif
  std::int64_t parts[sizeof(Mask) / sizeof(std::int64_t)], all = 0;
  std::memcpy(parts, &mask, sizeof mask);
  for (std::int64_t part : parts) all |= part;
  return all != 0;
}
#else
#define TRACKBED_LANES inline
#endif

/// The same number in every lane. (Minus nothing, not nothing plus: compilers may not leave the sum away, for -0.)
template <class Real>
TRACKBED_HD TRACKBED_LANES Real all(double value) {
  return static_cast<typename LanesOf<Real>::Number>(value) - Real{};
}
template <class Real>
TRACKBED_HD TRACKBED_LANES Real larger(Real a, std::type_identity_t<Real> b) {
  return choose(a > b, a, b);
}
template <class Real>
TRACKBED_HD TRACKBED_LANES Real smaller(Real a, std::type_identity_t<Real> b) {
  return choose(a < b, a, b);
}
template <class Real, class Mask>
TRACKBED_HD TRACKBED_LANES Vector3<Real> choose(Mask condition, const Vector3<Real>& yes, const Vector3<Real>& no) {
  return {choose(condition, yes.x, no.x), choose(condition, yes.y, no.y), choose(condition, yes.z, no.z)};
}

}  // namespace dem::kernels
