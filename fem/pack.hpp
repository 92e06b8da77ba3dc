#pragma once
// W doubles side by side: one number of W elements at once. The element and law kernels are written once for a type T
// that is either such a pack or a plain double. Vector extensions of GCC and Clang, because auto-vectorisation of the
// lane loops is not dependable.
#include <cstring>

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

}  // namespace fem
