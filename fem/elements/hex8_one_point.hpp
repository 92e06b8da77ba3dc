#pragma once
// Hexahedron of eight nodes with one point and a physical hourglass control: the law is asked once per element.
//   constant part: mean gradients b_a = 1/V integral grad N_a (Flanagan & Belytschko 1981), so that distorted meshes
//   pass the patch test; the rest of the motion is four hourglass shapes per direction,
//   q = Gamma u,  Gamma = 1/8 (h - sum_i (h . x_i) b_i),   h = eta zeta, xi zeta, xi eta, xi eta zeta
//   Gamma annihilates every linear field. Forces Gamma^T K_q q, K_q the elastic stiffness of the hourglass field with
//   incompatible modes condensed out, on the parallelepiped of the element's mean Jacobian.
// There is no free parameter. On parallelepipeds the element is hex8_incompatible.
// Source: Flanagan & Belytschko 1981, DOI 10.1002/nme.1620170504; Puso 2000, Int. J. Numer. Meth. Engng 49, 1029
// (physical stabilisation by enhanced strain). Hourglass stiffness stays elastic whatever the
// law; viscous laws damp it in proportion (mu_D / mu). Mass: row sums of the trilinear element.
#include "fem/elements/hex8_incompatible.hpp"

namespace fem {

struct Hex8OnePoint {
  static constexpr const char* name = "hex8_one_point";
  static constexpr int nodes = 8, points = 1;
  static constexpr int shapes = 25, stiffness = 57;           // after b[3 a + c] and the volume: Gamma[8 s + a], K_q
  static constexpr int geometry_size = 57 + packed_size(12);  // K_q of q[3 s + c]
  static constexpr bool assumed_strain = false, stabilised = true;

  static double measure(const double (*x)[3], const Elastic& elastic, double* geometry) {
    double full[80];
    const double volume = hex8::measure_points(x, full);
    hex8::mean_gradients(full, volume, geometry);
    geometry[24] = volume;
    hourglass_shapes(x, geometry);
    hourglass_stiffness(x, volume, elastic, geometry + stiffness);
    return volume;
  }

  static void node_volumes(const double (*x)[3], const double*, double* volumes) {
    double full[80];
    hex8::measure_points(x, full);
    hex8::node_volumes(full, volumes);
  }

  template <class T>
  static T weight(const T* g, int) {
    return g[24];
  }

  template <class T>
  struct Field {
    inline __attribute__((always_inline)) Field(const T* geometry, const Elastic&, const T (*nodal)[3])
        : g(geometry), u(nodal) {}
    inline __attribute__((always_inline)) void gradient(int, T (*h)[3]) const {
      for (int c = 0; c < 3; ++c) {
        for (int d = 0; d < 3; ++d) {
          h[c][d] = u[0][c] * g[d];
          for (int a = 1; a < 8; ++a) h[c][d] += u[a][c] * g[3 * a + d];
        }
      }
    }
    const T* g;
    const T (*u)[3];
  };

  template <class T, bool hooke>
  struct Forces {
    inline __attribute__((always_inline)) Forces(const T* geometry, const Elastic&) : g(geometry) {}
    inline __attribute__((always_inline)) void add(int, const T (*given)[3]) {
      for (int c = 0; c < 3; ++c) {
        for (int d = 0; d < 3; ++d) stress[c][d] = given[c][d];
      }
    }
    inline __attribute__((always_inline)) void finish(T (*f)[3]) {
      for (int a = 0; a < 8; ++a) {
        for (int c = 0; c < 3; ++c)
          f[a][c] = stress[c][0] * g[3 * a] + stress[c][1] * g[3 * a + 1] + stress[c][2] * g[3 * a + 2];
      }
    }
    const T* g;
    T stress[3][3];
  };

  /// Adds the forces of the hourglass control.
  template <class T>
  static inline __attribute__((always_inline)) void stabilise(const T* g, const T (*u)[3], T (*f)[3]) {
    T q[12], force[12];
    hourglass(g, u, q);
    multiply<12>(g + stiffness, q, force);
    add_hourglass(g, force, f);
  }

  /// Adds the hourglass forces of velocities, `relaxation` [s] times those of displacements; returns their power [W].
  template <class T>
  static inline __attribute__((always_inline)) T drag(const T* g, double relaxation, const T (*v)[3], T (*f)[3]) {
    T q[12], force[12], power{};
    hourglass(g, v, q);
    multiply<12>(g + stiffness, q, force);
    for (int i = 0; i < 12; ++i) {
      force[i] *= relaxation;
      power += force[i] * q[i];
    }
    add_hourglass(g, force, f);
    return power;
  }

