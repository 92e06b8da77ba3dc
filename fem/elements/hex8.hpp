#pragma once
// Hexahedron of eight nodes, trilinear, 2 x 2 x 2 Gauss points; full integration or mean dilatation (B-bar).
//   full:   f_a = sum_p w_p sigma_p grad N_a,p
//   B-bar:  the dilatation of every point, and the mean stress that answers it, are replaced by their volume averages
// Source: Hughes, The Finite Element Method (2000), 3.8 (Gauss), 4.5.2 (B-bar, after Nagtegaal 1974, mean dilatation).
// Validity: full integration is stiff in bending and locks near nu = 0.5; B-bar does not lock in volume.
// Slopes are formed by sums over edges: d u / d xi is constant along xi, so four values per direction serve eight
// points. Node order as gmsh's and VTK's: 0 (-,-,-), 1 (+,-,-), 2 (+,+,-), 3 (-,+,-), 4 to 7 the same at zeta = +1.
#include <cmath>

#include "fem/elements/gradient.hpp"

namespace fem {

namespace hex8 {

constexpr double gauss = 0.57735026918962576451;  // 1 / sqrt(3)
/// The four edges along xi, eta and zeta: from, to.
constexpr int edges[3][4][2] = {
    {{0, 1}, {3, 2}, {4, 5}, {7, 6}}, {{0, 3}, {1, 2}, {4, 7}, {5, 6}}, {{0, 4}, {1, 5}, {3, 7}, {2, 6}}};
/// Which of the four values of a direction serves point p = i + 2 j + 4 k (i, j, k = 0 or 1 along xi, eta, zeta).
constexpr int edge_of(int direction, int p) {
  const int i = p & 1, j = (p >> 1) & 1, k = p >> 2;
  return direction == 0 ? j + 2 * k : direction == 1 ? i + 2 * k : i + 2 * j;
}

/// From values on four edges to values at 2 x 2 Gauss points, halved for d xi = 2; its own transpose.
template <class T>
inline __attribute__((always_inline)) void edges_to_points(T* v) {
  constexpr double near = 0.5 * (1 + gauss), far = 0.5 * (1 - gauss);
  constexpr double nn = 0.5 * near * near, nf = 0.5 * near * far, ff = 0.5 * far * far;
  const T a = v[0] + v[3], b = v[1] + v[2], c = v[0], d = v[1], e = v[2], f = v[3];
  v[0] = nn * c + nf * b + ff * f;
  v[1] = nn * d + nf * a + ff * e;
  v[2] = nn * e + nf * a + ff * d;
  v[3] = nn * f + nf * b + ff * c;
}

/// slope[c][e][4]: d u_c / d xi_e at the four places where it differs.
template <class T>
inline __attribute__((always_inline)) void slopes(const T (*u)[3], T (*slope)[3][4]) {
  for (int c = 0; c < 3; ++c) {
    for (int e = 0; e < 3; ++e) {
      for (int m = 0; m < 4; ++m) slope[c][e][m] = u[edges[e][m][1]][c] - u[edges[e][m][0]][c];
      edges_to_points(slope[c][e]);
    }
  }
}

}  // namespace hex8

template <bool mean_dilatation>
struct Hex8 {
  static constexpr const char* name = mean_dilatation ? "hex8_bbar" : "hex8";
  static constexpr int nodes = 8;
  static constexpr int geometry_size = 80;  // per point: d xi_e / d x_c, then the volume it stands for

  static double measure(const double (*x)[3], double* geometry) {
    double slope[3][3][4], volume = 0;
    hex8::slopes(x, slope);
    for (int p = 0; p < 8; ++p) {
      double jacobian[3][3];
      for (int e = 0; e < 3; ++e) {
        for (int c = 0; c < 3; ++c) jacobian[e][c] = slope[c][e][hex8::edge_of(e, p)];
      }
      geometry[10 * p + 9] = invert(jacobian, geometry + 10 * p);
      volume += geometry[10 * p + 9];
    }
    return volume;
  }

