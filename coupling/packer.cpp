#include "coupling/packer.hpp"

#include <fmt/core.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <unordered_set>

#include "base/error.hpp"
#include "coupling/measure.hpp"
#include "dem/grading.hpp"
#include "dem/insertion.hpp"
#include "dem/output.hpp"

namespace coupling {
namespace {

constexpr double pour_fraction = 0.28;  // solid fraction of the grains before they fall
constexpr double calm = 3e-3;           // kinetic energy over m g r at which grains count as at rest (some 3 cm/s)
constexpr double chunk = 0.01;          // [s] between looks at the state
/// Times the step that the live contacts allow now, until the next look. Their bound adds up the springs and dashpots
/// of a grain as if all acted along one line; grains that settle have been stable up to about twice of it.
constexpr double contact_safety = 2.0;
constexpr double contact_recovery = 1.1;   // by which that step may grow from look to look: impacts come in crowds
constexpr double absurd_pressure = 0.5e6;  // [Pa] mean under the plate
constexpr double bedding_share = 0.25;     // of the plate's speed, at which a body is set down on the layer below
constexpr double release_share = 0.1;      // of the plate's speed, at which the plate lets go of the grains
constexpr double release_time = 0.05;      // [s]
constexpr double strike_depth = 0.25;      // of the median grain radius, below the level that the plate presses to
constexpr double plate_rest = 0.05;        // [s] for which the plate stays down
constexpr double slope_earliest = 0.1;     // [s] that the cut slope gets at least: it takes time to start moving
constexpr double slope_time = 0.3;         // [s] at most

dem::SieveCurve sieve_curve(const Packing& packing) {
  dem::SieveCurve curve;
  for (const GradingRow& row : packing.grading) curve.push_back({row.size, row.passing});
  return curve;
}

/// Diameter [m] that half of the mass passes.
double median_size(const dem::SieveCurve& curve) {
  double lower = 0, upper = curve.back().size;
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (lower + upper);
    (dem::passing(curve, middle) < 0.5 ? lower : upper) = middle;
  }
  return upper;
}

}  // namespace

Packer::Packer(const Scene& scene, const std::vector<base::Skin>& skins, dem::Backend backend, const MakeGrains& make)
    : scene_(scene),
      packing_(*scene.grains->packing),
      skins_(skins),
      region_(scene, skins),
      mix_(packing_, scene.grains->shapes),
      clumps_(clumps(scene.grains->shapes)),
      median_(median_size(sieve_curve(packing_))),
      terminal_(isatty(STDERR_FILENO) != 0) {
  dem::Setup setup;
  setup.materials = scene.grains->materials;
  setup.materials.front().young_modulus = packing_.young_modulus;
  for (const LooseRegion& region : packing_.loosened) {
    if (region.friction) setup.materials.push_back(setup.materials.front());
  }
  setup.interactions.assign(setup.materials.size() * setup.materials.size(),
                            for_beds(scene.grains->interactions.front()));
  setup.gravity = scene.gravity;
  setup.skin = scene.grains->neighbour_skin;
  setup.maximum_overlap = scene.grains->maximum_overlap;
  setup.periods = scene.grains->periods;
  setup.track_energy = false;
  simulation_ = make(setup, backend);
  add_shapes(*simulation_, scene.grains->shapes);
  simulation_->set_grain_damping(packing_.grain_damping);
  use_interactions(Friction::of_packing);
  add_walls();
}

std::vector<dem::Grain> Packer::run(PackingReport& report) {
  for (std::size_t layer = 0; layer < packing_.layers.size(); ++layer) {
    phase_ = fmt::format("packing layer {} of {}", layer + 1, packing_.layers.size());
    bring_bodies(layer);
    if (packing_.layers[layer].growth)
      grow(layer);
    else
      pour(layer);
    if (packing_.layers[layer].vibration) vibrate(layer);
    const double top = packing_.layers[layer].box.upper.z;
    if (packing_.layers[layer].plate) {
      strike_off(top - strike_depth * 0.5 * median_);
      press(packing_.layers[layer]);
    } else {
      strike_off(top);
    }
    tell_shortest();
  }
  phase_ = "packing: slope";
  cut_free();
  drop_lost();
  report.porosity = region_.porosity(simulation_->spheres(), median_);
  loosen();
  erode();
  drop_lost();
  tell_shortest();
  if (terminal_) fmt::print(stderr, "\r\033[K");
  std::vector<dem::Grain> grains = simulation_->grains();
  if (!grains.empty()) simulation_->advance(0, asked_step());  // contacts of grains that were taken out are gone then
  report.coordination = coordination(grains, simulation_->grain_contacts(), region_.all());
  report.steps = steps_;
  for (dem::Grain& grain : grains) {
    grain.velocity = grain.angular_velocity = {};
    grain.material = 0;
  }
  return grains;
}

