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

/// A box of this width [m], empty.
inline Bed box(double width) { return {{}, {}, {}, {0, 0}, {width, width}}; }

/// Loose random layers of grains that do not touch, at most `reach` m in radius: what settle() starts from.
template <class Make>
void fill_loosely(Bed& bed, int count, double reach, const Make& make) {
  std::mt19937 random(1);
  const int across = static_cast<int>((bed.high[0] - bed.low[0]) / (2.1 * reach));
  const double spacing = (bed.high[0] - bed.low[0]) / across, play = 0.5 * spacing - reach;
  std::uniform_real_distribution<double> shift(-play, play);
  for (int k = 0; k < count; ++k) {
    dem::Grain grain = make(random);
    grain.id = k;
    grain.position = {(k % across + 0.5) * spacing + shift(random),
                      (k / across % across + 0.5) * spacing + shift(random),
                      (k / (across * across) + 0.5) * spacing + shift(random)};
    bed.grains.push_back(grain);
  }
}

/// Lets a bed fall together and come to rest; what it then is, is the start of all codes.
inline void settle(Bed& bed) {
  const auto simulation = dem::Simulation::create(setup_of(false), dem::Backend::omp);
  put_into(*simulation, bed);
  simulation->set_grain_damping(2);
  simulation->advance(35000, 8 * time_step);
  simulation->set_grain_damping(50);
  simulation->advance(5000, 8 * time_step);
  bed.grains = simulation->grains();
  for (dem::Grain& g : bed.grains) g.velocity = g.angular_velocity = {};
  bed.spheres.clear();
  for (const dem::GrainSphere& s : simulation->spheres()) bed.spheres.push_back({s.position, s.radius});
}

/// Spheres of a file (x,y,z,radius in m) in a box of 1.2 x 1.2 m; without one, 20 000 of 11 to 31 mm, poured.
inline Bed sphere_bed(const std::string& csv) {
  Bed bed = box(1.2);
  if (csv.empty()) {
    std::uniform_real_distribution<double> radius(0.011, 0.031);
    fill_loosely(bed, 20000, 0.031, [&](auto& random) { return dem::Grain{.radius = radius(random)}; });
    settle(bed);
    return bed;
  }
  for (const dem::Sphere& s : dem::read_spheres(csv)) {
    bed.grains.push_back(
        {.position = s.position, .radius = s.radius, .id = static_cast<std::int64_t>(bed.grains.size())});
    bed.spheres.push_back(s);
  }
  return bed;
}

/// Clumps of one shape in a box of this width [m], turned at random and poured.
inline Bed poured_clumps(const dem::Clump& shape, double width, int count) {
  Bed bed = box(width);
  bed.shapes = {shape};
  std::normal_distribution<double> part;
  fill_loosely(bed, count, shape.reach, [&](auto& random) {
    return dem::Grain{
        .radius = shape.reach,
        .shape = 0,
        .orientation = dem::kernels::normalised({part(random), part(random), part(random), part(random)})};
  });
  settle(bed);
  return bed;
}

/// Clumps of a file (centroid x,y,z in m, unit quaternion w,x,y,z of the frame in which the stone's spheres are given)
/// in a box of 0.72 x 0.72 m; without one, 4000 turned at random and poured.
inline Bed clump_bed(const std::string& csv, const std::vector<dem::Sphere>& stone) {
  const dem::Clump shape = dem::make_clump(stone);
  if (csv.empty()) return poured_clumps(shape, 0.72, 4000);
  Bed bed = box(0.72);
  bed.shapes = {shape};
  std::ifstream file(csv);
  base::require_user(file.good(), csv + ": cannot be read");
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
