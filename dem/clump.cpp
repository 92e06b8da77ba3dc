#include "dem/clump.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numeric>
#include <sstream>
#include <string>

#include "base/error.hpp"
#include "dem/sphere_union.hpp"

namespace dem {
namespace {

std::string number(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

void check_spheres(std::span<const Sphere> spheres) {
  base::require_user(!spheres.empty(), "a clump needs one sphere or more; none found");
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    const std::string which = "sphere " + std::to_string(i + 1) + " of the clump";
    const Sphere& s = spheres[i];
    base::require_user(s.radius > 0 && std::isfinite(s.radius),
                       which + ": radius = " + number(s.radius) + " m; must be > 0");
    base::require_user(std::isfinite(norm2(s.position)), which + ": position is not a finite number");
  }
  // Everything that overlapping spheres lead to from the first one.
  std::vector<std::size_t> apart(spheres.size() - 1);
  std::iota(apart.begin(), apart.end(), std::size_t{1});
  std::vector<std::size_t> front{0};
  while (!front.empty()) {
    const Sphere from = spheres[front.back()];
    front.pop_back();
    const auto rest = std::stable_partition(apart.begin(), apart.end(), [&](std::size_t j) {
      return norm(spheres[j].position - from.position) >= spheres[j].radius + from.radius;
    });
    front.insert(front.end(), rest, apart.end());
    apart.erase(rest, apart.end());
  }
  if (apart.empty()) return;
  throw base::UserError(
      "sphere " + std::to_string(apart.front() + 1) +
      " of the clump overlaps no sphere that leads to sphere 1; a clump is one piece: move or enlarge "
      "it, or leave it out");
}

/// The sphere's point that is farthest from `from`.
Vec3 farthest_point(const Sphere& sphere, const Vec3& from) {
  const Vec3 way = sphere.position - from;
  const double distance = norm(way);
  const Vec3 direction = distance > 0 ? (1.0 / distance) * way : Vec3{1, 0, 0};
  return sphere.position + sphere.radius * direction;
}

Vec3 farthest_point(std::span<const Sphere> spheres, const Vec3& from) {
  Vec3 farthest = farthest_point(spheres.front(), from);
  for (const Sphere& sphere : spheres) {
    const Vec3 point = farthest_point(sphere, from);
    if (norm2(point - from) > norm2(farthest - from)) farthest = point;
  }
  return farthest;
}

}  // namespace

Sphere bounding_sphere(std::span<const Sphere> spheres) {
  Sphere best = *std::max_element(spheres.begin(), spheres.end(),
                                  [](const Sphere& a, const Sphere& b) { return a.radius < b.radius; });
  double longest = 2 * best.radius;
  for (const Sphere& a : spheres) {
    for (const Sphere& b : spheres) {
      const double distance = norm(b.position - a.position), across = distance + a.radius + b.radius;  // 5.58
      if (across <= longest || distance <= std::fabs(a.radius - b.radius)) continue;
      longest = across;
      const Vec3 direction = (1.0 / distance) * (b.position - a.position);
      const Vec3 end_a = a.position - a.radius * direction, end_b = b.position + b.radius * direction;  // 5.59
      best = {0.5 * (end_a + end_b), 0.5 * across};                                                     // 5.60, 5.61
    }
  }
  // Move the centre until the farthest point lies on the sphere (5.62, 5.63); the radius reaches the farthest point.
  constexpr int most_moves = 200;
  const double least_radius = best.radius;
  Vec3 centre = best.position;
  best.radius = HUGE_VAL;
  for (int move = 0; move < most_moves; ++move) {
    const Vec3 way = farthest_point(spheres, centre) - centre;
    const double radius = norm(way);
    if (radius < best.radius) best = {centre, radius};
    if (radius <= least_radius * (1 + 1e-12)) break;
    centre += (0.5 * (radius - least_radius) / radius) * way;
  }
  return best;
}

Clump make_clump(std::span<const Sphere> spheres) {
  check_spheres(spheres);
  const MassProperties properties = union_properties(spheres);
  const PrincipalAxes axes = principal_axes(properties.inertia);
  Clump clump;
  clump.volume = properties.volume;
  clump.inertia = axes.inertia;
  clump.centroid = properties.centroid;
  clump.orientation = axes.orientation;
  for (const Sphere& s : spheres) {
    clump.spheres.push_back({kernels::to_body(axes.orientation, s.position - clump.centroid), s.radius});
  }
  clump.reach = norm(farthest_point(clump.spheres, {}));
  clump.bounding = bounding_sphere(clump.spheres);
  return clump;
}

Clump scaled(const Clump& clump, double factor) {
  base::require_user(factor > 0 && std::isfinite(factor),
                     "a clump cannot be scaled by " + number(factor) + "; must be > 0");
  Clump result = clump;
  for (Sphere& sphere : result.spheres) sphere = {factor * sphere.position, factor * sphere.radius};
  result.bounding = {factor * clump.bounding.position, factor * clump.bounding.radius};
  result.reach *= factor;
  result.volume *= factor * factor * factor;
  result.inertia *= factor * factor;
  result.centroid *= factor;
  return result;
}

std::vector<Sphere> read_spheres(const std::filesystem::path& path) {
  std::ifstream file(path);
  base::require_user(file.good(), path.string() + ": cannot be read; must be a file of lines x,y,z,radius");
  std::vector<Sphere> spheres;
  bool names_seen = false;
  std::string line;
  for (int line_number = 1; std::getline(file, line); ++line_number) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.empty() || line.front() == '#') continue;
    std::istringstream text(line);
    Sphere s;
    char comma1 = 0, comma2 = 0, comma3 = 0;
    text >> s.position.x >> comma1 >> s.position.y >> comma2 >> s.position.z >> comma3 >> s.radius;
    const bool complete = text && comma1 == ',' && comma2 == ',' && comma3 == ',' && (text >> std::ws).eof();
    if (complete) {
      spheres.push_back(s);
    } else {
      base::require_user(spheres.empty() && !names_seen, path.string() + ":" + std::to_string(line_number) + ": \"" +
                                                             line + "\"; must be four numbers x,y,z,radius in metres");
      names_seen = true;
    }
  }
  base::require_user(!spheres.empty(), path.string() + ": no sphere found; must hold lines x,y,z,radius");
  return spheres;
}

}  // namespace dem
