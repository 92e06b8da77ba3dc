#pragma once
// Where a sphere touches a wall made of triangles and quadrilaterals: the Double Hierarchy.
//   Contact-type hierarchy: facet before edge before vertex, one contact point with nodal weights per facet.
//   Distance hierarchy: of the contact vectors V = C - P that one sphere finds, V_i is redundant when another V_j hides
//   it, V_i . V_j / |V_j| >= |V_j|.
// Source: Irazabal Gonzalez 2017 (PhD thesis, UPC Barcelona), sections 4.3.1 (eqs. 4.2-4.18), 4.3.2 (eq. 4.19,
// Table 4.3).
//
// Where we differ from the source, and why:
// - One contact per facet. Table 4.2 lets a facet offer several edges. A planar facet is convex, its nearest point P0
// is
//   unique, and every other point P of it has (P - P0) . V0 <= 0, that is V . V0 / |V0| >= |V0|: the distance hierarchy
//   would discard it. Asking for the nearest point at once gives the same contacts.
// - Quadrilaterals: nearest point of the bilinear surface x = sum N_i(xi, eta) x_i by Newton's method, weights N_i. For
// a
//   planar quadrilateral this is the projection 4.5 (one iteration for a parallelogram). The areas of 4.10 are not
//   bilinear weights, and a skin that deforms is warped: there only P = sum N_i x_i passes the moment of a force to the
//   nodes exactly.
// - Table 4.3 depends on the order of the facets (a vector that is discarded later may have discarded others before).
// Here V_i
//   goes when any nearer V_j hides it, discarded or not: a point on a facet that has a nearer point is no place where
//   the sphere rests. The result does not depend on the order, except that of two equal vectors the first stays.
// - The tolerance that 4.4.2 mentions without a value is `hidden_tolerance`.
//
// Limits: at a concave fold of more than 0.8 degrees the second facet comes in with the overlap it already has (4.4.2).
// A quadrilateral warped so much that a sphere touches it twice gives the nearest of the two contacts.
#include "base/vec3.hpp"

namespace dem::kernels {
using base::Vec3;

enum class Feature : int { none = 0, facet = 1, edge = 2, vertex = 3 };

/// Result of the contact-type hierarchy for one facet.
struct FacetContact {
  Feature feature = Feature::none;
  Vec3 point;                        // [m] Pc
  double weights[4] = {0, 0, 0, 0};  // shape functions of the facet's nodes at the point, sum 1; [3] = 0 for a triangle
};

/// Share of a length by which a projection may fall short and still hide a vector. Two facets at a concave fold of
/// angle alpha and equal distance see cos(alpha): 1e-4 merges folds up to 0.81 degrees, which is more than the skin of
/// a loaded formation takes between neighbours (slopes of 1e-3), at the price of a force direction that may jump by
/// such an angle; counting both would double the force. Rounding needs only 1e-12 or so.
inline constexpr double hidden_tolerance = 1e-4;

namespace detail {

TRACKBED_HD inline bool lexicographically_less(const Vec3& a, const Vec3& b) {
  return a.x < b.x || (a.x == b.x && (a.y < b.y || (a.y == b.y && a.z < b.z)));
}

/// Nearest point of the edge from node a to node b (eqs. 4.12-4.17); replaces `best` if nearer than `best_distance2`.
/// Always walked from the lesser end, so that two facets find their shared edge's point to the last bit.
TRACKBED_HD inline void try_edge(const Vec3* nodes, int a, int b, const Vec3& centre, FacetContact& best,
                                 double& best_distance2) {
  if (lexicographically_less(nodes[b], nodes[a])) {
    const int swap = a;
    a = b;
    b = swap;
  }
  const Vec3 edge = nodes[b] - nodes[a];
  const double length2 = norm2(edge), along = dot(centre - nodes[a], edge);
  FacetContact contact;
  if (along <= 0 || length2 <= 0) {
    contact.feature = Feature::vertex;
    contact.point = nodes[a];
    contact.weights[a] = 1;
  } else if (along >= length2) {
    contact.feature = Feature::vertex;
    contact.point = nodes[b];
    contact.weights[b] = 1;
  } else {
    const double eta = along / length2;
    contact.feature = Feature::edge;
    contact.point = nodes[a] + eta * edge;
    contact.weights[a] = 1 - eta;
    contact.weights[b] = eta;
  }
  const double distance2 = norm2(centre - contact.point);
  if (distance2 < best_distance2) {
    best = contact;
    best_distance2 = distance2;
  }
}

/// Eqs. 4.2-4.9. An edge that has the projection of the centre on its inner side cannot hold the nearest point.
TRACKBED_HD inline void closest_on_triangle(const Vec3* nodes, const Vec3& centre, FacetContact& best,
                                            double& best_distance2) {
  const Vec3 normal = cross(nodes[1] - nodes[0], nodes[2] - nodes[1]);
  double side[3];
  for (int a = 0; a < 3; ++a) side[a] = dot(cross(nodes[(a + 1) % 3] - nodes[a], centre - nodes[a]), normal);
  const double sum = side[0] + side[1] + side[2];
  if (side[0] >= 0 && side[1] >= 0 && side[2] >= 0 && sum > 0) {
    FacetContact contact;
    contact.feature = Feature::facet;
    for (int i = 0; i < 3; ++i) {
      contact.weights[i] = side[(i + 1) % 3] / sum;
      contact.point += contact.weights[i] * nodes[i];
    }
    const double distance2 = norm2(centre - contact.point);
    if (distance2 < best_distance2) {
      best = contact;
      best_distance2 = distance2;
    }
    return;
  }
  for (int a = 0; a < 3; ++a)
    if (side[a] < 0 || !(sum > 0)) try_edge(nodes, a, (a + 1) % 3, centre, best, best_distance2);
}

/// x = c0 + xi c1 + eta c2 + xi eta c3 on [-1, 1]^2, seen from a sphere's centre.
struct Bilinear {
  Vec3 c0, c1, c2, c3;

