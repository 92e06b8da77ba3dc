#pragma once
// W doubles side by side: one number of W elements at once. The element and law kernels are written once for a type T
// that is either such a pack or a plain double. Vector extensions of GCC and Clang, because auto-vectorisation of the
// lane loops is not dependable.
#include <cstring>
#include <type_traits>

namespace fem {

template <int W>
struct PackOf {
  typedef double type __attribute__((vector_size(8 * W)));
};
template <>
struct PackOf<1> {
  typedef double type;
};
template <int W>
using Pack = typename PackOf<W>::type;

template <class T>
inline __attribute__((always_inline)) T load(const double* from) {
  T value;
  std::memcpy(&value, from, sizeof value);  // no alignment asked for
  return value;
}

/// Calls call(number) for every lane's number of a pack, or for the one number.
template <class T, class Call>
inline __attribute__((always_inline)) void each_lane(T& value, Call&& call) {
  if constexpr (std::is_same_v<T, double>) {
    call(value);
  } else {
    double lane[sizeof(T) / sizeof(double)];
    std::memcpy(lane, &value, sizeof value);
    for (double& number : lane) call(number);
    std::memcpy(&value, lane, sizeof value);
  }
}

template <class T>
inline __attribute__((always_inline)) T square_root(T value) {
  each_lane(value, [](double& x) { x = __builtin_sqrt(x); });
  return value;
}

template <class T>
inline __attribute__((always_inline)) bool any_above_zero(T value) {
  bool any = false;
  each_lane(value, [&](double& x) { any |= x > 0; });
  return any;
}

}  // namespace fem
