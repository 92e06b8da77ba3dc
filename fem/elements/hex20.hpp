#pragma once
// Hexahedron of twenty nodes (serendipity): 3 x 3 x 3 points, or 2 x 2 x 2 (reduced, much the faster).
//   corners  N = 1/8 (1 + xi xi_a)(1 + eta eta_a)(1 + zeta zeta_a)(xi xi_a + eta eta_a + zeta zeta_a - 2)
//   middles  N = 1/4 (1 - xi^2)(1 + eta eta_a)(1 + zeta zeta_a), likewise along eta and zeta
// Source: Hughes, The Finite Element Method (2000), 3.I. With eight points a lone element has six motions without
// strain besides the rigid ones; in a mesh of two or more they cannot spread. Mass: HRZ, see isoparametric.hpp. Node
// order as gmsh's: corners as hex8, then the middles of 0-1, 0-3, 0-4, 1-2, 1-5, 2-3, 2-6, 3-7, 4-5, 4-7, 5-6, 6-7.
#include "fem/elements/isoparametric.hpp"

namespace fem {

template <int per_side>
struct Hex20Shape {
  static constexpr int nodes = 20, points = per_side * per_side * per_side, mass_points = 27;
  static constexpr int middles[12][2] = {{0, 1}, {0, 3}, {0, 4}, {1, 2}, {1, 5}, {2, 3},
                                         {2, 6}, {3, 7}, {4, 5}, {4, 7}, {5, 6}, {6, 7}};

  static constexpr double point(int p, double* place) { return gauss_point(per_side, p, place); }
  static constexpr double mass_point(int p, double* place) { return gauss_point(3, p, place); }

  static constexpr void shape(const double* place, double* values, double (*slope)[3]) {
    for (int a = 0; a < nodes; ++a) {
      double at[3] = {}, factor[3] = {}, change[3] = {};
      int flat = -1;  // the direction in which a middle node lies at 0
      for (int e = 0; e < 3; ++e) {
        at[e] = side(a, e);
        if (at[e] == 0) flat = e;
        factor[e] = at[e] == 0 ? 1 - place[e] * place[e] : 1 + at[e] * place[e];
        change[e] = at[e] == 0 ? -2 * place[e] : at[e];
      }
      const double product = factor[0] * factor[1] * factor[2];
      const double last = at[0] * place[0] + at[1] * place[1] + at[2] * place[2] - 2;
      values[a] = flat < 0 ? 0.125 * product * last : 0.25 * product;
      for (int e = 0; e < 3; ++e) {
        const double grown = change[e] * factor[(e + 1) % 3] * factor[(e + 2) % 3];
        slope[a][e] = flat < 0 ? 0.125 * (grown * last + product * at[e]) : 0.25 * grown;
      }
    }
  }

 private:
  /// Reference coordinate e of node a: -1, 0 or 1.
  static constexpr double side(int a, int e) {
    if (a >= 8) return 0.5 * (side(middles[a - 8][0], e) + side(middles[a - 8][1], e));
    if (e == 0) return a == 1 || a == 2 || a == 5 || a == 6 ? 1 : -1;
    return e == 1 ? (a % 4 >= 2 ? 1 : -1) : (a >= 4 ? 1 : -1);
  }

  static constexpr double gauss_point(int count, int p, double* place) {
    constexpr double two = 0.57735026918962576451, three = 0.77459666924148337704;  // 1 / sqrt3, sqrt(3 / 5)
    double weight = 1;
    for (int e = 0; e < 3; ++e) {
      const int i = p % count;
      p /= count;
      place[e] = count == 2 ? (i == 0 ? -two : two) : (i - 1) * three;
      if (count == 3) weight *= i == 1 ? 8.0 / 9.0 : 5.0 / 9.0;
    }
    return weight;
  }
};

struct Hex20 : Isoparametric<Hex20Shape<3>> {
  static constexpr const char* name = "hex20";
};
struct Hex20Reduced : Isoparametric<Hex20Shape<2>> {
  static constexpr const char* name = "hex20_reduced";
};

}  // namespace fem
