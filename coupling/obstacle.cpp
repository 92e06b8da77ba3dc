#include "coupling/obstacle.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

namespace coupling {
namespace {

/// Squared distance of a point to a triangle (Ericson, Real-Time Collision Detection 2005, 5.1.5).
double distance2(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double d1 = dot(ab, ap), d2 = dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return norm2(ap);
  const double d3 = dot(ab, bp), d4 = dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return norm2(bp);
  const double d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return norm2(cp);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return norm2(ap - ab * (d1 / (d1 - d3)));
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return norm2(ap - ac * (d2 / (d2 - d6)));
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    return norm2(bp - (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6))));
  }
  const double sum = va + vb + vc;
  return sum > 0 ? norm2(ap - ab * (vb / sum) - ac * (vc / sum)) : norm2(ap);
}

double side(const Vec3& a, const Vec3& b, const Vec3& p) {
  return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
}

constexpr double infinity = std::numeric_limits<double>::infinity();

}  // namespace

Obstacle::Obstacle(const base::Skin& skin)
    : bounds_{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}} {
  const auto add = [&](int i, int j, int k) {
    const auto node = [&](int n) { return skin.nodes[static_cast<std::size_t>(n)]; };
    const Vec3 normal = cross(node(j) - node(i), node(k) - node(i));
    const double length = norm(normal);
    if (length > 0) triangles_.push_back({node(i), node(j), node(k), normal * (1.0 / length)});
  };
  for (const auto& facet : skin.facets) {
    add(facet[0], facet[1], facet[2]);
    if (facet[3] >= 0) add(facet[0], facet[2], facet[3]);
  }
  if (triangles_.empty()) return;
  for (const Triangle& t : triangles_) {
    for (int axis = 0; axis < 3; ++axis) {
      bounds_.lower[axis] = std::min({bounds_.lower[axis], t.a[axis], t.b[axis], t.c[axis]});
      bounds_.upper[axis] = std::max({bounds_.upper[axis], t.a[axis], t.b[axis], t.c[axis]});
    }
  }
  const double width = bounds_.upper.x - bounds_.lower.x, length = bounds_.upper.y - bounds_.lower.y;
  cell_ = std::max({std::sqrt(width * length / static_cast<double>(triangles_.size())), 0.02 * (width + length), 1e-6});
  nx_ = 1 + static_cast<int>(width / cell_);
  ny_ = 1 + static_cast<int>(length / cell_);
  columns_.resize(static_cast<std::size_t>(nx_ * ny_));
  for (std::size_t number = 0; number < triangles_.size(); ++number) {
    const Triangle& t = triangles_[number];
    const auto range = columns(std::min({t.a.x, t.b.x, t.c.x}), std::min({t.a.y, t.b.y, t.c.y}),
                               std::max({t.a.x, t.b.x, t.c.x}), std::max({t.a.y, t.b.y, t.c.y}));
    for (int j = range[1]; j <= range[3]; ++j) {
      for (int i = range[0]; i <= range[2]; ++i) {
        columns_[static_cast<std::size_t>(j * nx_ + i)].push_back(static_cast<int>(number));
      }
    }
  }
}

std::array<int, 4> Obstacle::columns(double x_lower, double y_lower, double x_upper, double y_upper) const {
  const auto index = [this](double offset, int count) {
    return static_cast<int>(std::clamp(std::floor(offset / cell_), 0.0, static_cast<double>(count - 1)));
  };
  return {index(x_lower - bounds_.lower.x, nx_), index(y_lower - bounds_.lower.y, ny_),
          index(x_upper - bounds_.lower.x, nx_), index(y_upper - bounds_.lower.y, ny_)};
}

