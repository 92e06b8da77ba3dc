#pragma once
// What a law is told about a point, and the tensors that laws make of it. T is a double or a pack of doubles.
// Components of a symmetric tensor: xx, yy, zz, xy, yz, xz.

namespace fem {

template <class T>
struct Deformation {
  T gradient[3][3];  // [-] d u_c / d X_d
  T rate[3][3];      // [1/s] d v_c / d X_d; set for viscous laws only
};

/// What a law takes out of the mechanics at a point, per volume of the reference body.
template <class T>
struct Loss {
  T viscous{};  // [W/m3]
  T plastic{};  // [J/m3] since the last step
};

/// Symmetric part with engineering shear: xx, yy, zz, 2 xy, 2 yz, 2 xz.
template <class T>
inline __attribute__((always_inline)) void symmetric_part(const T (*h)[3], T* strain) {
  for (int c = 0; c < 3; ++c) strain[c] = h[c][c];
  strain[3] = h[0][1] + h[1][0];
  strain[4] = h[1][2] + h[2][1];
  strain[5] = h[0][2] + h[2][0];
}

/// sigma = lambda tr(eps) I + 2 mu eps; strain with engineering shear.
template <class T>
inline __attribute__((always_inline)) void isotropic(double lambda, double mu, const T* strain, T* stress) {
  const T pressure = lambda * (strain[0] + strain[1] + strain[2]);
  for (int i = 0; i < 3; ++i) stress[i] = pressure + (2 * mu) * strain[i];
  for (int i = 3; i < 6; ++i) stress[i] = mu * strain[i];
}

/// stress : strain, strain with engineering shear.
template <class T>
inline __attribute__((always_inline)) T contraction(const T* stress, const T* strain) {
  return stress[0] * strain[0] + stress[1] * strain[1] + stress[2] * strain[2] + stress[3] * strain[3] +
         stress[4] * strain[4] + stress[5] * strain[5];
}

template <class T>
inline __attribute__((always_inline)) void to_matrix(const T* s, T (*m)[3]) {
  m[0][0] = s[0], m[1][1] = s[1], m[2][2] = s[2];
  m[0][1] = m[1][0] = s[3];
  m[1][2] = m[2][1] = s[4];
  m[0][2] = m[2][0] = s[5];
}

/// Cofactors of F = I + h: det(F) F^-T. Returns det F.
template <class T>
inline __attribute__((always_inline)) T cofactors(const T (*h)[3], T (*cofactor)[3]) {
  T f[3][3];
  for (int c = 0; c < 3; ++c) {
    for (int d = 0; d < 3; ++d) f[c][d] = h[c][d] + (c == d ? 1.0 : 0.0);
  }
  for (int c = 0; c < 3; ++c) {
    for (int d = 0; d < 3; ++d) {
      const int c1 = (c + 1) % 3, c2 = (c + 2) % 3, d1 = (d + 1) % 3, d2 = (d + 2) % 3;
      cofactor[c][d] = f[c1][d1] * f[c2][d2] - f[c1][d2] * f[c2][d1];
    }
  }
  return f[0][0] * cofactor[0][0] + f[0][1] * cofactor[0][1] + f[0][2] * cofactor[0][2];
}

}  // namespace fem
