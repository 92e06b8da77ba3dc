#pragma once
// (interface agreed; the implementation follows)
#include "base/vec3.hpp"

namespace dem::kernels {
using base::Vec3;

enum class Feature : int { none = 0, facet = 1, edge = 2, vertex = 3 };

/// Result of the contact-type hierarchy for one facet.
struct FacetContact {
  Feature feature = Feature::none;
  Vec3 point;          // [m] Pc
  double weights[4];   // shape functions of the facet's nodes at the point, sum 1; [3] = 0 for a triangle
};

/// Closest point of a triangle (count 3) or quadrilateral (count 4) to a sphere centre, if nearer than `reach`.
TRACKBED_HD FacetContact closest_on_facet(const Vec3* nodes, int count, const Vec3& centre, double reach);

/// Distance hierarchy (Table 4.3): marks in `keep` which of n contact vectors (centre - point) stay.
TRACKBED_HD void distance_hierarchy(const Vec3* contact_vectors, int n, bool* keep);
}  // namespace dem::kernels