void Packer::use_interactions(Friction friction) {
  const int count = static_cast<int>(scene_.grains->materials.size());
  std::vector<double> loose;  // frictions of loosened regions, whose grains are materials of their own
  for (const LooseRegion& region : packing_.loosened) {
    if (region.friction) loose.push_back(*region.friction);
  }
  const int all = count + static_cast<int>(loose.size());
  const auto in_scene = [&](int material) { return material < count ? material : 0; };
  for (int a = 0; a < all; ++a) {
    for (int b = a; b < all; ++b) {
      dem::Interaction pair =
          for_beds(scene_.grains->interactions[static_cast<std::size_t>(in_scene(a) * count + in_scene(b))]);
      if (friction == Friction::of_packing) {
        pair = while_packing(pair, packing_);
        if (a == b && a >= count) pair.friction = loose[static_cast<std::size_t>(a - count)];
      } else if (friction == Friction::none) {
        pair.friction = pair.rolling_friction = 0;
      }
      simulation_->set_interaction(a, b, pair);
    }
  }
}

void Packer::add_walls() {
  for (std::size_t number = 0; number < scene_.grains->walls.size(); ++number) {
    const WallScene& wall = scene_.grains->walls[number];
    if (!stands_while_packing(scene_, wall)) continue;
    const int added = wall.plane ? simulation_->add_plane(*wall.plane, wall.material)
                                 : simulation_->add_mesh(region_.wall_surface(number), wall.material, wall.two_sided);
    if (wall.packing_only) temporary_walls_.push_back(added);
  }
  for (const dem::Plane& side : region_.sides()) {
    if (!cuts_period(side, scene_.grains->periods)) temporary_walls_.push_back(simulation_->add_plane(side, 0));
  }
}

void Packer::bring_bodies(std::size_t layer) {
  for (const int body : region_.arriving(layer)) {
    base::Skin skin = skins_[static_cast<std::size_t>(body)];
    const int material = surface_material(scene_, skin.body);
    const double lift = clearing_lift(region_.obstacle(body));
    for (Vec3& node : skin.nodes) node.z += lift;
    const int wall = simulation_->add_mesh(skin, material, false);
    if (lift > 0) {
      spdlog::info("body \"{}\" is set down from {:.1f} mm above its place", skin.body, 1e3 * lift);
      const double speed = bedding_share * packing_.plate_speed;
      simulation_->set_wall_velocity(wall, {0, 0, -speed});
      advance(lift / speed);
      simulation_->set_wall_velocity(wall, {});
    }
    const base::Skin& rim = region_.rim(body);
    if (!rim.facets.empty()) temporary_walls_.push_back(simulation_->add_mesh(rim, material, false));
  }
}

double Packer::clearing_lift(const Obstacle& obstacle) {
  constexpr double increment = 0.5e-3;  // [m]
  constexpr int most = 40;
  const std::vector<dem::GrainSphere> spheres = simulation_->spheres();
  const auto touches = [&](const dem::GrainSphere& sphere, double lift) {
    const Vec3 seen = sphere.position - Vec3{0, 0, lift};  // the grain as the body in its place would see it
    return obstacle.inside(seen) || obstacle.closer_than(seen, sphere.radius);
  };
  for (int i = 0; i < most; ++i) {
    const double lift = i * increment;
    if (std::none_of(spheres.begin(), spheres.end(), [&](const auto& sphere) { return touches(sphere, lift); }))
      return lift;
  }
  std::unordered_set<std::int64_t> touching;
  for (const dem::GrainSphere& sphere : spheres) {
    if (touches(sphere, most * increment)) touching.insert(sphere.id);
  }
  const std::size_t removed = remove_if([&](const dem::Grain& grain) { return touching.count(grain.id) > 0; });
  spdlog::info("{} grains make room for a body", removed);
  return most * increment;
}

void Packer::refuse(const PackingLayer& layer, const std::string& why) const {
  throw base::UserError(fmt::format("{}: packing.layer: {}", layer.origin, why));
}

std::vector<dem::Grain> Packer::draw(std::size_t number, double solid) const {
  const std::vector<double> sizes =
      dem::sample_radii(sieve_curve(packing_), solid / mix_.solid(), packing_.seed + number);
  return mix_.grains(sizes, packing_.seed + 7000003 * (number + 1));
}

