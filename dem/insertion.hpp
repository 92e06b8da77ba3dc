#pragma once
// Random places for grains of given radii, none touching another: how a lift of ballast is held ready to be poured.
// Random sequential addition, largest first; a place is drawn again until it is free. The box grows upwards when it is
// full. Validity: solid fractions up to about 0.3 are quick; random sequential addition jams near 0.38 for equal
// spheres (Widom 1966, doi:10.1063/1.1726548).
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "base/vec3.hpp"

namespace dem {

using base::Vec3;

struct Sphere {
  Vec3 position;      // [m]
  double radius = 0;  // [m]
};

/// True when a sphere at this place keeps clear of everything that is not a sphere.
using RoomTest = std::function<bool(const Sphere&)>;

struct Insertion {
  Vec3 lower, upper;  // [m] box that the spheres stay inside; its top is raised as needed
  std::uint64_t seed = 1;
  double gap = 0;                    // [m] least distance between surfaces of spheres
  std::span<const Sphere> existing;  // already there
  RoomTest room;                     // empty: everywhere
};

struct Inserted {
  std::vector<Vec3> positions;  // [m] in the order of the radii
  double top = 0;               // [m] where the box ends now
};

/// Same input, same places, on every machine. Throws base::UserError when there is no room however high the box.
Inserted insert_spheres(std::span<const double> radii, const Insertion&);

}  // namespace dem
