#pragma once
// Tetrahedron of four nodes: linear displacement, constant strain.
//   grad u = sum_e (u_{e+1} - u_0) (x) d xi_e / d x,   f_a = V sigma grad N_a
// Source: Hughes, The Finite Element Method (2000), 3.I. Stiff in bending, locks near nu = 0.5: use fine meshes.
// Node order: (x1 - x0, x2 - x0, x3 - x0) right-handed.
#include "fem/elements/gradient.hpp"

namespace fem {

struct Tet4 {
  static constexpr const char* name = "tet4";
  static constexpr int nodes = 4;
  static constexpr int geometry_size = 10;  // d xi_e / d x_c, then the volume

  /// From the nodes' places [m]. Returns the volume [m3].
  static double measure(const double (*x)[3], double* geometry) {
    double jacobian[3][3];  // [e][c] = d x_c / d xi_e
    for (int e = 0; e < 3; ++e) {
      for (int c = 0; c < 3; ++c) jacobian[e][c] = x[e + 1][c] - x[0][c];
    }
    geometry[9] = invert(jacobian, geometry) / 6;
    return geometry[9];
  }

  /// The volume [m3] that belongs to each node.
  static void node_volumes(const double* geometry, double* volumes) {
    for (int a = 0; a < 4; ++a) volumes[a] = geometry[9] / 4;
  }

  /// Inner nodal forces [N] at displacements u [m].
  template <class T, class Law>
  static inline __attribute__((always_inline)) void forces(const T* g, const Law& law, const T (*u)[3], T (*f)[3]) {
    T stress[6], first_piola[3][3];
    mean_stress(g, law, u, stress);
    for (int i = 0; i < 6; ++i) stress[i] *= g[9];
    to_reference(stress, g, first_piola);
    for (int c = 0; c < 3; ++c) {
      for (int e = 0; e < 3; ++e) f[e + 1][c] = first_piola[c][e];
      f[0][c] = -(first_piola[c][0] + first_piola[c][1] + first_piola[c][2]);
    }
  }

  template <class T, class Law>
  static inline __attribute__((always_inline)) void mean_stress(const T* g, const Law& law, const T (*u)[3],
                                                                T* stress) {
    T slope[3][3], strain[6];  // [c][e] = d u_c / d xi_e
    for (int c = 0; c < 3; ++c) {
      for (int e = 0; e < 3; ++e) slope[c][e] = u[e + 1][c] - u[0][c];
    }
    to_strain(slope, g, strain);
    law.stress(strain, stress);
  }
};

}  // namespace fem
