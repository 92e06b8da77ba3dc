#pragma once
// Beds of grains for the benchmarks of the DEM core: read from a file, or made. The material is that of benchmarks A
// and B: E 2.4e8 Pa, nu 0.2, rho 2700 kg/m3, mu 0.6, e 0.4; steps of 5e-6 s.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "dem/dem.hpp"

namespace benchmarks {
using base::Vec3;

constexpr double young_modulus = 2.4e8, poisson_ratio = 0.2, density = 2700;  // [Pa], [-], [kg/m3]
constexpr double friction = 0.6, restitution = 0.4, gravity = 9.81, time_step = 5e-6;

inline dem::Setup setup_of(bool energy) {
  dem::Setup setup;
  setup.materials = {{"stone", young_modulus, poisson_ratio, density}};
  setup.interactions = {{friction, restitution, 0}};
  setup.gravity = {0, 0, -gravity};
  setup.track_energy = energy;
  return setup;
}

struct Bed {
  std::vector<dem::Grain> grains;
  std::vector<dem::Clump> shapes;    // of the grains
  std::vector<dem::Sphere> spheres;  // [m] of all grains, in their order, placed as the file says
  std::array<double, 2> low, high;   // [m] of the side walls in x and y; the floor is at z = 0
};

/// Fills an empty simulation.
inline void put_into(dem::Simulation& simulation, const Bed& bed) {
  for (const dem::Clump& shape : bed.shapes) simulation.add_shape(shape);
  simulation.add_grains(bed.grains);
  simulation.add_plane({{0, 0, 0}, {0, 0, 1}}, 0);
  for (int axis : {0, 1})
    for (bool upper : {false, true}) {
      dem::Plane wall{};
      wall.point[axis] = upper ? bed.high[axis] : bed.low[axis];
      wall.normal[axis] = upper ? -1 : 1;
      simulation.add_plane(wall, 0);
    }
}

/// Spheres of a file (x,y,z,radius in m) in a box of 1.2 x 1.2 m. Without one, 20 000 spheres: a slightly compressed
/// face-centred lattice of mixed radii, about 4 contacts per sphere.
inline Bed sphere_bed(const std::string& csv) {
  Bed bed{{}, {}, {}, {0, 0}, {1.2, 1.2}};
  const auto add = [&](const Vec3& position, double radius) {
    bed.grains.push_back({.position = position, .radius = radius, .id = static_cast<std::int64_t>(bed.grains.size())});
    bed.spheres.push_back({position, radius});
  };
  if (!csv.empty()) {
    for (const dem::Sphere& s : dem::read_spheres(csv)) add(s.position, s.radius);
    return bed;
  }
  std::mt19937 random(1);
  std::uniform_real_distribution<double> smaller(0, 0.0004);
  const int across = 28;
  const double spacing = 1.2 / across;  // of the square layers; neighbours are spacing / sqrt(2) apart between layers
  const double radius = 0.5 * spacing / std::sqrt(2.0) + 0.00018;
  bed.low.fill(0.25 * spacing - radius);
  bed.high.fill((across - 0.25) * spacing + radius);
  for (int layer = 0; bed.grains.size() < 20000; ++layer)
    for (int k = 0; k < 2 * across * across && bed.grains.size() < 20000; ++k) {
      const int row = k / across, column = k % across;
      const double x = (column + 0.5 * ((row + layer) % 2) + 0.25) * spacing, y = (0.5 * row + 0.25) * spacing;
      add({x, y, 0.5 * layer * spacing + radius}, radius - smaller(random));
    }
  return bed;
}

/// Least distance [m] along `axis` at which two equal clumps, turned alike, do not overlap.
inline double touching_distance(const dem::Clump& shape, int axis) {
  double least = 0;
  for (const dem::Sphere& a : shape.spheres)
    for (const dem::Sphere& b : shape.spheres) {
      const Vec3 between = b.position - a.position;
      const double along = between[axis], reach = a.radius + b.radius;
      const double aside = norm2(between) - along * along;
      if (aside < reach * reach) least = std::max(least, std::sqrt(reach * reach - aside) - along);
    }
  return least;
}

/// 4000 clumps, all turned alike, in a slightly compressed simple lattice; its spheres are not written down.
inline Bed clump_lattice(const dem::Clump& shape) {
  const double squeeze = 2e-5;  // [m] overlap of neighbours
  const int across = 12;
  Bed bed{{}, {shape}, {}, {}, {}};
  Vec3 spacing, lowest, highest;
  for (int axis : {0, 1, 2}) {
    spacing[axis] = touching_distance(shape, axis) - squeeze;
    for (const dem::Sphere& s : shape.spheres) {
      lowest[axis] = std::min(lowest[axis], s.position[axis] - s.radius);
      highest[axis] = std::max(highest[axis], s.position[axis] + s.radius);
    }
  }
  for (int axis : {0, 1}) {
    bed.low[axis] = lowest[axis] + squeeze;
    bed.high[axis] = (across - 1) * spacing[axis] + highest[axis] - squeeze;
  }
  for (int k = 0; k < 4000; ++k)
    bed.grains.push_back({.position = {(k % across) * spacing.x, (k / across % across) * spacing.y,
                                       (k / (across * across)) * spacing.z - lowest.z - squeeze},
                          .radius = shape.reach,
                          .id = k,
                          .shape = 0});
  return bed;
}

/// Clumps of a file (centroid x,y,z in m, unit quaternion w,x,y,z of the frame in which the stone's spheres are given)
/// in a box of 0.72 x 0.72 m; without one, a lattice.
inline Bed clump_bed(const std::string& csv, const std::vector<dem::Sphere>& stone) {
  const dem::Clump shape = dem::make_clump(stone);
  if (csv.empty()) return clump_lattice(shape);
  std::ifstream file(csv);
  base::require_user(file.good(), csv + ": cannot be read");
  Bed bed{{}, {shape}, {}, {0, 0}, {0.72, 0.72}};
  std::string line;
  std::getline(file, line);
  for (int number = 2; std::getline(file, line); ++number) {
    Vec3 x;
    dem::kernels::Quaternion q;
    base::require_user(
        std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf,%lf,%lf,%lf", &x.x, &x.y, &x.z, &q.w, &q.x, &q.y, &q.z) == 7,
        csv + ":" + std::to_string(number) + ": " + line + "; must be x,y,z,qw,qx,qy,qz");
    q = normalised(q);
    bed.grains.push_back({.position = x + to_space(q, shape.centroid),
                          .radius = shape.reach,
                          .id = static_cast<std::int64_t>(bed.grains.size()),
                          .shape = 0,
                          .orientation = q * shape.orientation});
    for (const dem::Sphere& s : stone) bed.spheres.push_back({x + to_space(q, s.position), s.radius});
  }
  return bed;
}

}  // namespace benchmarks
