#include "coupling/run_loop.hpp"

#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "base/error.hpp"
#include "coupling/grain_files.hpp"
#include "coupling/instants.hpp"
#include "coupling/interrupt.hpp"
#include "coupling/packing.hpp"

namespace coupling {

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// Runs work, books its time.
FailureText timed(double& seconds, const std::function<void()>& work) {
  const auto start = Clock::now();
  FailureText failure = caught(work);
  seconds += seconds_since(start);
  return failure;
}

bool is_coupled(const Scene& scene) { return scene.has_grains() && scene.has_bodies(); }

std::vector<std::string> history_columns(const Scene& scene) {
  std::vector<std::string> columns{"time [s]", "stage [-]"};
  for (const auto& probe : scene.probes)
    columns.push_back(fmt::format("{} [{}]", probe.name, probe.unit.empty() ? "-" : probe.unit));
  for (const char* name :
       {"kinetic", "elastic", "strain", "work_gravity", "work_loads", "work_walls", "interface_seen_by_grains",
        "interface_seen_by_bodies", "loss_friction", "loss_contact_damping", "loss_rolling", "loss_breakage",
        "loss_damping", "loss_viscous", "loss_plastic", "residual"})
    columns.push_back(fmt::format("energy_{} [J]", name));
  columns.push_back("momentum_error [-]");
  if (!is_coupled(scene)) return columns;
  for (const char* quantity : {"impulse", "angular_impulse"})
    for (const char* side : {"grains", "bodies"})
      for (const char axis : {'x', 'y', 'z'})
        columns.push_back(fmt::format("interface_{}_seen_by_{}_{} [N {}s]", quantity, side, axis,
                                      std::string_view(quantity) == "impulse" ? "" : "m "));
  return columns;
}

void append_energy(std::vector<double>& row, const Sides& sides, const Ledger& ledger) {
  const auto& [g, b] = sides;
  row.insert(row.end(), {g.kinetic + b.kinetic, g.elastic_normal + g.elastic_shear + g.elastic_bonds, b.strain,
                         g.work_gravity + b.work_gravity, b.work_loads, g.work_walls, g.work_interface,
                         b.work_interface, g.loss_friction, g.loss_contact_damping, g.loss_rolling, g.loss_breakage,
                         g.loss_damping + b.loss_damping, b.loss_viscous, b.loss_plastic, ledger.residual()});
}

/// What each side has received through the interface.
void append_impulses(std::vector<double>& row, const Sides& sides) {
  for (const auto quantity : {&base::Energy::interface_impulse, &base::Energy::interface_angular_impulse})
    for (const base::Energy* side : {&sides.grains, &sides.bodies})
      for (int axis = 0; axis < 3; ++axis) row.push_back((side->*quantity)[axis]);
}

}  // namespace

RunLoop::RunLoop(Setup& setup, std::filesystem::path directory, Summary& summary, Series& series,
                 const Restart* restart)
    : setup_(setup),
      directory_(std::move(directory)),
      summary_(summary),
      series_(series),
      sampler_(*setup.roles, setup.scene, setup.grains.get(), setup.bodies.get(), setup.skins, setup.skin_walls,
               setup.named_walls),
      checkpoints_(directory_),
      next_checkpoint_(setup.scene.output.checkpoint_interval) {
  for (const auto& stage : setup.scene.stages) total_ += stage.duration;
  agree(setup.roles->world, [&] {
    if (restart) return go_on_from(*restart);
    if (setup_.roles->is_root())
      history_ = std::make_unique<HistoryFile>(directory_ / "history.csv", history_columns(setup_.scene));
  });
}

