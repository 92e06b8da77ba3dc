#pragma once
// Facets as grains meet them: the nearest point, and the nodes that share a contact. A facet that is a part of a face
// of the second order (base/skin.hpp) only finds that face, which is then touched itself (kernels/face_geometry.hpp).
#include "dem/core/rows.hpp"
#include "dem/kernels/face_geometry.hpp"
#include "dem/laws.hpp"

namespace dem::TRACKBED_DEM_SYSTEM {

struct WallGeometry {
  const Facet* facet;
  const WallRow* wall;
  const Vec3* position;  // of the nodes
  const FacePart* part;  // per facet; null: no face of the second order
  const Face* face;

  TRACKBED_HD bool is_part(int f) const { return part && part[f].face >= 0; }
  TRACKBED_HD int places(const Face& on, Vec3* nodes) const {
    const int number = on.nodes();
    for (int k = 0; k < number; ++k) nodes[k] = position[on.node[k]];
    return number;
  }
  /// How far a facet's face can be from it [m].
  TRACKBED_HD double margin(int f) const {
    if (!is_part(f)) return 0;
    Vec3 nodes[8];
    const int number = places(face[part[f].face], nodes);
    return kernels::departure(nodes, number);
  }

  /// Nearest point of a facet, if nearer than `reach` and on the side that the wall works on. Where the facet is a part
  /// of a face: of the face, and the weights are its coordinates r, s there and the corners (their numbers in the face)
  /// between which the point lies, -1 for none.
  TRACKBED_ONE_FUNCTION TRACKBED_HD kernels::FacetContact nearest(int f, const Vec3& centre, double reach) const {
    const Facet& t = facet[f];
    const WallRow& w = wall[t.wall];
    kernels::FacetContact contact;
    if (t.node[1] < 0) {
      const double height = dot(centre - position[t.node[0]], w.plane_normal);
      if (height >= reach) return contact;
      contact.feature = kernels::Feature::facet;
      contact.point = centre - height * w.plane_normal;
      contact.weights[0] = 1;
      return contact;
    }
    const int count = t.node[3] < 0 ? 3 : 4;
    Vec3 corners[4];
    for (int k = 0; k < count; ++k) corners[k] = position[t.node[k]];
    if (is_part(f)) return nearest_on_face(part[f], corners, count, centre, reach, w.two_sided);
    contact = kernels::closest_on_facet(corners, count, centre, reach);
    if (contact.feature != kernels::Feature::none && !w.two_sided) {
      const Vec3 outward =
          cross(corners[count == 3 ? 1 : 2] - corners[0], corners[count - 1] - corners[count == 3 ? 0 : 1]);
      if (dot(centre - contact.point, outward) < 0) contact.feature = kernels::Feature::none;
    }
    return contact;
  }

  TRACKBED_HD kernels::FacetContact nearest_on_face(const FacePart& of, const Vec3* corners, int count,
                                                    const Vec3& centre, double reach, int two_sided) const {
    Vec3 nodes[8];
    const int number = places(face[of.face], nodes);
    auto contact = kernels::closest_on_facet(corners, count, centre, reach + kernels::departure(nodes, number));
    if (contact.feature == kernels::Feature::none) return contact;
    double r = 0, s = 0;
    for (int k = 0; k < count; ++k) {
      double corner_r, corner_s;
      kernels::coordinates_of(number, of.corner[k], corner_r, corner_s);
      r += contact.weights[k] * corner_r;
      s += contact.weights[k] * corner_s;
    }
    const auto there = kernels::closest_on_face(nodes, number, centre, reach, r, s);
    contact.feature = there.feature;
    contact.point = there.point;
    contact.weights[0] = there.r;
    contact.weights[1] = there.s;
    contact.weights[2] = there.from;
    contact.weights[3] = there.to;
    if (!two_sided && dot(centre - there.point, there.outward) < 0) contact.feature = kernels::Feature::none;
    return contact;
  }
};

/// The nodes that share a contact on a facet, and their shares: shape functions of the facet or of its face.
struct Carriers {
  const int* node;
  const double* share;
  int number = 4;
  double of_face[8];

  TRACKBED_HD Carriers(const WallGeometry& geometry, int f, const double* weights)
      : node(geometry.facet[f].node), share(weights) {
    if (!geometry.is_part(f)) return;
    const Face& face = geometry.face[geometry.part[f].face];
    const base::FaceShapes shapes = base::face_shapes(face.nodes(), weights[0], weights[1]);
    for (int k = 0; k < 8; ++k) of_face[k] = shapes.value[k];
    node = face.node;
    share = of_face;
    number = face.nodes();
  }
  Carriers(const Carriers&) = delete;
};

}  // namespace dem::TRACKBED_DEM_SYSTEM
