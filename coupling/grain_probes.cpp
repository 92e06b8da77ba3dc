#include "coupling/grain_probes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "base/error.hpp"
#include "coupling/grain_files.hpp"
#include "coupling/measure.hpp"
#include "coupling/scene_parts.hpp"
#include "dem/measure/contact_forces.hpp"
#include "dem/measure/contact_numbers.hpp"
#include "dem/measure/stress.hpp"

namespace coupling {

using base::fail;
using base::Parameter;
using base::Value;

namespace {

constexpr double porosity_lattice = 0.005;  // [m] a fifth of the smallest ballast grain

const std::vector<std::string> stress_parts{"xx", "yy", "zz", "xy", "yz", "zx", "pressure", "von_mises"};

std::vector<Parameter> region_parameters(const base::Table& box, bool required) {
  const std::string instead = required ? "" : ", or all grains";
  return {base::table("box", box, "where").optional("`centre` and `radius` instead" + instead),
          base::vector("centre", "m", "of a measurement sphere").optional("`box` instead" + instead),
          base::real("radius", "m", "of the measurement sphere").above(0).optional("`box` instead" + instead)};
}

bool needs_region(ProbeRow::Where where) {
  return where == ProbeRow::region || where == ProbeRow::rattlers || where == ProbeRow::stress;
}

std::optional<dem::Region> read_region(const Value& row, bool required) {
  for (const char* name : {"centre", "radius"})
    if (row.has("box") && row.has(name)) fail(row.at(name), "stands beside box", "give one of the two");
  if (const Value* box = row.find("box")) {
    const Box corners = read_box(*box);
    return dem::BoxRegion{corners.lower, corners.upper};
  }
  if (row.has("centre") != row.has("radius")) {
    const char* missing = row.has("centre") ? "radius" : "centre";
    fail(row, fmt::format("\"{}\" is missing", missing), fmt::format("add {}, or give a box instead", missing));
  }
  if (row.has("centre")) return dem::BallRegion{row.at("centre").vector(), row.at("radius").real()};
  if (required) fail(row, "\"box\" or \"centre\" is missing", "add box, or centre and radius");
  return std::nullopt;
}

dem::HeapView read_heap(const Value& row) {
  dem::HeapView view;
  const std::string& axis = row.at("axis").text();
  view.axis = axis == "x" ? dem::HeapView::x : axis == "y" ? dem::HeapView::y : dem::HeapView::vertical;
  if (const Value* centre = row.find("centre")) view.centre = centre->vector();
  if (const Value* floor = row.find("floor")) view.floor = floor->real();
  return view;
}

}  // namespace

std::vector<Parameter> grain_probe_parameters(ProbeRow::Where where, const base::Table& box) {
  if (where == ProbeRow::heap)
    return {base::text("axis", "vertical: a cone; x, y: a slope that falls along it")
                .among({"vertical", "x", "y"})
                .otherwise("vertical"),
            base::vector("centre", "m", "a point of the cone's axis, of the slope's crest").optional("found"),
            base::real("floor", "m", "level that the heap stands on").optional("found"),
            base::text("value", "mean over the flanks, or its standard deviation")
                .among({"angle", "scatter"})
                .otherwise("angle"),
            base::table("box", box, "grains in it belong to the heap").optional("all grains")};
  std::vector<Parameter> list = region_parameters(box, needs_region(where));
  if (where == ProbeRow::rattlers)
    list.push_back(
        base::integer("fewest", "contacts of a grain that carries (without friction: 4)").at_least(1).otherwise(2));
  if (where == ProbeRow::forces || where == ProbeRow::force_quantile)
    list.push_back(base::boolean("walls", "contacts with walls and bodies count too").otherwise(false));
  if (where == ProbeRow::force_quantile)
    list.push_back(base::real("share", "", "of the contacts that lie below").at_least(0).at_most(1).otherwise(0.9));
  if (where == ProbeRow::stress)
    list.push_back(base::text("component", "tension positive; pressure: -(xx+yy+zz)/3; von_mises: sqrt(3/2 s:s)")
                       .among(stress_parts)
                       .otherwise("zz"));
  if (where == ProbeRow::sieve) list.push_back(base::real("size", "m", "of the sieve").above(0));
  return list;
}

GrainProbe read_grain_probe(const Value& row, ProbeRow::Where where) {
  GrainProbe probe;
  if (where == ProbeRow::heap) {
    if (const Value* box = row.find("box")) {
      const Box corners = read_box(*box);
      probe.region = dem::BoxRegion{corners.lower, corners.upper};
    }
    probe.heap = read_heap(row);
    probe.scatter = row.at("value").text() == "scatter";
    return probe;
  }
  probe.region = read_region(row, needs_region(where));
  if (const Value* fewest = row.find("fewest")) probe.fewest = static_cast<int>(fewest->integer());
  if (const Value* walls = row.find("walls")) probe.walls = walls->boolean();
  if (const Value* share = row.find("share")) probe.share = share->real();
  if (const Value* size = row.find("size")) probe.sieve = size->real();
  if (where == ProbeRow::stress) {
    const auto part = std::find(stress_parts.begin(), stress_parts.end(), row.at("component").text());
    probe.stress = static_cast<StressPart>(part - stress_parts.begin());
  }
  return probe;
}

const std::vector<dem::Grain>& GrainCopies::grains() {
  if (!grains_) grains_ = simulation_->grains();
  return *grains_;
}
const std::vector<dem::GrainSphere>& GrainCopies::spheres() {
  if (!spheres_) spheres_ = simulation_->spheres();
  return *spheres_;
}
const std::vector<dem::GrainContact>& GrainCopies::contacts() {
  if (!contacts_) contacts_ = simulation_->grain_contacts();
  return *contacts_;
}
const std::vector<dem::WallContact>& GrainCopies::wall_contacts() {
  if (!wall_contacts_) wall_contacts_ = simulation_->wall_contacts();
  return *wall_contacts_;
}

namespace {

double part_of(const dem::RegionStress& stress, StressPart part) {
  switch (part) {
    case StressPart::xx:
      return stress.xx;
    case StressPart::yy:
      return stress.yy;
    case StressPart::zz:
      return stress.zz;
    case StressPart::xy:
      return stress.xy;
    case StressPart::yz:
      return stress.yz;
    case StressPart::zx:
      return stress.zx;
    case StressPart::pressure:
      return stress.pressure();
    default:
      return stress.von_mises();
  }
}

double heap(const GrainProbe& probe, const std::vector<dem::GrainSphere>& spheres) {
  std::vector<dem::GrainSphere> inside;
  for (const auto& sphere : spheres)
    if (!probe.region || contains(*probe.region, sphere.position)) inside.push_back(sphere);
  const dem::HeapAngle found = dem::heap_angle(inside, probe.heap);
  return probe.scatter ? found.scatter : found.angle;
}

double passing(const GrainProbe& probe, const std::vector<dem::Grain>& grains, std::span<const GrainShape> shapes) {
  std::vector<dem::Grain> inside;
  for (const auto& grain : grains)
    if (!probe.region || contains(*probe.region, grain.position)) inside.push_back(grain);
  return sieve_grains(inside, shapes, std::array{probe.sieve}).front().passing;
}

}  // namespace

bool measures_grains(ProbeKind kind) { return kind == ProbeKind::stress || is_slow(kind); }

bool is_slow(ProbeKind kind) {
  switch (kind) {
    case ProbeKind::porosity:
    case ProbeKind::coordination:
    case ProbeKind::rattlers:
    case ProbeKind::mechanical_coordination:
    case ProbeKind::contact_force_mean:
    case ProbeKind::contact_force_quantile:
    case ProbeKind::strong_contacts:
    case ProbeKind::heap_angle:
    case ProbeKind::passing:
      return true;
    default:
      return false;
  }
}

namespace {

/// The spheres, and where space is periodic their images about it.
std::vector<dem::GrainSphere> with_images(std::vector<dem::GrainSphere> spheres,
                                          const std::array<dem::Period, 3>& periods) {
  for (int axis = 0; axis < 3; ++axis) {
    const double length = periods[static_cast<std::size_t>(axis)].length;
    if (length == 0) continue;
    const std::size_t count = spheres.size();
    for (std::size_t k = 0; k < count; ++k) {
      for (const double shift : {-length, length}) {
        spheres.push_back(spheres[k]);
        spheres.back().position[axis] += shift;
      }
    }
  }
  return spheres;
}

}  // namespace

double measure_grains(const Probe& probe, GrainCopies& copies, const GrainsScene& scene) {
  const GrainProbe& look = probe.look;
  const auto forces = [&] {
    return dem::contact_forces(look.region ? &*look.region : nullptr, copies.contacts(),
                               look.walls ? copies.wall_contacts() : std::vector<dem::WallContact>{});
  };
  const auto numbers = [&] {
    return dem::contact_numbers(*look.region, copies.grains(), copies.contacts(), copies.wall_contacts(), look.fewest);
  };
  switch (probe.kind) {
    case ProbeKind::porosity:
      return porosity(with_images(copies.spheres(), scene.periods), *look.region, porosity_lattice);
    case ProbeKind::coordination:
      return numbers().coordination;
    case ProbeKind::rattlers:
      return numbers().rattler_share();
    case ProbeKind::mechanical_coordination:
      return numbers().mechanical;
    case ProbeKind::contact_force_mean:
      return dem::mean_normal_force(forces());
    case ProbeKind::contact_force_quantile:
      return dem::normal_force_quantile(forces(), look.share);
    case ProbeKind::strong_contacts:
      return dem::share_above_mean(forces());
    case ProbeKind::stress:
      return part_of(dem::region_stress(*look.region, copies.grains(), copies.contacts(), copies.wall_contacts()),
                     look.stress);
    case ProbeKind::heap_angle:
      return heap(look, copies.spheres());
    case ProbeKind::passing:
      return passing(look, copies.grains(), scene.shapes);
    default:
      throw base::InternalError("no probe of grains in a region");
  }
}

GrainMark mark_grain(const Probe& probe, std::span<const dem::Grain> grains) {
  const auto distance = [&](const dem::Grain& grain) { return norm2(grain.position - *probe.point); };
  const auto chosen =
      probe.point ? std::min_element(grains.begin(), grains.end(),
                                     [&](const auto& a, const auto& b) { return distance(a) < distance(b); })
                  : std::find_if(grains.begin(), grains.end(), [&](const auto& g) { return g.id == probe.grain; });
  base::require_internal(chosen != grains.end(), "probe of a grain that does not exist");
  return {chosen->id, chosen->position};
}

}  // namespace coupling