  TRACKBED_HD Bilinear(const Vec3* nodes, const Vec3& centre)
      : c0(0.25 * (nodes[0] + nodes[1] + nodes[2] + nodes[3]) - centre),
        c1(0.25 * (nodes[1] + nodes[2] - nodes[0] - nodes[3])),
        c2(0.25 * (nodes[2] + nodes[3] - nodes[0] - nodes[1])),
        c3(0.25 * (nodes[0] + nodes[2] - nodes[1] - nodes[3])) {}

  /// Iterates on x . x_xi = x . x_eta = 0 from the middle: by Newton's method, or (`full` false, or where the Hessian
  /// is not positive definite) by Gauss-Newton. True when the nearest point lies inside.
  TRACKBED_HD bool search(bool full, double& xi, double& eta) const {
    const double far = 2;  // beyond this in xi or eta the search goes on at the border: the nearest point is on an edge
    xi = eta = 0;
    for (int iteration = 0; iteration < 20; ++iteration) {
      const Vec3 r = c0 + xi * c1 + eta * c2 + (xi * eta) * c3;
      const Vec3 x_xi = c1 + eta * c3, x_eta = c2 + xi * c3;
      const double g1 = dot(r, x_xi), g2 = dot(r, x_eta);
      const double h11 = norm2(x_xi), h22 = norm2(x_eta), gauss = dot(x_xi, x_eta);
      double h12 = full ? gauss + dot(r, c3) : gauss;
      double determinant = h11 * h22 - h12 * h12;
      if (determinant <= 1e-3 * h11 * h22) {
        h12 = gauss;
        determinant = h11 * h22 - h12 * h12;
      }
      if (!(determinant > 0)) return false;
      const double d_xi = (h12 * g2 - h22 * g1) / determinant, d_eta = (h12 * g1 - h11 * g2) / determinant;
      xi = std::fmin(far, std::fmax(-far, xi + d_xi));
      eta = std::fmin(far, std::fmax(-far, eta + d_eta));
      const bool converged = std::fabs(d_xi) + std::fabs(d_eta) < 1e-9;  // quadratic: the next step would be 1e-18
      if (converged || norm2(c3) == 0) return std::fabs(xi) <= 1 && std::fabs(eta) <= 1;
    }
    return false;
  }