void RunLoop::begin(const Stage& stage) {
  const auto& scene = setup_.scene;
  if (setup_.grains) {
    setup_.grains->set_grain_damping(stage.grain_damping);
    if (!stage.ramp_stiffness) setup_.grains->set_material(0, scene.grains->materials[0]);
    if (stage.packing_friction != packing_friction_) use_friction(stage.packing_friction);
    begin_walls();
  }
  if (setup_.bodies)
    for (const auto& body : scene.bodies) {
      const auto own = stage.body_damping.find(body.name);
      setup_.bodies->set_damping(body.name, own == stage.body_damping.end() ? body.damping : own->second);
      setup_.bodies->hold(body.name, std::find(stage.hold.begin(), stage.hold.end(), body.name) != stage.hold.end());
    }
  spdlog::info("stage {}: {:.4g} s", stage.name, stage.duration);
  const bool any_measured =
      std::any_of(scene.stages.begin(), scene.stages.end(), [](const Stage& s) { return s.measure; });
  if (stage.measure || (!any_measured && stage_ == 0)) zero();
}

void RunLoop::use_friction(bool of_packing) {
  packing_friction_ = of_packing;
  const GrainsScene& grains = *setup_.scene.grains;
  const int count = static_cast<int>(grains.materials.size());
  for (int a = 0; a < count; ++a) {
    for (int b = a; b < count; ++b) {
      const dem::Interaction& pair = grains.interactions[static_cast<std::size_t>(a * count + b)];
      setup_.grains->set_interaction(a, b, of_packing ? while_packing(pair, *grains.packing) : pair);
    }
  }
}

/// What the scene wants of its walls from the start of this stage on.
void RunLoop::begin_walls() {
  removed_ = false;
  const auto& walls = setup_.scene.grains->walls;
  for (std::size_t w = 0; w < walls.size(); ++w) {
    if (setup_.named_walls[w] < 0) continue;
    for (const WallMotion& motion : walls[w].motions)
      if (motion.stage == stage_) setup_.grains->set_wall_velocity(setup_.named_walls[w], motion.velocity);
    if (walls[w].removed_at != stage_) continue;
    setup_.grains->remove_wall(setup_.named_walls[w]);
    setup_.named_walls[w] = -1;
    sampler_.forget_wall(w);
    removed_ = true;
  }
  load_walls();
}

bool RunLoop::steers_walls() const {
  if (!setup_.scene.has_grains()) return false;
  const auto& walls = setup_.scene.grains->walls;
  return std::any_of(walls.begin(), walls.end(),
                     [](const WallScene& wall) { return wall.body && !wall.body->loads.empty(); });
}

void RunLoop::load_walls() {
  const auto& walls = setup_.scene.grains->walls;
  for (std::size_t w = 0; w < walls.size(); ++w) {
    if (setup_.named_walls[w] < 0 || !walls[w].body) continue;
    Vec3 force;
    for (const WallLoad& load : walls[w].body->loads) force += load.history->value(time_) * load.direction;
    setup_.grains->set_wall_load(setup_.named_walls[w], force, {});
  }
}

/// From here on displacements, ledgers and results count.
void RunLoop::zero() {
  measuring_ = true;
  if (setup_.bodies) {
    setup_.bodies->set_displacement_zero();
    setup_.bodies->reset_energy();
  }
  if (setup_.grains) {
    // A packing's contacts hold energy, which is known once they have been looked at.
    if (dem_steps_ == 0 || removed_) setup_.grains->advance(0, setup_.window.dt_dem);
    setup_.grains->reset_energy();
  }
  sampler_.zero();
  ledger_.start(sampler_.sample(time_, true).energy);
  series_ = {};
  series_.columns.resize(setup_.scene.probes.size());
  agree(setup_.roles->world, [&] {
    if (setup_.grains) writer_ = make_writer(setup_.grains->grains());
  });
  observe(true, false);
}

std::shared_ptr<dem::Writer> RunLoop::make_writer(std::span<const dem::Grain> reference) const {
  return std::make_shared<dem::Writer>(directory_, reference, clumps(setup_.scene.grains->shapes),
                                       setup_.scene.grains->periods);
}

/// Geometric path of the grains' modulus from its packing to its loading value.
void RunLoop::ramp(double share) {
  if (!setup_.grains) return;
  dem::Material material = setup_.scene.grains->materials[0];
  const double from = setup_.scene.grains->packing->young_modulus;
  material.young_modulus = from * std::pow(material.young_modulus / from, share);
  setup_.grains->set_material(0, material);
}

