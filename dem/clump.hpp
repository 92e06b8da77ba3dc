#pragma once
// Clump: spheres that overlap and move as one rigid body. Mass, centre and inertia are those of their union, not of the
// sum (sphere_union.hpp); the spheres are kept in the frame of its centroid and principal axes, where the rotation
// schemes work (kernels/rotation.hpp).
// Source: Irazabal Gonzalez 2017 (PhD thesis, UPC Barcelona), sections 5.3, 5.3.4 (properties), 5.3.5 (bounding
// sphere). Where we differ: the properties are exact, not those of a tetrahedral mesh. 5.58-5.63 are printed with a
// radius divided by a length where a unit vector times the radius is meant; the centre is moved again until the sphere
// grows no smaller.
#include <filesystem>
#include <span>
#include <vector>

#include "dem/insertion.hpp"
#include "dem/kernels/rotation.hpp"

namespace dem {

struct Clump {
  std::vector<Sphere> spheres;      // [m] in the body frame: centroid at the origin, axes principal, x the longest
  double volume = 0;                // [m3] of the union
  Vec3 inertia{};                   // [m2] principal moments of the union / mass, rising
  double reach = 0;                 // [m] from the centroid to the farthest point
  Sphere bounding;                  // [m] sphere around all, in the body frame; need not be centred on the centroid
  Vec3 centroid{};                  // [m] in the frame in which the spheres were given
  kernels::Quaternion orientation;  // body frame to that frame: given = centroid + to_space(orientation, body)
};

/// Throws base::UserError (without origin): no sphere, a radius not > 0, a number not finite, a sphere apart from the
/// rest.
Clump make_clump(std::span<const Sphere> spheres);

/// The same shape, `factor` times as long.
Clump scaled(const Clump&, double factor);

/// Sphere that holds all spheres: Irazabal2017 5.3.5. Exact for one and two spheres; a few per cent above the least
/// else.
Sphere bounding_sphere(std::span<const Sphere> spheres);

/// Spheres of a file with lines x,y,z,radius [m]; lines starting with # and one line of column names are passed over.
/// Throws base::UserError with file and line.
std::vector<Sphere> read_spheres(const std::filesystem::path&);

}  // namespace dem
