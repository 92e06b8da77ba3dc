#pragma once
// The stones of meshes/ballast/: their recipes, and the files made from them.
#include <span>
#include <string>

#include "dem/clump_builder.hpp"
#include "dem/stone_generator.hpp"

namespace dem {

/// Spheres of the two clumps of every stone: the levels 7-16 and 29-45 of Irazabal2017 5.3.4.
inline constexpr int few_spheres = 10, many_spheres = 36;

/// Recipe number i makes stone i+1 of meshes/ballast/. All pass a sieve of 45 mm.
std::span<const AngularStone> ballast_stones();

/// The two-sphere clump of Talebiahooie2021 (figure 3), which prints no more than that each clump replaces a ball of
/// 18.5 mm radius: two equal spheres one radius apart, of that ball's volume. Union of such spheres: 9/4 pi r^3.
std::vector<Sphere> two_sphere_clump();

/// File of spheres for read_spheres(): `origin` and the mass properties of the union as # lines, then x,y,z,radius in
/// metres to 0.1 um.
std::string spheres_text(std::span<const Sphere>, const std::string& origin);

/// The first line of such a file for a stone's clump, without the #.
std::string filling_origin(const std::string& stone, const Filling&);

}  // namespace dem