/// An explicit step leads to places that need no force of its end; an implicit one is a whole.
bool RunLoop::is_predicted() const { return setup_.window.n_fem == 1 && setup_.scene.is_explicit(); }

bool RunLoop::fem_begin() {
  auto& model = *setup_.bodies;
  const Window& w = setup_.window;
  if (setup_.exchange && failure_.kind == Failure::none) setup_.exchange->begin_window(model);
  if (w.n_fem == 1 && failure_.kind == Failure::none) failure_ = timed(fem_seconds_, [&] { model.predict(w.dt_fem); });
  // Within one process nobody else has to be told, and nobody would take the message.
  const bool tell = setup_.exchange && (failure_.kind == Failure::none || setup_.roles->size > 1);
  if (tell) setup_.exchange->send_skins(model, is_predicted() ? 0.0 : w.length(), failure_.kind != Failure::none);
  return failure_.kind == Failure::none;
}

bool RunLoop::dem_window() {
  auto& grains = *setup_.grains;
  const Window& w = setup_.window;
  Exchange* exchange = setup_.exchange.get();
  if (!exchange) {
    if (failure_.kind == Failure::none) failure_ = timed(dem_seconds_, [&] { grains.advance(w.n_dem, w.dt_dem); });
    return failure_.kind == Failure::none;
  }
  bool alive = true;
  const FailureText before = failure_;
  dem_seconds_ += exchange->seconds() + exchange->seconds_waited();
  failure_ = timed(dem_seconds_, [&] { alive = exchange->window(w.n_dem, w.dt_dem, before.kind != Failure::none); });
  dem_seconds_ -= exchange->seconds() + exchange->seconds_waited();
  if (before.kind != Failure::none) failure_ = before;
  return alive && failure_.kind == Failure::none;
}

bool RunLoop::fem_end() {
  auto& model = *setup_.bodies;
  const Window& w = setup_.window;
  const bool late = setup_.scene.coupling.scheme == Scheme::concurrent;
  if (w.n_fem == 1) failure_ = timed(fem_seconds_, [&] { model.inner_forces(); });
  // The other side's message is taken in any case; nothing waits in the air when this side has failed.
  if (setup_.exchange && !late && !setup_.exchange->receive_impulses()) return false;
  if (failure_.kind == Failure::none) {
    if (setup_.exchange) setup_.exchange->apply(model, w.length());
    failure_ = timed(fem_seconds_, [&] { take_fem_steps(); });
  }
  if (setup_.exchange && late && !setup_.exchange->receive_impulses()) return false;
  return failure_.kind == Failure::none;
}

/// The window's FEM steps, or with one the rest of it.
void RunLoop::take_fem_steps() {
  auto& model = *setup_.bodies;
  const Window& w = setup_.window;
  if (w.n_fem == 1) return model.correct(w.dt_fem);
  for (int step = 0; step < w.n_fem; ++step) {
    model.predict(w.dt_fem);
    model.inner_forces();
    model.correct(w.dt_fem);
  }
}

bool RunLoop::step_window() {
  bool sound = true;
  if (setup_.bodies) sound = fem_begin();
  if (setup_.grains && sound) sound = dem_window();
  // A failed correct() is told to the other side by the next window's message, or at the next sample.
  bool alive = sound;
  if (setup_.bodies && sound) {
    alive = fem_end();
    if (setup_.exchange && failure_.kind != Failure::none) alive = true;
  }
  if (setup_.exchange) setup_.exchange->finish_window();
  time_ += setup_.window.length();
  ++windows_;
  dem_steps_ += setup_.window.n_dem;
  fem_steps_ += setup_.window.n_fem;
  return alive;
}

