#pragma once
// A stone as a closed surface of triangles: reading and writing STL, checks, mass properties.
//
// The surface is right when it bounds one body: every edge belongs to two triangles that run along it in opposite
// directions, and everything hangs together. Which side is outside follows from the sign of the volume; a surface that
// is inside out as a whole is turned when it is read. Surfaces that cross themselves are not detected. Mass properties:
// exact, as a sum over the tetrahedra from one point to the triangles (divergence theorem), uniform density.
#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "dem/insertion.hpp"
#include "dem/mass_properties.hpp"

namespace dem {

struct Stone {
  std::vector<Vec3> corners;                  // [m]
  std::vector<std::array<int, 3>> triangles;  // corner numbers, counter-clockwise seen from outside
};

/// STL, text or binary (binary and text coordinates are kept in single precision, as the format has them). STL has no
/// unit: `metres_per_unit` is 0.001 for a file in millimetres. Throws base::UserError with the file's name: not
/// readable, no triangles, not closed.
Stone read_stl(const std::filesystem::path&, double metres_per_unit = 1);

/// STL text in metres, to 1 um.
std::string stl_text(const Stone&, const std::string& name);

/// Throws base::UserError (without origin) unless the surface bounds one body.
void check_closed(const Stone&);

MassProperties mass_properties(const Stone&);

/// The corners as spheres of radius 0, for dimensions().
std::vector<Sphere> corner_spheres(const Stone&);

}  // namespace dem
