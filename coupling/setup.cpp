#include "coupling/setup.hpp"

#include <fmt/core.h>
#include <omp.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "base/error.hpp"
#include "coupling/agree.hpp"
#include "coupling/checkpoint.hpp"
#include "coupling/model_checks.hpp"
#include "coupling/packing.hpp"
#include "coupling/slab_simulation.hpp"
#include "coupling/wall_mesh.hpp"

namespace coupling {

namespace {

/// Threads for the grains of each DEM rank: its share of the cores this process may use, less those of the FEM ranks
/// beside it when they `work`, but not more than the grains can feed.
int sensible_threads(int asked, std::size_t grains, const Roles& roles, bool work) {
  static const int cores = omp_get_max_threads();
  if (asked > 0) return asked;
  const std::size_t useful = grains / 2000 / static_cast<std::size_t>(roles.dem_ranks);
  return std::clamp((cores - (work ? roles.fem_here : 0)) / roles.dem_here, 1, std::max(1, static_cast<int>(useful)));
}

std::size_t expected_grains(const GrainsScene& scene) {
  return scene.packing ? 20000 : static_cast<std::size_t>(sphere_count(scene.list, scene.shapes));
}

/// Throws where a probe names a group of a body that is not there, or a mean over an area a group without one, or a
/// point far from its body.
void check_probes(const Scene& scene, const fem::Model& bodies) {
  for (const Probe& probe : scene.probes) {
    if (!probe.body.empty() && probe.point)
      bodies.check_point(probe.body, *probe.point, fmt::format("{}: probe \"{}\"", probe.origin, probe.name));
    if (probe.body.empty() || probe.group.empty()) continue;
    if (probe.kind == ProbeKind::body_stress || probe.kind == ProbeKind::body_plastic_strain) {
      bodies.stress_at(probe.body, {std::nullopt, probe.group});
    } else {
      bodies.probe_group(probe.body, probe.group, fem::Quantity::displacement);
    }
  }
}

/// Throws on every rank where the parts of one mpirun line ask for different runs.
void require_one_run(MPI_Comm all, const Scene& scene, const RunOptions& options) {
  const std::pair<const char*, std::string> asked[] = {
      {"the scene, or a --set,", scene.resolved_toml},
      {"--until", options.until ? fmt::format("{:.17g}", *options.until) : ""},
      {"--restart", options.restart},
      {"--out", options.out ? options.out->string() : ""},
      {"--overwrite", options.overwrite ? "yes" : "no"},
      {"--backend", options.backend},
  };
  for (const auto& [name, value] : asked) {
    const std::uint64_t mine = std::hash<std::string>()(value);
    std::uint64_t least = 0, most = 0;
    MPI_Allreduce(&mine, &least, 1, MPI_UINT64_T, MPI_MIN, all);
    MPI_Allreduce(&mine, &most, 1, MPI_UINT64_T, MPI_MAX, all);
    base::require_user(
        least == most,
        fmt::format("{} is not the same in all parts of the mpirun line; give every part the same but for --role",
                    name));
  }
}

}  // namespace

Setup::Setup(MPI_Comm all, const RunOptions& options_) : options(options_) {
  agree(all, [&] { scene = read_scene(options.scene, options.overrides); });
  agree(all, [&] { require_one_run(all, scene, options); });
  agree(all, [&] { roles = std::make_unique<Roles>(all, scene, options.ranks); });
  if (roles->dem != MPI_COMM_NULL) dem::use_device(roles->dem_number_here);
  if (roles->is_worker) return;
  if (roles->is_dem && roles->dem_ranks > 1)
    slabs = std::make_unique<SlabCrew>(roles->dem, dem::Simulation::create, roles->joint);
  const MPI_Comm world = roles->world;
  agree(world, [&] {
    if (!roles->is_fem) return;
    library = std::make_unique<fem::Library>(roles->fem);
    fem::SolverSettings solver = scene.solver;
    solver.only_looked_at = options.only_check;
    bodies = fem::Model::create(roles->fem, {scene.bodies, scene.gravity, solver});
    body_counts = bodies->counts();
    for (const auto& warning : bodies->warnings()) warnings += warning + "\n";
    check_overlaps(scene, body_counts);
    check_probes(scene, *bodies);
    fem_limit = bodies->stable_step();
    check_step("time.fem_step", scene, scene.time.fem_step, fem_limit.limit, fem_limit.limiter);
  });
  agree(world, [&] {
    if (roles->is_dem) choose_backend();
    if (!scene.has_grains() && options.backend == "cuda")
      backend_text = "--backend cuda: the scene has no grains, so no GPU is used";
  });
  if (scene.has_bodies()) {
    MPI_Bcast(&fem_limit.limit, 1, MPI_DOUBLE, roles->first_fem_rank, world);
    for (std::string* text : {&fem_limit.limiter, &warnings}) {
      int length = static_cast<int>(text->size());
      MPI_Bcast(&length, 1, MPI_INT, roles->first_fem_rank, world);
      text->resize(static_cast<std::size_t>(length));
      MPI_Bcast(text->data(), length, MPI_CHAR, roles->first_fem_rank, world);
    }
  }
  if (roles->coupled) exchange = std::make_unique<Exchange>(*roles, bodies.get(), scene.coupling);
  if (exchange) skins = exchange->skins();
}

Setup::~Setup() = default;

void Setup::choose_backend() {
  std::string why_not;
  const bool usable = dem::cuda_available(&why_not);
  base::require_user(options.backend != "cuda" || usable,
                     fmt::format("--backend cuda: not usable here ({}); use --backend auto or omp", why_not));
  backend = usable && options.backend != "omp" ? dem::Backend::cuda : dem::Backend::omp;
  if (dem::cuda_built() && !usable && options.backend == "auto")
    backend_text = fmt::format("no usable GPU ({}): grains run on the processor's cores", why_not);
  if (backend == dem::Backend::cuda) {
    device = dem::device_text();
    backend_text =
        fmt::format("grains run on {}{}", device,
                    roles->dem_ranks > 1 ? ", those of the other ranks on the GPUs of their machines in turn" : "");
  }
  threads = sensible_threads(options.threads, expected_grains(*scene.grains), *roles, true);
  use_threads(threads);
}

void Setup::use_threads(int number) {
  if (slabs)
    slabs->set_threads(number);
  else
    dem::set_threads(number);
}

MakeGrains Setup::maker() const {
  if (!slabs) return dem::Simulation::create;
  return [this](const dem::Setup& setup, dem::Backend where) { return slabs->make(setup, where); };
}

int Setup::add_mesh_wall(const WallScene& wall) {
  const base::Skin surface = read_wall_mesh(wall);
  const int number = grains->add_mesh(surface, wall.material, wall.two_sided);
  if (!wall.body) return number;
  dem::WallBody body = wall.body->is;
  for (const Vec3& node : surface.nodes) body.centre += node;
  body.centre = wall.body->centre.value_or(1.0 / static_cast<double>(surface.nodes.size()) * body.centre);
  grains->set_wall_body(number, body);
  return number;
}

void Setup::add_walls() {
  for (const auto& skin : skins)
    skin_walls.push_back(grains->add_mesh(skin, scene.grains->body_material.at(skin.body), false));
  if (exchange) exchange->join(*grains, slabs ? static_cast<SlabSimulation*>(grains.get()) : nullptr, skin_walls);
  for (const auto& wall : scene.grains->walls) {
    if (wall.packing_only) {
      named_walls.push_back(-1);
      continue;
    }
    named_walls.push_back(wall.plane ? grains->add_plane(*wall.plane, wall.material) : add_mesh_wall(wall));
    if (base::norm(wall.velocity) > 0) grains->set_wall_velocity(named_walls.back(), wall.velocity);
  }
}

void Setup::make_simulation() {
  const auto& part = *scene.grains;
  dem::Setup dem_setup;
  dem_setup.materials = part.materials;
  dem_setup.interactions = part.interactions;
  dem_setup.gravity = scene.gravity;
  dem_setup.skin = part.neighbour_skin;
  dem_setup.rotations = part.rotations;
  dem_setup.rotation_scheme = part.rotation_scheme;
  dem_setup.time_scheme = scene.time.integrator;
  dem_setup.precision = part.precision;
  dem_setup.periods = part.periods;
  dem_setup.maximum_overlap = part.maximum_overlap;
  grains = maker()(dem_setup, backend);
  add_shapes(*grains, part.shapes);
}

void Setup::place_grains(Summary& summary) {
  agree(roles->world, [&] {
    if (!roles->is_dem) return;
    const auto& part = *scene.grains;
    std::vector<dem::Grain> list = part.list;
    if (part.packing) {
      PackingReport report;
      use_threads(sensible_threads(options.threads, expected_grains(part), *roles, false));
      const auto packed = pack(scene, skins, backend, report, maker());
      use_threads(threads);
      list.insert(list.end(), packed.begin(), packed.end());
      summary.packed = true;
      summary.packing_wall = report.seconds;
      summary.packing_from_cache = report.from_cache;
      summary.porosity = report.porosity;
      summary.porosity_asked = part.packing->target_porosity;
      summary.packing_friction = report.friction;
      summary.packing_steps = report.steps;
      summary.coordination = report.coordination;
      spdlog::info("{} grains, porosity {:.3f}, coordination {:.2f} ({})", report.grains, report.porosity,
                   report.coordination,
                   report.from_cache ? "packing from the cache" : fmt::format("packed in {:.0f} s", report.seconds));
    }
    make_simulation();
    grains->add_grains(list);
    grains->add_bonds(make_bonds(part.bonding, list));
    add_walls();
    dem_limit = grains->stable_step();
    check_step("time.dem_step", scene, scene.time.dem_step, dem_limit.limit, dem_limit.limiter);
    look_at_the_start();
  });
  if (scene.has_grains()) MPI_Bcast(&dem_limit.limit, 1, MPI_DOUBLE, roles->dem_rank, roles->world);
  choose_window();
  report_steps();
}

template <class Self, class Of, class Walk>
void Setup::walk(Self& self, Of& summary, Walk&& walk) {
  walk.rows("named_walls", self.named_walls);
  walk.numbers("dem_limit", self.dem_limit.limit);
  walk.text("dem_limiter", self.dem_limit.limiter);
  walk.numbers("packing", summary.packed, summary.packing_from_cache, summary.packing_wall, summary.porosity,
               summary.porosity_asked, summary.packing_friction, summary.coordination);
  int steps = static_cast<int>(summary.packing_steps.size());
  walk.numbers("packing_steps", steps);
  if constexpr (std::remove_reference_t<Walk>::loads) summary.packing_steps.resize(static_cast<std::size_t>(steps));
  for (int k = 0; k < steps; ++k) {
    auto& step = summary.packing_steps[static_cast<std::size_t>(k)];
    walk.text(fmt::format("packing_step_{}/what", k), step.what);
    walk.numbers(fmt::format("packing_step_{}/numbers", k), step.number, step.taken, step.porosity_before,
                 step.porosity_after);
  }
}

void Setup::save(base::Columns& run, const Summary& summary) const { walk(*this, summary, base::Saver(run)); }

void Setup::restore(const Restart& restart, Summary& summary) {
  agree(roles->world, [&] {
    try {
      if (roles->is_dem) {
        make_simulation();
        add_walls();
        const auto columns = group_of(restart.columns, "grains/");
        const auto parts = saved_parts(columns);
        if (parts.size() > 1 && !slabs)
          grains->restore_parts(parts);
        else
          grains->restore(columns);
      }
      walk(*this, summary, base::Loader(group_of(restart.columns, "run/")));
      if (bodies) bodies->restore(group_of(restart.columns, "bodies/"));
    } catch (const base::UserError& error) {
      throw base::UserError(
          fmt::format("{}: does not fit: {}; start a new run without --restart", restart.file.string(), error.what()));
    }
  });
  choose_window();
  report_steps();
}

/// Grains that overlap too much from the first are a mistake in the scene, not an instability.
void Setup::look_at_the_start() {
  try {
    grains->advance(0, wanted_dem_step());
  } catch (const base::UnstableError& error) {
    throw base::UserError(fmt::format("{}: the scene cannot start: {}; move the grains apart, or away from the wall",
                                      scene.file.string(), error.what()));
  }
}

double Setup::wanted_dem_step() const { return step_of(scene.time.dem_step, scene.time.dem_fraction, dem_limit.limit); }

void Setup::choose_window(double longest_step, double longest_window) {
  std::optional<double> d, f;
  if (scene.has_grains()) d = std::min(wanted_dem_step(), longest_step);
  if (scene.has_bodies() && !scene.is_explicit() && !d) {
    window = {0, 1, 0, scene.time.fem_step ? scene.time.fem_step->seconds : 0};
    return;
  }
  if (scene.has_bodies()) f = step_of(scene.time.fem_step, scene.time.fem_fraction, fem_limit.limit);
  if (d) d = std::min(*d, longest_window / std::max(1, scene.coupling.n_dem));
  if (f) f = std::min(*f, longest_window / std::max(1, scene.coupling.n_fem));
  window = coupling::choose_window(d, f, scene.coupling);
}

void Setup::fit_to(double duration) {
  if (scene.is_explicit() || scene.has_grains()) return;
  const double wanted = scene.time.fem_step ? scene.time.fem_step->seconds : duration;
  window.dt_fem = duration / std::ceil(duration / wanted * (1 - 1e-9));
}

void Setup::aim_at(double duration) {
  if (scene.has_bodies()) return;
  window.n_dem = static_cast<int>(std::clamp(std::round(duration / window.dt_dem), 1.0, 1e6));
}

void Setup::report_steps() const {
  if (scene.has_grains())
    spdlog::info("DEM step {:.3g} s (limit {:.3g} s: {})", window.dt_dem, dem_limit.limit, dem_limit.limiter);
  if (scene.has_bodies() && (scene.is_explicit() || scene.has_grains()))
    spdlog::info("FEM step {:.3g} s (limit {:.3g} s: {})", window.dt_fem, fem_limit.limit, fem_limit.limiter);
  if (roles->coupled)
    spdlog::info("window {:.3g} s = {} DEM step{} = {} FEM step{}; contact forces act on the bodies {:.3g} s late",
                 window.length(), window.n_dem, window.n_dem > 1 ? "s" : "", window.n_fem, window.n_fem > 1 ? "s" : "",
                 lag(window, scene.coupling));
}

}  // namespace coupling