void RunLoop::observe(bool picture, bool final) {
  const auto start = Clock::now();
  agree(setup_.roles->world, [&] {
    raise(failure_);
    files_.check();
  });
  const auto sample = sampler_.sample(time_, picture);
  agree(setup_.roles->world, [&] {
    if (setup_.grains && setup_.scene.time.force_step) guard_flight();
    if (measuring_) ledger_.add(sample.energy);
    if (picture && (measuring_ || final)) write_picture();
    if (!setup_.roles->is_root()) return;
    std::vector<double> row{time_, static_cast<double>(stage_)};
    row.insert(row.end(), sample.probes.begin(), sample.probes.end());
    append_energy(row, sample.energy, ledger_);
    row.push_back(setup_.exchange ? setup_.exchange->momentum_error() : 0.0);
    if (is_coupled(setup_.scene)) append_impulses(row, sample.energy);
    history_->row(row);
    if (!measuring_) return;
    series_.time.push_back(time_);
    for (std::size_t p = 0; p < sample.probes.size(); ++p) series_.columns[p].push_back(sample.probes[p]);
    guard_energy(10);
  });
  // Costs about a step: not at every sample.
  if (picture || ++samples_since_bound_ >= 4) obey_contacts();
  output_seconds_ += seconds_since(start);
}

/// With a step forced far above the limit grains may fly through each other without ever touching: no energy is lost.
void RunLoop::guard_flight() {
  for (const dem::Grain& grain : setup_.grains->grains()) {
    const double way = norm(grain.velocity) * setup_.window.dt_dem;
    if (way <= grain.radius) continue;
    throw base::UnstableError(fmt::format(
        "t = {:.6g} s: grain {} at ({:.4g}, {:.4g}, {:.4g}) m moves {:.3g} m in one step of {:.3g} s, farther than its "
        "radius of {:.3g} m, and misses what it should touch; remove time.force_step",
        time_, grain.id, grain.position.x, grain.position.y, grain.position.z, way, setup_.window.dt_dem,
        grain.radius));
  }
}

/// A run that leaves its energy budget has become unstable, whatever its numbers look like. Among the first samples,
/// when little work has been done, it is not judged.
void RunLoop::guard_energy(std::size_t samples) {
  constexpr double tolerance = 0.5;  // of the work done and the energy there was: far outside any honest error
  const auto& energy = ledger_.last();
  const double budget =
      ledger_.external_work() + energy.grains.losses() + energy.bodies.losses() + ledger_.stored_at_start();
  if (series_.time.size() < samples || !(std::abs(ledger_.residual()) > tolerance * budget) || budget < 1e-12) return;
  std::string place;
  if (setup_.grains) {
    const auto list = setup_.grains->grains();
    const auto fastest = std::max_element(list.begin(), list.end(), [](const dem::Grain& a, const dem::Grain& b) {
      return base::norm2(a.velocity) < base::norm2(b.velocity);
    });
    if (fastest != list.end())
      place = fmt::format("; fastest grain {} at ({:.4g}, {:.4g}, {:.4g}) m with {:.3g} m/s", fastest->id,
                          fastest->position.x, fastest->position.y, fastest->position.z, base::norm(fastest->velocity));
  }
  throw base::UnstableError(fmt::format(
      "t = {:.6g} s, window {}: the energy balance is lost: residual {:.3g} J after {:.3g} J of work (grains hold "
      "{:.3g} J, "
      "bodies {:.3g} J, interface mismatch {:.3g} J){}; take a smaller step (time.dem_fraction, time.fem_fraction)",
      time_, windows_, ledger_.residual(), ledger_.external_work(), energy.grains.stored(), energy.bodies.stored(),
      ledger_.interface_mismatch(), place));
}