  static void node_volumes(const double* geometry, double* volumes) {
    for (int a = 0; a < 8; ++a) {
      const double sign[3] = {a == 1 || a == 2 || a == 5 || a == 6 ? 1.0 : -1.0, a % 4 >= 2 ? 1.0 : -1.0,
                              a >= 4 ? 1.0 : -1.0};
      volumes[a] = 0;
      for (int p = 0; p < 8; ++p) {
        double shape = geometry[10 * p + 9];
        for (int d = 0; d < 3; ++d) shape *= 0.5 * (1 + sign[d] * ((p >> d) & 1 ? hex8::gauss : -hex8::gauss));
        volumes[a] += shape;
      }
    }
  }

  template <class T, class Law>
  static inline __attribute__((always_inline)) void forces(const T* g, const Law& law, const T (*u)[3], T (*f)[3]) {
    T stress[8][6], flux[3][3][4] = {};
    point_stresses(g, law, u, stress);
    for (int p = 0; p < 8; ++p) {
      T part[3][3];
      for (int i = 0; i < 6; ++i) stress[p][i] *= g[10 * p + 9];
      to_reference(stress[p], g + 10 * p, part);
      for (int c = 0; c < 3; ++c) {
        for (int e = 0; e < 3; ++e) flux[c][e][hex8::edge_of(e, p)] += part[c][e];
      }
    }
    for (int c = 0; c < 3; ++c) {
      for (int a = 0; a < 8; ++a) f[a][c] = T{};
      for (int e = 0; e < 3; ++e) {
        hex8::edges_to_points(flux[c][e]);
        for (int m = 0; m < 4; ++m) {
          f[hex8::edges[e][m][1]][c] += flux[c][e][m];
          f[hex8::edges[e][m][0]][c] -= flux[c][e][m];
        }
      }
    }
  }

  template <class T, class Law>
  static void mean_stress(const T* g, const Law& law, const T (*u)[3], T* mean) {
    T stress[8][6], volume{};
    point_stresses(g, law, u, stress);
    for (int i = 0; i < 6; ++i) mean[i] = T{};
    for (int p = 0; p < 8; ++p) {
      for (int i = 0; i < 6; ++i) mean[i] += g[10 * p + 9] * stress[p][i];
      volume += g[10 * p + 9];
    }
    for (int i = 0; i < 6; ++i) mean[i] /= volume;
  }

 private:
  template <class T, class Law>
  static inline __attribute__((always_inline)) void point_stresses(const T* g, const Law& law, const T (*u)[3],
                                                                   T (*stress)[6]) {
    T slope[3][3][4], strain[8][6];
    hex8::slopes(u, slope);
    for (int p = 0; p < 8; ++p) {
      T local[3][3];
      for (int c = 0; c < 3; ++c) {
        for (int e = 0; e < 3; ++e) local[c][e] = slope[c][e][hex8::edge_of(e, p)];
      }
      to_strain(local, g + 10 * p, strain[p]);
    }
    if constexpr (mean_dilatation) average_trace(g, strain);
    for (int p = 0; p < 8; ++p) law.stress(strain[p], stress[p]);
    if constexpr (mean_dilatation) average_trace(g, stress);
  }

  /// Gives the tensors of all points the same trace: its volume average.
  template <class T>
  static inline __attribute__((always_inline)) void average_trace(const T* g, T (*tensor)[6]) {
    T volume{}, sum{};
    for (int p = 0; p < 8; ++p) {
      volume += g[10 * p + 9];
      sum += g[10 * p + 9] * (tensor[p][0] + tensor[p][1] + tensor[p][2]);
    }
    const T mean = sum / volume;
    for (int p = 0; p < 8; ++p) {
      const T change = (mean - (tensor[p][0] + tensor[p][1] + tensor[p][2])) * (1.0 / 3.0);
      for (int i = 0; i < 3; ++i) tensor[p][i] += change;
    }
  }
};

}  // namespace fem
