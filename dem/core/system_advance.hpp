#pragma once
// The step: first half, list check, forces, second half.
#include <cstdio>

#include "dem/core/system.hpp"

namespace dem::TRACKBED_DEM_SYSTEM {

inline void System::advance(int n, double dt) {
  base::require_internal(n >= 0 && dt > 0, "advance needs a positive step");
  [[maybe_unused]] const ThreadsFor threads(grains_.size());
  node_impulse_current_ = false;
  walls_.begin_advance();
  clear(near_walls_.impulse);
  clear(near_walls_.nodal);
  last_dt_ = dt;
  prepare();
  for (int k = 1; k <= n; ++k) step(k, n, dt);
  time_ += n * dt;
}

/// Brings lists, masses and forces up to date after changes between steps.
inline void System::prepare() {
  if (walls_.rows_changed) {
    flush_losses();
    walls_.upload_rows();
  }
  const bool ledger = setup_.track_energy && (alpha_ > 0 || (any_rolling_ && setup_.rotations));
  if (ledger && grains_.ledger.empty()) grains_.ledger.resize(grains_.size());
  if (list_is_stale_) rebuild(0);
  if (forces_are_stale_) {
    evaluate(last_dt_, 0);
    const int trouble = first_of(trouble_);
    if (trouble) stop_unstable(trouble, 0);
  }
  if (setup_.track_energy && !gravity_referenced_) {
    gravity_reference_ = gravity_potential();
    gravity_referenced_ = true;
  }
  forces_are_stale_ = false;
}

/// Grains that move fast want a thick skin (few builds), grains at rest a thin one (few candidates).
inline void System::adapt_skin() {
  const std::int64_t interval = steps_ - last_rebuild_;
  if (interval < 30) skin_share_ = std::fmin(0.5, 1.3 * skin_share_);
  if (interval > 300) skin_share_ = std::fmax(0.05, 0.8 * skin_share_);
}

/// New lists for grains and walls where they are now, `share` of the way through the present advance().
inline void System::rebuild(double share) {
  const int n = grains_.size();
  flush_losses();
  flush_impulses();
  if (n > 0) {
    const Place* place = pointer(grains_.place);
    radii_ = reduce(n, RadiiOf{place}, Radii{}, JoinRadii{});
    if (rebuilds_ > 0 && !list_is_stale_) adapt_skin();
    skin_ = setup_.skin > 0 ? setup_.skin : skin_share_ * radii_.smallest;
    const Box box = reduce(n, BoxOf{place}, Box{}, JoinBoxes{});
    const CellGrid grid = make_grid(box, 2 * radii_.largest + skin_, n);
    Vector<int> bucket;
    grains_.sort_by_bucket(grid, bucket);
    const int materials = static_cast<int>(setup_.materials.size());
    pairs_ = build_pairs(grains_, grid, bucket, pairs_, {materials, any_friction_, setup_.track_energy, skin_});
    if (walls_.any())
      near_walls_ = build_walls(grains_, walls_, grid, near_walls_, {setup_.track_energy, skin_, radii_.largest});
    grains_.listed.resize(n);
    launch(n, CopyPositions{pointer(grains_.place), pointer(grains_.listed)});
    thrust::sequence(policy(), grains_.old_of_new.begin(), grains_.old_of_new.end());
  } else {
    pairs_ = {};
    near_walls_ = {};
  }
  walls_.listed_here(share);
  list_is_stale_ = false;
  last_rebuild_ = steps_;
  ++rebuilds_;
}

/// Forces at the present positions; the step that ends now took `advance` (dt, or 0 for the forces at the start).
inline void System::evaluate(double dt, double advance) {
  launch(pairs_.size(), ContactPass{.place = pointer(grains_.place),
                                    .translation = pointer(grains_.translation),
                                    .rotation = pointer(grains_.rotation),
                                    .first = pointer(pairs_.first),
                                    .second = pointer(pairs_.second),
                                    .reduced = pointer(pairs_.reduced),
                                    .pair = pointer(pairs_.pair),
                                    .parameters = pointer(grain_parameters_),
                                    .history = pointer(pairs_.history),
                                    .result = pointer(pairs_.result),
                                    .ledger = pointer(pairs_.ledger),
                                    .unstable = pointer(trouble_),
                                    .maximum_overlap = setup_.maximum_overlap,
                                    .dt = advance,
                                    .number = pairs_.size()});
  launch(near_walls_.near_grains(), WallPass{.geometry = walls_.geometry(),
                                             .node_velocity = pointer(walls_.velocity),
                                             .node_displacement = pointer(walls_.displacement),
                                             .place = pointer(grains_.place),
                                             .translation = pointer(grains_.translation),
                                             .rotation = pointer(grains_.rotation),
                                             .grain_material = pointer(grains_.material),
                                             .parameters = pointer(wall_parameters_),
                                             .materials = static_cast<int>(setup_.materials.size()),
                                             .grain = pointer(near_walls_.grain),
                                             .start = pointer(near_walls_.start),
                                             .candidate = pointer(near_walls_.candidate),
                                             .state = pointer(near_walls_.state),
                                             .sum = pointer(near_walls_.sum),
                                             .impulse = pointer(near_walls_.impulse),
                                             .nodal = pointer(near_walls_.nodal),
                                             .ledger = pointer(near_walls_.ledger),
                                             .unstable = pointer(trouble_),
                                             .maximum_overlap = setup_.maximum_overlap,
                                             .dt = advance});
  launch(grains_.size(), GatherPass{.place = pointer(grains_.place),
                                    .translation = pointer(grains_.translation),
                                    .rotation = pointer(grains_.rotation),
                                    .own_start = pointer(pairs_.own_start),
                                    .other_start = pointer(pairs_.other_start),
                                    .other = pointer(pairs_.other),
                                    .pair_force = pointer(pairs_.result),
                                    .wall_slot = pointer(near_walls_.slot),
                                    .wall_sum = pointer(near_walls_.sum),
                                    .ledger = pointer(grains_.ledger),
                                    .gravity = setup_.gravity,
                                    .alpha = alpha_,
                                    .rolling = any_rolling_,
                                    .dt = dt,
                                    .advance = advance});
}

inline void System::step(int k, int n, double dt) {
  if (walls_.any()) walls_.move(k, n, dt);
  const int number = grains_.size();
  const double squared = reduce(number,
                                FirstHalf{pointer(grains_.place), pointer(grains_.translation),
                                          pointer(grains_.rotation), pointer(grains_.listed), dt},
                                0.0, thrust::maximum<double>());
  ++steps_;
  if (!(squared < HUGE_VAL)) stop_unstable(0, k * dt);
  const double moved = std::sqrt(squared), share = static_cast<double>(k) / n;
  if (2 * moved > skin_ || (walls_.any() && moved + walls_.shift(share) > skin_)) rebuild(share);
  evaluate(dt, dt);
  const int trouble = first_of(trouble_);
  if (trouble) stop_unstable(trouble, k * dt);
}

/// Finds the grain to blame and says where it is. Called once, at the end of a run.
inline void System::stop_unstable(int trouble, double dt) const {
  const auto place = download(grains_.place);
  const auto translation = download(grains_.translation);
  const auto rotation = download(grains_.rotation);
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
    const auto first = download(pairs_.first), second = download(pairs_.second);
    const auto result = download(pairs_.result);
    for (std::size_t c = 0; c < result.size(); ++c) {
      const double smaller = std::fmin(place[first[c]].radius, place[second[c]].radius);
      if (result[c].half_overlap > 0)
        accuse(first[c], 2 * result[c].half_overlap / smaller,
               "overlap with another grain is %.3g of the smaller radius");
    }
    const auto grain = download(near_walls_.grain), start = download(near_walls_.start);
    const auto state = download(near_walls_.state);
    for (std::size_t w = 0; w < grain.size(); ++w)
      for (int c = start[w]; c < start[w + 1]; ++c)
        if (state[c].overlap > 0)
          accuse(grain[w], state[c].overlap / place[grain[w]].radius, "overlap with a wall is %.3g of its radius");
  } else if (trouble == too_many_wall_contacts) {
    const auto grain = download(near_walls_.grain), start = download(near_walls_.start);
    for (std::size_t w = 0; w < grain.size(); ++w)
      accuse(grain[w], start[w + 1] - start[w], "touches more wall facets at once than can be held (%.0f near it)");
  } else {
    for (std::size_t g = 0; g < place.size(); ++g) {
      const bool finite = norm2(place[g].position) < 1e100 && norm2(translation[g].velocity) < 1e200;
      const bool turns = rotation.empty() || norm2(rotation[g].velocity) < 1e200;
      if (!finite)
        accuse(static_cast<int>(g), 2, "position or velocity is not finite");
      else if (!turns)
        accuse(static_cast<int>(g), 1, "angular velocity is not finite");
    }
  }
  const Vec3 p = place.empty() ? Vec3{} : place[worst].position;
  const Vec3 v = place.empty() ? Vec3{} : translation[worst].velocity;
  char message[500];
  std::snprintf(message, sizeof message,
                "grain %lld: %s; at (%.6g, %.6g, %.6g) m, speed %.4g m/s, step %lld, t = %.6g s (dt = %.3g s)",
                static_cast<long long>(ids.empty() ? -1 : ids[worst]), text, p.x, p.y, p.z, norm(v),
                static_cast<long long>(steps_), time_ + dt, last_dt_);
  throw base::UnstableError(message);
}

}  // namespace dem::TRACKBED_DEM_SYSTEM
