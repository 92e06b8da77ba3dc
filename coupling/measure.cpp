#include "coupling/measure.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "dem/measure/contact_numbers.hpp"

namespace coupling {
namespace {

/// Cell-centred lattice fitted to a box.
struct Lattice {
  Vec3 lower, step;
  std::int64_t count[3];

  Lattice(const Box& box, double spacing) : lower(box.lower) {
    for (int axis = 0; axis < 3; ++axis) {
      const double length = box.upper[axis] - box.lower[axis];
      count[axis] = length > 0 ? std::max<std::int64_t>(1, std::llround(length / spacing)) : 0;
      step[axis] = count[axis] > 0 ? length / static_cast<double>(count[axis]) : 0;
    }
  }
  double coordinate(int axis, std::int64_t i) const {
    return lower[axis] + (static_cast<double>(i) + 0.5) * step[axis];
  }
  /// First index whose coordinate is not below x, within [0, count].
  std::int64_t first_from(int axis, double x) const {
    const double index = std::ceil((x - lower[axis]) / step[axis] - 0.5);
    return static_cast<std::int64_t>(std::clamp(index, 0.0, static_cast<double>(count[axis])));
  }
};

/// Marks the points of one layer z = const that lie in spheres of `touching`: a clump's overlaps count once.
void mark_layer(const Lattice& lattice, double z, std::span<const dem::GrainSphere* const> touching,
                std::vector<std::uint8_t>& solid) {
  std::fill(solid.begin(), solid.end(), std::uint8_t{0});
  for (const dem::GrainSphere* sphere : touching) {
    const Vec3& centre = sphere->position;
    const double disc = sphere->radius * sphere->radius - (z - centre.z) * (z - centre.z);
    if (disc < 0) continue;
    const double half_y = std::sqrt(disc);
    for (auto j = lattice.first_from(1, centre.y - half_y); j < lattice.count[1]; ++j) {
      const double dy = lattice.coordinate(1, j) - centre.y;
      if (dy > half_y) break;
      const double half_x = std::sqrt(std::max(0.0, disc - dy * dy));
      for (auto i = lattice.first_from(0, centre.x - half_x); i < lattice.count[0]; ++i) {
        if (lattice.coordinate(0, i) > centre.x + half_x) break;
        solid[static_cast<std::size_t>(j * lattice.count[0] + i)] = 1;
      }
    }
  }
}

}  // namespace

bool contains(const Box& box, const Vec3& point) {
  for (int axis = 0; axis < 3; ++axis) {
    if (point[axis] < box.lower[axis] || point[axis] > box.upper[axis]) return false;
  }
  return true;
}

double porosity(std::span<const dem::GrainSphere> spheres, const Box& box, double spacing, const PointFilter& filter) {
  const Lattice lattice(box, spacing);
  std::vector<std::vector<const dem::GrainSphere*>> touching(static_cast<std::size_t>(lattice.count[2]));
  if (lattice.count[0] == 0 || lattice.count[1] == 0 || lattice.count[2] == 0) return 1;
  for (const dem::GrainSphere& sphere : spheres) {
    const auto end = lattice.first_from(2, sphere.position.z + sphere.radius);
    for (auto k = lattice.first_from(2, sphere.position.z - sphere.radius); k < end; ++k) {
      touching[static_cast<std::size_t>(k)].push_back(&sphere);
    }
  }
  std::vector<std::uint8_t> solid(static_cast<std::size_t>(lattice.count[0] * lattice.count[1]));
  std::int64_t points = 0, filled = 0;
  for (std::int64_t k = 0; k < lattice.count[2]; ++k) {
    const double z = lattice.coordinate(2, k);
    mark_layer(lattice, z, touching[static_cast<std::size_t>(k)], solid);
    for (std::int64_t j = 0; j < lattice.count[1]; ++j) {
      for (std::int64_t i = 0; i < lattice.count[0]; ++i) {
        if (filter && !filter({lattice.coordinate(0, i), lattice.coordinate(1, j), z})) continue;
        ++points;
        filled += solid[static_cast<std::size_t>(j * lattice.count[0] + i)];
      }
    }
  }
  return points > 0 ? 1.0 - static_cast<double>(filled) / static_cast<double>(points) : 1.0;
}

double porosity(std::span<const dem::GrainSphere> spheres, const dem::Region& region, double spacing) {
  const dem::BoxRegion around = dem::box_around(region);
  const auto inside = [&](const Vec3& point) { return dem::contains(region, point); };
  const bool box = std::holds_alternative<dem::BoxRegion>(region);
  return porosity(spheres, Box{around.lower, around.upper}, spacing, box ? PointFilter{} : PointFilter{inside});
}

double coordination(std::span<const dem::Grain> grains, std::span<const dem::GrainContact> contacts, const Box& box) {
  return dem::contact_numbers(dem::BoxRegion{box.lower, box.upper}, grains, contacts, {}).coordination;
}

double volume(const Box& box, double spacing, const PointFilter& filter) {
  const Lattice lattice(box, spacing);
  std::int64_t points = 0;
  for (std::int64_t k = 0; k < lattice.count[2]; ++k) {
    for (std::int64_t j = 0; j < lattice.count[1]; ++j) {
      for (std::int64_t i = 0; i < lattice.count[0]; ++i) {
        points += filter({lattice.coordinate(0, i), lattice.coordinate(1, j), lattice.coordinate(2, k)}) ? 1 : 0;
      }
    }
  }
  return static_cast<double>(points) * lattice.step.x * lattice.step.y * lattice.step.z;
}

}  // namespace coupling
