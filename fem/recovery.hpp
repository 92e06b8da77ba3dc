#pragma once
// Stress at a node from the elements around it: the patch recovery of Zienkiewicz & Zhu (1992, DOI
// 10.1002/nme.1620330702), with a linear field through the elements' mean stresses at their centres.
//   sigma(x) = sum_e w_e sigma_e,  w_e = 1/n (1 + d_e . (1/n sum d d^T)^+ (x - c)),  d_e = x_e - c
// over n elements of one material with centres x_e, c their mean: the least-squares fit, level in the directions in
// which the patch says nothing. It is exact for a stress that is linear in space, on the surface too, where the mean of
// the elements around a node is that of half a layer below. The patch grows by a ring as long as that tells the slope
// in another direction; in bodies of one layer it stays level across. At a boundary between materials: the stress of
// the one that the mesh lists first. In bending the stress of tet4 alternates between neighbours (by up to the
// change over a cell): there it is a percent off on ten cells over the height, with tet10 and hexahedra it is not.
#include <vector>

#include "fem/mesh.hpp"

namespace fem {

struct Recovery {
  std::vector<int> elements;    // of the mesh
  std::vector<double> weights;  // of their mean stresses; they sum to 1
};

Recovery recovery_at(const Mesh&, int node);
/// The mean over the area of facets of the field that the shape functions make of the nodes' values.
Recovery recovery_over(const Mesh&, const std::vector<Facet>&);

}  // namespace fem