bool Obstacle::inside(const Vec3& p) const {
  if (triangles_.empty()) return false;
  if (p.x < bounds_.lower.x || p.x > bounds_.upper.x || p.y < bounds_.lower.y || p.y > bounds_.upper.y) return false;
  double below = -infinity, above = infinity;
  bool below_faces_down = false, above_faces_up = false;
  const auto range = columns(p.x, p.y, p.x, p.y);
  for (const int number : columns_[static_cast<std::size_t>(range[1] * nx_ + range[0])]) {
    const Triangle& t = triangles_[static_cast<std::size_t>(number)];
    if (std::abs(t.normal.z) < 1e-6) continue;
    const double sign = t.normal.z > 0 ? 1 : -1;
    const double slack = -1e-12 * (norm2(t.b - t.a) + norm2(t.c - t.a));
    if (sign * side(t.a, t.b, p) < slack || sign * side(t.b, t.c, p) < slack || sign * side(t.c, t.a, p) < slack)
      continue;
    const double z = t.a.z - (t.normal.x * (p.x - t.a.x) + t.normal.y * (p.y - t.a.y)) / t.normal.z;
    if (z <= p.z && z > below) below = z, below_faces_down = t.normal.z < 0;
    if (z > p.z && z < above) above = z, above_faces_up = t.normal.z > 0;
  }
  return below > -infinity ? below_faces_down : above_faces_up;
}

bool Obstacle::closer_than(const Vec3& p, double distance) const {
  for (int axis = 0; axis < 3; ++axis) {
    if (p[axis] < bounds_.lower[axis] - distance || p[axis] > bounds_.upper[axis] + distance) return false;
  }
  const auto range = columns(p.x - distance, p.y - distance, p.x + distance, p.y + distance);
  for (int j = range[1]; j <= range[3]; ++j) {
    for (int i = range[0]; i <= range[2]; ++i) {
      for (const int number : columns_[static_cast<std::size_t>(j * nx_ + i)]) {
        const Triangle& t = triangles_[static_cast<std::size_t>(number)];
        if (std::abs(dot(p - t.a, t.normal)) >= distance) continue;
        if (distance2(p, t.a, t.b, t.c) < distance * distance) return true;
      }
    }
  }
  return false;
}

bool Obstacle::carries(const Box& box, double tolerance) const {
  return !triangles_.empty() && bounds_.lower.x < box.upper.x && bounds_.upper.x > box.lower.x &&
         bounds_.lower.y < box.upper.y && bounds_.upper.y > box.lower.y && bounds_.lower.z <= box.lower.z + tolerance;
}

base::Skin collar(const base::Skin& skin, double height) {
  base::Skin result;
  result.body = skin.body;
  double top = -infinity;
  for (const Vec3& node : skin.nodes) top = std::max(top, node.z);
  std::map<std::pair<int, int>, bool> edges;  // directed edge -> whether its facet is steep
  for (const auto& facet : skin.facets) {
    const std::size_t corners = facet[3] >= 0 ? 4 : 3;
    const Vec3& origin = skin.nodes[static_cast<std::size_t>(facet[0])];
    const Vec3 normal = cross(skin.nodes[static_cast<std::size_t>(facet[1])] - origin,
                              skin.nodes[static_cast<std::size_t>(facet[2])] - origin);
    const bool steep = std::abs(normal.z) < 0.7 * norm(normal);
    for (std::size_t i = 0; i < corners; ++i) edges[{facet[i], facet[(i + 1) % corners]}] = steep;
  }
  const double level = 1e-6 * (1 + std::abs(top));
  for (const auto& [edge, steep] : edges) {
    if (!steep || edges.count({edge.second, edge.first}) > 0) continue;
    const Vec3 &from = skin.nodes[static_cast<std::size_t>(edge.first)],
               &to = skin.nodes[static_cast<std::size_t>(edge.second)];
    if (from.z < top - level || to.z < top - level) continue;
    const int first = static_cast<int>(result.nodes.size());
    const Vec3 up{0, 0, height};
    for (const Vec3& node : {to, from, from + up, to + up}) result.nodes.push_back(node);
    result.facets.push_back({first, first + 1, first + 2, first + 3});
  }
  return result;
}

}  // namespace coupling
