#pragma once
// The whole state as columns, for a checkpoint. Lists of neighbours and their order are stored as they are, together
// with what decides when they are made anew: the simulation that is saved does not notice, and one that goes on from
// the columns adds the same forces in the same order. Stored: everything but what the scene says (shapes, the form of
// walls, laws) and what every step computes afresh.
#include "dem/core/system_slabs.hpp"

namespace dem::TRACKBED_DEM_SYSTEM {

template <class Self, class Walk>
void walk_grains(Self& grains, Walk& walk) {
  walk.numbers("grains/layout", grains.own_state, grains.parts);
  walk.rows("grains/place", grains.place);
  walk.rows("grains/state", grains.state);
  walk.rows("grains/motion", grains.motion);
  walk.rows("grains/pull", grains.pull);
  walk.rows("grains/listed", grains.listed);
  walk.rows("grains/material", grains.material);
  walk.rows("grains/id", grains.id);
  walk.rows("grains/ledger", grains.ledger);
  walk.rows("grains/old_of_new", grains.old_of_new);
}

template <class Self, class Walk>
void walk_bodies(Self& bodies, Walk& walk) {
  walk.rows("clumps/place", bodies.place);
  walk.rows("clumps/state", bodies.state);
  walk.rows("clumps/pull", bodies.pull);
  walk.rows("clumps/orientation", bodies.orientation);
  walk.rows("clumps/inertia", bodies.inertia);
  walk.rows("clumps/inertia_per_mass", bodies.inertia_per_mass);
  walk.rows("clumps/volume", bodies.volume);
  walk.rows("clumps/material", bodies.material);
  walk.rows("clumps/shape", bodies.shape);
  walk.rows("clumps/id", bodies.id);
  walk.rows("clumps/start", bodies.start);
  walk.rows("clumps/of_sphere", bodies.of_sphere);
  walk.rows("clumps/offset", bodies.offset);
  walk.rows("clumps/sphere_entry", bodies.sphere_entry);
}

template <class Self, class Walk>
void walk_bonds(Self& bonds, Walk& walk) {
  struct Numbers {
    kernels::BondParameters is;
    kernels::BondState state;
  };
  std::vector<Numbers> numbers;
  std::vector<int> broken;
  for (const BondRow& row : download(bonds.row)) {
    numbers.push_back({row.is, row.state});
    broken.push_back(row.broken);
  }
  walk.rows("bonds/row", numbers);
  walk.rows("bonds/broken", broken);
  if constexpr (Walk::loads) {
    base::require_user(numbers.size() == broken.size(), "column bonds/broken is of other bonds");
    std::vector<BondRow> rows;
    for (std::size_t b = 0; b < numbers.size(); ++b) rows.push_back({numbers[b].is, numbers[b].state, broken[b]});
    upload(rows, bonds.row);
  }
  walk.rows("bonds/id", bonds.id);
  walk.rows("bonds/end", bonds.end);
  walk.rows("bonds/grain", bonds.grain);
  walk.rows("bonds/entry", bonds.entry);
  walk.rows("bonds/pull", bonds.pull);
  walk.rows("bonds/ledger", bonds.ledger);
}

template <class Self, class Walk>
void walk_ghosts(Self& ghosts, Walk& walk) {
  std::vector<std::int64_t> keys;
  for (const SphereKey& key : ghosts.keys) {
    keys.push_back(key.grain);
    keys.push_back(key.sphere);
  }
  walk.numbers("ghosts/numbers", ghosts.first, ghosts.count[0], ghosts.count[1], ghosts.shift[0], ghosts.shift[1],
               ghosts.work, ghosts.imbalance);
  walk.rows("ghosts/keys", keys);
  walk.rows("ghosts/sent_below", ghosts.sent[0]);
  walk.rows("ghosts/sent_above", ghosts.sent[1]);
  walk.rows("ghosts/cuts", ghosts.cuts);
  walk.rows("ghosts/next_cuts", ghosts.next_cuts);
  walk.rows("ghosts/material", ghosts.material);
  if constexpr (Walk::loads) {
    ghosts.keys.clear();
    for (std::size_t k = 0; k + 1 < keys.size(); k += 2) ghosts.keys.push_back({keys[k], keys[k + 1]});
  }
}

template <class Self, class Walk>
void walk_pairs(Self& pairs, Walk& walk) {
  walk.numbers("pairs/stride", pairs.history_stride);
  walk.rows("pairs/own_start", pairs.own_start);
  walk.rows("pairs/other_start", pairs.other_start);
  walk.rows("pairs/other", pairs.other);
  walk.rows("pairs/first", pairs.first);
  walk.rows("pairs/second", pairs.second);
  walk.rows("pairs/second_row", pairs.second_row);
  walk.rows("pairs/pair", pairs.pair);
  walk.rows("pairs/history", pairs.full.history);
  walk.rows("pairs/result", pairs.full.result);
  walk.rows("pairs/couple", pairs.full.couple);
  walk.rows("pairs/short_history", pairs.mixed.history);
  walk.rows("pairs/short_result", pairs.mixed.result);
  walk.rows("pairs/short_couple", pairs.mixed.couple);
  walk.rows("pairs/ledger", pairs.ledger);
}

template <class Self, class Walk>
void walk_near_walls(Self& near, Walk& walk) {
  walk.numbers("near_walls/stride", near.history_stride);
  walk.rows("near_walls/slot", near.slot);
  walk.rows("near_walls/grain", near.grain);
  walk.rows("near_walls/start", near.start);
  walk.rows("near_walls/sum", near.sum);
  walk.rows("near_walls/candidate", near.candidate);
  walk.rows("near_walls/grain_of", near.grain_of);
  walk.rows("near_walls/state", near.state);
  walk.rows("near_walls/history", near.history);
  walk.rows("near_walls/impulse", near.impulse);
  walk.rows("near_walls/nodal", near.nodal);
  walk.rows("near_walls/ledger", near.ledger);
  walk.rows("near_walls/passed", near.passed);
  walk.rows("near_walls/node_start", near.node_start);
  walk.rows("near_walls/node_entry", near.node_entry);
  if constexpr (Walk::loads) near.found.resize(near.candidate.size());
}

/// What can be changed between steps: moduli (a ramp of stiffness), constants of contacts, gravity, damping.
template <class Self, class Walk>
void walk_constants(Self& setup, Walk& walk) {
  for (std::size_t m = 0; m < setup.materials.size(); ++m) {
    auto& is = setup.materials[m];
    walk.numbers("material/" + std::to_string(m), is.young_modulus, is.poisson_ratio, is.density);
  }
  for (std::size_t k = 0; k < setup.interactions.size(); ++k) {
    auto& is = setup.interactions[k];
    walk.numbers("interaction/" + std::to_string(k), is.friction, is.restitution, is.rolling_friction,
                 is.normal_stiffness, is.shear_stiffness, is.normal_viscosity, is.shear_viscosity,
                 is.dissipative_coefficient, is.damping_mode, is.critical_stress, is.friction_exponent,
                 is.rolling_damping);
  }
  walk.numbers("gravity", setup.gravity);
}

template <class Self, class Walk>
void System::walk(Self& self, Walk& walk) {
  walk_constants(self.setup_, walk);
  walk.numbers("clock", self.alpha_, self.time_, self.last_dt_, self.last_ahead_, self.steps_, self.rebuilds_,
               self.last_rebuild_, self.last_tight_);
  walk.numbers("lists", self.list_is_stale_, self.forces_are_stale_, self.rows_moved_, self.skin_, self.skin_share_,
               self.tight_, self.tight_share_, self.travelled_, self.radii_, self.reach_, self.periods_.margin);
  double taken_away = self.taken_away_.value_or(0);
  bool taken = self.taken_away_.has_value();
  walk.numbers("energy", self.totals_, self.gravity_reference_, self.gravity_referenced_, taken, taken_away);
  walk.numbers("sweep/sums", self.sweep_sums_.elastic_normal, self.sweep_sums_.elastic_shear);
  walk_bonds(self.bonds_, walk);  // waits for some of its rows, as walls do: before rows come that are not waited for
  Walls::walk(self.walls_, walk);
  walk_grains(self.grains_, walk);
  walk_bodies(self.bodies_, walk);
  walk.numbers("images/first", self.images_.first);
  walk.rows("images/start", self.images_.start);
  walk.rows("images/owner", self.images_.owner);
  walk.rows("images/shift", self.images_.shift);
  int parts = self.in_company() ? self.setup_.company->parts() : 1;
  walk.numbers("ghosts/parts", parts, self.ghosts_.first);
  if (parts > 1) walk_ghosts(self.ghosts_, walk);
  walk_pairs(self.pairs_, walk);
  walk_near_walls(self.near_walls_, walk);
#if !defined(TRACKBED_DEM_CUDA)
  SweepLists::walk(self.sweep_lists_, walk);
#endif
  if constexpr (Walk::loads) {
    self.taken_away_.reset();
    if (taken) self.taken_away_ = taken_away;
  }
}

inline base::Columns System::save() const {
  base::Columns columns;
  columns["backend"] = std::string(backend_ == Backend::cuda ? "cuda" : "omp");
  ToColumns saver(columns);
  walk(*this, saver);
  return columns;
}

inline std::function<base::Columns()> System::saved() const {
  if (sweeps()) return Simulation::saved();
  const auto snapshot = begin_snapshot(saved_);
  base::Columns columns;
  columns["backend"] = std::string(backend_ == Backend::cuda ? "cuda" : "omp");
  ToColumnsLater saver(columns, *snapshot, queue_);
  walk(*this, saver);
  snapshot->end(queue_);
  return [snapshot, columns = std::move(columns), left = saver.left()]() mutable {
    snapshot->wait();
    for (const auto& rows : left) rows(columns);
    return std::move(columns);
  };
}

inline void System::restore(const base::Columns& columns) {
  base::require_internal(grains_.size() == 0, "a state goes into a new simulation");
  int parts = 0, first_ghost = 0;
  base::Loader(columns).numbers("ghosts/parts", parts, first_ghost);
  if (parts != (in_company() ? setup_.company->parts() : 1)) return restore_parts({&columns, 1});
  load(columns);
}

inline void System::load(const base::Columns& columns) {
  const std::string here = backend_ == Backend::cuda ? "cuda" : "omp";
  const auto& there = base::column<std::string>(columns, "backend");
  base::require_user(here == there, "its grains were computed with the backend " + there + ", not " + here);
  FromColumns loader(columns);
  walk(*this, loader);
  const bool stale = list_is_stale_;
  upload_parameters();
  list_is_stale_ = stale;
  node_impulse_is_here_ = wall_impulse_is_here_ = false;
  convert(pairs_, setup_.precision);
#if !defined(TRACKBED_DEM_CUDA)
  if (sweeps() && !sweep_lists_.go_on(sweep_layout(), images_, periods_)) list_is_stale_ = true;
#endif
}

/// This part alone, outside any company, with the walls and shapes of `like`.
inline System::System(const System& like, const base::Columns& columns)
    : System(
          [&] {
            Setup alone = like.setup_;
            alone.company = nullptr;
            return alone;
          }(),
          like.backend_) {
  shapes_ = like.shapes_;
  walls_ = like.walls_;
  load(columns);
}

/// Grains with all that their contacts remember, on their way to whichever part they belong to now.
inline Company::Letter System::everything() {
  if (ghosts_.keys.empty()) list_keys();
  std::array<Company::Letter, 2> out;
  write_leaving(std::vector<int>(static_cast<std::size_t>(bodies_.any() ? bodies_.size() : grains_.size()), 0), out);
  return out[0];
}

inline void System::restore_parts(std::span<const base::Columns> saved) {
  base::require_internal(grains_.size() == 0 && !saved.empty(), "a state goes into a new simulation");
  const std::size_t parts = in_company() ? static_cast<std::size_t>(setup_.company->parts()) : 1;
  const std::size_t here = in_company() ? static_cast<std::size_t>(setup_.company->part()) : 0;
  base::Energy totals;
  SweepSums sums;
  bool referenced = false, clumps = false;
  std::vector<Company::Letter> letters;
  for (std::size_t k = 0; k < saved.size(); ++k) {
    System part(*this, saved[k]);
    base::require_user(!part.bonds_.any() || !in_company(), "bonds need all grains in one place");
    for (HostWall& wall : part.walls_.walls)  // the first part has counted them
      if (k > 0 && wall.body)
        wall.body->work_loads = wall.body->work_gravity = wall.body->work_drive = wall.body->loss_damping = 0;
    referenced = part.gravity_referenced_;
    clumps = clumps || part.bodies_.any();
    part.settle_gravity();
    part.flush_losses();
    totals += part.totals_;
    const auto stored = part.pair_energies();
    sums.elastic_normal += part.sweep_sums_.elastic_normal + stored.value[2];
    sums.elastic_shear += part.sweep_sums_.elastic_shear + stored.value[3];
    if (k * parts / saved.size() == here) letters.push_back(part.everything());
    if (k > 0) {
      walls_.learn(part.walls_);
      continue;
    }
    setup_.materials = part.setup_.materials;
    setup_.interactions = part.setup_.interactions;
    setup_.gravity = part.setup_.gravity;
    upload_parameters();
    walls_ = part.walls_;
    forces_are_stale_ = part.forces_are_stale_;
    alpha_ = part.alpha_;
    time_ = part.time_;
    last_dt_ = part.last_dt_;
    last_ahead_ = part.last_ahead_;
    steps_ = part.steps_;
    rebuilds_ = part.rebuilds_;
    skin_ = part.skin_;
    skin_share_ = part.skin_share_;
    tight_share_ = part.tight_share_;
    taken_away_ = part.taken_away_;
  }
  if (clumps) make_bodies();
  for (const auto& letter : letters) read_arriving(letter);
  if (in_company()) ghosts_.cuts = new_cuts();
  list_is_stale_ = true;
  rebuild(0);
  if (here == 0) {
    totals_ = totals;
    sweep_sums_ = sums;
  }
  gravity_referenced_ = false;
  reference_gravity(referenced);
}

}  // namespace dem::TRACKBED_DEM_SYSTEM