 private:
  template <class T>
  static inline __attribute__((always_inline)) void hourglass(const T* g, const T (*u)[3], T* q) {
    for (int s = 0; s < 4; ++s) {
      for (int c = 0; c < 3; ++c) {
        q[3 * s + c] = g[shapes + 8 * s] * u[0][c];
        for (int a = 1; a < 8; ++a) q[3 * s + c] += g[shapes + 8 * s + a] * u[a][c];
      }
    }
  }
  template <class T>
  static inline __attribute__((always_inline)) void add_hourglass(const T* g, const T* force, T (*f)[3]) {
    for (int a = 0; a < 8; ++a) {
      for (int c = 0; c < 3; ++c) {
        for (int s = 0; s < 4; ++s) f[a][c] += g[shapes + 8 * s + a] * force[3 * s + c];
      }
    }
  }

  static void hourglass_shapes(const double (*x)[3], double* geometry) {
    for (int s = 0; s < 4; ++s) {
      double along[3] = {};  // h . x_i
      for (int a = 0; a < 8; ++a) {
        for (int c = 0; c < 3; ++c) along[c] += value(s, a) * x[a][c];
      }
      for (int a = 0; a < 8; ++a) {
        double gamma = value(s, a);
        for (int c = 0; c < 3; ++c) gamma -= along[c] * geometry[3 * a + c];
        geometry[shapes + 8 * s + a] = gamma / 8;
      }
    }
  }

  /// Hourglass shape s at node a; the fourth is the product of all three coordinates.
  static double value(int s, int a) {
    double product = 1;
    for (int e = 0; e < 3; ++e) product *= e == s ? 1 : hex8::side(a, e);
    return product;
  }

  /// K_q on the parallelepiped with the mean Jacobian and the element's volume: 12 hourglass and 9 incompatible
  /// motions, of which the second are condensed out.
  static void hourglass_stiffness(const double (*x)[3], double volume, const Elastic& elastic, double* packed_k) {
    double rows[9];  // -2 gauss j_0 d xi_e / d x_c
    incompatible::mode_rows(x, rows);
    double centre_volume = 0;
    {
      double centre[3][3] = {}, inverse[9];
      for (int e = 0; e < 3; ++e) {
        for (int c = 0; c < 3; ++c) {
          for (const auto& edge : hex8::edges[e]) centre[e][c] += 0.125 * (x[edge[1]][c] - x[edge[0]][c]);
        }
      }
      centre_volume = invert(centre, inverse);
    }
    double k[21][21] = {};
    for (int p = 0; p < 8; ++p) {
      const double weight = volume / 8;
      double h[21][3][3] = {}, stress[21][3][3];
      for (int i = 0; i < 21; ++i) {
        const int shape = i / 3, c = i % 3;
        for (int e = 0; e < 3; ++e) {
          double slope = 0;  // d shape / d xi_e at p
          if (shape >= 4) {
            slope = shape - 4 == e ? -2 * hex8::gauss * hex8::sign(e, p) : 0;
          } else if (shape != e) {
            slope = 1;
            for (int d = 0; d < 3; ++d) slope *= d == e || d == shape ? 1 : hex8::sign(d, p) * hex8::gauss;
          }
          for (int d = 0; d < 3; ++d) h[i][c][d] += slope * rows[3 * e + d] / (-2 * hex8::gauss * centre_volume);
        }
        elastic.stress(h[i], stress[i]);
      }
      for (int i = 0; i < 21; ++i) {
        for (int j = 0; j < 21; ++j) {
          for (int c = 0; c < 3; ++c) {
            for (int d = 0; d < 3; ++d) k[i][j] += weight * h[i][c][d] * stress[j][c][d];
          }
        }
      }
    }
    double modes[9][9];
    for (int i = 0; i < 9; ++i) {
      for (int j = 0; j < 9; ++j) modes[i][j] = k[12 + i][12 + j];
    }
    invert_definite(modes);
    for (int i = 0; i < 12; ++i) {
      for (int j = 0; j <= i; ++j) {
        double value = k[i][j];
        for (int m = 0; m < 9; ++m) {
          for (int n = 0; n < 9; ++n) value -= k[i][12 + m] * modes[m][n] * k[12 + n][j];
        }
        packed_k[packed(i, j)] = value;
      }
    }
  }
};

}  // namespace fem
