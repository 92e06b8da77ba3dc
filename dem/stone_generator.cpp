#include "dem/stone_generator.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.hpp"
#include "dem/dimensions.hpp"
#include "dem/grading.hpp"

namespace dem {
namespace {

using Polygon = std::vector<Vec3>;  // counter-clockwise seen from outside
using Polyhedron = std::vector<Polygon>;

struct CutPlane {
  Vec3 normal;    // outwards
  double offset;  // [m] the stone is where normal . x <= offset
};

constexpr double same_point = 1e-9;  // the block is of length 2

Polyhedron block(const Vec3& half) {
  Polyhedron faces;
  for (int a = 0; a < 3; ++a) {
    for (const double side : {-1.0, 1.0}) {
      const int b = (a + 1) % 3, c = (a + 2) % 3;
      Polygon face(4);
      for (int k = 0; k < 4; ++k) {
        const double along_b = k == 1 || k == 2 ? 1 : -1, along_c = k >= 2 ? 1 : -1;
        Vec3& corner = face[static_cast<std::size_t>(k)];
        corner[a] = side * half[a];
        corner[b] = along_b * half[b];
        corner[c] = along_c * half[c];
      }
      if (side < 0) std::reverse(face.begin(), face.end());
      faces.push_back(face);
    }
  }
  return faces;
}

void add_unless_there(Polygon& points, const Vec3& point) {
  for (const Vec3& p : points)
    if (norm(p - point) < same_point) return;
  points.push_back(point);
}

/// What of a face is under the plane (Sutherland-Hodgman); points on the plane go into `rim` too.
Polygon cut_face(const Polygon& face, const CutPlane& plane, Polygon& rim) {
  Polygon rest;
  for (std::size_t i = 0; i < face.size(); ++i) {
    const Vec3 &from = face[i], &to = face[(i + 1) % face.size()];
    const double height_from = dot(plane.normal, from) - plane.offset, height_to = dot(plane.normal, to) - plane.offset;
    if (height_from <= 0) add_unless_there(rest, from);
    if ((height_from <= 0) == (height_to <= 0)) continue;
    const Vec3 crossing = from + (height_from / (height_from - height_to)) * (to - from);
    add_unless_there(rest, crossing);
    add_unless_there(rim, crossing);
  }
  return rest;
}

/// Orders points on a plane counter-clockwise seen against its normal.
void order_around(Polygon& rim, const Vec3& normal) {
  Vec3 middle;
  for (const Vec3& p : rim) middle += (1.0 / static_cast<double>(rim.size())) * p;
  const Vec3 u = rim[0] - middle, v = cross(normal, u);
  const auto angle = [&](const Vec3& p) { return std::atan2(dot(p - middle, v), dot(p - middle, u)); };
  std::sort(rim.begin(), rim.end(), [&](const Vec3& a, const Vec3& b) { return angle(a) < angle(b); });
}

void cut(Polyhedron& faces, const CutPlane& plane) {
  Polyhedron rest;
  Polygon rim;
  for (const Polygon& face : faces) {
    Polygon left = cut_face(face, plane, rim);
    if (left.size() >= 3) rest.push_back(std::move(left));
  }
  if (rim.size() >= 3) {
    order_around(rim, plane.normal);
    rest.push_back(std::move(rim));
  }
  faces = std::move(rest);
}

/// Corners shared, faces as fans.
Stone triangulated(const Polyhedron& faces) {
  Stone stone;
  const auto corner = [&](const Vec3& point) {
    const auto known = std::find_if(stone.corners.begin(), stone.corners.end(),
                                    [&](const Vec3& p) { return norm(p - point) < 10 * same_point; });
    if (known != stone.corners.end()) return static_cast<int>(known - stone.corners.begin());
    stone.corners.push_back(point);
    return static_cast<int>(stone.corners.size()) - 1;
  };
  for (const Polygon& face : faces) {
    std::vector<int> ring;
    for (const Vec3& point : face) {
      const int number = corner(point);
      if (std::find(ring.begin(), ring.end(), number) == ring.end()) ring.push_back(number);
    }
    for (std::size_t i = 2; i < ring.size(); ++i) stone.triangles.push_back({ring[0], ring[i - 1], ring[i]});
  }
  return stone;
}

Polyhedron cut_block(const AngularStone& recipe) {
  Random random(recipe.seed);
  const Vec3 half{1, recipe.width_to_length, recipe.width_to_length * recipe.thickness_to_width};
  const auto spread = [&](double width) { return random.uniform(-width, width); };
  const Vec3 turn{spread(3), spread(3), spread(3)};
  const kernels::Quaternion spiral_turn = kernels::turn_by(turn);
  Polyhedron faces = block(half);
  for (int i = 0; i < recipe.cuts; ++i) {
    const double z = 1 - (2 * i + 1.0) / recipe.cuts, s = std::sqrt(1 - z * z);
    const double phi = i * std::numbers::pi * (3 - std::sqrt(5.0));
    Vec3 on_ball{s * std::cos(phi) + spread(0.3), s * std::sin(phi) + spread(0.3), z + spread(0.3)};
    on_ball = kernels::to_space(spiral_turn, (1 / norm(on_ball)) * on_ball);
    const Vec3 across = kernels::over(on_ball, half);  // normal of the ellipsoid at half * on_ball
    const double tangent = 1 / norm(across);
    cut(faces, {tangent * across, tangent * random.uniform(0.80, 1.08)});
  }
  return faces;
}

void check(const AngularStone& recipe) {
  const auto in = [](double value, double above, double most) { return value > above && value <= most; };
  base::require_user(in(recipe.sieve, 0, 1e3), "a stone's sieve size must be > 0");
  base::require_user(in(recipe.width_to_length, 0, 1), "a stone's width_to_length must be in (0, 1]");
  base::require_user(in(recipe.thickness_to_width, 0, 1), "a stone's thickness_to_width must be in (0, 1]");
  base::require_user(recipe.cuts >= 4 && recipe.cuts <= 100, "a stone's cuts must be in [4, 100]");
}

}  // namespace

Stone make_stone(const AngularStone& recipe) {
  check(recipe);
  Stone stone = triangulated(cut_block(recipe));
  const MassProperties properties = mass_properties(stone);
  const PrincipalAxes axes = principal_axes(properties.inertia);
  // Rounded, so that the last bits of the search for the sieve size do not reach the corners.
  const double scale = std::round(1e6 * recipe.sieve / sieve_size(corner_spheres(stone))) / 1e6;
  for (Vec3& corner : stone.corners) {
    corner = scale * kernels::to_body(axes.orientation, corner - properties.centroid);
    for (int a = 0; a < 3; ++a) corner[a] = std::round(1e6 * corner[a]) / 1e6;
  }
  check_closed(stone);
  return stone;
}

}  // namespace dem
