#pragma once
// A box of ballast without a lid, to be packed: five smooth planes, one layer.
#include "coupling/packing.hpp"

/// `size` [m] along x, y, z; one corner at the origin.
inline coupling::Scene packing_box(const base::Vec3& size, std::vector<coupling::GradingRow> grading,
                                   double target_porosity) {
  coupling::Scene scene;
  scene.time.dem_fraction = 0.3;
  scene.grains.emplace();
  coupling::GrainsScene& grains = *scene.grains;
  grains.materials = {{"ballast", 16.8e9, 0.2, 2700}};
  grains.interactions = {{0.6, 0.4, 0.2}};
  const auto add_wall = [&](const base::Vec3& point, const base::Vec3& normal) {
    coupling::WallScene wall;
    wall.plane = dem::Plane{point, normal};
    grains.walls.push_back(wall);
  };
  add_wall({0, 0, 0}, {0, 0, 1});
  add_wall({0, 0, 0}, {1, 0, 0});
  add_wall({size.x, 0, 0}, {-1, 0, 0});
  add_wall({0, 0, 0}, {0, 1, 0});
  add_wall({0, size.y, 0}, {0, -1, 0});
  coupling::Packing& packing = grains.packing.emplace();
  packing.grading = std::move(grading);
  packing.young_modulus = 0.24e9;
  packing.friction = 0.1;
  packing.target_porosity = target_porosity;
  packing.grain_damping = 5;
  packing.origin = "scene.toml:3";
  coupling::PackingLayer layer;
  layer.box = {{0, 0, 0}, size};
  layer.origin = "scene.toml:9";
  packing.layers = {layer};
  return scene;
}
