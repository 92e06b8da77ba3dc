// Packing by growth (Talebiahooie2021, packing step): grains are put small and apart into the closed box of a layer and
// grow in stages while they push each other apart without friction. Then the lid is taken away, raised gravity presses
// the bed with the friction of packing until it is calm, and gravity goes back to the scene's own.
//   number of grains: solid volume = (1 - target porosity) x volume of the box
//   one stage: radii times 1 + overlap x smallest sphere / (2 x largest grain), so that no two spheres come closer by
//   more than `overlap` of the smaller radius; then time for the overlaps to fall below that
// Where we differ: grains start at random places, not on a hexagonal lattice, and are of the scene's shapes from the
// first instead of being spheres that clumps replace; growth to a share `overlap` is judged, and refused with its
// reason, instead of being relaxed afterwards; the box is higher than the layer by `overfill`, to be struck off and
// levelled as a poured layer is. The volume of the box is taken less a slab along every wall, because random packings
// are looser there (Desmond and Weeks 2009, doi:10.1103/PhysRevE.80.051305: porosity rises as 1 / distance of walls);
// else the inside would be denser than asked.
// Measured (31.5-63 mm, box 0.4 x 0.4 x 0.3 m, E 0.24 GPa; porosity of the inside). Closed box, no overfill, friction
// 0.1: asked 0.380, grown to 0.380, 0.375 after 30 g, 0.372 at the end. With overfill and plate:
//   asked 0.36, friction 0.1: grown 0.369, end 0.378      asked 0.38, friction 0.3: grown 0.378, end 0.387
//   asked 0.38, friction 0.1: grown 0.378, end 0.381      asked 0.40, friction 0.3: grown 0.384, end 0.396
//   asked 0.40, friction 0.1: grown 0.384, end 0.377
// Loose beds sink a little while they grow, for the scene's gravity acts; the friction of packing decides the rest.
// Limits: a porosity below that of random close packing (0.36 for equal spheres, some 0.35 for ballast gradings)
// cannot be grown: overlaps remain. The layer must be as wide as the whole packing.
#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "coupling/packer.hpp"

