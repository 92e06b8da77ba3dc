#pragma once
// The stages of a run, window by window.
//
// One window, W = n_dem dt_dem = n_fem dt_fem, on each side (window.hpp: its schemes and what they cost):
//   FEM: n_fem = 1: predict to the window's end (u there needs no force of that instant), send the skin, take the inner
//        forces while the grains work, receive the nodal impulses, correct. At 1 : 1 both sides so use forces of one
//        and the same instant, as a single velocity-Verlet step of the whole would. n_fem > 1, and implicit steps: send
//        the skin extrapolated over the window, receive, then n_fem steps under the force impulse / W. Concurrent: take
//        the steps under the impulse of the window before, then receive.
//   DEM: receive, n_dem steps over the moving skin, send the impulse.
#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>

#include "coupling/agree.hpp"
#include "coupling/background_writer.hpp"
#include "coupling/checkpoint.hpp"
#include "coupling/coupled_step.hpp"
#include "coupling/progress.hpp"
#include "coupling/run_files.hpp"
#include "coupling/sampler.hpp"
#include "coupling/setup.hpp"
#include "coupling/summary.hpp"
#include "dem/output.hpp"

namespace coupling {

class RunLoop {
 public:
  /// With a restart the run goes on from there. Collective.
  RunLoop(Setup&, std::filesystem::path directory, Summary&, Series&, const Restart* = nullptr);
  /// All stages, or up to this simulated time [s]. Collective; throws the same error on every rank.
  void run(std::optional<double> until);

 private:
  void begin(const Stage&);
  void begin_walls();
  void load_walls();
  void zero();
  void use_friction(bool of_packing);
  void ramp(double share);
  bool steers_walls() const;                                  // some wall is pulled by a load that may change
  bool run_stage(const Stage&, std::optional<double> until);  // false: stopped before its end
  void advance_to_next_instant(const Stage&);
  bool step_window();  // false: this rank or the other side has failed
  bool fem_begin();
  bool dem_window();
  bool fem_end();
  void take_fem_steps();
  bool is_predicted() const;
  void observe(bool picture, bool final);  // final: the run stops here; its state is written in any case
  void guard_energy(std::size_t samples);
  void guard_flight();
  // run_loop_limits.cpp
  void obey_contacts();
  double judge_window(double grain_limit);
  std::string remedy() const;
  void write_picture();
  void await_files();
  std::shared_ptr<dem::Writer> make_writer(std::span<const dem::Grain> reference) const;
  void close_summary();
  // run_loop_checkpoint.cpp
  void look_after_checkpoints(double half, bool sampling);
  void write_checkpoint();
  void go_on_from(const Restart&);
  template <class Self, class Walk>
  static void walk(Self&, Walk&&);
  std::string next_steps(Failure) const;  // what a failed run can go on from, in words

  Setup& setup_;
  std::filesystem::path directory_;
  Summary& summary_;
  Series& series_;
  Sampler sampler_;
  Progress progress_;
  std::unique_ptr<HistoryFile> history_;
  std::shared_ptr<dem::Writer> writer_;  // in the hands of files_ from the first picture on
  CheckpointFolder checkpoints_;
  std::chrono::steady_clock::time_point last_checkpoint_ = std::chrono::steady_clock::now(), start_ = last_checkpoint_;
  FailureText failure_;  // of this rank
  Ledger ledger_;
  double time_ = 0, total_ = 0;
  int stage_ = 0;
  /// Where the present stage began, what comes next in it [s], and how many windows it has had.
  struct Place {
    double first = 0, next_probe = 0, next_picture = 0;
    std::int64_t windows = 0;
  } place_;
  double next_checkpoint_ = 0;                            // [s] when the next is due;
  double checkpoint_taken_ = 0, checkpoint_overdue_ = 0;  // when the last was taken, when it must be on the disk
  bool goes_on_ = false;                                  // the next window has been done already, before the restart
  bool packing_friction_ = false;                         // grains have the friction of their packing
  bool measuring_ = false, removed_ = false;              // removed: walls, at the start of this stage
  double smallest_contact_step_ = 0;
  /// How hard skins were pressed when the longest window [s] was found last; see judge_window().
  struct Judged {
    SkinContacts contacts;
    int n_dem = 0, n_fem = 0;
    double longest = 0, damping_ratio = 0, shortest = 0;  // [s] [-] [s]
  } judged_;
  double smallest_window_ = 0;  // [s] of those found
  double warned_ = 0;           // damping ratio that has been spoken of
  int samples_since_bound_ = 0;
  double dem_seconds_ = 0, fem_seconds_ = 0, output_seconds_ = 0;
  std::int64_t windows_ = 0, dem_steps_ = 0, fem_steps_ = 0;
  BackgroundWriter files_;  // of this rank; goes first, since what it writes reads the rest
};

}  // namespace coupling
