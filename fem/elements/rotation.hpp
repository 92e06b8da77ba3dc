#pragma once
// The rotation R of a deformation gradient F = R U, by Newton's iteration R <- (R + R^-T) / 2 from F.
// Source: Higham 1986, DOI 10.1137/0907079. It squares the distance at every turn: strains of 0.2 are gone to rounding
// after five.
#include "fem/laws/deformation.hpp"

namespace fem {

template <class T>
inline __attribute__((always_inline)) void rotation_of(const T (*gradient)[3], T (*r)[3]) {
  constexpr int turns = 6;
  T h[3][3];  // R - I
  for (int c = 0; c < 3; ++c) {
    for (int d = 0; d < 3; ++d) h[c][d] = gradient[c][d];
  }
  for (int turn = 0; turn < turns; ++turn) {
    T cofactor[3][3];
    const T determinant = cofactors(h, cofactor);
    for (int c = 0; c < 3; ++c) {
      for (int d = 0; d < 3; ++d) h[c][d] = 0.5 * (h[c][d] + cofactor[c][d] / determinant - (c == d ? 1.0 : 0.0));
    }
  }
  for (int c = 0; c < 3; ++c) {
    for (int d = 0; d < 3; ++d) r[c][d] = h[c][d] + (c == d ? 1.0 : 0.0);
  }
}

/// Every node's vector turned back (R^T u).
template <int nodes, class T>
inline __attribute__((always_inline)) void turn_back(const T (*r)[3], const T (*u)[3], T (*turned)[3]) {
  for (int a = 0; a < nodes; ++a) {
    for (int c = 0; c < 3; ++c) turned[a][c] = r[0][c] * u[a][0] + r[1][c] * u[a][1] + r[2][c] * u[a][2];
  }
}

}  // namespace fem