  /// True when the nearest point lies inside. Far from a parallelogram Newton's method may miss it or find another
  /// stationary point; Gauss-Newton, which inverts the map where the quadrilateral is planar, then decides.
  TRACKBED_HD bool project(double& xi, double& eta) const {
    if (search(true, xi, eta)) return true;
    return norm2(c3) > 1e-4 * std::fmin(norm2(c1), norm2(c2)) && search(false, xi, eta);
  }
};

TRACKBED_HD inline void closest_on_quadrilateral(const Vec3* nodes, const Vec3& centre, FacetContact& best,
                                                 double& best_distance2) {
  double xi, eta;
  if (Bilinear(nodes, centre).project(xi, eta)) {
    FacetContact contact;
    contact.feature = Feature::facet;
    for (int i = 0; i < 4; ++i) {
      const double sign_xi = i == 1 || i == 2 ? 1 : -1, sign_eta = i >= 2 ? 1 : -1;
      contact.weights[i] = 0.25 * (1 + sign_xi * xi) * (1 + sign_eta * eta);
      contact.point += contact.weights[i] * nodes[i];
    }
    const double distance2 = norm2(centre - contact.point);
    if (distance2 < best_distance2) {
      best = contact;
      best_distance2 = distance2;
    }
    return;
  }
  for (int a = 0; a < 4; ++a) try_edge(nodes, a, (a + 1) % 4, centre, best, best_distance2);
}

/// True when the box around the facet is `reach` or more away from the centre along one axis.
TRACKBED_HD inline bool out_of_box(const Vec3* nodes, int count, const Vec3& centre, double reach) {
  Vec3 low = nodes[0], high = nodes[0];
  for (int i = 1; i < count; ++i) {
    low = {std::fmin(low.x, nodes[i].x), std::fmin(low.y, nodes[i].y), std::fmin(low.z, nodes[i].z)};
    high = {std::fmax(high.x, nodes[i].x), std::fmax(high.y, nodes[i].y), std::fmax(high.z, nodes[i].z)};
  }
  return centre.x - high.x >= reach || centre.y - high.y >= reach || centre.z - high.z >= reach ||
         low.x - centre.x >= reach || low.y - centre.y >= reach || low.z - centre.z >= reach;
}

}  // namespace detail

/// Nearest point of a triangle (count 3) or quadrilateral (count 4) to a sphere centre, if nearer than `reach`
/// (the sphere's radius); Feature::none otherwise. `nodes` go round the facet; it is touched from either side.
TRACKBED_HD inline FacetContact closest_on_facet(const Vec3* nodes, int count, const Vec3& centre, double reach) {
  FacetContact best;
  if (detail::out_of_box(nodes, count, centre, reach)) return best;
  double distance2 = reach * reach;
  if (count == 3)
    detail::closest_on_triangle(nodes, centre, best, distance2);
  else
    detail::closest_on_quadrilateral(nodes, centre, best, distance2);
  return best;
}

/// Whether contact vector V = C - P of one sphere and one wall is hidden by another; `other_is_first`: it stands before
/// this one.
TRACKBED_HD inline bool is_hidden(const Vec3& vector, const Vec3& by, bool other_is_first) {
  const double own = norm2(vector), other = norm2(by);
  const bool nearer = other < own || (other == own && other_is_first);
  return nearer && dot(vector, by) >= (1 - hidden_tolerance) * other;
}
/// Marks in `keep` which of the n contact vectors stay.
TRACKBED_HD inline void distance_hierarchy(const Vec3* contact_vectors, int n, bool* keep) {
  for (int i = 0; i < n; ++i) {
    keep[i] = true;
    for (int j = 0; j < n && keep[i]; ++j) keep[i] = !is_hidden(contact_vectors[i], contact_vectors[j], j < i);
  }
}

}  // namespace dem::kernels
