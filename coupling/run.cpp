#include "coupling/run.hpp"

#include <fmt/core.h>
#include <mpi.h>
#include <spdlog/sinks/basic_file_sink.h>
#include <spdlog/sinks/ringbuffer_sink.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <sstream>

#include "base/error.hpp"
#include "coupling/agree.hpp"
#include "coupling/checkpoint.hpp"
#include "coupling/grain_files.hpp"
#include "coupling/interrupt.hpp"
#include "coupling/modal_run.hpp"
#include "coupling/run_files.hpp"
#include "coupling/run_loop.hpp"
#include "coupling/setup.hpp"
#include "coupling/spectrum.hpp"
#include "coupling/summary.hpp"

namespace coupling {

namespace {

namespace fs = std::filesystem;

using Ring = spdlog::sinks::ringbuffer_sink_mt;

/// The log before the run has a folder: the screen on the root, silence elsewhere. What is said is kept for run.log.
std::shared_ptr<Ring> open_log(bool root) {
  if (!root) {
    spdlog::set_level(spdlog::level::off);
    return nullptr;
  }
  auto screen = std::make_shared<spdlog::sinks::stdout_sink_mt>();
  screen->set_pattern("%v");
  auto kept = std::make_shared<Ring>(10000);
  auto logger = std::make_shared<spdlog::logger>("run", spdlog::sinks_init_list{screen, kept});
  logger->flush_on(spdlog::level::info);
  spdlog::set_default_logger(logger);
  return kept;
}

/// From now on the log goes to run.log too, what was said before at its head.
void move_log(const std::shared_ptr<Ring>& kept, const fs::path& directory, bool anew) {
  if (!kept) return;
  auto file = std::make_shared<spdlog::sinks::basic_file_sink_mt>((directory / "run.log").string(), anew);
  file->set_pattern("%Y-%m-%d %H:%M:%S.%e %l %v");
  for (const auto& message : kept->last_raw()) file->log(message);
  auto& sinks = spdlog::default_logger()->sinks();
  std::replace(sinks.begin(), sinks.end(), std::static_pointer_cast<spdlog::sinks::sink>(kept),
               std::static_pointer_cast<spdlog::sinks::sink>(file));
}

const char* status_word(Failure kind) {
  switch (kind) {
    case Failure::none:
      return "completed";
    case Failure::unstable:
      return "unstable";
    case Failure::interrupted:
      return "interrupted";
    default:
      return "failed";
  }
}

void finish(const Setup& setup, const fs::path& directory, const FailureText& failure, Summary& summary,
            const Series& series) {
  const auto outcomes = failure.kind == Failure::none ? evaluate(setup.scene, series) : std::vector<Outcome>{};
  summary.status = status_word(failure.kind);
  summary.message = failure.text;
  write_file(directory / "summary.json", to_json(summary, outcomes));
  if (failure.kind != Failure::none) return;
  const std::string spectra = spectra_text(setup.scene, series);
  if (!spectra.empty()) write_file(directory / "spectra.csv", spectra);
  if (!outcomes.empty()) spdlog::info("\n{}", table(outcomes));
  if (summary.measured) {
    spdlog::info("energy error {:.3g} of the work done, momentum error {:.2g} of the impulse passed",
                 summary.ledger.relative_error(), summary.momentum_error);
  }
  spdlog::info("{} in {:.1f} s; results in {}",
               setup.scene.is_modal() ? "modes found" : fmt::format("{:.4g} s simulated", summary.time_simulated),
               summary.wall, directory.string());
}

fs::path parent_of(const fs::path& file) { return file.has_parent_path() ? file.parent_path() : fs::path("."); }

/// The life of a rank, from the scene on.
void run_rank(const RunOptions& options) {
  Summary summary;
  Setup setup(MPI_COMM_WORLD, options);
  const Roles& roles = *setup.roles;
  const auto kept = open_log(roles.is_root());
  if (!setup.backend_text.empty()) spdlog::info("{}", setup.backend_text);
  if (roles.is_worker) return serve_slabs(roles.dem, dem::Simulation::create, roles.joint);
  const CheckpointWatch watch;
  fs::path directory = options.out.value_or(fs::path("runs") / options.scene.stem());
  const auto restart = find_restart(options, setup.scene, roles, directory);
  if (restart && options.until) {
    const double reached = base::column<std::vector<double>>(restart->columns, "run/clock").front();
    base::require_user(*options.until > reached,
                       fmt::format("--until {:.6g} s: {} was written at {:.6g} s already; give a later time",
                                   *options.until, restart->file.string(), reached));
  }
  const fs::path earlier = restart ? parent_of(restart->file) : fs::path();
  if (restart && !options.out) directory = earlier;
  std::error_code ignored;
  const bool in_place = restart && fs::equivalent(directory, earlier, ignored);
  agree(roles.world, [&] {
    if (!roles.is_root()) return;
    base::require_user(!in_place || !options.overwrite || options.restart == "auto",
                       fmt::format("--overwrite: the run in {} is the one to go on with; leave it out, or give another "
                                   "--out",
                                   directory.string()));
    if (!in_place) check_run_directory(directory, options.overwrite);
  });
  spdlog::info("{}", setup.scene.title);
  std::istringstream warnings(setup.warnings);
  for (std::string line; std::getline(warnings, line);) spdlog::warn("{}", line);

  // Everything that can be refused is refused before an earlier run in the folder is touched.
  if (restart)
    setup.restore(*restart, summary);
  else
    setup.place_grains(summary);
  agree(roles.world, [&] {
    if (!roles.is_root()) return;
    if (in_place) return move_log(kept, directory, false);
    make_run_directory(directory, options.overwrite);
    if (restart) copy_results(earlier, directory);
    write_file(directory / "scene.resolved.toml", setup.scene.resolved_toml);
    if (setup.grains && !restart) {
      const std::string sieves = sieve_curve_text(setup.scene, setup.grains->grains());
      if (!sieves.empty()) write_file(directory / "sieve_curve.csv", sieves);
    }
    move_log(kept, directory, true);
  });
  Series series;
  const FailureText failure = caught([&] {
    if (setup.scene.is_modal()) {
      run_modal(setup, directory, summary, series);
      return;
    }
    RunLoop loop(setup, directory, summary, series, restart ? &*restart : nullptr);
    loop.run(options.until);
  });
  summary.wall = summary.wall_so_far();
  const FailureText written = caught([&] {
    agree(roles.world, [&] {
      if (roles.is_root()) finish(setup, directory, failure, summary, series);
    });
  });
  if (roles.is_root()) spdlog::default_logger()->flush();
  raise(failure);
  raise(written);
}

}  // namespace

void run(const RunOptions& options) {
  agree(MPI_COMM_WORLD, [&] { run_rank(options); });  // workers learn how the run has ended
}

}  // namespace coupling