namespace coupling {
namespace {

constexpr double wall_slab = 0.13;        // of the median diameter, along each wall; measured
constexpr double stage_time = 3e-3;       // [s] from one stage of growth to the next
constexpr double stage_wait = 0.03;       // [s] at most, while grains overlap too much
constexpr double last_wait = 0.5;         // [s] at most, for those of full size
constexpr double jammed = 4;              // times the allowed overlap, at which growth is given up
constexpr int lowering_pieces = 20;       // of the way from raised to the scene's own gravity
constexpr double width_tolerance = 1e-3;  // [m]
constexpr double surface_share = 0.95;    // of the grains' centres lie below a layer's surface

}  // namespace

double Packer::porosity_of(std::size_t number) const {
  Box box = packing_.layers[number].box;
  std::vector<double> heights;
  for (const dem::Grain& grain : simulation_->grains()) {
    if (grain.position.z > box.lower.z) heights.push_back(grain.position.z);
  }
  if (heights.empty()) return 1;
  const auto surface =
      heights.begin() + static_cast<std::ptrdiff_t>(surface_share * static_cast<double>(heights.size() - 1));
  std::nth_element(heights.begin(), surface, heights.end());
  box.upper.z = std::min(box.upper.z, *surface);
  return region_.porosity(simulation_->spheres(), box, number, 0.5 * median_);
}

double Packer::largest_overlap(const std::vector<double>& radii) const {
  const auto radius = [&](std::int64_t id) { return radii[static_cast<std::size_t>(id)]; };
  double largest = 0;
  for (const dem::GrainContact& contact : simulation_->grain_contacts())
    largest = std::max(largest, contact.overlap / std::min(radius(contact.id_i), radius(contact.id_j)));
  for (const dem::WallContact& contact : simulation_->wall_contacts())
    largest = std::max(largest, contact.overlap / radius(contact.id));
  return largest;
}

double Packer::enlarge(const std::vector<dem::Grain>& grains, const PackingLayer& layer) {
  const Growth& growth = *layer.growth;
  const auto& shapes = scene_.grains->shapes;
  std::vector<std::int64_t> ids;
  std::vector<double> radii(static_cast<std::size_t>(next_id_));  // of the smallest sphere, by id
  for (const dem::Grain& grain : simulation_->grains())
    radii[static_cast<std::size_t>(grain.id)] = smallest_sphere(grain, shapes);
  double smallest = radii[static_cast<std::size_t>(grains.front().id)], largest = 0;
  for (const dem::Grain& grain : grains) {
    ids.push_back(grain.id);
    smallest = std::min(smallest, radii[static_cast<std::size_t>(grain.id)]);
    largest = std::max(largest, grain.radius);
  }
  const double stage = 1 + growth.overlap * smallest / (2 * largest);
  double overlap = 0;
  for (double size = growth.start; size < 1;) {
    const double factor = size * stage < 1 ? stage : 1 / size;
    simulation_->scale_grains(ids, factor);
    for (const std::int64_t id : ids) radii[static_cast<std::size_t>(id)] *= factor;
    size = size * stage < 1 ? size * stage : 1;
    const double wait = size < 1 ? stage_wait : last_wait;
    for (double time = 0; time < wait; time += stage_time) {
      advance(stage_time);
      overlap = largest_overlap(radii);
      show(0);
      if (overlap <= growth.overlap) break;
    }
    spdlog::debug("grown to {:.4f}: overlap {:.4f} of the radius", size, overlap);
    if (overlap > (size < 1 ? jammed : 1) * growth.overlap)
      refuse(layer, fmt::format("method = \"growth\": at {:.3g} of their size the grains overlap by {:.2g} of their "
                                "radius and find no more room; must be at most growth.overlap = {:g}; raise "
                                "packing.target_porosity = {:g}",
                                size, overlap, growth.overlap, packing_.target_porosity));
  }
  return overlap;
}

void Packer::lower_gravity(const Growth& growth) {
  for (int i = 1; i <= lowering_pieces && growth.lowering > 0; ++i) {
    const double factor = std::pow(growth.gravity_factor, 1 - static_cast<double>(i) / lowering_pieces);
    simulation_->set_gravity(factor * scene_.gravity);
    advance(growth.lowering / lowering_pieces);
    show(0);
  }
  simulation_->set_gravity(scene_.gravity);
}

void Packer::grow(std::size_t number) {
  const PackingLayer& layer = packing_.layers[number];
  const Growth& growth = *layer.growth;
  for (int axis = 0; axis < 2; ++axis) {
    if (layer.box.lower[axis] > region_.all().lower[axis] + width_tolerance ||
        layer.box.upper[axis] < region_.all().upper[axis] - width_tolerance)
      refuse(layer, fmt::format("method = \"growth\" needs a closed box, but along {} another layer is wider; make "
                                "the boxes equally wide, or choose method = \"gravity\"",
                                "xy"[axis]));
  }
  Box closed = layer.box;
  const Vec3 size = layer.box.upper - layer.box.lower;
  closed.upper.z += layer.overfill * size.z;
  const double free = region_.volume(closed, number, 0);
  const double along_walls = free - region_.volume(closed, number, 0.5 * median_) + 0.5 * median_ * size.x * size.y;
  const double solid = (1 - packing_.target_porosity) * (free - 2 * wall_slab * along_walls);
  std::vector<dem::Grain> grains;
  if (solid > 0) grains = draw(number, solid);
  if (grains.empty())
    refuse(layer, fmt::format("the box has room for {:.3g} m3, less than one grain; bodies and walls fill it, or it is "
                              "too small",
                              free));
  for (dem::Grain& grain : grains) grain.radius *= growth.start;
  const double top = insert(number, grains, closed.upper.z);
  if (top > closed.upper.z)
    refuse(layer,
           fmt::format("the grains do not fit into the closed box at growth.start = {:g} of their size; lower it",
                       growth.start));
  const Vec3 middle = 0.5 * (closed.lower + closed.upper);
  const int lid = simulation_->add_plane({{middle.x, middle.y, closed.upper.z}, {0, 0, -1}}, 0);
  use_interactions(Friction::none);
  simulation_->set_grain_damping(growth.damping);
  double overlap = 0;
  try {
    overlap = enlarge(grains, layer);
  } catch (const base::UnstableError& error) {
    refuse(layer, fmt::format("method = \"growth\" became unstable: {}; raise packing.target_porosity or lower "
                              "growth.overlap",
                              error.what()));
  }
  const double grown_porosity = region_.porosity(simulation_->spheres(), closed, number, 0.5 * median_);
  simulation_->remove_wall(lid);
  use_interactions(Friction::of_packing);
  simulation_->set_grain_damping(packing_.grain_damping);
  simulation_->set_gravity(growth.gravity_factor * scene_.gravity);
  settle(0, layer.settle);
  lower_gravity(growth);
  settle(0, layer.settle);
  steps_.push_back({"growth", static_cast<int>(number + 1), 0, grown_porosity, porosity_of(number)});
  spdlog::info(
      "layer {}: {} grains grown to a porosity of {:.3f}, overlap at most {:.4f} of the radius; {:.3f} after "
      "{:g} times gravity",
      number + 1, grains.size(), grown_porosity, overlap, steps_.back().porosity_after, growth.gravity_factor);
}

}  // namespace coupling
