#pragma once
// A window of steps without the host: all of its steps are queued at once, kernels decide by the control block
// (control.hpp) whether they are done, and the host looks at what has become of them now and then. It makes new lists
// where they have become stale, for the step that found them so, and queues the rest.
#include "dem/core/system_bodies.hpp"

namespace dem::TRACKBED_DEM_SYSTEM {

/// Steps queued between two looks. A look costs about as much as a step of a small scene; steps that do nothing, after
/// one that needs new lists, a few microseconds each.
constexpr int steps_between_looks = 32;

inline bool System::queues() const { return !sweeps() && !in_company(); }

inline void System::advance_queued(int n, double dt) {
  if (n == 0) return;
  const std::int64_t before = steps_;
  Control now;
  now.steps = n;
  now.dt = dt;
  now.gravity = setup_.gravity;
  set_start(now);
  last_ahead_ = interval(dt).ahead;
  const auto queue_last_steps = [&](int steps) {
    queue_.repeat(steps, [&] { queue_step(dt); });
    queue_end(dt, dt);
    if (walls_.nodal()) fetch_impulses();
    queue_look();
  };
  const bool is_short = n <= steps_without_graph;
  if (!is_short) send_start();
  for (int begun = 0;;) {
    const int end = std::min(n, begun + steps_between_looks);
    if (is_short && begun == 0) {  // a coupled window, mostly: the same as the last one until lists are new
      queue_.window([&] {
        send_start();
        queue_last_steps(n);
      });
    } else if (end == n) {
      queue_last_steps(end - begun);
    } else {
      queue_.repeat(end - begun, [&] { queue_step(dt); });
      queue_look();
    }
    look(now);
    steps_ = before + now.step;
    if (!now.finite()) stop_unstable(0, now.step * dt);
    if (now.lists_are_stale()) {
      node_impulse_is_here_ = wall_impulse_is_here_ = false;
      rebuild(now.share());
      set_start(now);
      send_start();
      queue_rest_of_step(dt);
    } else {
      if (now.trouble) stop_unstable(now.trouble, now.step * dt);
      if (end == n) return;
    }
    begun = now.step;
  }
}

/// What the steps to come start from: the present lists and walls.
inline void System::set_start(Control& control) {
  control.halts = 0;
  control.moved = 0;
  control.tight = tight_;
  control.skin = skin_;
  control.walls = walls_.any() && grains_.size() > 0;
  control.wall_shift = 0;  // the first step, or the forces on new lists, come whatever the walls do
  control.still_shift = walls_.shift(0);
  *control_host_.data() = control;
  const bool moving = walls_.moving();
  driven_.resize(moving ? walls_.walls.size() : 0);
  if (moving) walls_.write_drives(driven_host_.make(driven_.size()));
  std::vector<int> bodies;
  for (std::size_t k = 0; k < driven_.size(); ++k)
    if (walls_.walls[k].motion == WallMotion::body) bodies.push_back(static_cast<int>(k));
  if (bodies != wall_bodies_host_) upload(bodies, wall_bodies_);
  wall_bodies_host_ = bodies;
}

inline void System::send_start() {
  queue_.send(control_host_.data(), pointer(control_), 1);
  queue_.send(driven_host_.data(), pointer(driven_), driven_.size());
}

inline void System::queue_look() {
  queue_.fetch(pointer(control_), control_host_.data(), 1);
  queue_.fetch(pointer(driven_), driven_host_.data(), driven_.size());
}

/// Waits for what has been queued.
inline void System::look(Control& control) {
  queue_.wait();
  control = *control_host_.data();
  if (!driven_.empty()) walls_.read_drives(driven_host_.data());
}

/// A control block that holds nothing back, for passes outside a window.
inline void System::send_free_control(double dt, int step) {
  Control control;
  control.steps = 1;
  control.step = step;
  control.dt = dt;
  control.tight = HUGE_VAL;
  *control_host_.data() = control;
  queue_.send(control_host_.data(), pointer(control_), 1);
}

inline void System::queue_step(double dt) {
  queue_.launch(1, BeginStep{pointer(control_), pointer(driven_), static_cast<int>(driven_.size())});
  queue_motion(dt, driven_.empty() ? 0 : static_cast<int>(walls_.position.size()));
  queue_rest_of_step(dt);
}

/// What follows the motion.
inline void System::queue_rest_of_step(double dt) {
  queue_forces(interval(dt), dt);
  if (wall_bodies_.empty()) return;
  const SumWallForce on_walls{.state = pointer(near_walls_.state),
                              .candidate = pointer(near_walls_.candidate),
                              .grain_of = pointer(near_walls_.grain_of),
                              .facet = pointer(walls_.facets),
                              .place = pointer(grains_.place),
                              .wall = 0,
                              .about = {}};
  queue_.launch_sums<6>(static_cast<int>(wall_bodies_.size()), near_walls_.size(),
                        FinishWalls{pointer(control_), on_walls, pointer(wall_bodies_), pointer(driven_)});
}

/// Grains, and so many nodes of walls.
inline void System::queue_motion(double dt, int nodes) {
  Control* const control = pointer(control_);
  with_numbers(setup_.precision, [&]<class Real>() {
    with_leap(dt, gathered_forces<Real>(), [&]<class Leap>(int n, const Leap& leap) {
      queue_.launch_largest(n + nodes, MoveAll<Leap>{control, leap, n, walls_.nodes(), pointer(driven_)},
                            &control->moved);
    });
  });
}

/// The part of a step after its motion.
inline void System::queue_forces(const kernels::Interval& time, double ended) {
  Control* const control = pointer(control_);
  const auto pass = [&](int n, const auto& functor) { queue_.launch(n, unless_stale(control, functor)); };
  pass(images_.size(), MoveImages{periods_, pointer(images_.owner), pointer(images_.shift), images_.first,
                                  grains_.parts, pointer(grains_.place), pointer(grains_.motion)});
  with_scene_law([&]<class Law, bool Ledger, bool Couples>() {
    const auto pairs = [&] {
      with_numbers(setup_.precision, [&]<class Real>() {
        const auto contacts = unless_stale(control, contact_pass<Law, Real, Ledger, Couples>(time));
        if constexpr (Ledger)
          queue_.launch_groups<5>(pairs_.size(), contacts);
        else
          queue_.launch(pairs_.size(), contacts);
      });
    };
    if (near_walls_.near_grains() == 0) return pairs();
    queue_.side_by_side(pairs, [&] { pass(near_walls_.near_grains(), wall_pass<Law, Ledger, Couples>(time, ended)); });
  });
  sweep_sums_ = {};  // the pairs say themselves from now on
  press_bonds(pass, ended);
}

/// The second half of the last step.
inline void System::queue_end(double dt, double ended) {
  with_numbers(setup_.precision, [&]<class Real>() {
    with_leap(dt, gathered_forces<Real>(), [&]<class Leap>(int n, const Leap& leap) {
      queue_.launch(n, EndSteps<Leap>{pointer(control_), leap, ended});
    });
  });
}

/// Rows of nodes to the backend, without waiting. Each kind has its own memory on the host, where the next copy of that
/// kind may overwrite it: it goes to the same place.
inline void System::send_nodes(NodeRows kind, std::span<const Vec3> rows, Vec3* to, int first) {
  const std::size_t nodes = walls_.position.size();
  if (sent_nodes_.size() < kinds_of_node_rows * nodes) queue_.wait();
  Vec3* const here = sent_nodes_.make(kinds_of_node_rows * nodes) + kind * nodes + first;
  std::copy(rows.begin(), rows.end(), here);
  queue_.send(here, to + first, rows.size());
}

/// What the bodies are told after every window.
inline void System::fetch_impulses() {
  fetch_node_impulse();
  const int walls = static_cast<int>(walls_.walls.size());
  wall_impulse_.resize(walls);
  const SumImpulse sum{pointer(near_walls_.impulse), pointer(near_walls_.candidate), pointer(walls_.facets), 0};
  queue_.launch_sums<3>(walls, near_walls_.size(), SumImpulses{sum, pointer(wall_impulse_)});
  queue_.fetch(pointer(wall_impulse_), wall_impulse_host_.make(walls), walls);
  wall_impulse_is_here_ = true;
}

inline void System::fetch_node_impulse() const {
  const std::size_t nodes = walls_.node_impulse.size();
  node_impulse_.resize(nodes);
  const bool candidates = !near_walls_.nodal.empty();
  queue_.launch(static_cast<int>(nodes),
                SumNodes{pointer(walls_.node_impulse),
                         {candidates ? pointer(near_walls_.node_start) : nullptr, pointer(near_walls_.node_entry),
                          pointer(near_walls_.nodal), pointer(node_impulse_)}});
  queue_.fetch(pointer(node_impulse_), node_impulse_host_.make(nodes), nodes);
  node_impulse_is_here_ = true;
}

}  // namespace dem::TRACKBED_DEM_SYSTEM