double Packer::insert(std::size_t number, std::vector<dem::Grain>& grains, double top) {
  const PackingLayer& layer = packing_.layers[number];
  std::vector<dem::Sphere> around;
  std::vector<double> radii;
  for (const dem::Grain& grain : grains) {
    around.push_back(sphere_around(grain, scene_.grains->shapes));
    radii.push_back(around.back().radius);
  }
  std::vector<dem::Sphere> existing;
  for (const dem::GrainSphere& sphere : simulation_->spheres()) existing.push_back({sphere.position, sphere.radius});
  dem::Insertion insertion;
  insertion.lower = layer.box.lower;
  insertion.upper = layer.box.upper;
  insertion.upper.z = top;
  insertion.seed = packing_.seed + 1000003 * (number + 1);
  insertion.existing = existing;
  insertion.room = [&](const dem::Sphere& s) { return region_.room(number, s.position, s.radius); };
  dem::Inserted inserted;
  try {
    inserted = dem::insert_spheres(radii, insertion);
  } catch (const base::UserError& error) {
    refuse(layer, error.what());
  }
  const double sinking = (layer.box.upper.z - layer.box.lower.z) / (inserted.top - layer.box.lower.z);
  for (std::size_t i = 0; i < grains.size(); ++i) {
    Vec3 rest = inserted.positions[i];  // about where it comes to rest
    rest.z = layer.box.lower.z + sinking * (rest.z - layer.box.lower.z);
    grains[i].material = material_at(rest);
    grains[i].position = inserted.positions[i] - around[i].position;  // which was taken round a grain at the origin
    grains[i].id = next_id_++;
  }
  simulation_->add_grains(grains);
  return inserted.top;
}

void Packer::pour(std::size_t number) {
  const PackingLayer& layer = packing_.layers[number];
  const double free = region_.volume(number);
  const double solid = (1 - packing_.target_porosity) * free * (1 + layer.overfill);
  if (solid < mix_.solid() * dem::mean_grain_volume(sieve_curve(packing_))) {
    refuse(layer, fmt::format("the box has room for {:.3g} m3, less than one grain; bodies and walls fill it, or it is "
                              "too small",
                              free));
  }
  std::vector<dem::Grain> grains = draw(number, solid);
  const Vec3 size = layer.box.upper - layer.box.lower;
  const double top = insert(number, grains, layer.box.lower.z + mix_.around() * solid / pour_fraction * size.z / free);
  spdlog::info("layer {}: {} grains poured from {:.2f} m", number + 1, grains.size(), top - layer.box.lower.z);
  const double fall = std::sqrt(2 * (top - layer.box.lower.z) / norm(scene_.gravity));
  const double time = layer.settle * std::sqrt(mix_.around());  // what is poured from higher falls longer
  settle(std::min(fall, time), time);
}

double Packer::asked_step() const { return scene_.time.dem_fraction * simulation_->stable_step().limit; }

double Packer::step() {
  const double asked = asked_step();
  if (simulation_->time() < next_look_) return std::min(asked, contact_safety * contact_limit_);
  next_look_ = simulation_->time() + (1 - 1e-6) * chunk;
  const dem::StableStep live = simulation_->contact_stable_step();
  contact_limit_ = std::min(live.limit, contact_recovery * contact_limit_);
  if (contact_safety * live.limit < std::min(asked, shortest_)) {
    shortest_ = contact_safety * live.limit;
    shortest_by_ = live.limiter;
  }
  return std::min(asked, contact_safety * contact_limit_);
}

void Packer::tell_shortest() {
  if (std::isfinite(shortest_))
    spdlog::info("{}: DEM step shortened to {:.3g} s at the least by the live contacts: {}", phase_, shortest_,
                 shortest_by_);
  shortest_ = std::numeric_limits<double>::infinity();
}

void Packer::advance(double duration) {
  const double asked = asked_step();
  base::require_user(
      std::isfinite(asked),
      "packing: the layers hold no grain of this grading; make packing.layer.box higher or wider than the "
      "grains, or the grading finer");
  for (double left = duration; left > 1e-9 * duration;) {
    const double dt = step();
    const double piece = dt < asked ? std::min(left, chunk) : left;  // contacts that shorten steps are looked at often
    const int steps = std::max(1, static_cast<int>(std::ceil(piece / dt)));
    simulation_->advance(steps, piece / steps);
    left -= piece;
  }
}

void Packer::settle(double earliest, double duration) {
  for (double time = 0; time < duration - 1e-9; time += chunk) {
    advance(std::min(chunk, duration - time));
    double kinetic = 0, scale = 0;  // both over density
    for (const dem::Grain& grain : simulation_->grains()) {
      const double solid = dem::volume(grain, clumps_);
      kinetic += 0.5 * solid * norm2(grain.velocity);
      scale += solid * norm(scene_.gravity) * grain.radius;
    }
    show(kinetic / scale);
    spdlog::debug("t = {:.3f} s: kinetic energy {:.2e} m g r", simulation_->time(), kinetic / scale);
    if (time + chunk > earliest && kinetic < calm * scale) return;
  }
}

