#pragma once
// Shapes of a scene's grains: clumps read from files of spheres, how large they are, and which of them a packing pours.
// The size of a stone is the smallest square hole it passes (dem/dimensions.hpp), so that a grading means the same for
// every shape; a sphere passes a sieve of its own diameter.
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "dem/dem.hpp"
#include "dem/grading.hpp"

namespace coupling {

struct Packing;

struct GrainShape {
  std::string name;
  dem::Clump clump;  // as in its file
  double sieve = 0;  // [m] size of it
};

/// Throws base::UserError when the file holds no clump.
GrainShape read_shape(const std::string& name, const std::filesystem::path&);

/// A grain of this shape and size [m]; `turn`: from the file's frame to space.
dem::Grain shaped_grain(std::span<const GrainShape>, int shape, double size, const dem::kernels::Quaternion& turn);
/// All shapes in their order, so that Grain::shape counts in it.
void add_shapes(dem::Simulation&, std::span<const GrainShape>);
std::vector<dem::Clump> clumps(std::span<const GrainShape>);

double sieve_size(const dem::Grain&, std::span<const GrainShape>);       // [m]
double smallest_sphere(const dem::Grain&, std::span<const GrainShape>);  // [m] radius
std::int64_t sphere_count(std::span<const dem::Grain>, std::span<const GrainShape>);
dem::Sphere sphere_around(const dem::Grain&, std::span<const GrainShape>);

/// Evenly spread over all turns (Shoemake 1992, Graphics Gems III, p. 124).
dem::kernels::Quaternion random_turn(dem::Random&);

/// The shapes that a packing pours, in their shares of the number of grains; none: spheres.
class ShapeMix {
 public:
  ShapeMix(const Packing&, std::span<const GrainShape>);
  /// Mean volume of a grain over that of a sphere of the same size; 1 for spheres.
  double solid() const { return solid_; }
  /// Mean volume of the spheres around grains over that of the grains; 1 for spheres.
  double around() const { return around_; }
  /// Grains of these sizes (half, [m]), without places or ids: shapes in turn, turned at random.
  std::vector<dem::Grain> grains(std::span<const double> radii, std::uint64_t seed) const;

 private:
  const Packing& packing_;
  std::span<const GrainShape> shapes_;
  double solid_ = 1, around_ = 1;
};

}  // namespace coupling