/// What this rank has to write of this instant goes to the background; the picture before is waited for.
void RunLoop::write_picture() {
  files_.await(BackgroundWriter::picture);
  std::function<void()> of_bodies;
  if (setup_.bodies) of_bodies = setup_.bodies->picture(directory_.string(), time_);
  if (!setup_.grains) {
    if (of_bodies) files_.start(BackgroundWriter::picture, std::move(of_bodies));
    return;
  }
  if (!writer_) writer_ = make_writer(setup_.grains->grains());  // stopped before the measured stage
  files_.start(BackgroundWriter::picture, [of_bodies = std::move(of_bodies), take = setup_.grains->picture(),
                                           writer = writer_, time = time_, directory = directory_,
                                           with_contacts = setup_.scene.output.contacts]() mutable {
    if (of_bodies) std::exchange(of_bodies, {})();
    const dem::Picture picture = std::exchange(take, {})();
    writer->write(time, picture.grains, picture.grain_contacts, picture.wall_contacts);
    if (!with_contacts) return;
    writer->write_contacts(time, picture.grain_contacts, picture.wall_contacts);
    write_file(directory / "contact_forces.csv", contact_forces_text(picture.grain_contacts, picture.wall_contacts));
  });
}

/// Everything that has been asked for is on the disk after this, or its failure is thrown.
void RunLoop::await_files() {
  files_.await_all();
  files_.check();
}

/// One window; that of a side without partner ends where the next thing is to happen.
void RunLoop::advance_to_next_instant(const Stage& stage) {
  const bool alone = !setup_.scene.has_bodies(), steered = steers_walls();
  double instant = std::min(place_.first + stage.duration, place_.next_picture);
  if (setup_.scene.output.probe_interval > 0) instant = std::min(instant, place_.next_probe);
  if (stage.ramp_stiffness) instant = std::min(instant, time_ + 16 * setup_.window.dt_dem);
  if (steered) instant = std::min(instant, time_ + 32 * setup_.window.dt_dem);
  setup_.aim_at(instant - time_);
  const FailureText failed = caught([&] {
    if (stage.ramp_stiffness && (alone || place_.windows % 16 == 0)) ramp((time_ - place_.first) / stage.duration);
    if (setup_.grains && steered) load_walls();
  });
  // Told to the other side with this window's messages, as is what failed at the end of the last one.
  if (failure_.kind == Failure::none) failure_ = failed;
  if (!step_window()) raise({Failure::internal, ""});
}

bool RunLoop::run_stage(const Stage& stage, std::optional<double> until) {
  const auto& output = setup_.scene.output;
  const double picture_interval = output.interval > 0 ? output.interval : stage.duration;
  if (!goes_on_) {
    setup_.choose_window();
    setup_.fit_to(stage.duration);
    obey_contacts();
    begin(stage);
    place_ = {time_, time_ + output.probe_interval, time_ + picture_interval, 0};
  }
  const double end = place_.first + stage.duration;
  for (bool alone = !setup_.scene.has_bodies();; ++place_.windows) {
    if (!std::exchange(goes_on_, false)) advance_to_next_instant(stage);
    // An instant has come when the middle of the next window (or of the next step, where windows are cut to fit)
    // would lie beyond it.
    const double half = 0.5 * (alone ? setup_.window.dt_dem : setup_.window.length());
    const bool enough = until && time_ >= *until;
    const bool last = time_ + half >= end || enough;
    const bool picture = last || time_ + half >= place_.next_picture;
    const bool sampling = picture || time_ + half >= place_.next_probe;
    look_after_checkpoints(half, sampling);
    if (sampling) observe(picture, enough);
    if (output.probe_interval > 0)
      place_.next_probe = next_instant(place_.next_probe, time_ + half, output.probe_interval);
    place_.next_picture = next_instant(place_.next_picture, time_ + half, picture_interval);
    progress_.show(stage.name, time_, time_ / total_, static_cast<double>(windows_) / seconds_since(start_),
                   ledger_.relative_error());
    if (enough) return false;
    if (last) return true;
  }
}

