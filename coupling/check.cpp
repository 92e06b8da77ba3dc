#include "coupling/check.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <span>
#include <sstream>

#include "base/text.hpp"
#include "base/version.hpp"
#include "coupling/bonding.hpp"
#include "coupling/coupled_step.hpp"
#include "coupling/model_checks.hpp"
#include "coupling/packing_cache.hpp"
#include "coupling/packing_region.hpp"
#include "coupling/setup.hpp"
#include "dem/grading.hpp"

namespace coupling {

namespace {

// Rough costs of one core, for the estimates only; tests/benchmarks measures them.
constexpr double sphere_steps_per_second = 5.0e6, element_steps_per_second = 8.0e6;
constexpr double bytes_per_sphere = 800;  // state, candidate pairs, contact memory of a packed bed

struct GrainEstimate {
  std::vector<dem::Grain> grains;  // a list, a cached packing, or radii alone
  std::string source;
  double packing_volume = 0;  // [m3] of the layers inside walls and cuts, outside bodies
  bool packed = true;         // the grains are where they will be
};

/// Share of the box that no cut takes away, from a lattice of points.
double uncut_share(const Box& box, const std::vector<dem::Plane>& cuts) {
  constexpr int n = 24;
  int kept = 0;
  for (int i = 0; i < n * n * n; ++i) {
    const double share[3] = {(i % n + 0.5) / n, (i / n % n + 0.5) / n, (i / n / n + 0.5) / n};
    Vec3 point;
    for (int d = 0; d < 3; ++d) point[d] = box.lower[d] + share[d] * (box.upper[d] - box.lower[d]);
    kept += std::none_of(cuts.begin(), cuts.end(), [&](const auto& cut) { return height_above(cut, point) > 0; });
  }
  return static_cast<double>(kept) / (n * n * n);
}

GrainEstimate estimate_grains(const Setup& setup) {
  const GrainsScene& part = *setup.scene.grains;
  GrainEstimate estimate{part.list, fmt::format("{} listed", part.list.size()), 0};
  if (!part.packing) return estimate;
  const Packing& packing = *part.packing;
  const auto surfaces = arriving_surfaces(setup.scene, setup.skins);
  const PackingRegion region(setup.scene, surfaces);
  double solid = 0;
  for (std::size_t l = 0; l < packing.layers.size(); ++l) {
    const double volume = region.volume(l) * uncut_share(packing.layers[l].box, packing.cuts);
    estimate.packing_volume += volume;
    solid += volume * (1 - packing.target_porosity);
  }
  PackingReport report;
  std::optional<std::vector<dem::Grain>> cached;
  if (packing.use_cache) cached = load_packing(packing_key(setup.scene, surfaces, setup.backend), report);
  if (cached) {
    estimate.source = fmt::format("{} from the cached packing, porosity {:.3f}", cached->size(), report.porosity);
    estimate.grains.insert(estimate.grains.end(), cached->begin(), cached->end());
    return estimate;
  }
  dem::SieveCurve curve;
  for (const auto& row : packing.grading) curve.push_back({row.size, row.passing});
  estimate.packed = false;
  const ShapeMix mix(packing, part.shapes);
  const auto packed = mix.grains(dem::sample_radii(curve, solid / mix.solid(), packing.seed), packing.seed);
  estimate.grains.insert(estimate.grains.end(), packed.begin(), packed.end());
  estimate.source = fmt::format("about {} to be packed into {:.3g} m3 at a porosity of {:.2f}", packed.size(),
                                estimate.packing_volume, packing.target_porosity);
  return estimate;
}

/// Grains whose places are known: all but those that are yet to be packed.
std::vector<dem::Grain> placed_grains(const Setup& setup, const GrainEstimate& estimate) {
  return estimate.packed ? estimate.grains : setup.scene.grains->list;
}

/// Stable step of the smallest grain in this material: it sets the limit, and needs no neighbours, but for bonds.
dem::StableStep stable_step(const Setup& setup, const GrainEstimate& estimate, double young_modulus,
                            bool with_bonds = false) {
  dem::Setup one;
  one.materials = {setup.scene.grains->materials[0]};
  one.materials[0].young_modulus = young_modulus;
  one.interactions = {setup.scene.grains->interactions[0]};
  one.track_energy = false;
  const auto& shapes = setup.scene.grains->shapes;
  const auto smallest = std::min_element(
      estimate.grains.begin(), estimate.grains.end(),
      [&](const auto& a, const auto& b) { return smallest_sphere(a, shapes) < smallest_sphere(b, shapes); });
  const auto simulation = dem::Simulation::create(one, dem::Backend::omp);
  add_shapes(*simulation, shapes);
  const auto placed = with_bonds ? placed_grains(setup, estimate) : std::vector<dem::Grain>{};
  const auto bonds = make_bonds(setup.scene.grains->bonding, placed);
  if (bonds.empty()) {
    simulation->add_grains(std::span(&*smallest, 1));
  } else {
    simulation->add_grains(placed);
    simulation->add_bonds(bonds);
  }
  return simulation->stable_step();
}

/// "linear; with floor: hertz_mindlin": between grains, then where it differs.
template <class Text>
std::string of_every_pair(const GrainsScene& part, const Text& text_of) {
  const std::string own = text_of(part.interactions[0]);
  std::string text = own;
  for (std::size_t m = 1; m < part.materials.size(); ++m) {
    const std::string other = text_of(part.interactions[m]);
    if (other != own) text += fmt::format("; with {}: {}", part.materials[m].name, other);
  }
  return text;
}

/// "1234 spheres in all; stone1 (10 spheres): 60": diameters are then sieve sizes.
std::string shapes_text(const GrainEstimate& estimate, const GrainsScene& part) {
  std::vector<int> of_shape(part.shapes.size() + 1, 0);  // spheres first
  for (const auto& grain : estimate.grains) ++of_shape[static_cast<std::size_t>(grain.shape + 1)];
  if (of_shape[0] == static_cast<int>(estimate.grains.size())) return "spheres, no orientation";
  std::vector<std::string> parts;
  if (of_shape[0] > 0) parts.push_back(fmt::format("{} spheres", of_shape[0]));
  for (std::size_t s = 0; s < part.shapes.size(); ++s)
    if (of_shape[s + 1] > 0)
      parts.push_back(fmt::format("{} {} of {} spheres", of_shape[s + 1], part.shapes[s].name,
                                  part.shapes[s].clump.spheres.size()));
  return fmt::format("{}; {} spheres in all; diameters are sieve sizes", base::join(parts),
                     sphere_count(estimate.grains, part.shapes));
}

std::string grains_text(const Setup& setup, const GrainEstimate& estimate) {
  const GrainsScene& part = *setup.scene.grains;
  double smallest = std::numeric_limits<double>::infinity(), largest = 0;
  for (const auto& grain : estimate.grains) {
    smallest = std::min(smallest, sieve_size(grain, part.shapes));
    largest = std::max(largest, sieve_size(grain, part.shapes));
  }
  const auto any = [&](double dem::Interaction::*member) {
    return std::any_of(part.interactions.begin(), part.interactions.end(),
                       [&](const auto& interaction) { return interaction.*member > 0; });
  };
  std::string text =
      fmt::format("grains: {}, diameters {:.1f} .. {:.1f} mm\n", estimate.source, 1e3 * smallest, 1e3 * largest);
  text += "  shapes: " + shapes_text(estimate, part) + "\n";
  for (int axis = 0; axis < 3; ++axis)
    if (const dem::Period& along = part.periods[static_cast<std::size_t>(axis)]; along.length > 0)
      text +=
          fmt::format("  periodic along {}: {:g} .. {:g} m\n", "xyz"[axis], along.lower, along.lower + along.length);
  text += fmt::format("  rotations: {}\n", part.rotations ? "on" : "off: no angular velocities");
  text += fmt::format("  friction: {}\n", any(&dem::Interaction::friction) ? "on, with contact history" : "off");
  text += fmt::format("  contact law: {}\n", of_every_pair(part, [](const auto& pair) { return pair.law; }));
  text += fmt::format("  rolling: {}\n", of_every_pair(part, [](const auto& pair) {
                        return pair.rolling_friction > 0 ? pair.rolling : std::string("off");
                      }));
  if (part.packing) text += packing_text(*part.packing);
  if (part.bonding.any())
    text += fmt::format("  bonds: {}{}\n", make_bonds(part.bonding, placed_grains(setup, estimate)).size(),
                        estimate.packed ? "" : ", and those of the grains to be packed, which may shorten the step");
  if (setup.scene.time.integrator == dem::TimeScheme::symplectic_euler) text += "  integrator: symplectic Euler\n";
  text += fmt::format("  walls: {} rigid, {} deformable skins\n", part.walls.size(), part.body_material.size());
  text += fmt::format("  precision: {}\n", part.precision == dem::Precision::mixed
                                               ? "mixed: contacts between grains in single, the rest in double"
                                               : "double");
  text += fmt::format("  backend: {}, {} thread{}\n", setup.backend == dem::Backend::cuda ? "cuda" : "omp",
                      setup.threads, setup.threads > 1 ? "s" : "");
  return text;
}

/// "(0.3, 0, -1)", to the nanometre.
std::string place(const Vec3& point) {
  const auto rounded = [](double x) { return std::round(x * 1e9) / 1e9 + 0.0; };
  return fmt::format("({:.4g}, {:.4g}, {:.4g})", rounded(point.x), rounded(point.y), rounded(point.z));
}

std::string bodies_text(const Setup& setup) {
  const auto& solver = setup.scene.solver;
  std::string text = fmt::format("bodies: {}{}\n", solver_name(solver.kind),
                                 solver.start_in_equilibrium ? ", from the equilibrium under the loads of time 0" : "");
  for (const auto& body : setup.body_counts) {
    const auto& scene_body = *std::find_if(setup.scene.bodies.begin(), setup.scene.bodies.end(),
                                           [&](const auto& candidate) { return candidate.name == body.name; });
    text += fmt::format("  {}: {} {} elements, {} nodes, {:.4g} kg, from {} to {} m, {}\n", body.name, body.elements,
                        scene_body.element, body.nodes, body.mass, place(body.lower), place(body.upper),
                        scene_body.skin.empty() ? "no skin" : "skin " + base::join(scene_body.skin));
    for (const auto& faces : scene_body.periodic)
      text += fmt::format("    periodic: {} and {} are one\n", faces.first, faces.second);
  }
  std::istringstream warnings(setup.warnings);
  for (std::string line; std::getline(warnings, line);) text += "warning: " + line + "\n";
  return text;
}

double resident_bytes() {
  std::ifstream in("/proc/self/statm");
  double total = 0, resident = 0;
  in >> total >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE));
}

