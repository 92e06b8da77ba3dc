#pragma once
// The step: first half, list check, forces, second half.
#include <atomic>
#include <cstdio>

#include "dem/core/system_bodies.hpp"
#include "dem/core/system_queue.hpp"
#include "dem/core/system_reach.hpp"
#include "dem/core/system_slabs.hpp"

namespace dem::TRACKBED_DEM_SYSTEM {

inline void System::advance(int n, double dt) {
  base::require_internal(n >= 0 && dt > 0, "advance needs a positive step");
  [[maybe_unused]] const ThreadsFor threads(grains_.size());
  node_impulse_is_here_ = wall_impulse_is_here_ = false;
  walls_.begin_advance(n * dt, [this](const auto&... arguments) { send_nodes(arguments...); });
  if (!ghosts_.next_cuts.empty()) ghosts_.cuts = std::exchange(ghosts_.next_cuts, {});
  clear(near_walls_.impulse);
  clear(near_walls_.nodal);
  last_dt_ = dt;
  prepare(dt);
  if (queues())
    advance_queued(n, dt);
  else
    advance_by_steps(n, dt);
  time_ += n * dt;
}

/// The host looks at every step: it sweeps, or other parts must be asked.
inline void System::advance_by_steps(int n, double dt) {
  int trouble = 0;                // in company all parts stop together: after the next leap
  const bool queued = !sweeps();  // it is told then, too
  for (int k = 1; k <= n; ++k) {
    if (walls_.any()) walls_.move(k, n, dt, setup_.gravity);
    const double share = static_cast<double>(k) / n;
    // A part sees only the walls near it move; new lists are made by all or by none.
    double way[2] = {leap({.ends = k > 1, .ended = dt, .begins = true}, dt), walls_.any() ? walls_.shift(share) : 0};
    if (queued && k > 1) trouble = control_host_.data()[1].trouble;
    if (trouble) way[0] = HUGE_VAL;
    if (in_company()) setup_.company->largest(way);
    const auto [squared, wall_shift] = way;
    ++steps_;
    if (!(squared < HUGE_VAL)) stop_unstable(trouble, k * dt);
    move_ghosts();
    relist(std::sqrt(squared), wall_shift, share);
    evaluate(interval(dt), dt);
    if (!queued || k == n) trouble = met_trouble();
    if (trouble && !in_company()) stop_unstable(trouble, k * dt);
    if (walls_.bodies()) finish_walls(dt);
  }
  if (in_company() && over_parts(trouble) > 0) stop_unstable(trouble, n * dt);
  if (n > 0) leap({.ends = true, .ended = dt, .begins = false}, dt);
  move_images();
}

inline kernels::Interval System::interval(double dt) const {
  if (setup_.time_scheme == TimeScheme::symplectic_euler) return {.before = dt, .ahead = 0, .ended = dt};
  return {.before = 0.5 * dt, .ahead = 0.5 * dt};
}

/// What the last forces have met, when they are done.
inline int System::met_trouble() {
  if (sweeps()) return pointer(control_)->trouble;
  queue_.fetch(pointer(control_), control_host_.data(), 1);
  queue_.wait();
  return control_host_.data()->trouble;
}

/// Brings lists, masses and forces up to date after changes between steps.
inline void System::prepare(double dt) {
  const bool rows_changed = walls_.rows_changed;
  if (rows_changed) {
    flush_losses();
    walls_.upload_rows();
  }
  if (in_company()) {
    double stale[2] = {list_is_stale_ ? 1.0 : 0.0, forces_are_stale_ ? 1.0 : 0.0};
    setup_.company->largest(stale);
    list_is_stale_ = stale[0] > 0;
    forces_are_stale_ = stale[1] > 0;
  }
  if (keeps_grain_ledger() && grains_.ledger.empty())
    grains_.ledger.resize(bodies_.any() ? bodies_.size() : grains_.size());
  if (list_is_stale_)
    rebuild(0);
  else if (rows_changed)
    list_planes();
  if (forces_are_stale_) {
    // The histories are half a step ahead: taken back to this instant, and ahead again for the step to come.
    clear(grains_.pull);
    move_ghosts();
    if (!sweeps()) send_free_control(dt, 1);
    evaluate({-last_ahead_, interval(dt).ahead}, 0);
    const int trouble = met_trouble();
    if (over_parts(trouble) > 0) stop_unstable(trouble, 0);
    if (walls_.bodies()) feel_walls();
    leap({.ends = true, .ended = 0, .begins = false}, dt);
    book_removed_walls();
  }
  if (setup_.track_energy && !gravity_referenced_) {
    gravity_reference_ = gravity_potential();
    gravity_referenced_ = true;
  }
  forces_are_stale_ = false;
}

/// A wall that is taken away takes along what its contacts held.
inline void System::book_removed_walls() {
  if (!taken_away_) return;
  const base::Energy held = pending();
  totals_.work_walls += held.elastic_normal + held.elastic_shear - *taken_away_;
  taken_away_.reset();
}

/// Forces of the grains on walls that are bodies.
inline void System::feel_walls() {
  std::vector<double> sums;
  for (std::size_t k = 0; k < walls_.walls.size(); ++k) {
    const auto& body = walls_.walls[k].body;
    if (!body) continue;
    const auto sum = ordered_sum<6>(
        near_walls_.size(),
        SumWallForce{pointer(near_walls_.state), pointer(near_walls_.candidate), pointer(near_walls_.grain_of),
                     pointer(walls_.facets), pointer(grains_.place), static_cast<int>(k), body->state.centre});
    sums.insert(sums.end(), sum.value, sum.value + 6);
  }
  if (in_company()) setup_.company->sum(sums);
  const double* sum = sums.data();
  for (HostWall& wall : walls_.walls) {
    if (!wall.body) continue;
    wall.body->state.contact_force = {sum[0], sum[1], sum[2]};
    wall.body->state.contact_torque = {sum[3], sum[4], sum[5]};
    sum += 6;
  }
}

inline void System::finish_walls(double dt) {
  feel_walls();
  for (HostWall& wall : walls_.walls)
    if (wall.body) wall.body->finish_step(dt, setup_.gravity);
}

/// Grains that move fast want a thick skin (few builds), grains at rest a thin one (few candidates).
inline void System::adapt_skin() {
  const std::int64_t interval = steps_ - last_rebuild_;
  if (interval < 30) skin_share_ = std::fmin(0.5, 1.3 * skin_share_);
  if (interval > 300) skin_share_ = std::fmax(sweeps() ? 0.1 : 0.05, 0.8 * skin_share_);
}

/// New lists where grains have moved too far for the present ones: `moved` since the tight list was made, `wall_shift`
/// of the walls of all parts since the lists were.
inline void System::relist(double moved, double wall_shift, double share) {
  const bool walls_stale = walls_.any() && travelled_ + moved + wall_shift > skin_;
  if (2 * moved <= tight_ && !walls_stale) return;
  const double total = travelled_ + moved;
  if (!sweeps() || walls_stale || tight_ + 2 * total > skin_) return rebuild(share);
#if !defined(TRACKBED_DEM_CUDA)
  travelled_ = total;
  const std::int64_t interval = steps_ - last_tight_;
  if (interval < 20) tight_share_ = std::fmin(0.25 * skin_share_, 1.5 * tight_share_);
  if (interval > 80) tight_share_ = std::fmax(0.002, 0.8 * tight_share_);
  last_tight_ = steps_;
  tight_ = std::fmin(tight_share_ * radii_.smallest, skin_ - 2 * total);
  sweep_lists_.tighten(grains_, tight_, sweep_lists_.layout(), false);
  launch(grains_.size(), CopyPositions{pointer(grains_.place), pointer(grains_.listed)});
#endif
}

/// New lists for grains and walls where they are now, `share` of the way through the present advance().
inline void System::rebuild(double share) {
  flush_losses();
  flush_impulses();
  radii_ = reduce(grains_.size(), RadiiOf{pointer(grains_.place)}, Radii{}, JoinRadii{});
  radii_ = {-over_parts(-radii_.smallest), over_parts(radii_.largest)};
  if (radii_.largest > 0) {
    if (rebuilds_ > 0 && !list_is_stale_) adapt_skin();
    skin_ = setup_.skin > 0 ? setup_.skin : skin_share_ * radii_.smallest;
    if (!sweeps()) keep_touching_pairs();
    if (periods_.any()) return_grains();
    if (in_company()) migrate();
    const int n = grains_.size();
    const Box box = reduce(n, BoxOf{pointer(grains_.place)}, Box{}, JoinBoxes{});
    note_reach(box);
    const CellGrid grid = make_grid(box, 2 * radii_.largest + skin_, n);
    Vector<int> bucket, bucket_start;
    sort(grid, bucket);
    if (in_company())
      take_ghosts();
    else
      ghosts_.first = n;
    PairSearch search = this->search(grid, bucket, bucket_start);
    if (bonds_.any()) bonds_.find(grains_);
    const int materials = static_cast<int>(setup_.materials.size());
    const int history = history_stride();
    tight_ = skin_;
#if !defined(TRACKBED_DEM_CUDA)
    if (sweeps()) {
      tight_ = std::fmin(tight_share_ * radii_.smallest, 0.5 * skin_);
      const int threads = omp_get_max_threads();
      make_images(threads);
      search.place = pointer(grains_.place);
      // Ghosts are single spheres: where there are any, all are looked for as such.
      const Bodies* bodies = bodies_.any() && !in_company() ? &bodies_ : nullptr;
      sweep_lists_.find_near(search, bodies, n, images_, threads);
      sweep_lists_.tighten(grains_, tight_, sweep_layout(), true);
      last_tight_ = steps_;
    }
#endif
    if (!sweeps()) {
      if (periods_.any()) make_images(0);
      search.place = pointer(grains_.place);
      pairs_ = build_pairs(grains_, search, std::move(pairs_),
                           {.materials = materials,
                            .history = history,
                            .parameters = pointer(grain_parameters_),
                            .couples = couples_,
                            .ledger = setup_.track_energy,
                            .precision = setup_.precision,
                            .images = images_.rows()});
    }
    if (walls_.any())
      near_walls_ =
          build_walls(grains_, walls_, grid, near_walls_, {setup_.track_energy, history, skin_, radii_.largest});
    list_planes();
    grains_.listed.resize(n);
    launch(n, CopyPositions{pointer(grains_.place), pointer(grains_.listed)});
    thrust::sequence(policy(), grains_.old_of_new.begin(), grains_.old_of_new.end());
    recall();
    if (in_company()) count_work();
  } else {
    reach_ = nowhere;
    pairs_ = {};
    images_ = {};
    ghosts_.first = 0;
    near_walls_ = {};
#if !defined(TRACKBED_DEM_CUDA)
    planes_.clear();
    sweep_lists_ = {};
#endif
  }
  travelled_ = 0;
  walls_.listed_here(share);
  list_is_stale_ = rows_moved_ = false;
  last_rebuild_ = steps_;
  ++rebuilds_;
}

/// Of the old lists, what the new ones take over. What the pairs store is known as one sum until the next forces.
inline void System::keep_touching_pairs() {
  list_is_stale_ = true;  // should no new ones come of it
  const auto stored = pair_energies();
  sweep_sums_.elastic_normal += stored.value[2];
  sweep_sums_.elastic_shear += stored.value[3];
  with_numbers(setup_.precision, [&]<class Real>() { pairs_.keep_touching<Real>(); });
}

/// Spheres in the order of the grid, or bodies with their spheres.
inline void System::sort(const CellGrid& grid, Vector<int>& bucket) {
  if (bodies_.any())
    bodies_.sort_by_bucket(grid, grains_, bucket);
  else
    grains_.sort_by_bucket(grid, bucket);
}

inline PairSearch System::search(const CellGrid& grid, Vector<int>& bucket, Vector<int>& bucket_start) {
  if (in_company()) enter_ghosts(grid, bucket, entry_);
  bucket_starts(bucket, grid.buckets(), bucket_start);
  return {grid,
          pointer(bucket_start),
          pointer(in_company() ? entry_ : bodies_.sphere_entry),
          pointer(bodies_.of_sphere),
          pointer(grains_.place),
          skin_,
          periods_};
}

/// Back between the faces; what gravity does along the way is not its work.
inline void System::return_grains() {
  const double reach =
      bodies_.any() ? over_parts(reduce(bodies_.size(), RadiiOf{pointer(bodies_.place)}, Radii{}, JoinRadii{}).largest)
                    : radii_.largest;
  periods_.margin = 2 * radii_.largest + skin_ + (bodies_.any() ? reach : 0);
  for (int axis = 0; axis < 3; ++axis) {
    const double length = periods_.length[axis], least = 4 * reach + 2 * skin_;
    if (length == 0 || length >= least) continue;
    char message[200];
    std::snprintf(
        message, sizeof message,
        "dem: the period of %.4g m along %c is too short for grains of radius %.4g m; at least %.4g m is needed",
        length, "xyz"[axis], reach, least);
    throw base::UserError(message);
  }
  const bool referenced = gravity_referenced_;
  settle_gravity();
  if (bodies_.any())
    launch(bodies_.size(),
           ReturnBodies{periods_, pointer(bodies_.place), pointer(grains_.place), pointer(bodies_.start)});
  else
    launch(grains_.size(), ReturnGrains{periods_, pointer(grains_.place)});
  reference_gravity(referenced);
}

/// Images of the grains near periodic faces, and spare rows behind them.
inline void System::make_images(int spare_rows) {
  images_ = {};
  const int n = ghosts_.total();
  const Place* place = pointer(grains_.place);
  if (periods_.any()) {
    images_.start.resize(n + 1);
    launch(n, CountImages{periods_, place, pointer(images_.start)});
    const int images = counts_to_starts(images_.start);
    images_.owner.resize(images);
    images_.shift.resize(images);
    launch(n, NameImages{periods_, place, pointer(images_.start), pointer(images_.owner), pointer(images_.shift)});
  }
  images_.first = n;
  grains_.make_spare_rows(n, images_.size() + spare_rows);
  move_images();
}

/// Images to where their grains are now, with the motion that these have.
inline void System::move_images() {
  if (images_.size() == 0) return;
  launch(images_.size(), MoveImages{periods_, pointer(images_.owner), pointer(images_.shift), images_.first,
                                    grains_.parts, pointer(grains_.place), pointer(grains_.motion)});
}

inline bool System::sweeps() const {
#if defined(TRACKBED_DEM_CUDA)
  return false;
#else
  return setup_.lanes != 1;
#endif
}

#if !defined(TRACKBED_DEM_CUDA)
inline SweepLayout System::sweep_layout() const {
  SweepLayout layout;
  const int doubles = setup_.lanes ? setup_.lanes : sweep_lanes();
  layout.mixed = setup_.precision == Precision::mixed;
  layout.lanes = layout.mixed ? 2 * doubles : doubles;
  layout.materials = static_cast<int>(setup_.materials.size());
  for (const auto& pair : grain_parameters_host_) {
    const int history = law_history(pair.law);
    layout.histories.push_back(history_layout(history, setup_.track_energy, pair.rolling));
    const SweepChoice choice{.law = pair.law,
                             .rolling = pair.rolling,
                             .ledger = setup_.track_energy,
                             .turns = setup_.rotations,
                             .mixed = layout.mixed};
    layout.sweeps.push_back(find_sweep(choice, doubles));
  }
  return layout;
}
#endif

/// Calls visit.operator()<Law, Ledger, Couples>() with the leanest law that covers every pair of materials; see
/// ContactPass.
template <class Visit>
void System::with_scene_law(const Visit& visit) const {
  const auto with_law = [&]<bool Ledger, bool Couples>() {
    if (mixed_laws_)
      visit.template operator()<AnyLaw, Ledger, Couples>();
    else if (smooth_)
      visit.template operator()<kernels::HertzSmooth, Ledger, Couples>();
    else
      visit.template operator()<kernels::HertzMindlin, Ledger, Couples>();
  };
  if (setup_.track_energy)
    couples_ ? with_law.template operator()<true, true>() : with_law.template operator()<true, false>();
  else
    couples_ ? with_law.template operator()<false, true>() : with_law.template operator()<false, false>();
}

template <class Law, class Real, bool Ledger, bool Couples>
ContactPass<Law, Real, Ledger, Couples> System::contact_pass(const kernels::Interval& time) {
  using Pass = ContactPass<Law, Real, Ledger, Couples>;
  base::require_internal(pairs_.size() == 0 || pairs_.history_stride == Pass::numbers, "pairs keep other numbers");
  auto& numbers = pairs_.numbers<Real>();
  return {.geometry = {pointer(grains_.place), std::as_const(grains_).motions()},
          .first = pointer(pairs_.first),
          .second = pairs_.second_row.empty() ? pointer(pairs_.second) : pointer(pairs_.second_row),
          .pair = pointer(pairs_.pair),
          .parameters = pointer(grain_parameters_),
          .history = pointer(numbers.history),
          .result = pointer(numbers.result),
          .couple = pointer(numbers.couple),
          .ledger = pointer(pairs_.ledger),
          .partner = pointer(pairs_.second),
          .first_ghost = ghosts_.first,
          .unstable = &pointer(control_)->trouble,
          .maximum_overlap = setup_.maximum_overlap,
          .time = time};
}

template <class Law, bool Ledger, bool Couples>
WallPass<Law, Ledger, Couples> System::wall_pass(const kernels::Interval& time, double ended) {
  base::require_internal(
      near_walls_.size() == 0 || near_walls_.history_stride == WallPass<Law, Ledger, Couples>::numbers,
      "contacts with walls keep other numbers");
  return {.geometry = walls_.geometry(),
          .node_velocity = pointer(walls_.velocity),
          .node_displacement = pointer(walls_.displacement),
          .place = pointer(grains_.place),
          .motion = std::as_const(grains_).motions(),
          .grain_material = pointer(grains_.material),
          .parameters = pointer(wall_parameters_),
          .materials = static_cast<int>(setup_.materials.size()),
          .grain = pointer(near_walls_.grain),
          .start = pointer(near_walls_.start),
          .candidate = pointer(near_walls_.candidate),
          .state = pointer(near_walls_.state),
          .found = pointer(near_walls_.found),
          .history = pointer(near_walls_.history),
          .sum = pointer(near_walls_.sum),
          .impulse = pointer(near_walls_.impulse),
          .nodal = pointer(near_walls_.nodal),
          .nodal_rows = walls_.nodal_rows(),
          .ledger = pointer(near_walls_.ledger),
          .passed = pointer(near_walls_.passed),
          .unstable = &pointer(control_)->trouble,
          .maximum_overlap = setup_.maximum_overlap,
          .time = time,
          .dt = ended};
}

/// Which grains near walls are taken several at once.
inline void System::list_planes() {
#if !defined(TRACKBED_DEM_CUDA)
  planes_.clear();
  if (sweeps() && near_walls_.near_grains() > 0)
    planes_.make(near_walls_, walls_, grains_.material, static_cast<int>(setup_.materials.size()));
#endif
}

#if !defined(TRACKBED_DEM_CUDA)
/// Share number `share` of the grains near walls. False when an overlap with a plane is too large.
template <class Walls>
bool System::press_walls(const Walls& walls, int share, int shares) {
  const bool at_once = std::is_same_v<typename Walls::ContactLaw, kernels::HertzMindlin> && !couples_;
  const long long number = at_once ? static_cast<long long>(planes_.others.size()) : near_walls_.near_grains();
  const int end = static_cast<int>(number * (share + 1) / shares);
  for (int k = static_cast<int>(number * share / shares); k < end; ++k) walls(at_once ? planes_.others[k] : k);
  bool fine = true;
  if (!at_once) return fine;
  const PlaneSweep press =
      find_plane_sweep(walls.ledger != nullptr, setup_.rotations, setup_.lanes ? setup_.lanes : sweep_lanes());
  planes_.each_kind(share, shares, [&](int kind, int from, int to) {
    const kernels::PairParameters& pair = walls.parameters[kind];
    const PlaneInput contacts{.place = &walls.place->position.x,
                              .motion = &walls.motion.row->vector.x,
                              .row = pointer(planes_.row),
                              .plane = &pointer(planes_.plane)->vector.x,
                              .candidate = pointer(planes_.candidate),
                              .slot = pointer(planes_.slot),
                              .history = walls.history,
                              .state = &walls.state->force.x,
                              .impulse = &walls.impulse->x,
                              .ledger = walls.ledger ? &walls.ledger->loss_friction : nullptr,
                              .sum = &walls.sum->force.x,
                              .rolling = pair.rolling == rolling_brof ? pair.rolling_friction : 0,
                              .maximum_overlap = walls.maximum_overlap,
                              .parameters = &pair,
                              .time = walls.time,
                              .ended = walls.dt};
    fine = !press(contacts, from, to) && fine;
  });
  return fine;
}

/// Pairs, and beside them the walls: every thread takes its share of both, and all wait once.
template <class Walls>
void System::sweep_pairs(const kernels::Interval& time, const Walls& walls) {
  sweep_sums_ = {};
  if (grains_.size() == 0) return;
  const SweepInput rows{.place = &pointer(grains_.place)->position.x,
                        .motion = &pointer(grains_.motion)->vector.x,
                        .pull = &pointer(grains_.pull)->vector.x,
                        .first = nullptr,
                        .second = nullptr,
                        .to_first = nullptr,
                        .to_second = nullptr,
                        .history = nullptr,
                        .blocks = 0,
                        .parameters = nullptr,
                        .time = time,
                        .maximum_overlap = setup_.maximum_overlap};
  static_assert(sizeof(WallState) == 88 && sizeof(WallLedger) == 48);
  if (planes_.near_grains() != near_walls_.near_grains()) list_planes();  // lists from a checkpoint
  std::atomic<bool> too_large = false;
  sweep_sums_ = sweep_lists_.run(rows, pointer(grain_parameters_), [&](int share, int shares) {
    if (!press_walls(walls, share, shares)) too_large = true;
  });
  if (too_large) pointer(control_)->trouble = overlap_too_large;
  totals_.loss_friction += sweep_sums_.loss_friction;
  totals_.loss_contact_damping += sweep_sums_.loss_damping;
  totals_.loss_rolling += sweep_sums_.loss_rolling;
  if (sweep_sums_.overlap_too_large) pointer(control_)->trouble = overlap_too_large;
}
#endif

/// Forces at the present positions, added to grains_.pull or left with the pairs; the step that ends took `ended`.
inline void System::evaluate(const kernels::Interval& time, double ended) {
#if !defined(TRACKBED_DEM_CUDA)
  if (sweeps()) {
    move_images();
    with_scene_law([&]<class Law, bool Ledger, bool Couples>() {
      sweep_pairs(time, wall_pass<Law, Ledger, Couples>(time, ended));
    });
    press_bonds([](int n, const auto& pass) { launch(n, pass); }, ended);
  }
#endif
  if (!sweeps()) queue_forces(time, ended);
  last_ahead_ = time.ahead;
}

/// Each pass is started by launch(n, functor).
template <class Launch>
void System::press_bonds(const Launch& launch_pass, double ended) {
  if (bonds_.any())
    bonds_.press(launch_pass, grains_,
                 bodies_.any() ? std::as_const(bodies_).states() : std::as_const(grains_).states(), bodies_.of_sphere,
                 ended, periods_);
}

template <class Real>
GatheredForces<Real> System::gathered_forces() {
  auto& numbers = pairs_.numbers<Real>();
  return {pointer(grains_.place), pointer(pairs_.own_start), pointer(pairs_.other_start),
          pointer(pairs_.other),  pointer(numbers.result),   pointer(numbers.couple)};
}

inline Integrator System::integrator(double dt) {
  const bool verlet = setup_.time_scheme == TimeScheme::velocity_verlet;
  return {.place = pointer(grains_.place),
          .state = grains_.states(),
          .motion = grains_.motions(),
          .pull = grains_.pulls(),
          .wall_slot = pointer(near_walls_.slot),
          .wall_sum = pointer(near_walls_.sum),
          .ledger = pointer(grains_.ledger),
          .gravity = setup_.gravity,
          .alpha = alpha_,
          .rolling = brakes_,
          .dt = dt,
          .at_start = verlet ? 0.5 : 1,
          .at_end = verlet ? 0.5 : 0};
}

/// Calls visit(number of grains, pass of the integrator over them).
template <class Forces, class Visit>
void System::with_leap(double dt, const Forces& forces, const Visit& visit) {
  const Integrator integrator = this->integrator(dt);
  if (bodies_.any()) return with_body_leap(integrator, forces, visit);
  visit(grains_.size(), Leapfrog<Forces>{integrator, forces, pointer(grains_.listed), {}, bonds_.any()});
}

#if !defined(TRACKBED_DEM_CUDA)
/// The same for spheres whose forces have been summed: every thread its share of the rows.
inline double System::leap_rows(const Phase& phase, double dt) {
  const int n = grains_.size();
  if (n == 0) return 0;
  const Integrator integrator = this->integrator(dt);
  static_assert(sizeof(WallSum) == 64 && sizeof(Vec3) == 24 && sizeof(GrainLedger) == 16);
  const LeapInput rows{.place = &pointer(grains_.place)->position.x,
                       .state = &pointer(grains_.state)->vector.x,
                       .motion = &pointer(grains_.motion)->vector.x,
                       .pull = &pointer(grains_.pull)->vector.x,
                       .listed = &pointer(grains_.listed)->x,
                       .wall_slot = integrator.wall_slot,
                       .wall_sum = integrator.wall_sum ? &integrator.wall_sum->force.x : nullptr,
                       .ledger = integrator.ledger ? &integrator.ledger->loss_rolling : nullptr,
                       .gravity = setup_.gravity,
                       .alpha = alpha_,
                       .dt = dt,
                       .ended = phase.ended,
                       .end_share = integrator.at_end,
                       .kick = integrator.kick(),
                       .seen = integrator.at_end * dt};
  const Leap pass = find_leap({.turns = setup_.rotations,
                               .brakes = brakes_,
                               .ledger = rows.ledger != nullptr,
                               .ends = phase.ends,
                               .begins = phase.begins},
                              setup_.lanes ? setup_.lanes : sweep_lanes());
  if (n <= serial_length) return pass(rows, 0, n);
  double most = 0;
#pragma omp parallel reduction(max : most)
  {
    const long long share = omp_get_thread_num(), shares = omp_get_num_threads();
    most = pass(rows, static_cast<int>(n * share / shares), static_cast<int>(n * (share + 1) / shares));
  }
  return most;
}
#endif

/// One pass of the integrator, outside a window; returns the largest squared displacement since the list was made.
inline double System::leap(const Phase& phase, double dt) {
#if !defined(TRACKBED_DEM_CUDA)
  if (sweeps()) {
    if (!bodies_.any()) return leap_rows(phase, dt);
    double squared = 0;
    with_body_leap(integrator(dt), SummedForces{}, [&](int n, auto pass) {
      pass.phase = phase;
      squared = reduce(n, pass, 0.0, thrust::maximum<double>());
    });
    return squared;
  }
#endif
  if (!phase.begins) {
    queue_end(dt, phase.ended);
    return 0;
  }
  queue_.fetch(pointer(control_), control_host_.data() + 1, 1);  // what the forces before this have met
  send_free_control(dt, phase.ends ? 2 : 1);
  queue_motion(dt, 0);
  queue_.fetch(pointer(control_), control_host_.data(), 1);
  queue_.wait();
  return number_of(control_host_.data()->moved);
}

/// Finds the grain to blame and says where it is. Called once, at the end of a run.
inline void System::stop_unstable(int trouble, double dt) const {
  const auto place = download(grains_.place);
  const auto motion = download(grains_.motion);
  const Rows<const Quad> rows{motion.data(), grains_.parts};
  const auto ids = download(grains_.id);
  int worst = 0;
  double measure = -1;
  char text[200] = "";
  const auto accuse = [&](int g, double value, const char* format) {
    if (value < measure || (value == measure && ids[g] > ids[worst])) return;
    worst = g;
    measure = value;
    std::snprintf(text, sizeof text, format, value);
  };
  if (trouble == overlap_too_large) {
    each_contact(
        [&](int i, int j, const Meeting<double>& meeting, const kernels::PairParameters&, const Vec3&, const Vec3&) {
          const double smaller = std::fmin(place[i].radius, place[j].radius);
          accuse(i, meeting.touch.overlap / smaller, "overlap with another grain is %.3g of the smaller radius");
        });
    const auto grain = download(near_walls_.grain), start = download(near_walls_.start);
    const auto state = download(near_walls_.state);
    for (std::size_t w = 0; w < grain.size(); ++w)
      for (int c = start[w]; c < start[w + 1]; ++c)
        if (state[c].overlap > 0)
          accuse(grain[w], state[c].overlap / place[grain[w]].radius, "overlap with a wall is %.3g of its radius");
  } else {
    for (int g = 0; g < grains_.size(); ++g) {
      const bool finite = norm2(place[g].position) < 1e100 && norm2(rows.translation(g).vector) < 1e200;
      const bool turns = rows.parts == 1 || norm2(rows.rotation(g).vector) < 1e200;
      if (!finite)
        accuse(g, 2, "position or velocity is not finite");
      else if (!turns)
        accuse(g, 1, "angular velocity is not finite");
    }
  }
  if (measure < 0 && in_company()) throw base::UnstableError("stopped with another part of the grains");
  const Vec3 p = ids.empty() ? Vec3{} : place[worst].position;
  const Vec3 v = ids.empty() ? Vec3{} : rows.translation(worst).vector;
  char message[500];
  std::snprintf(message, sizeof message,
                "grain %lld: %s; at (%.6g, %.6g, %.6g) m, speed %.4g m/s, step %lld, t = %.6g s (dt = %.3g s)",
                static_cast<long long>(ids.empty() ? -1 : ids[worst]), text, p.x, p.y, p.z, norm(v),
                static_cast<long long>(steps_), time_ + dt, last_dt_);
  throw base::UnstableError(message);
}

}  // namespace dem::TRACKBED_DEM_SYSTEM
