#include "dem/measure/region.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dem {
namespace {

/// Stretch [0, 1] of a line that is inside; narrowed by every bound.
struct Stretch {
  double from = 0, to = 1;
  double length() const { return std::max(0.0, to - from); }
};

double share(const BoxRegion& box, const Vec3& from, const Vec3& step) {
  Stretch inside;
  for (int axis = 0; axis < 3; ++axis) {
    if (step[axis] == 0) {
      if (from[axis] < box.lower[axis] || from[axis] > box.upper[axis]) return 0;
      continue;
    }
    const double a = (box.lower[axis] - from[axis]) / step[axis], b = (box.upper[axis] - from[axis]) / step[axis];
    inside = {std::max(inside.from, std::min(a, b)), std::min(inside.to, std::max(a, b))};
  }
  return inside.length();
}

double share(const BallRegion& ball, const Vec3& from, const Vec3& step) {
  const Vec3 offset = from - ball.centre;
  const double a = norm2(step), b = dot(offset, step), c = norm2(offset) - ball.radius * ball.radius;
  const double discriminant = b * b - a * c;
  if (discriminant <= 0) return 0;
  const double root = std::sqrt(discriminant);
  return Stretch{std::max(0.0, (-b - root) / a), std::min(1.0, (-b + root) / a)}.length();
}

bool holds(const BoxRegion& box, const Vec3& point) {
  for (int axis = 0; axis < 3; ++axis) {
    if (point[axis] < box.lower[axis] || point[axis] > box.upper[axis]) return false;
  }
  return true;
}
bool holds(const BallRegion& ball, const Vec3& point) {
  return norm2(point - ball.centre) <= ball.radius * ball.radius;
}

}  // namespace

bool contains(const Region& region, const Vec3& point) {
  return std::visit([&](const auto& shape) { return holds(shape, point); }, region);
}

double volume(const Region& region) {
  if (const auto* ball = std::get_if<BallRegion>(&region))
    return 4.0 / 3.0 * std::numbers::pi * ball->radius * ball->radius * ball->radius;
  const auto& box = std::get<BoxRegion>(region);
  const Vec3 edges = box.upper - box.lower;
  return edges.x * edges.y * edges.z;
}

BoxRegion box_around(const Region& region) {
  if (const auto* box = std::get_if<BoxRegion>(&region)) return *box;
  const auto& ball = std::get<BallRegion>(region);
  const Vec3 reach{ball.radius, ball.radius, ball.radius};
  return {ball.centre - reach, ball.centre + reach};
}

double share_inside(const Region& region, const Vec3& from, const Vec3& to) {
  const Vec3 step = to - from;
  if (norm2(step) == 0) return contains(region, from) ? 1 : 0;
  return std::visit([&](const auto& shape) { return share(shape, from, step); }, region);
}

}  // namespace dem
