#pragma once
// Where a sphere touches a face of the second order, and what the face's nodes receive: the coupling of grains with
// solids of hex20 and tet10 elements (Li2021 2.3, DOI 10.32604/cmes.2021.013674 gives it for the faces of hex20).
//   Nearest point of x(r, s) = sum N_a(r, s) x_a to the centre C: (x - C) . x_r = (x - C) . x_s = 0 by Newton's method,
//   or on the sides, curved edges of three nodes; f_a = N_a f, velocity sum N_a v_a.
// The plane parts of a face (fem/faces.hpp) find what is near and where the search starts. With the contact point on
// the face itself, force and moment arrive whole (sum f_a = f, sum x_a x f_a = x x f), the overlap changes at the very
// rate at which force meets the nodes' motion (the interface neither makes nor loses energy), and normals do not jump
// between the parts of a face.
//
// Where we differ from the source, and why: Li2021 takes area coordinates (Soh, Long & Cen 2000, DOI
// 10.1007/s004660050484) to do without Newton's method. Functions of area coordinates are polynomials in Cartesian
// coordinates; the element's own shape functions are not, unless the face is a parallelogram with its middles in the
// middle. On a distorted face they are other functions: they hand the nodes other shares of the force than that point
// of the solid has of their motion, which makes or loses energy, and need not agree with the neighbour's on the common
// side. With the eight serendipity monomials of area coordinates a share is wrong by up to 0.62 on a trapezoid with
// sides 2 : 1 and by 0.11 on a square with a side bowed by a tenth (tests/unit/dem_face_geometry.cpp); the shares found
// by Newton's method are exact to 1e-12. It starts at the part's point, near the answer.
//
// Between faces the distance hierarchy (wall_geometry.hpp) decides as between facets. It takes facets for plane; a skin
// that is hollow rises above the plane in which a sphere touches one face, and the nearest point of the next face, on
// their common side, is not hidden. It counts as redundant because the first face has it too, and a nearer one.
//
// Limits: of several nearest points, on a face bent so much that a sphere touches it twice, one is found.
#include "base/face.hpp"
#include "dem/kernels/wall_geometry.hpp"

namespace dem::kernels {

/// Place of node a of a face (6 or 8 nodes) in its coordinates.
TRACKBED_HD inline void coordinates_of(int nodes, int a, double& r, double& s) {
  if (nodes == 6) {
    r = a == 1 ? 1 : (a == 3 || a == 4 ? 0.5 : 0);
    s = a == 2 ? 1 : (a == 4 || a == 5 ? 0.5 : 0);
  } else {
    r = a == 4 || a == 6 ? 0 : (a == 1 || a == 2 || a == 5 ? 1 : -1);
    s = a == 5 || a == 7 ? 0 : (a == 2 || a == 3 || a == 6 ? 1 : -1);
  }
}

/// How far the face can be from its plane parts [m]: |x - x_part| at the same coordinates, from above. With d_a the way
/// from the middle between two corners to the node between them, x = (bi)linear of the corners + sum M_a d_a. What the
/// parts miss of a middle's function M_a is 1/4 at most, and of r s (times t, the warp of the corners) 1/4.
TRACKBED_HD inline double departure(const Vec3* x, int nodes) {
  const int corners = nodes / 2;
  double sum = 0;
  for (int a = 0; a < corners; ++a) sum += norm(x[corners + a] - 0.5 * (x[a] + x[(a + 1) % corners]));
  if (nodes == 8) sum += 0.25 * norm(x[0] - x[1] + x[2] - x[3]);
  return 0.25 * sum;
}

struct FaceContact {
  Feature feature = Feature::none;
  Vec3 point;              // [m]
  double r = 0, s = 0;     // of the point
  int from = -1, to = -1;  // corners between which it lies, one twice at a vertex; -1: within the face
  Vec3 outward;            // x_r × x_s there
};

namespace detail {

/// The face as a polynomial, seen from a sphere's centre: both kinds are made of these monomials.
struct FaceSurface {
  Vec3 c, r, s, rs, rr, ss, rrs, rss;

  TRACKBED_HD FaceSurface(const Vec3* x, int nodes, const Vec3& centre) {
    const int corners = nodes / 2;
    Vec3 d[4];
    for (int a = 0; a < corners; ++a) d[a] = x[corners + a] - 0.5 * (x[a] + x[(a + 1) % corners]);
    if (nodes == 6) {
      c = x[0] - centre;
      r = x[1] - x[0] + 4 * d[0];
      s = x[2] - x[0] + 4 * d[2];
      rs = 4 * (d[1] - d[0] - d[2]);
      rr = -4 * d[0];
      ss = -4 * d[2];
    } else {
      c = 0.25 * (x[0] + x[1] + x[2] + x[3]) + 0.5 * (d[0] + d[1] + d[2] + d[3]) - centre;
      r = 0.25 * (x[1] + x[2] - x[0] - x[3]) + 0.5 * (d[1] - d[3]);
      s = 0.25 * (x[2] + x[3] - x[0] - x[1]) + 0.5 * (d[2] - d[0]);
      rs = 0.25 * (x[0] + x[2] - x[1] - x[3]);
      rr = -0.5 * (d[0] + d[2]);
      ss = -0.5 * (d[1] + d[3]);
      rrs = 0.5 * (d[0] - d[2]);
      rss = 0.5 * (d[3] - d[1]);
    }
  }
  TRACKBED_HD Vec3 at(double u, double v) const {
    return c + u * (r + v * rs + u * (rr + v * rrs)) + v * (s + v * (ss + u * rss));
  }
  TRACKBED_HD Vec3 along_r(double u, double v) const { return r + v * (rs + v * rss) + (2 * u) * (rr + v * rrs); }
  TRACKBED_HD Vec3 along_s(double u, double v) const { return s + u * (rs + u * rrs) + (2 * v) * (ss + u * rss); }

