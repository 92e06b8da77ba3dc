// When a run writes checkpoints, what it puts into them, and how it goes on from one.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.hpp"
#include "coupling/column_file.hpp"
#include "coupling/instants.hpp"
#include "coupling/interrupt.hpp"
#include "coupling/run_loop.hpp"

namespace coupling {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// The largest of what the ranks say, on every rank.
template <std::size_t N>
void largest(std::array<int, N>& values, const Roles& roles) {
  if (roles.size == 1) return;
  const auto mine = values;
  MPI_Request request;
  MPI_Iallreduce(mine.data(), values.data(), static_cast<int>(N), MPI_INT, MPI_MAX, roles.world, &request);
  wait_politely(request);
}

/// False when a side's motion has blown up without having been noticed: that is no state to go on from.
bool is_finite(const base::Columns& columns) {
  const auto is_motion = [](const std::string& name) {
    return name.ends_with("nodes/velocity") || name.ends_with("grains/state") || name.ends_with("clumps/state");
  };
  return std::ranges::all_of(columns, [&](const auto& column) {
    const auto* values = std::get_if<std::vector<double>>(&column.second);
    return !values || !is_motion(column.first) ||
           std::ranges::all_of(*values, [](double x) { return std::isfinite(x); });
  });
}

template <class Self, class Walk>
void walk_series(Self& series, Walk& walk) {
  walk.rows("series/time", series.time);
  int columns = static_cast<int>(series.columns.size());
  walk.numbers("series/columns", columns);
  if constexpr (Walk::loads) series.columns.resize(static_cast<std::size_t>(columns));
  for (std::size_t p = 0; p < series.columns.size(); ++p) walk.rows(fmt::format("series/{}", p), series.columns[p]);
}

}  // namespace

/// The run's own numbers; those that every rank has the same, and on the root results and samples.
template <class Self, class Walk>
void RunLoop::walk(Self& self, Walk&& walk) {
  walk.numbers("clock", self.time_, self.stage_, self.windows_, self.dem_steps_, self.fem_steps_, self.measuring_,
               self.removed_, self.packing_friction_, self.smallest_contact_step_, self.samples_since_bound_);
  walk.numbers("place", self.place_.first, self.place_.next_probe, self.place_.next_picture, self.place_.windows,
               self.next_checkpoint_);
  auto& window = self.setup_.window;
  walk.numbers("window", window.n_dem, window.n_fem, window.dt_dem, window.dt_fem);
  walk.numbers("ledger", self.ledger_);
  walk.text("coupling_limiter", self.summary_.coupling_limiter);
  walk.text("window_limiter", self.summary_.window_limiter);
  auto& judged = self.judged_;
  walk.numbers("judged", judged.contacts.grain, judged.contacts.node, judged.contacts.body, judged.contacts.dashpot,
               judged.contacts.implicit_body, judged.n_dem, judged.n_fem, judged.longest, judged.damping_ratio,
               judged.shortest, self.smallest_window_);
  walk.numbers("seconds", self.dem_seconds_, self.output_seconds_);
  walk_series(self.series_, walk);
}

void RunLoop::look_after_checkpoints(double half, bool sampling) {
  const auto& output = setup_.scene.output;
  const double interval = output.checkpoint_interval;
  bool due = interval > 0 && time_ + half >= next_checkpoint_;
  // A run that is killed loses less than one interval and a half: of that age is the checkpoint before this one then.
  if (interval > 0 && time_ >= checkpoint_overdue_) files_.await(BackgroundWriter::checkpoint);
  if (due) next_checkpoint_ = next_instant(next_checkpoint_, time_ + half, interval);
  int signal = 0;
  if (sampling) {  // signals and clocks are each rank's own
    const bool late = output.checkpoint_wall_time > 0 && seconds_since(last_checkpoint_) >= output.checkpoint_wall_time;
    std::array<int, 2> news{late || CheckpointWatch::asked(), InterruptWatch::signal()};
    largest(news, *setup_.roles);
    due = due || news[0] || news[1];
    signal = news[1];
  }
  if (due) write_checkpoint();
  if (signal)
    throw base::InterruptedError(fmt::format("t = {:.6g} s: {}; results up to here are in {}", time_,
                                             InterruptWatch::name(signal), directory_.string()));
}