std::size_t Packer::remove_if(const std::function<bool(const dem::Grain&)>& condition) {
  std::vector<std::int64_t> ids;
  for (const dem::Grain& grain : simulation_->grains()) {
    if (condition(grain)) ids.push_back(grain.id);
  }
  if (!ids.empty()) simulation_->remove_grains(ids);
  return ids.size();
}

void Packer::strike_off(double level) {
  const std::size_t removed = remove_if([level](const dem::Grain& grain) { return grain.position.z > level; });
  spdlog::info("{} grains struck off above z = {:g} m", removed, level);
}

void Packer::press(const PackingLayer& layer) {
  double top = layer.box.upper.z;
  for (const dem::GrainSphere& sphere : simulation_->spheres()) top = std::max(top, sphere.position.z + sphere.radius);
  const double travel = top - layer.box.upper.z;
  if (!(travel > 0)) return spdlog::info("no grain stands above the plate's level");
  const Vec3 middle = (layer.box.lower + layer.box.upper) * 0.5;
  const Vec3 size = layer.box.upper - layer.box.lower;
  const int plate = simulation_->add_plane({{middle.x, middle.y, top}, {0, 0, -1}}, 0);
  const auto pressure = [&] {
    double force = 0;
    for (const dem::WallContact& contact : simulation_->wall_contacts()) {
      if (contact.wall == plate) force -= contact.force.z;
    }
    return force / (size.x * size.y);
  };
  double peak = 0;
  const int chunks = std::max(1, static_cast<int>(std::ceil(travel / (packing_.plate_speed * chunk))));
  simulation_->set_wall_velocity(plate, {0, 0, -packing_.plate_speed});
  for (int i = 0; i < chunks; ++i) {
    const double level = top - travel * (i + 1) / chunks;
    try {
      advance(travel / packing_.plate_speed / chunks);
    } catch (const base::UnstableError& error) {
      refuse_plate(layer, level, error.what());
    }
    peak = std::max(peak, pressure());
    show(0);
    if (peak > absurd_pressure) refuse_plate(layer, level, fmt::format("{:.0f} kPa press against it", 1e-3 * peak));
  }
  simulation_->set_wall_velocity(plate, {});
  settle(0, plate_rest);
  const double held = pressure();
  simulation_->set_wall_velocity(plate, {0, 0, release_share * packing_.plate_speed});
  settle(release_time, release_time);
  simulation_->remove_wall(plate);
  settle(chunk, plate_rest);
  spdlog::info("plate came down {:.1f} mm, {:.1f} kPa at most, {:.1f} kPa at rest", 1e3 * travel, 1e-3 * peak,
               1e-3 * held);
}

void Packer::refuse_plate(const PackingLayer& layer, double level, const std::string& what) const {
  throw base::UserError(
      fmt::format("{}: packing.layer.plate: cannot come down to z = {:g} m: at z = {:.4g} m {}; raise "
                  "packing.target_porosity, lower packing.friction or the layer's overfill, or leave the plate out",
                  layer.origin, layer.box.upper.z, level, what));
}

void Packer::cut_free() {
  const std::size_t cut = remove_if([&](const dem::Grain& grain) {
    return std::any_of(packing_.cuts.begin(), packing_.cuts.end(),
                       [&](const dem::Plane& plane) { return height_above(plane, grain.position) > 0; });
  });
  if (!packing_.cuts.empty()) spdlog::info("{} grains cut away", cut);
  use_interactions(Friction::of_scene);
  for (const int wall : temporary_walls_) simulation_->remove_wall(wall);
  settle(slope_earliest, slope_time);
}

void Packer::drop_lost() {
  const Box& box = region_.all();
  const std::size_t lost = remove_if([&](const dem::Grain& grain) {
    const Vec3& p = grain.position;
    return p.z > box.upper.z || p.z < box.lower.z - grain.radius || p.x < box.lower.x - grain.radius ||
           p.x > box.upper.x + grain.radius || p.y < box.lower.y - grain.radius || p.y > box.upper.y + grain.radius;
  });
  if (lost == 0) return;
  spdlog::info("{} grains left the box and are taken out", lost);
  if (std::isfinite(asked_step())) simulation_->advance(0, asked_step());  // contacts are known again without them
}

void Packer::show(double kinetic) {
  if (!terminal_) return;
  const auto now = std::chrono::steady_clock::now();
  if (now - shown_ < std::chrono::milliseconds(200)) return;
  shown_ = now;
  fmt::print(stderr, "\r\033[K{}  t = {:.3f} s  {} grains  kinetic energy {:.1e} m g r", phase_, simulation_->time(),
             simulation_->counts().grains, kinetic);
  std::fflush(stderr);
}

}  // namespace coupling
