#pragma once
// What all elements share: from slopes in reference coordinates to gradients in space, and back from stress to fluxes.
// The map g[3 e + c] = d xi_e / d x_c comes from invert(). T is a double or a pack of doubles.

namespace fem {

/// inverse[3 e + c] of the matrix jacobian[e][c] = d x_c / d xi_e; returns its determinant.
inline double invert(const double (*j)[3], double* inverse) {
  double cofactor[3][3];  // of j[e][c]
  for (int e = 0; e < 3; ++e) {
    for (int c = 0; c < 3; ++c) {
      const int e1 = (e + 1) % 3, e2 = (e + 2) % 3, c1 = (c + 1) % 3, c2 = (c + 2) % 3;
      cofactor[e][c] = j[e1][c1] * j[e2][c2] - j[e1][c2] * j[e2][c1];
    }
  }
  const double determinant = j[0][0] * cofactor[0][0] + j[0][1] * cofactor[0][1] + j[0][2] * cofactor[0][2];
  // j[e][c] inverse[3 f + c] = delta_ef, so inverse[3 f + c] = cofactor[f][c] / determinant
  for (int e = 0; e < 3; ++e) {
    for (int c = 0; c < 3; ++c) inverse[3 * e + c] = cofactor[e][c] / determinant;
  }
  return determinant;
}

/// h[c][d] = d u_c / d x_d from slope[c][e] = d u_c / d xi_e.
template <class T>
inline __attribute__((always_inline)) void to_gradient(const T (*slope)[3], const T* g, T (*h)[3]) {
  for (int c = 0; c < 3; ++c) {
    for (int d = 0; d < 3; ++d) h[c][d] = slope[c][0] * g[d] + slope[c][1] * g[3 + d] + slope[c][2] * g[6 + d];
  }
}

/// result[c][e] = sum_d stress_cd d xi_e / d x_d
template <class T>
inline __attribute__((always_inline)) void to_reference(const T (*stress)[3], const T* g, T (*result)[3]) {
  for (int c = 0; c < 3; ++c) {
    for (int e = 0; e < 3; ++e) {
      result[c][e] = stress[c][0] * g[3 * e] + stress[c][1] * g[3 * e + 1] + stress[c][2] * g[3 * e + 2];
    }
  }
}

}  // namespace fem