std::string duration_text(double seconds) {
  if (seconds < 90) return fmt::format("{:.0f} s", std::max(1.0, seconds));
  return seconds < 5400 ? fmt::format("{:.0f} min", seconds / 60) : fmt::format("{:.1f} h", seconds / 3600);
}

struct Steps {
  std::optional<double> dem, fem;  // [s] longest step of either side
  std::string text;
};

Steps choose_steps(const Setup& setup, const std::optional<GrainEstimate>& estimate) {
  const Scene& scene = setup.scene;
  Steps steps;
  if (estimate) {
    const auto limit = stable_step(setup, *estimate, scene.grains->materials[0].young_modulus, true);
    check_step("time.dem_step", scene, scene.time.dem_step, limit.limit, limit.limiter);
    steps.dem = step_of(scene.time.dem_step, scene.time.dem_fraction, limit.limit);
    steps.text += fmt::format("  grains: stable step {:.4g} s ({}); at most {:.4g} s is used\n", limit.limit,
                              limit.limiter, *steps.dem);
    if (const auto& packing = scene.grains->packing) {
      const auto soft = stable_step(setup, *estimate, packing->young_modulus);
      steps.text += fmt::format("  grains while packing: stable step {:.4g} s\n", soft.limit);
    }
  }
  if (scene.has_bodies() && !scene.is_explicit()) {
    if (scene.time.fem_step) steps.fem = scene.time.fem_step->seconds;
    steps.text += fmt::format("  bodies: {}\n", scene.is_modal() ? "none" : setup.fem_limit.limiter);
  } else if (scene.has_bodies()) {
    const auto& limit = setup.fem_limit;
    steps.fem = step_of(scene.time.fem_step, scene.time.fem_fraction, limit.limit);
    steps.text += fmt::format("  bodies: stable step {:.4g} s ({}); at most {:.4g} s is used\n", limit.limit,
                              limit.limiter, *steps.fem);
  }
  return steps;
}

