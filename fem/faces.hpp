#pragma once
// Integrals over facets of a mesh, and facets of the second order cut into plane ones.
#include <vector>

#include "fem/mesh.hpp"

namespace fem {

struct FaceNode {
  int node;
  double area;  // [m2] integral of the shape function: a uniform traction's share; may be <= 0 at corners with middles
  Vec3 normal;  // [m2] the same times the outward normal
  double lumped;  // [m2] positive share of the area, in proportion to the integral of the shape function's square
};

/// The nodes of a facet with their shares, by 3 x 3 Gauss points.
std::vector<FaceNode> integrate(const Mesh&, const Facet&);

/// Triangles and quadrilaterals ([3] = -1 for a triangle) through the nodes of a facet: itself, or with middles four
/// triangles, or a quadrilateral of the middles and four triangles. Grains look for the facet by them.
std::vector<std::array<int, 4>> plane_parts(const Facet&);

}  // namespace fem
