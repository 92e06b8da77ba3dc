#include "fem/faces.hpp"

#include <cmath>

#include "base/face.hpp"

namespace fem {
std::vector<FaceNode> integrate(const Mesh& mesh, const Facet& facet) {
  constexpr double at[3] = {-0.77459666924148337704, 0, 0.77459666924148337704};
  constexpr double share[3] = {5.0 / 9.0, 8.0 / 9.0, 5.0 / 9.0};
  const int corners = corners_of(facet);
  const bool middles = has_middles(facet);
  std::vector<FaceNode> nodes;
  for (int a = 0; a < corners * (middles ? 2 : 1); ++a)
    nodes.push_back({facet[a < corners ? a : 4 + a - corners], 0, {}, 0});
  double area = 0, squares = 0;
  for (int p = 0; p < 9; ++p) {
    double r = at[p % 3], s = at[p / 3], weight = share[p % 3] * share[p / 3];
    if (corners == 3) {  // the square collapsed onto the triangle
      r = 0.5 * (1 + r);
      s = 0.5 * (1 + s) * (1 - r);
      weight *= 0.25 * (1 - r);
    }
    const auto shapes = base::face_shapes(static_cast<int>(nodes.size()), r, s);
    Vec3 along_r, along_s;
    for (std::size_t a = 0; a < nodes.size(); ++a) {
      along_r += mesh.nodes[nodes[a].node] * shapes.along_r[a];
      along_s += mesh.nodes[nodes[a].node] * shapes.along_s[a];
    }
    const Vec3 normal = base::cross(along_r, along_s) * weight;
    const double here = base::norm(normal);
    area += here;
    for (std::size_t a = 0; a < nodes.size(); ++a) {
      nodes[a].area += here * shapes.value[a];
      nodes[a].normal += normal * shapes.value[a];
      nodes[a].lumped += here * shapes.value[a] * shapes.value[a];
    }
  }
  for (const auto& node : nodes) squares += node.lumped;
  for (auto& node : nodes) node.lumped *= area / squares;
  return nodes;
}

std::vector<std::array<int, 4>> plane_parts(const Facet& f) {
  if (!has_middles(f)) return {{f[0], f[1], f[2], f[3]}};
  const int corners = corners_of(f);
  std::vector<std::array<int, 4>> parts;
  for (int a = 0; a < corners; ++a) parts.push_back({f[a], f[4 + a], f[4 + (a + corners - 1) % corners], -1});
  parts.push_back({f[4], f[5], f[6], f[7]});  // f[7] is -1 for a triangle
  return parts;
}

}  // namespace fem