/// Linear springs are known before they touch: one at the lightest node of every skin.
std::string coupled_limit_text(const Setup& setup, const Window& window) {
  std::string text;
  for (std::size_t s = 0; s < setup.skins.size(); ++s) {
    const auto& skin = setup.skins[s];
    const auto& part = *setup.scene.grains;
    const auto& pair = part.interactions[static_cast<std::size_t>(part.body_material.at(skin.body))];
    if (!(pair.normal_stiffness > 0)) {
      text += fmt::format("  coupled limit at {}: from the contacts, as they press\n", skin.body);
      continue;
    }
    const auto& mobility = setup.exchange->mobility(s);
    const double lightest = *std::max_element(mobility.begin(), mobility.end());
    const double bodies = setup.scene.is_explicit() ? 2 / setup.fem_limit.limit : 0;
    const SkinContacts contacts{
        .node = pair.normal_stiffness * lightest, .body = bodies * bodies, .implicit_body = !setup.scene.is_explicit()};
    text += fmt::format(
        "  coupled limit at {}: window of at most {:.4g} s with one contact of {:.4g} N/m at a node of {:.4g} kg\n",
        skin.body, longest_window(window, setup.scene.coupling, contacts), pair.normal_stiffness, 1 / lightest);
  }
  return text;
}

