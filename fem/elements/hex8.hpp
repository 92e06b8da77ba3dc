#pragma once
// Hexahedron of eight nodes, trilinear, 2 x 2 x 2 Gauss points; full integration or mean dilatation (B-bar).
//   full:   f_a = sum_p w_p sigma_p grad N_a,p
//   B-bar:  the dilatation of every point, and the mean stress that answers it, are replaced by their volume averages
// Source: Hughes, The Finite Element Method (2000), 3.8 (Gauss), 4.5.2 (B-bar, after Nagtegaal 1974, mean dilatation).
// Validity: full integration is stiff in bending and locks near nu = 0.5; B-bar does not lock in volume.
// Slopes are formed by sums over edges: d u / d xi is constant along xi, so four values per direction serve eight
// points. Node order as gmsh's and VTK's: 0 (-,-,-), 1 (+,-,-), 2 (+,+,-), 3 (-,+,-), 4 to 7 the same at zeta = +1.
#include <cmath>
#include <initializer_list>

#include "fem/elements/elastic.hpp"
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

/// Reference coordinate e of node a, and sign of that of Gauss point p.
constexpr double side(int a, int e) {
  return e == 0   ? (a == 1 || a == 2 || a == 5 || a == 6 ? 1.0 : -1.0)
         : e == 1 ? (a % 4 >= 2 ? 1.0 : -1.0)
                  : (a >= 4 ? 1.0 : -1.0);
}
constexpr double sign(int e, int p) { return (p >> e) & 1 ? 1.0 : -1.0; }

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

/// From places [m]: per point d xi_e / d x_c and the volume it stands for, into geometry[80]. Returns the volume.
inline double measure_points(const double (*x)[3], double* geometry) {
  double slope[3][3][4], volume = 0;
  slopes(x, slope);
  for (int p = 0; p < 8; ++p) {
    double jacobian[3][3];
    for (int e = 0; e < 3; ++e) {
      for (int c = 0; c < 3; ++c) jacobian[e][c] = slope[c][e][edge_of(e, p)];
    }
    geometry[10 * p + 9] = invert(jacobian, geometry + 10 * p);
    volume += geometry[10 * p + 9];
  }
  return volume;
}

/// Row sums of the mass matrix over the density.
inline void node_volumes(const double* geometry, double* volumes) {
  for (int a = 0; a < 8; ++a) {
    volumes[a] = 0;
    for (int p = 0; p < 8; ++p) {
      double shape = geometry[10 * p + 9];
      for (int e = 0; e < 3; ++e) shape *= 0.5 * (1 + side(a, e) * sign(e, p) * gauss);
      volumes[a] += shape;
    }
  }
}

/// b[3 a + c] = 1 / V integral of d N_a / d x_c, from the points' geometry.
inline void mean_gradients(const double* geometry, double volume, double* b) {
  for (int i = 0; i < 24; ++i) b[i] = 0;
  for (int p = 0; p < 8; ++p) {
    for (int a = 0; a < 8; ++a) {
      for (int e = 0; e < 3; ++e) {
        double slope = 0.5 * side(a, e);
        for (const int d : {(e + 1) % 3, (e + 2) % 3}) slope *= 0.5 * (1 + side(a, d) * sign(d, p) * gauss);
        for (int c = 0; c < 3; ++c)
          b[3 * a + c] += geometry[10 * p + 9] / volume * slope * geometry[10 * p + 3 * e + c];
      }
    }
  }
}

/// Gradient of a nodal field at the points, as the trilinear shape functions give it.
template <class T>
struct Field {
  inline __attribute__((always_inline)) Field(const T* geometry, const T (*u)[3]) : g(geometry) { slopes(u, slope); }
  inline __attribute__((always_inline)) void gradient(int p, T (*h)[3]) const {
    T local[3][3];
    for (int c = 0; c < 3; ++c) {
      for (int e = 0; e < 3; ++e) local[c][e] = slope[c][e][edge_of(e, p)];
    }
    to_gradient(local, g + 10 * p, h);
  }
  const T* g;
  T slope[3][3][4];
};

