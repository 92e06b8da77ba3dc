#pragma once
// The surface that a deformable body shows to the grains: what fem hands out and dem takes in.
// Nodes are numbered 0 … node_count-1 within the skin; facets list 3 (triangle) or 4 (quadrilateral) of them,
// counter-clockwise seen from outside the body (so the normal points towards the grains).
// A face of the second order (triangle of six nodes, quadrilateral of eight: base/face.hpp) is cut into plane facets
// through its nodes. They only find what is near: the contact lies on the face itself, and its shape functions carry
// force and motion.
#include <array>
#include <string>
#include <vector>

#include "base/vec3.hpp"

namespace base {

struct Skin {
  std::string body;                        // name of the body it belongs to
  std::vector<Vec3> nodes;                 // [m] reference positions
  std::vector<std::array<int, 4>> facets;  // skin node numbers; [3] = -1 for a triangle
  // Of the second order only; both empty where no face is.
  std::vector<std::array<int, 8>> faces = {};  // skin node numbers as in base/face.hpp; [6] = [7] = -1 for a triangle
  std::vector<int> face_of = {};               // per facet: the face that it is a part of; -1: a face of its own
};

}  // namespace base
