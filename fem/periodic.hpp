#pragma once
// Periodic faces: two surfaces of a body, one a shift away from the other, are taken as one; what leaves at the first
// comes in at the second. Opposite nodes share one unknown, u(x + shift) = u(x), so their forces and masses add up in
// the one equation; no element knows of it. Several pairs of faces may meet: edges and corners then share one unknown.
// The rigid motions left are the translations, and the rotation about the shift where there is one pair.
// A skin goes on by one facet beyond either face, on the unknowns of the other: grains that cross there keep it.
// The shift is that between the smallest corners of the faces' bounding boxes. Nodes are partners within 1e-6 of the
// larger of shift and face; the mesh must put them there.
#include <vector>

#include "fem/mesh.hpp"

namespace fem {

/// Per node of the mesh the smallest node with which it shares its unknowns; empty where the body has no such faces.
/// Throws base::UserError.
std::vector<int> tie_periodic_faces(const Mesh&, const Body&);

/// The way [m] from the first face to the second.
Vec3 shift_of(const Mesh&, const Body&, const PeriodicFaces&);

}  // namespace fem