  /// From (u, v), by Newton's method, or (`full` false, or where the Hessian is not positive definite) by Gauss-Newton.
  /// True when it converges.
  TRACKBED_HD bool search(bool full, double& u, double& v) const {
    const double longest = 0.5;  // step
    const double far = 1.5;      // beyond this the nearest point is on a side
    for (int iteration = 0; iteration < 20; ++iteration) {
      const Vec3 x = at(u, v), x_r = along_r(u, v), x_s = along_s(u, v);
      const double g1 = dot(x, x_r), g2 = dot(x, x_s);
      double h11 = norm2(x_r), h22 = norm2(x_s), h12 = dot(x_r, x_s);
      const double f11 = h11 + 2 * dot(x, rr + v * rrs), f22 = h22 + 2 * dot(x, ss + u * rss);
      const double f12 = h12 + dot(x, rs + (2 * u) * rrs + (2 * v) * rss);
      if (full && f11 > 0 && f11 * f22 - f12 * f12 > 1e-3 * h11 * h22) {
        h11 = f11;
        h22 = f22;
        h12 = f12;
      }
      const double determinant = h11 * h22 - h12 * h12;
      if (!(determinant > 0)) return false;
      const double du = (h12 * g2 - h22 * g1) / determinant, dv = (h12 * g1 - h11 * g2) / determinant;
      u = std::fmin(far, std::fmax(-far, u + std::fmin(longest, std::fmax(-longest, du))));
      v = std::fmin(far, std::fmax(-far, v + std::fmin(longest, std::fmax(-longest, dv))));
      if (std::fabs(du) + std::fabs(dv) < 1e-9) return true;  // quadratic: the next step would be 1e-18
    }
    return false;
  }
};

TRACKBED_HD inline bool inside_face(int nodes, double r, double s) {
  if (nodes == 6) return r >= 0 && s >= 0 && r + s <= 1;
  return std::fabs(r) <= 1 && std::fabs(s) <= 1;
}

/// Nearest point of the side from corner a to corner b, x = a + t (b - a) + 4 t (1 - t) d. Always walked from the
/// lesser end, so that two faces find their common side's point to the last bit.
TRACKBED_HD inline void try_side(const Vec3* x, int nodes, int a, const Vec3& centre, FaceContact& best,
                                 double& best_distance2) {
  const int corners = nodes / 2;
  int from = a, to = (a + 1) % corners;
  if (lexicographically_less(x[to], x[from])) {
    const int swap = from;
    from = to;
    to = swap;
  }
  const Vec3 start = x[from] - centre, way = x[to] - x[from], d = x[corners + a] - 0.5 * (x[from] + x[to]);
  const double length2 = norm2(way);
  double t = length2 > 0 ? std::fmin(1.0, std::fmax(0.0, -dot(start, way) / length2)) : 0;
  for (int iteration = 0; iteration < 20 && norm2(d) > 0; ++iteration) {
    const Vec3 here = start + t * way + (4 * t * (1 - t)) * d, slope = way + (4 - 8 * t) * d;
    const double gauss = norm2(slope), full = gauss - 8 * dot(here, d);
    const double step = -dot(here, slope) / (full > 1e-3 * gauss ? full : gauss);
    if (!(std::fabs(step) >= 1e-9)) break;
    const double next = std::fmin(1.0, std::fmax(0.0, t + step));
    if (next == t) break;
    t = next;
  }
  const Vec3 point = start + t * way + (4 * t * (1 - t)) * d;
  const double distance2 = norm2(point);
  if (!(distance2 < best_distance2)) return;
  best_distance2 = distance2;
  best.feature = t > 0 && t < 1 ? Feature::edge : Feature::vertex;
  best.point = t <= 0 ? x[from] : (t >= 1 ? x[to] : centre + point);
  best.from = t >= 1 ? to : from;
  best.to = t <= 0 ? from : to;
  double from_r, from_s, to_r, to_s;
  coordinates_of(nodes, from, from_r, from_s);
  coordinates_of(nodes, to, to_r, to_s);
  best.r = from_r + t * (to_r - from_r);
  best.s = from_s + t * (to_s - from_s);
}

}  // namespace detail

/// Nearest point of a face of 6 or 8 nodes to a sphere's centre, if nearer than `reach`; Feature::none otherwise. The
/// search starts at (r, s).
TRACKBED_HD inline FaceContact closest_on_face(const Vec3* x, int nodes, const Vec3& centre, double reach, double r,
                                               double s) {
  const detail::FaceSurface surface(x, nodes, centre);
  FaceContact best;
  double distance2 = reach * reach;
  double u = r, v = s;
  bool converged = surface.search(true, u, v);
  if (!converged) {
    u = r;
    v = s;
    converged = surface.search(false, u, v);
  }
  const bool found = converged && detail::inside_face(nodes, u, v);
  if (found) {
    const base::FaceShapes shapes = base::face_shapes(nodes, u, v);
    Vec3 point;
    for (int a = 0; a < nodes; ++a) point += shapes.value[a] * x[a];
    if (norm2(centre - point) < distance2) {
      best.feature = Feature::facet;
      best.point = point;
      best.r = u;
      best.s = v;
    }
  } else {
    for (int a = 0; a < nodes / 2; ++a) detail::try_side(x, nodes, a, centre, best, distance2);
  }
  best.outward = cross(surface.along_r(best.r, best.s), surface.along_s(best.r, best.s));
  return best;
}

}  // namespace dem::kernels