void RunLoop::run(std::optional<double> until) {
  const InterruptWatch watch;
  const FailureText stop = caught([&] {
    const auto& stages = setup_.scene.stages;
    for (; stage_ < static_cast<int>(stages.size()); ++stage_)
      if (!run_stage(stages[static_cast<std::size_t>(stage_)], until)) return;
    agree(setup_.roles->world, [&] {
      if (measuring_ && setup_.roles->is_root()) guard_energy(0);
    });
  });
  progress_.clear();
  // Whoever left the loop does so for its own failure, for the other side's, or for one already agreed on.
  if (stop.kind != Failure::none && failure_.kind == Failure::none && !stop.text.empty()) failure_ = stop;
  const auto start = Clock::now();
  const FailureText unwritten = caught([&] { await_files(); });
  if (unwritten.kind != Failure::none) failure_ = unwritten;  // of an earlier instant than anything else
  FailureText agreed = caught([&] { agree(setup_.roles->world, [&] { raise(failure_); }); });
  if (agreed.kind == Failure::interrupted) {
    agree(setup_.roles->world, [&] {
      write_picture();
      await_files();
    });
  }
  output_seconds_ += seconds_since(start);
  close_summary();
  if (agreed.kind == Failure::unstable) agreed.text += remedy();
  if (agreed.kind != Failure::none) agreed.text += next_steps(agreed.kind);
  raise(agreed);
}

void RunLoop::close_summary() {
  const auto& roles = *setup_.roles;
  if (roles.fem_ranks > 0 && roles.first_fem_rank != 0) {
    double seconds[2] = {fem_seconds_, setup_.exchange ? setup_.exchange->seconds() : 0.0};
    if (roles.is_fem_root()) MPI_Send(seconds, 2, MPI_DOUBLE, 0, 31, roles.world);
    if (roles.is_root()) MPI_Recv(seconds, 2, MPI_DOUBLE, roles.first_fem_rank, 31, roles.world, MPI_STATUS_IGNORE);
    fem_seconds_ = seconds[0];
  }
  std::int64_t elements = 0;
  for (const auto& body : setup_.body_counts) elements += body.elements;
  if (roles.fem_ranks > 0) MPI_Bcast(&elements, 1, MPI_INT64_T, roles.first_fem_rank, roles.world);
  const Window& w = setup_.window;
  summary_.scene = setup_.scene.file.string();
  summary_.title = setup_.scene.title;
  summary_.time_simulated = time_;
  summary_.ranks = roles.all_ranks;
  summary_.dem_ranks = roles.dem_ranks;
  summary_.fem_ranks = roles.fem_ranks;
  summary_.threads = setup_.threads;
  summary_.backend = setup_.grains ? (setup_.backend == dem::Backend::cuda ? "cuda" : "omp") : "none";
  summary_.device = setup_.device;
  if (setup_.scene.grains && setup_.scene.grains->precision == dem::Precision::mixed) summary_.precision = "mixed";
  summary_.elements = elements;
  summary_.windows = windows_;
  summary_.dem_steps = dem_steps_;
  summary_.fem_steps = fem_steps_;
  summary_.dem_dt = w.dt_dem;
  summary_.fem_dt = w.dt_fem;
  summary_.dem_limiter = setup_.dem_limit.limiter;
  if (setup_.scene.has_bodies()) summary_.solver = solver_name(setup_.scene.solver.kind);
  summary_.fem_limiter = setup_.fem_limit.limiter;
  summary_.measured = measuring_;
  summary_.ledger = ledger_;
  if (setup_.grains) {
    const auto counts = setup_.grains->counts();
    summary_.grains = counts.grains;
    summary_.spheres = counts.spheres;
    summary_.dem_bytes = counts.bytes;
    summary_.seconds["dem"] = dem_seconds_;
  }
  if (setup_.scene.has_bodies()) summary_.seconds["fem"] = fem_seconds_;
  if (setup_.exchange) {
    summary_.seconds["exchange"] = setup_.exchange->seconds();
    summary_.seconds["waiting"] = setup_.exchange->seconds_waited();
    summary_.momentum_error = setup_.exchange->momentum_error();
    for (const auto& skin : setup_.skins) summary_.skin_nodes += static_cast<std::int64_t>(skin.nodes.size());
    if (setup_.grains) summary_.traffic = setup_.exchange->traffic();
  }
  summary_.seconds["output"] = output_seconds_;
}

}  // namespace coupling
