#include "fem/faces.hpp"

#include <cmath>

namespace fem {
namespace {

struct ShapeValue {
  double value, along_r, along_s;
};

/// Shape functions of triangles with three or six nodes at barycentric (1 - r - s, r, s).
std::vector<ShapeValue> triangle_shapes(double r, double s, bool middles) {
  const double l[3] = {1 - r - s, r, s}, lr[3] = {-1, 1, 0}, ls[3] = {-1, 0, 1};
  std::vector<ShapeValue> shapes;
  for (int a = 0; a < 3; ++a) {
    if (middles) {
      shapes.push_back({l[a] * (2 * l[a] - 1), (4 * l[a] - 1) * lr[a], (4 * l[a] - 1) * ls[a]});
    } else {
      shapes.push_back({l[a], lr[a], ls[a]});
    }
  }
  for (int a = 0; a < 3 && middles; ++a) {
    const int b = (a + 1) % 3;
    shapes.push_back({4 * l[a] * l[b], 4 * (l[a] * lr[b] + l[b] * lr[a]), 4 * (l[a] * ls[b] + l[b] * ls[a])});
  }
  return shapes;
}

/// Shape functions of quadrilaterals with four or eight nodes at (r, s) in [-1, 1]^2.
std::vector<ShapeValue> quadrilateral_shapes(double r, double s, bool middles) {
  constexpr double at_r[8] = {-1, 1, 1, -1, 0, 1, 0, -1}, at_s[8] = {-1, -1, 1, 1, -1, 0, 1, 0};
  std::vector<ShapeValue> shapes;
  for (int a = 0; a < (middles ? 8 : 4); ++a) {
    const bool flat_r = at_r[a] == 0, flat_s = at_s[a] == 0;
    const double f = flat_r ? 1 - r * r : 1 + at_r[a] * r, df = flat_r ? -2 * r : at_r[a];
    const double h = flat_s ? 1 - s * s : 1 + at_s[a] * s, dh = flat_s ? -2 * s : at_s[a];
    if (flat_r || flat_s) {
      shapes.push_back({0.5 * f * h, 0.5 * df * h, 0.5 * f * dh});
    } else if (middles) {
      const double last = at_r[a] * r + at_s[a] * s - 1;
      shapes.push_back(
          {0.25 * f * h * last, 0.25 * h * (df * last + f * at_r[a]), 0.25 * f * (dh * last + h * at_s[a])});
    } else {
      shapes.push_back({0.25 * f * h, 0.25 * df * h, 0.25 * f * dh});
    }
  }
  return shapes;
}

}  // namespace

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
    const auto shapes = corners == 3 ? triangle_shapes(r, s, middles) : quadrilateral_shapes(r, s, middles);
    Vec3 along_r, along_s;
    for (std::size_t a = 0; a < nodes.size(); ++a) {
      along_r += mesh.nodes[nodes[a].node] * shapes[a].along_r;
      along_s += mesh.nodes[nodes[a].node] * shapes[a].along_s;
    }
    const Vec3 normal = base::cross(along_r, along_s) * weight;
    const double here = base::norm(normal);
    area += here;
    for (std::size_t a = 0; a < nodes.size(); ++a) {
      nodes[a].area += here * shapes[a].value;
      nodes[a].normal += normal * shapes[a].value;
      nodes[a].lumped += here * shapes[a].value * shapes[a].value;
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