/// The transpose of Field.
template <class T>
struct Forces {
  explicit inline __attribute__((always_inline)) Forces(const T* geometry) : g(geometry) {}
  inline __attribute__((always_inline)) void add(int p, const T (*stress)[3]) {
    T part[3][3];
    to_reference(stress, g + 10 * p, part);
    for (int c = 0; c < 3; ++c) {
      for (int e = 0; e < 3; ++e) flux[c][e][edge_of(e, p)] += part[c][e];
    }
  }
  inline __attribute__((always_inline)) void finish(T (*f)[3]) {
    for (int c = 0; c < 3; ++c) {
      for (int a = 0; a < 8; ++a) f[a][c] = T{};
      for (int e = 0; e < 3; ++e) {
        edges_to_points(flux[c][e]);
        for (int m = 0; m < 4; ++m) {
          f[edges[e][m][1]][c] += flux[c][e][m];
          f[edges[e][m][0]][c] -= flux[c][e][m];
        }
      }
    }
  }
  const T* g;
  T flux[3][3][4] = {};
};

}  // namespace hex8

template <bool mean_dilatation>
struct Hex8 {
  static constexpr const char* name = mean_dilatation ? "hex8_bbar" : "hex8";
  static constexpr int nodes = 8, points = 8;
  // per point: d xi_e / d x_c, then the volume it stands for; B-bar: then the mean gradients [3 a + c]
  static constexpr int geometry_size = mean_dilatation ? 104 : 80;
  static constexpr bool assumed_strain = mean_dilatation, stabilised = false;

  static double measure(const double (*x)[3], const Elastic&, double* geometry) {
    const double volume = hex8::measure_points(x, geometry);
    if constexpr (mean_dilatation) hex8::mean_gradients(geometry, volume, geometry + 80);
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
    inline __attribute__((always_inline)) Field(const T* geometry, const Elastic&, const T (*u)[3])
        : hex8::Field<T>(geometry, u) {
      if constexpr (mean_dilatation) {
        for (int a = 0; a < 8; ++a) {
          for (int c = 0; c < 3; ++c) mean += geometry[80 + 3 * a + c] * u[a][c];
        }
      }
    }
    inline __attribute__((always_inline)) void gradient(int p, T (*h)[3]) const {
      hex8::Field<T>::gradient(p, h);
      if constexpr (mean_dilatation) {
        const T change = (mean - (h[0][0] + h[1][1] + h[2][2])) * (1.0 / 3.0);
        for (int c = 0; c < 3; ++c) h[c][c] += change;
      }
    }
    T mean{};  // dilatation
  };

  template <class T, bool hooke>
  struct Forces : hex8::Forces<T> {
    inline __attribute__((always_inline)) Forces(const T* geometry, const Elastic&) : hex8::Forces<T>(geometry) {}
    inline __attribute__((always_inline)) void add(int p, const T (*stress)[3]) {
      if constexpr (splits) {
        const T third = (stress[0][0] + stress[1][1] + stress[2][2]) * (1.0 / 3.0);
        T deviator[3][3];
        for (int c = 0; c < 3; ++c) {
          for (int d = 0; d < 3; ++d) deviator[c][d] = stress[c][d];
          deviator[c][c] -= third;
        }
        pressure += third;
        hex8::Forces<T>::add(p, deviator);
      } else {
        hex8::Forces<T>::add(p, stress);
      }
    }
    inline __attribute__((always_inline)) void finish(T (*f)[3]) {
      hex8::Forces<T>::finish(f);
      if constexpr (splits) {
        for (int a = 0; a < 8; ++a) {
          for (int c = 0; c < 3; ++c) f[a][c] += pressure * this->g[80 + 3 * a + c];
        }
      }
    }
    // Hooke's mean stress is the same at every point already
    static constexpr bool splits = mean_dilatation && !hooke;
    T pressure{};  // sum of weight times mean stress
  };
};

}  // namespace fem
