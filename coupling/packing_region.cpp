#include "coupling/packing_region.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "coupling/measure.hpp"
#include "coupling/wall_mesh.hpp"

namespace coupling {
namespace {

constexpr double side_tolerance = 1e-3;  // [m] how far a wall may stand outside a box's face and still bound it
constexpr double lattice = 0.01;         // [m] finest spacing of the volume and porosity lattices

double lattice_for(const Box& box) {
  const Vec3 size = box.upper - box.lower;
  return std::max(1e-6, std::min(lattice, std::min({size.x, size.y, size.z}) / 20));
}

}  // namespace

Vec3 unit(const Vec3& v) {
  const double length = norm(v);
  return length > 0 ? v * (1 / length) : v;
}

double height_above(const dem::Plane& plane, const Vec3& point) { return dot(point - plane.point, unit(plane.normal)); }

std::vector<base::Skin> arriving_surfaces(const Scene& scene, const std::vector<base::Skin>& skins) {
  std::vector<base::Skin> all = skins;
  for (const WallScene& wall : scene.grains->walls) {
    if (wall.run_only || stands_while_packing(scene, wall)) continue;
    all.push_back(read_wall_mesh(wall));
    all.back().body = wall.name;
  }
  return all;
}

int surface_material(const Scene& scene, const std::string& name) {
  for (const WallScene& wall : scene.grains->walls)
    if (wall.name == name) return wall.material;
  const auto body = scene.grains->body_material.find(name);
  base::require_internal(body != scene.grains->body_material.end(), "a body's skin has a contact material");
  return body->second;
}

bool stands_while_packing(const Scene& scene, const WallScene& wall) {
  if (wall.run_only) return false;
  const auto& layers = scene.grains->packing->layers;
  return std::none_of(layers.begin(), layers.end(), [&](const PackingLayer& layer) {
    return std::count(layer.bodies.begin(), layer.bodies.end(), wall.name) > 0;
  });
}

PackingRegion::PackingRegion(const Scene& scene, const std::vector<base::Skin>& skins)
    : scene_(scene), packing_(*scene.grains->packing) {
  base::require_user(!packing_.layers.empty(),
                     fmt::format("{}: packing.layer: a packing needs one layer or more", packing_.origin));
  all_ = packing_.layers.front().box;
  for (const PackingLayer& layer : packing_.layers) {
    const Vec3 size = layer.box.upper - layer.box.lower;
    base::require_user(std::min({size.x, size.y, size.z}) > 0,
                       fmt::format("{}: packing.layer.box has no volume ({:g} x {:g} x {:g} m); every edge must be > 0",
                                   layer.origin, size.x, size.y, size.z));
    for (int axis = 0; axis < 3; ++axis) {
      all_.lower[axis] = std::min(all_.lower[axis], layer.box.lower[axis]);
      all_.upper[axis] = std::max(all_.upper[axis], layer.box.upper[axis]);
    }
  }
  for (const WallScene& wall : scene.grains->walls) {
    const bool stands = stands_while_packing(scene, wall);
    if (wall.plane && stands) planes_.push_back({wall.plane->point, unit(wall.plane->normal)});
    wall_surfaces_.push_back(wall.plane || !stands ? base::Skin{} : read_wall_mesh(wall));
    wall_obstacles_.emplace_back(wall_surfaces_.back());
  }
  arriving_.resize(packing_.layers.size());
  for (std::size_t body = 0; body < skins.size(); ++body) {
    obstacles_.emplace_back(skins[body]);
    rims_.push_back(collar(skins[body], 4 * (all_.upper.z - all_.lower.z) + 1));
    rim_obstacles_.emplace_back(rims_.back());
    std::size_t first = 0;
    for (std::size_t layer = packing_.layers.size(); layer-- > 0;) {
      const auto& names = packing_.layers[layer].bodies;
      if (std::find(names.begin(), names.end(), skins[body].body) != names.end()) first = layer;
    }
    arriving_[first].push_back(static_cast<int>(body));
  }
  find_sides();
  check_floor();
}

void PackingRegion::find_sides() {
  const Vec3 middle = (all_.lower + all_.upper) * 0.5;
  for (int axis = 0; axis < 2; ++axis) {
    for (const bool upper : {false, true}) {
      dem::Plane face{middle, {}};
      face.point[axis] = upper ? all_.upper[axis] : all_.lower[axis];
      face.normal[axis] = upper ? -1 : 1;
      const bool bounded = std::any_of(planes_.begin(), planes_.end(), [&](const dem::Plane& wall) {
        return dot(wall.normal, face.normal) > 0.7 && height_above(wall, face.point) < side_tolerance;
      });
      if (!bounded) sides_.push_back(face);
    }
  }
}

void PackingRegion::check_floor() const {
  const auto below = [&](const dem::Plane& wall) { return wall.normal.z > 0.7; };
  bool floor = std::any_of(planes_.begin(), planes_.end(), below);
  for (const Obstacle& wall : wall_obstacles_) floor = floor || wall.carries(all_, side_tolerance);
  for (const int body : arriving_[0]) floor = floor || obstacle(body).carries(all_, side_tolerance);
  base::require_user(floor,
                     fmt::format("{}: packing: nothing carries the ballast; give a [[wall]] or a [[body]] with a "
                                 "skin below the lowest layer (z = {:g} m)",
                                 packing_.origin, all_.lower.z));
}

bool PackingRegion::room(std::size_t layer, const Vec3& centre, double radius) const {
  for (const auto* planes : {&planes_, &sides_}) {
    for (const dem::Plane& plane : *planes) {
      if (dot(centre - plane.point, plane.normal) < radius) return false;
    }
  }
  for (std::size_t wall = 0; wall < wall_obstacles_.size(); ++wall) {
    const Obstacle& surface = wall_obstacles_[wall];
    if (!scene_.grains->walls[wall].two_sided && surface.inside(centre)) return false;
    if (radius > 0 && surface.closer_than(centre, radius)) return false;
  }
  for (std::size_t i = 0; i <= layer; ++i) {
    for (const int body : arriving_[i]) {
      if (obstacle(body).inside(centre)) return false;
      if (radius <= 0) continue;
      if (obstacle(body).closer_than(centre, radius)) return false;
      if (rim_obstacles_[static_cast<std::size_t>(body)].closer_than(centre, radius)) return false;
    }
  }
  return true;
}

double PackingRegion::volume(std::size_t layer) const {
  const Box& box = packing_.layers[layer].box;
  return coupling::volume(box, lattice_for(box), [&](const Vec3& p) { return room(layer, p, 0); });
}

double PackingRegion::volume(const Box& box, std::size_t layer, double margin) const {
  return coupling::volume(box, lattice_for(box), [&](const Vec3& p) { return room(layer, p, margin); });
}

bool PackingRegion::interior(const Vec3& p, double margin) const {
  for (const LooseRegion& region : packing_.loosened) {
    if (contains(region.box, p)) return false;
  }
  for (const ErodedRegion& region : packing_.eroded) {
    if (contains(region.box, p)) return false;
  }
  for (const dem::Plane& cut : packing_.cuts) {
    if (height_above(cut, p) > -margin) return false;
  }
  const auto in_some_layer = [this](const Vec3& q) {
    return std::any_of(packing_.layers.begin(), packing_.layers.end(),
                       [&](const PackingLayer& layer) { return contains(layer.box, q); });
  };
  return in_some_layer(p) && in_some_layer({p.x, p.y, p.z + margin}) && room(packing_.layers.size() - 1, p, margin);
}

double PackingRegion::porosity(std::span<const dem::GrainSphere> spheres, double margin) const {
  for (double m = margin; m > 0.05 * margin; m *= 0.5) {
    const auto filter = [&](const Vec3& p) { return interior(p, m); };
    if (coupling::volume(all_, 2 * lattice_for(all_), filter) > 0) {
      return coupling::porosity(spheres, all_, 0.8 * lattice_for(all_), filter);
    }
  }
  return coupling::porosity(spheres, all_, lattice_for(all_));
}

double PackingRegion::porosity(std::span<const dem::GrainSphere> spheres, const Box& box, std::size_t layer,
                               double margin) const {
  for (double m = margin; m > 0.05 * margin; m *= 0.5) {
    const auto filter = [&](const Vec3& p) { return p.z + m < box.upper.z && room(layer, p, m); };
    if (coupling::volume(box, 2 * lattice_for(box), filter) > 0)
      return coupling::porosity(spheres, box, 0.8 * lattice_for(box), filter);
  }
  return coupling::porosity(spheres, box, lattice_for(box));
}

double PackingRegion::porosity_in(const Box& box, std::span<const dem::GrainSphere> spheres) const {
  const auto filter = [&](const Vec3& p) {
    return room(packing_.layers.size() - 1, p, 0) &&
           std::none_of(packing_.cuts.begin(), packing_.cuts.end(),
                        [&](const dem::Plane& cut) { return height_above(cut, p) > 0; });
  };
  return coupling::porosity(spheres, box, 0.5 * lattice_for(box), filter);
}

}  // namespace coupling
