#pragma once
// Tetrahedron of ten nodes: quadratic displacement, four points (exact for straight sides).
//   N_i = L_i (2 L_i - 1) at corners, N_ij = 4 L_i L_j at the middles of edges, L barycentric
// Source: Hughes, The Finite Element Method (2000), 3.I. Mass: HRZ, see isoparametric.hpp.
// Node order as gmsh's: corners, then the middles of 0-1, 1-2, 2-0, 3-0, 2-3, 1-3.
#include "fem/elements/isoparametric.hpp"

namespace fem {

struct Tet10Shape {
  static constexpr int nodes = 10, points = 4, mass_points = 64;
  static constexpr int middles[6][2] = {{0, 1}, {1, 2}, {2, 0}, {3, 0}, {2, 3}, {1, 3}};

  /// Place of a point of the stiffness rule; returns its weight.
  static constexpr double point(int p, double* place) {
    constexpr double near = 0.58541019662496845446,
                     far = 0.13819660112501051518;  // (5 + 3 sqrt5) / 20, (5 - sqrt5) / 20
    for (int e = 0; e < 3; ++e) place[e] = p == e + 1 ? near : far;
    return 1.0 / 24.0;
  }

  /// Gauss-Legendre points of a cube, collapsed onto the tetrahedron: exact to the fifth degree (Stroud 1971).
  static constexpr double mass_point(int p, double* place) {
    constexpr double at[4] = {-0.86113631159405257522, -0.33998104358485626480, 0.33998104358485626480,
                              0.86113631159405257522};
    constexpr double share[4] = {0.34785484513745385737, 0.65214515486254614263, 0.65214515486254614263,
                                 0.34785484513745385737};
    const int i = p % 4, j = p / 4 % 4, k = p / 16;
    const double r = 0.5 * (1 + at[i]), s = 0.5 * (1 + at[j]), t = 0.5 * (1 + at[k]);
    place[0] = r;
    place[1] = s * (1 - r);
    place[2] = t * (1 - r) * (1 - s);
    return 0.125 * share[i] * share[j] * share[k] * (1 - r) * (1 - r) * (1 - s);
  }

  static constexpr void shape(const double* place, double* values, double (*slope)[3]) {
    const double l[4] = {1 - place[0] - place[1] - place[2], place[0], place[1], place[2]};
    for (int a = 0; a < 4; ++a) {
      values[a] = l[a] * (2 * l[a] - 1);
      for (int e = 0; e < 3; ++e) slope[a][e] = (4 * l[a] - 1) * along(a, e);
    }
    for (int m = 0; m < 6; ++m) {
      const int i = middles[m][0], j = middles[m][1];
      values[4 + m] = 4 * l[i] * l[j];
      for (int e = 0; e < 3; ++e) slope[4 + m][e] = 4 * (l[i] * along(j, e) + l[j] * along(i, e));
    }
  }

 private:
  /// d L_i / d xi_e
  static constexpr double along(int i, int e) { return i == 0 ? -1 : i == e + 1 ? 1 : 0; }
};

struct Tet10 : Isoparametric<Tet10Shape> {
  static constexpr const char* name = "tet10";
};

}  // namespace fem
