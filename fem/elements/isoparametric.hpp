#pragma once
// Elements whose shape functions give both place and displacement, integrated by a rule of points (Hughes 2000, 3.3).
// Shape says which: nodes, points, shape functions with their slopes, the rule of the stiffness, the rule of the mass.
//
// Lumped mass by diagonal scaling (HRZ; Hinton, Rock, Zienkiewicz 1976, DOI 10.1002/eqe.4290040305): each node's share
// is the integral of N_a^2, scaled so that the element's mass is kept. Row sums would make the corner masses negative.
// On straight-sided cells a corner of tet10 takes 1/36 and a middle 4/27 of the mass, a corner of hex20 7/248 and a
// middle 16/248. The light corners are what shortens the stable step: 0.261 h / c_p for hex20 and 0.265 for tet10 on a
// cube of concrete in 3 x 3 x 3 cells of edge h, where hex8 has 0.970 and tet4 0.664; eight hex8 in place of a hex20
// have 0.485 (tests/verification/fem_stable_step.cpp prints them).
#include "fem/elements/elastic.hpp"
#include "fem/elements/gradient.hpp"

namespace fem {

/// Slopes of the shape functions at the points of the stiffness rule.
template <class Shape>
struct ShapeTable {
  double slope[Shape::points][Shape::nodes][3];
  constexpr ShapeTable() : slope{} {
    for (int p = 0; p < Shape::points; ++p) {
      double place[3] = {}, values[Shape::nodes] = {};
      Shape::point(p, place);
      Shape::shape(place, values, slope[p]);
    }
  }
};

template <class Shape>
struct Isoparametric {
  static constexpr int nodes = Shape::nodes, points = Shape::points;
  static constexpr int geometry_size = 10 * points;  // per point: d xi_e / d x_c, then the volume it stands for
  static constexpr bool assumed_strain = false, stabilised = false;
  static constexpr ShapeTable<Shape> table{};

  static double measure(const double (*x)[3], const Elastic&, double* geometry) {
    double volume = 0;
    for (int p = 0; p < points; ++p) {
      double place[3];
      geometry[10 * p + 9] = jacobian(x, table.slope[p], geometry + 10 * p) * Shape::point(p, place);
      volume += geometry[10 * p + 9];
    }
    return volume;
  }

  static void node_volumes(const double (*x)[3], const double*, double* volumes) {
    double volume = 0, sum = 0;
    for (int a = 0; a < nodes; ++a) volumes[a] = 0;
    for (int p = 0; p < Shape::mass_points; ++p) {
      double place[3], values[nodes], slope[nodes][3], inverse[9];
      const double weight = Shape::mass_point(p, place);
      Shape::shape(place, values, slope);
      const double here = weight * jacobian(x, slope, inverse);
      volume += here;
      for (int a = 0; a < nodes; ++a) volumes[a] += here * values[a] * values[a];
    }
    for (int a = 0; a < nodes; ++a) sum += volumes[a];
    for (int a = 0; a < nodes; ++a) volumes[a] *= volume / sum;
  }

  template <class T>
  static T weight(const T* g, int p) {
    return g[10 * p + 9];
  }

  template <class T>
  struct Field {
    inline __attribute__((always_inline)) Field(const T* geometry, const Elastic&, const T (*nodal)[3])
        : g(geometry), u(nodal) {}
    inline __attribute__((always_inline)) void gradient(int p, T (*h)[3]) const {
      T slope[3][3] = {};
      for (int a = 0; a < nodes; ++a) {
        for (int c = 0; c < 3; ++c) {
          for (int e = 0; e < 3; ++e) slope[c][e] += table.slope[p][a][e] * u[a][c];
        }
      }
      to_gradient(slope, g + 10 * p, h);
    }
    const T* g;
    const T (*u)[3];
  };

  template <class T, bool hooke>
  struct Forces {
    inline __attribute__((always_inline)) Forces(const T* geometry, const Elastic&) : g(geometry) {}
    inline __attribute__((always_inline)) void add(int p, const T (*stress)[3]) {
      T flux[3][3];
      to_reference(stress, g + 10 * p, flux);
      for (int a = 0; a < nodes; ++a) {
        for (int c = 0; c < 3; ++c) {
          sum[a][c] +=
              table.slope[p][a][0] * flux[c][0] + table.slope[p][a][1] * flux[c][1] + table.slope[p][a][2] * flux[c][2];
        }
      }
    }
    inline __attribute__((always_inline)) void finish(T (*f)[3]) {
      for (int a = 0; a < nodes; ++a) {
        for (int c = 0; c < 3; ++c) f[a][c] = sum[a][c];
      }
    }
    const T* g;
    T sum[nodes][3] = {};
  };

 private:
  /// Inverse and determinant of the Jacobian.
  static double jacobian(const double (*x)[3], const double (*slope)[3], double* inverse) {
    double j[3][3] = {};  // [e][c] = d x_c / d xi_e
    for (int a = 0; a < nodes; ++a) {
      for (int e = 0; e < 3; ++e) {
        for (int c = 0; c < 3; ++c) j[e][c] += slope[a][e] * x[a][c];
      }
    }
    return invert(j, inverse);
  }
};

}  // namespace fem
