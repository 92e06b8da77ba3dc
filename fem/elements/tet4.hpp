#pragma once
// Tetrahedron of four nodes: linear displacement, constant strain.
//   grad u = sum_e (u_{e+1} - u_0) (x) d xi_e / d x,   f_a = V sigma grad N_a
// Source: Hughes, The Finite Element Method (2000), 3.I. Stiff in bending, locks near nu = 0.5: use fine meshes.
// Node order: (x1 - x0, x2 - x0, x3 - x0) right-handed. Lumped mass: a quarter per node.
#include "fem/elements/elastic.hpp"
#include "fem/elements/gradient.hpp"

namespace fem {

struct Tet4 {
  static constexpr const char* name = "tet4";
  static constexpr int nodes = 4, points = 1;
  static constexpr int geometry_size = 10;  // d xi_e / d x_c, then the volume
  static constexpr bool assumed_strain = false, stabilised = false;

  /// From the nodes' places [m]. Returns the volume [m3].
  static double measure(const double (*x)[3], const Elastic&, double* geometry) {
    double jacobian[3][3];  // [e][c] = d x_c / d xi_e
    for (int e = 0; e < 3; ++e) {
      for (int c = 0; c < 3; ++c) jacobian[e][c] = x[e + 1][c] - x[0][c];
    }
    geometry[9] = invert(jacobian, geometry) / 6;
    return geometry[9];
  }

  /// The volume [m3] whose mass each node carries.
  static void node_volumes(const double (*)[3], const double* geometry, double* volumes) {
    for (int a = 0; a < 4; ++a) volumes[a] = geometry[9] / 4;
  }

  template <class T>
  static T weight(const T* g, int) {
    return g[9];
  }

  /// Gradient [.] of a nodal field at the points.
  template <class T>
  struct Field {
    inline __attribute__((always_inline)) Field(const T* geometry, const Elastic&, const T (*u)[3]) : g(geometry) {
      for (int c = 0; c < 3; ++c) {
        for (int e = 0; e < 3; ++e) slope[c][e] = u[e + 1][c] - u[0][c];
      }
    }
    inline __attribute__((always_inline)) void gradient(int, T (*h)[3]) const { to_gradient(slope, g, h); }
    const T* g;
    T slope[3][3];  // [c][e] = d u_c / d xi_e
  };

  /// Nodal forces from stress times weight at the points: the transpose of Field.
  template <class T, bool hooke>
  struct Forces {
    inline __attribute__((always_inline)) Forces(const T* geometry, const Elastic&) : g(geometry) {}
    inline __attribute__((always_inline)) void add(int, const T (*stress)[3]) { to_reference(stress, g, flux); }
    inline __attribute__((always_inline)) void finish(T (*f)[3]) {
      for (int c = 0; c < 3; ++c) {
        for (int e = 0; e < 3; ++e) f[e + 1][c] = flux[c][e];
        f[0][c] = -(flux[c][0] + flux[c][1] + flux[c][2]);
      }
    }
    const T* g;
    T flux[3][3];
  };
};

}  // namespace fem
