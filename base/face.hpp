#pragma once
// Shape functions of the faces of solid elements, for loads over a face (fem) and for contacts on it (dem).
//   Triangles of 3 or 6 nodes: r, s >= 0, r + s <= 1; corners (0,0) (1,0) (0,1), then the middles of the sides
//     0-1, 1-2, 2-0. Corner l (2 l - 1), middle 4 l_a l_b with l = 1 - r - s, r, s.
//   Quadrilaterals of 4 or 8 nodes: r, s in [-1, 1]; corners (-1,-1) (1,-1) (1,1) (-1,1), then the middles of the sides
//     0-1, 1-2, 2-3, 3-0. Serendipity: corner (1 + r_a r)(1 + s_a s)(r_a r + s_a s - 1)/4, middle
//     (1 - r^2)(1 + s_a s)/2 or (1 + r_a r)(1 - s^2)/2.
// Source: Zienkiewicz & Taylor, The Finite Element Method, vol. 1, ch. 8 (the faces of hex20 and tet10 are these).
#include "base/vec3.hpp"

namespace base {

struct FaceShapes {
  double value[8] = {}, along_r[8] = {}, along_s[8] = {};
};

namespace detail {

TRACKBED_HD inline FaceShapes triangle_shapes(double r, double s, bool middles) {
  const double l[3] = {1 - r - s, r, s}, lr[3] = {-1, 1, 0}, ls[3] = {-1, 0, 1};
  FaceShapes n;
  for (int a = 0; a < 3; ++a) {
    const int b = (a + 1) % 3;
    n.value[a] = middles ? l[a] * (2 * l[a] - 1) : l[a];
    n.along_r[a] = middles ? (4 * l[a] - 1) * lr[a] : lr[a];
    n.along_s[a] = middles ? (4 * l[a] - 1) * ls[a] : ls[a];
    if (!middles) continue;
    n.value[3 + a] = 4 * l[a] * l[b];
    n.along_r[3 + a] = 4 * (l[a] * lr[b] + l[b] * lr[a]);
    n.along_s[3 + a] = 4 * (l[a] * ls[b] + l[b] * ls[a]);
  }
  return n;
}

TRACKBED_HD inline FaceShapes quadrilateral_shapes(double r, double s, bool middles) {
  const double at_r[8] = {-1, 1, 1, -1, 0, 1, 0, -1}, at_s[8] = {-1, -1, 1, 1, -1, 0, 1, 0};
  FaceShapes n;
  for (int a = 0; a < (middles ? 8 : 4); ++a) {
    const bool flat_r = at_r[a] == 0, flat_s = at_s[a] == 0;
    const double f = flat_r ? 1 - r * r : 1 + at_r[a] * r, df = flat_r ? -2 * r : at_r[a];
    const double h = flat_s ? 1 - s * s : 1 + at_s[a] * s, dh = flat_s ? -2 * s : at_s[a];
    if (flat_r || flat_s) {
      n.value[a] = 0.5 * f * h;
      n.along_r[a] = 0.5 * df * h;
      n.along_s[a] = 0.5 * f * dh;
    } else if (middles) {
      const double last = at_r[a] * r + at_s[a] * s - 1;
      n.value[a] = 0.25 * f * h * last;
      n.along_r[a] = 0.25 * h * (df * last + f * at_r[a]);
      n.along_s[a] = 0.25 * f * (dh * last + h * at_s[a]);
    } else {
      n.value[a] = 0.25 * f * h;
      n.along_r[a] = 0.25 * df * h;
      n.along_s[a] = 0.25 * f * dh;
    }
  }
  return n;
}

}  // namespace detail

/// Values and derivatives at (r, s), zero beyond the nodes that the face has: 3, 4, 6 or 8.
TRACKBED_HD inline FaceShapes face_shapes(int nodes, double r, double s) {
  return nodes % 3 == 0 ? detail::triangle_shapes(r, s, nodes == 6) : detail::quadrilateral_shapes(r, s, nodes == 8);
}

}  // namespace base