void RunLoop::write_checkpoint() {
  const auto start = Clock::now();
  const Roles& roles = *setup_.roles;
  CheckpointWatch::answered();
  std::function<base::Columns()> grains;
  base::Columns bodies;
  // A checkpoint names the pictures before it: those that other ranks write are waited for, the root's own come first.
  files_.await(BackgroundWriter::checkpoint);
  if (!roles.is_root()) files_.await(BackgroundWriter::picture);
  agree(roles.world, [&] { files_.check(); });
  agree(roles.world, [&] {
    raise(failure_);
    base::Columns of_grains;
    if (setup_.exchange) setup_.exchange->save(of_grains, bodies);
    if (setup_.bodies) bodies.merge(setup_.bodies->save());
    if (setup_.grains)
      grains = [state = setup_.grains->saved(), more = std::move(of_grains)]() mutable {
        base::Columns all = state();
        all.merge(more);
        return all;
      };
    if (roles.is_fem_root()) base::Saver(bodies).numbers("seconds", fem_seconds_);
  });
  if (roles.is_fem_root() && !roles.is_root()) send_columns(bodies, 0, roles.world);
  agree(roles.world, [&] {
    if (!roles.is_root()) return;
    if (roles.fem_ranks > 0 && !roles.is_fem_root()) bodies = receive_columns(roles.first_fem_rank, roles.world);
    base::Columns run;
    walk(*this, base::Saver(run));
    base::Saver saver(run);
    saver.numbers("history", history_->size());
    saver.numbers("wall", summary_.wall_so_far());
    setup_.save(run, summary_);
    add_group(run, "sampler/", sampler_.save());
    start_column_files();
    files_.start(BackgroundWriter::checkpoint,
                 [this, time = time_, grains = std::move(grains), bodies = std::move(bodies), run = std::move(run),
                  writer = writer_]() mutable {
                   base::Columns of_grains = grains ? std::exchange(grains, {})() : base::Columns();
                   if (!is_finite(of_grains) || !is_finite(bodies)) return;
                   sync_file(directory_ / "history.csv");
                   if (writer) add_group(run, "writer/", writer->save());
                   base::Columns all;
                   add_group(all, "run/", std::move(run));
                   add_group(all, "grains/", std::move(of_grains));
                   add_group(all, "bodies/", std::move(bodies));
                   checkpoints_.write(std::move(all), setup_.scene);
                   spdlog::info("t = {:.6g} s: {}", time, checkpoints_.last().filename().string());
                 });
  });
  last_checkpoint_ = Clock::now();
  checkpoint_overdue_ = checkpoint_taken_ + 1.5 * setup_.scene.output.checkpoint_interval;
  checkpoint_taken_ = time_;
  output_seconds_ += seconds_since(start);
}

void RunLoop::go_on_from(const Restart& restart) {
  const Roles& roles = *setup_.roles;
  const auto run = group_of(restart.columns, "run/"), bodies = group_of(restart.columns, "bodies/");
  base::Loader loader(run);
  walk(*this, base::Loader(run));
  goes_on_ = true;
  checkpoint_taken_ = time_;
  if (setup_.exchange) setup_.exchange->restore(group_of(restart.columns, "grains/"), bodies);
  if (roles.is_fem_root()) base::Loader(bodies).numbers("seconds", fem_seconds_);
  if (!roles.is_root()) return;
  std::uintmax_t kept = 0;
  loader.numbers("history", kept);
  loader.numbers("wall", summary_.earlier_wall);
  history_ = std::make_unique<HistoryFile>(directory_ / "history.csv", kept);
  sampler_.restore(group_of(run, "sampler/"));
  if (const auto written = group_of(run, "writer/"); !written.empty()) {
    writer_ = make_writer({});
    writer_->restore(written);
  }
  checkpoints_.go_on_from(restart.file);
  summary_.restarted_from = restart.file.string();
  spdlog::info("goes on from {} at t = {:.6g} s", restart.file.string(), time_);
}

std::string RunLoop::next_steps(Failure kind) const {
  if (checkpoints_.last().empty()) return "";
  if (kind == Failure::interrupted)
    return fmt::format("; to go on: trackbed run {} --restart {}", setup_.scene.file.string(),
                       checkpoints_.last().string());
  return fmt::format("; last good checkpoint: {}", checkpoints_.last().string());
}

}  // namespace coupling
