#include "coupling/shapes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "coupling/scene.hpp"
#include "dem/dimensions.hpp"
#include "dem/output.hpp"

namespace coupling {

namespace {

const GrainShape& shape_of(const dem::Grain& grain, std::span<const GrainShape> shapes) {
  return shapes[static_cast<std::size_t>(grain.shape)];
}
/// How much longer the grain is than its shape's file.
double factor(const dem::Grain& grain, const GrainShape& shape) { return grain.radius / shape.clump.reach; }

double ball(double radius) { return 4.0 / 3.0 * std::numbers::pi * radius * radius * radius; }

}  // namespace

GrainShape read_shape(const std::string& name, const std::filesystem::path& file) {
  const auto spheres = dem::read_spheres(file);
  return {name, dem::make_clump(spheres), dem::sieve_size(spheres)};
}

dem::Grain shaped_grain(std::span<const GrainShape> shapes, int shape, double size,
                        const dem::kernels::Quaternion& turn) {
  const GrainShape& own = shapes[static_cast<std::size_t>(shape)];
  dem::Grain grain;
  grain.shape = shape;
  grain.radius = size / own.sieve * own.clump.reach;
  grain.orientation = dem::kernels::normalised(turn * own.clump.orientation);
  return grain;
}

void add_shapes(dem::Simulation& simulation, std::span<const GrainShape> shapes) {
  for (const GrainShape& shape : shapes) simulation.add_shape(shape.clump);
}

std::vector<dem::Clump> clumps(std::span<const GrainShape> shapes) {
  std::vector<dem::Clump> all;
  for (const GrainShape& shape : shapes) all.push_back(shape.clump);
  return all;
}

double sieve_size(const dem::Grain& grain, std::span<const GrainShape> shapes) {
  if (grain.shape < 0) return 2 * grain.radius;
  const GrainShape& shape = shape_of(grain, shapes);
  return factor(grain, shape) * shape.sieve;
}

double smallest_sphere(const dem::Grain& grain, std::span<const GrainShape> shapes) {
  if (grain.shape < 0) return grain.radius;
  const GrainShape& shape = shape_of(grain, shapes);
  const auto& spheres = shape.clump.spheres;
  const auto least = std::min_element(spheres.begin(), spheres.end(),
                                      [](const auto& a, const auto& b) { return a.radius < b.radius; });
  return factor(grain, shape) * least->radius;
}

std::int64_t sphere_count(std::span<const dem::Grain> grains, std::span<const GrainShape> shapes) {
  std::int64_t count = 0;
  for (const dem::Grain& grain : grains)
    count += grain.shape < 0 ? 1 : static_cast<std::int64_t>(shape_of(grain, shapes).clump.spheres.size());
  return count;
}

dem::Sphere sphere_around(const dem::Grain& grain, std::span<const GrainShape> shapes) {
  if (grain.shape < 0) return {grain.position, grain.radius};
  const GrainShape& shape = shape_of(grain, shapes);
  const double longer = factor(grain, shape);
  const dem::Sphere& around = shape.clump.bounding;
  return {grain.position + to_space(grain.orientation, longer * around.position), longer * around.radius};
}

dem::kernels::Quaternion random_turn(dem::Random& random) {
  const double share = random.uniform(), a = 2 * std::numbers::pi * random.uniform(),
               b = 2 * std::numbers::pi * random.uniform();
  const double one = std::sqrt(1 - share), two = std::sqrt(share);
  return {two * std::cos(b), one * std::sin(a), one * std::cos(a), two * std::sin(b)};
}

ShapeMix::ShapeMix(const Packing& packing, std::span<const GrainShape> shapes) : packing_(packing), shapes_(shapes) {
  if (packing.shapes.empty()) return;
  double grain = 0, around = 0, sphere = 0;  // [m3] mean over grains of one size
  for (std::size_t s = 0; s < packing.shapes.size(); ++s) {
    const GrainShape& shape = shapes[static_cast<std::size_t>(packing.shapes[s])];
    const double per_size = packing.shape_shares[s] / (shape.sieve * shape.sieve * shape.sieve);
    grain += per_size * shape.clump.volume;
    around += per_size * ball(shape.clump.bounding.radius);
    sphere += per_size * ball(0.5 * shape.sieve);
  }
  solid_ = grain / sphere;
  around_ = around / grain;
}

std::vector<dem::Grain> ShapeMix::grains(std::span<const double> radii, std::uint64_t seed) const {
  std::vector<dem::Grain> all;
  const std::size_t kinds = packing_.shapes.size();
  std::vector<double> given(kinds, 0.0);
  dem::Random random(seed);
  for (const double radius : radii) {
    if (kinds == 0) {
      all.emplace_back();
      all.back().radius = radius;
      continue;
    }
    // The shape that lags most behind its share; radii come in random order, so that shape and size are independent.
    std::size_t next = 0;
    for (std::size_t s = 1; s < kinds; ++s) {
      const auto lag = [&](std::size_t k) {
        return packing_.shape_shares[k] * static_cast<double>(all.size() + 1) - given[k];
      };
      if (lag(s) > lag(next) + 1e-9) next = s;
    }
    ++given[next];
    all.push_back(shaped_grain(shapes_, packing_.shapes[next], 2 * radius, random_turn(random)));
  }
  return all;
}

}  // namespace coupling