/// Steps of implicit bodies: their cost depends on factors and multigrid, so none is promised.
std::string implicit_cost_text(const Setup& setup, const std::optional<double>& step) {
  std::string text = "run:\n";
  for (const auto& stage : setup.scene.stages)
    text += fmt::format("  stage {}: {:.4g} s in {:.0f} implicit steps{}\n", stage.name, stage.duration,
                        step ? std::ceil(stage.duration / *step * (1 - 1e-9)) : 1.0,
                        stage.measure ? ", measured from its start" : "");
  return text;
}

std::string cost_text(const Setup& setup, const Steps& steps, std::int64_t spheres) {
  double duration = 0, elements = 0;
  for (const auto& stage : setup.scene.stages) duration += stage.duration;
  if (!setup.scene.is_explicit() && !setup.roles->coupled) return implicit_cost_text(setup, steps.fem);
  const Window window = choose_window(steps.dem, steps.fem, setup.scene.coupling);
  for (const auto& body : setup.body_counts) elements += static_cast<double>(body.elements);
  const double windows = std::ceil(duration / window.length());
  std::string text = "run:\n";
  for (const auto& stage : setup.scene.stages) {
    text += fmt::format("  stage {}: {:.4g} s{}\n", stage.name, stage.duration,
                        stage.measure ? ", measured from its start" : "");
  }
  if (setup.scene.has_grains() && setup.scene.has_bodies()) {
    text +=
        fmt::format("  window {:.4g} s = {} DEM steps = {} FEM steps\n", window.length(), window.n_dem, window.n_fem);
    text += fmt::format("  contact forces act on the bodies {:.3g} s late\n", lag(window, setup.scene.coupling));
    text += coupled_limit_text(setup, window);
  }
  const double sphere_steps = windows * window.n_dem * static_cast<double>(spheres);
  const double element_steps = windows * window.n_fem * elements;
  text += fmt::format("  {:.0f} windows: {:.0f} DEM steps, {:.0f} FEM steps\n", windows, windows * window.n_dem,
                      windows * window.n_fem);
  const double memory = resident_bytes() + bytes_per_sphere * static_cast<double>(spheres);
  text += fmt::format("  memory: about {:.0f} MB\n", memory / 1e6);
  const double wall = sphere_steps / sphere_steps_per_second / setup.threads + element_steps / element_steps_per_second;
  text += fmt::format("  wall time: very roughly {} on this machine{}\n", duration_text(wall),
                      setup.scene.packing_hash.empty() ? "" : ", packing not counted");
  return text;
}

}  // namespace

std::string check(const RunOptions& asked) {
  RunOptions options = asked;
  options.only_check = true;
  const Setup setup(MPI_COMM_SELF, options);
  if (!setup.backend_text.empty()) spdlog::info("{}", setup.backend_text);
  const Scene& scene = setup.scene;
  std::optional<GrainEstimate> estimate;
  if (scene.has_grains()) estimate = estimate_grains(setup);
  std::string text = fmt::format("{}\n{}, Trackbed {}\n\n", scene.title.empty() ? "untitled scene" : scene.title,
                                 scene.file.string(), base::code_version());
  text += estimate ? grains_text(setup, *estimate) : "grains: none: no neighbour search, no contact memory\n";
  text += scene.has_bodies() ? bodies_text(setup) : "bodies: none: no PETSc\n";
  if (!setup.roles->coupled) text += "coupling: none: no exchange\n";
  if (scene.is_modal()) return text + fmt::format("modes: {} of every body\n", scene.modes);
  const Steps steps = choose_steps(setup, estimate);
  text += "steps:\n" + steps.text;
  return text + cost_text(setup, steps, estimate ? sphere_count(estimate->grains, scene.grains->shapes) : 0);
}

}  // namespace coupling
