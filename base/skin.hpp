#pragma once
// The surface that a deformable body shows to the grains: what fem hands out and dem takes in.
// Nodes are numbered 0 … node_count-1 within the skin; facets list 3 (triangle) or 4 (quadrilateral) of them,
// counter-clockwise seen from outside the body (so the normal points towards the grains).
#include <array>
#include <string>
#include <vector>

#include "base/vec3.hpp"

namespace base {

struct Skin {
  std::string body;                        // name of the body it belongs to
  std::vector<Vec3> nodes;                 // [m] reference positions
  std::vector<std::array<int, 4>> facets;  // skin node numbers; [3] = -1 for a triangle
};

}  // namespace base
