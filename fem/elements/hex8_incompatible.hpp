#pragma once
// Hexahedron of eight nodes with incompatible modes: bends as a beam does, 2 x 2 x 2 points.
//   u = sum N_a u_a + sum_e (1 - xi_e^2) alpha_e,   grad of the second part: -2 xi_e (j_0 / j) (d xi_e / d x)_0
// with the Jacobian of the centre, so that constant stress does no work on it (patch test). alpha is what makes the
// elastic forces on the modes vanish: alpha = -K_aa^-1 K_au u, a fixed matrix of the element. With laws other than
// Hooke's the same strain is assumed and forces are its transpose: energy is kept, and no modes need to be solved for
// in the step. Source: Taylor, Beresford, Wilson 1976, DOI 10.1002/nme.1620100602; Simo & Rifai 1990,
// DOI 10.1002/nme.1620290802. Validity: exact in bending for parallelepipeds, less so on distorted cells. Mass: row
// sums of the trilinear element.
#include "fem/elements/dense.hpp"
#include "fem/elements/hex8.hpp"

namespace fem {

namespace incompatible {

/// The gradient of mode e at p, times the volume of p, is hex8::sign(e, p) times row e of this (rows[3 e + c]).
inline void mode_rows(const double (*x)[3], double* rows) {
  double centre[3][3], inverse[9];
  for (int e = 0; e < 3; ++e) {
    for (int c = 0; c < 3; ++c) {
      centre[e][c] = 0;
      for (const auto& edge : hex8::edges[e]) centre[e][c] += 0.125 * (x[edge[1]][c] - x[edge[0]][c]);
    }
  }
  const double determinant = invert(centre, inverse);
  for (int i = 0; i < 9; ++i) rows[i] = -2 * hex8::gauss * determinant * inverse[i];
}

}  // namespace incompatible

struct Hex8Incompatible {
  static constexpr const char* name = "hex8_incompatible";
  static constexpr int nodes = 8, points = 8;
  static constexpr int rows = 80, stiffness = 89;            // places in the geometry, after hex8's own
  static constexpr int geometry_size = 89 + packed_size(9);  // K_aa^-1 of the modes, [3 e + c]
  static constexpr bool assumed_strain = true, stabilised = false;

  static double measure(const double (*x)[3], const Elastic& elastic, double* geometry) {
    const double volume = hex8::measure_points(x, geometry);
    incompatible::mode_rows(x, geometry + rows);
    double k[9][9] = {};
    for (int j = 0; j < 9; ++j) {
      for (int p = 0; p < 8; ++p) {
        double h[3][3] = {}, stress[3][3];
        for (int d = 0; d < 3; ++d)
          h[j % 3][d] = hex8::sign(j / 3, p) * geometry[rows + 3 * (j / 3) + d] / geometry[10 * p + 9];
        elastic.stress(h, stress);
        for (int i = 0; i < 9; ++i) {
          for (int d = 0; d < 3; ++d)
            k[i][j] += hex8::sign(i / 3, p) * geometry[rows + 3 * (i / 3) + d] * stress[i % 3][d];
        }
      }
    }
    invert_definite(k);
    for (int i = 0; i < 9; ++i) {
      for (int j = 0; j <= i; ++j) geometry[stiffness + packed(i, j)] = k[i][j];
    }
    return volume;
  }

  static void node_volumes(const double (*)[3], const double* geometry, double* volumes) {
    hex8::node_volumes(geometry, volumes);
  }

  template <class T>
  static T weight(const T* g, int p) {
    return g[10 * p + 9];
  }

  template <class T>
  struct Field : hex8::Field<T> {
    inline __attribute__((always_inline)) Field(const T* geometry, const Elastic& elastic, const T (*u)[3])
        : hex8::Field<T>(geometry, u) {
      T sum[3][3][3] = {}, force[9], alpha[9];  // sum over points of sign times gradient
      for (int p = 0; p < 8; ++p) {
        T h[3][3];
        hex8::Field<T>::gradient(p, h);
        for (int e = 0; e < 3; ++e) {
          for (int c = 0; c < 3; ++c) {
            for (int d = 0; d < 3; ++d) sum[e][c][d] += hex8::sign(e, p) * h[c][d];
          }
        }
      }
      for (int e = 0; e < 3; ++e) {
        T stress[3][3];
        elastic.stress(sum[e], stress);
        on_modes(geometry, e, stress, force);
      }
      multiply<9>(geometry + stiffness, force, alpha);
      spread(geometry, alpha, mode);
    }
    inline __attribute__((always_inline)) void gradient(int p, T (*h)[3]) const {
      hex8::Field<T>::gradient(p, h);
      const T share = 1.0 / weight(this->g, p);
      for (int c = 0; c < 3; ++c) {
        for (int d = 0; d < 3; ++d) {
          for (int e = 0; e < 3; ++e) h[c][d] += (hex8::sign(e, p) * share) * mode[e][c][d];
        }
      }
    }
    T mode[3][3][3];  // [e] gradient of the mode times volume, without its sign
  };

  template <class T, bool hooke>
  struct Forces : hex8::Forces<T> {
    inline __attribute__((always_inline)) Forces(const T* geometry, const Elastic& given)
        : hex8::Forces<T>(geometry), elastic(given) {}
    inline __attribute__((always_inline)) void add(int p, const T (*stress)[3]) {
      hex8::Forces<T>::add(p, stress);
      const T share = 1.0 / weight(this->g, p);
      for (int e = 0; e < 3; ++e) {
        for (int c = 0; c < 3; ++c) {
          for (int d = 0; d < 3; ++d) sum[e][c][d] += (hex8::sign(e, p) * share) * stress[c][d];
        }
      }
    }
    inline __attribute__((always_inline)) void finish(T (*f)[3]) {
      if constexpr (!hooke) {  // Hooke's forces on the modes vanish
        T force[9], alpha[9], mode[3][3][3];
        for (int e = 0; e < 3; ++e) on_modes(this->g, e, sum[e], force);
        multiply<9>(this->g + stiffness, force, alpha);
        spread(this->g, alpha, mode);
        for (int p = 0; p < 8; ++p) {
          T h[3][3] = {}, stress[3][3];
          for (int e = 0; e < 3; ++e) {
            for (int c = 0; c < 3; ++c) {
              for (int d = 0; d < 3; ++d) h[c][d] += hex8::sign(e, p) * mode[e][c][d];
            }
          }
          elastic.stress(h, stress);
          hex8::Forces<T>::add(p, stress);
        }
      }
      hex8::Forces<T>::finish(f);
    }
    const Elastic& elastic;
    T sum[3][3][3] = {};
  };

 private:
  /// force[3 e + c] = -sum_d stress_cd rows_ed
  template <class T>
  static inline __attribute__((always_inline)) void on_modes(const T* g, int e, const T (*stress)[3], T* force) {
    const T* row = g + rows + 3 * e;
    for (int c = 0; c < 3; ++c)
      force[3 * e + c] = -(stress[c][0] * row[0] + stress[c][1] * row[1] + stress[c][2] * row[2]);
  }
  /// mode[e][c][d] = alpha_ec rows_ed
  template <class T>
  static inline __attribute__((always_inline)) void spread(const T* g, const T* alpha, T (*mode)[3][3]) {
    for (int e = 0; e < 3; ++e) {
      for (int c = 0; c < 3; ++c) {
        for (int d = 0; d < 3; ++d) mode[e][c][d] = alpha[3 * e + c] * g[rows + 3 * e + d];
      }
    }
  }
};

}  // namespace fem
