#pragma once
// Host copies and sums of what the backend holds.
#include <limits>

#include "dem/contact_step.hpp"
#include "dem/core/system.hpp"

namespace dem::TRACKBED_DEM_SYSTEM {

/// take(rows) gives them on the host.
template <class Take>
GrainRows System::grain_rows(Take&& take) const {
  if (!bodies_.any())
    return {.place = take(grains_.place),
            .state = take(grains_.state),
            .parts = grains_.parts,
            .material = take(grains_.material),
            .shape = {},
            .orientation = {},
            .id = take(grains_.id)};
  return {.place = take(bodies_.place),
          .state = take(bodies_.state),
          .parts = 2,
          .material = take(bodies_.material),
          .shape = take(bodies_.shape),
          .orientation = take(bodies_.orientation),
          .id = take(bodies_.id)};
}

/// Without the list where it is a sweep's.
template <class Take>
PairRows System::pair_rows(Take&& take, bool listed) const {
  PairRows rows{.place = take(grains_.place),
                .motion = take(grains_.motion),
                .parts = grains_.parts,
                .material = take(grains_.material),
                .owner = take(images_.owner),
                .shift = take(images_.shift),
                .first_image = images_.first,
                .periods = periods_,
                .parameters = grain_parameters_host_,
                .materials = static_cast<int>(setup_.materials.size()),
                .ahead = last_ahead_,
                .first = {},
                .second = {},
                .history = {},
                .short_history = {},
                .stride = pairs_.history_stride};
  if (!listed) return rows;
  rows.first = take(pairs_.first);
  rows.second = take(pairs_.second_row.empty() ? pairs_.second : pairs_.second_row);
  rows.history = take(pairs_.full.history);
  rows.short_history = take(pairs_.mixed.history);
  return rows;
}

template <class Take>
NearWallRows System::near_wall_rows(Take&& take) const {
  return {.grain = take(near_walls_.grain),
          .start = take(near_walls_.start),
          .candidate = take(near_walls_.candidate),
          .state = take(near_walls_.state),
          .facet = take(walls_.facets),
          .place = take(grains_.place),
          .id = take(grains_.id)};
}

inline std::vector<Grain> System::grains() const {
  Downloads take;
  return grain_rows(take).grains();
}

inline std::vector<GrainSphere> System::spheres() const {
  const auto ids = download(grains_.id);
  const auto place = download(grains_.place);
  std::vector<GrainSphere> spheres(ids.size());
  for (std::size_t s = 0; s < ids.size(); ++s) spheres[s] = {place[s].position, place[s].radius, ids[s]};
  std::stable_sort(spheres.begin(), spheres.end(),
                   [](const GrainSphere& a, const GrainSphere& b) { return a.id < b.id; });
  return spheres;
}

// ---- energy
inline double System::gravity_potential() const {
  if (bodies_.any())
    return ordered_sum<1>(bodies_.size(), SumGravity{pointer(bodies_.place), bodies_.states(), setup_.gravity})
        .value[0];
  const SumGravity sum{pointer(grains_.place), grains_.states(), setup_.gravity};
  return ordered_sum<1>(grains_.size(), sum).value[0];
}

/// Books the work of gravity up to now; after the change that follows, the reference is taken anew.
inline void System::settle_gravity() {
  if (!setup_.track_energy || !gravity_referenced_) return;
  totals_.work_gravity += gravity_potential() - gravity_reference_;
  gravity_referenced_ = false;
}

/// As SumPairs says; of pairs that are swept, nothing.
inline Sums<5> System::pair_energies() const {
  return ordered_sum<5>(static_cast<int>(pairs_.ledger.size()), SumPairs{pointer(pairs_.ledger)});
}

/// What lies in the rows: stored energies now, works and losses since the last flush.
inline base::Energy System::pending() const {
  base::Energy e;
  if (!setup_.track_energy) return e;
  const auto pairs = pair_energies();
  const auto walls = ordered_sum<7>(static_cast<int>(near_walls_.ledger.size()),
                                    SumWalls{pointer(near_walls_.ledger), pointer(near_walls_.candidate),
                                             pointer(walls_.facets), pointer(walls_.rows)});
  const auto grains = ordered_sum<2>(static_cast<int>(grains_.ledger.size()), SumGrainLosses{pointer(grains_.ledger)});
  e.loss_friction = pairs.value[0] + walls.value[0];
  e.loss_contact_damping = pairs.value[1] + walls.value[1];
  e.elastic_normal = pairs.value[2] + walls.value[2] + sweep_sums_.elastic_normal;
  e.elastic_shear = pairs.value[3] + walls.value[3] + sweep_sums_.elastic_shear;
  e.work_walls = walls.value[5];
  e.work_interface = walls.value[6];
  const auto passed =
      ordered_sum<6>(static_cast<int>(near_walls_.passed.size()), SumPassed{pointer(near_walls_.passed)});
  e.interface_impulse = {passed.value[0], passed.value[1], passed.value[2]};
  e.interface_angular_impulse = {passed.value[3], passed.value[4], passed.value[5]};
  e.loss_rolling = grains.value[0] + pairs.value[4] + walls.value[4];
  e.loss_damping = grains.value[1];
  if (bonds_.any()) {
    const auto bonds = bonds_.energies();
    e.elastic_bonds = bonds.value[0];
    e.loss_breakage = bonds.value[1];
  }
  for (const HostWall& wall : walls_.walls) {
    if (!wall.body || !is_first_part()) continue;
    e.kinetic += wall.body->kinetic();
    e.work_loads += wall.body->work_loads;
    e.work_gravity += wall.body->work_gravity;
    e.work_walls += wall.body->work_drive;
    e.loss_damping += wall.body->loss_damping;
  }
  return e;
}

inline void System::flush_losses() {
  if (!setup_.track_energy) return;
  const base::Energy e = pending();
  totals_.loss_friction += e.loss_friction;
  totals_.loss_contact_damping += e.loss_contact_damping;
  totals_.loss_rolling += e.loss_rolling;
  totals_.loss_damping += e.loss_damping;
  totals_.loss_breakage += e.loss_breakage;
  totals_.work_walls += e.work_walls;
  totals_.work_interface += e.work_interface;
  totals_.interface_impulse += e.interface_impulse;
  totals_.interface_angular_impulse += e.interface_angular_impulse;
  totals_.work_loads += e.work_loads;
  totals_.work_gravity += e.work_gravity;
  for (HostWall& wall : walls_.walls)
    if (wall.body)
      wall.body->work_loads = wall.body->work_gravity = wall.body->work_drive = wall.body->loss_damping = 0;
  launch(static_cast<int>(pairs_.ledger.size()), ClearPairLosses{pointer(pairs_.ledger)});
  launch(static_cast<int>(near_walls_.ledger.size()), ClearWallLosses{pointer(near_walls_.ledger)});
  clear(near_walls_.passed);
  clear(grains_.ledger);
  bonds_.clear_losses();
}

inline base::Energy System::energy() const {
  base::Energy e = totals_;
  if (!setup_.track_energy) return e;
  const base::Energy p = pending();
  e.elastic_normal = p.elastic_normal;
  e.elastic_shear = p.elastic_shear;
  e.elastic_bonds = p.elastic_bonds;
  e.loss_friction += p.loss_friction;
  e.loss_contact_damping += p.loss_contact_damping;
  e.loss_rolling += p.loss_rolling;
  e.loss_damping += p.loss_damping;
  e.loss_breakage += p.loss_breakage;
  e.work_walls += p.work_walls;
  e.work_interface += p.work_interface;
  e.interface_impulse += p.interface_impulse;
  e.interface_angular_impulse += p.interface_angular_impulse;
  e.work_loads += p.work_loads;
  e.work_gravity += p.work_gravity;
  if (gravity_referenced_) e.work_gravity += gravity_potential() - gravity_reference_;
  e.kinetic = p.kinetic;
  e.kinetic += bodies_.any()
                   ? ordered_sum<1>(bodies_.size(), SumBodyKinetic{bodies_.states(), pointer(bodies_.orientation),
                                                                   pointer(bodies_.inertia)})
                         .value[0]
                   : ordered_sum<1>(grains_.size(), SumKinetic{grains_.states()}).value[0];
  return e;
}

inline void System::reset_energy() {
  settle_gravity();
  flush_losses();
  totals_ = {};
}

// ---- impulses
inline void System::flush_impulses() {
  if (near_walls_.size() == 0) return;
  for (std::size_t k = 0; k < walls_.walls.size(); ++k)
    walls_.walls[k].impulse = wall_impulse_on_grains(static_cast<int>(k));
  if (near_walls_.nodal.empty()) return;
  // Nodes of walls that have come since the lists were made have no candidates.
  launch(static_cast<int>(near_walls_.node_start.size()) - 1,
         GatherNodes{pointer(near_walls_.node_start), pointer(near_walls_.node_entry), pointer(near_walls_.nodal),
                     pointer(walls_.node_impulse)});
}

inline Vec3 System::wall_impulse_on_grains(int wall) const {
  require_wall(wall);
  const Vec3 flushed = walls_.walls[wall].impulse;
  if (wall_impulse_is_here_ && wall < static_cast<int>(wall_impulse_.size()))
    return flushed + wall_impulse_host_.data()[wall];
  const auto sum = ordered_sum<3>(
      near_walls_.size(),
      SumImpulse{pointer(near_walls_.impulse), pointer(near_walls_.candidate), pointer(walls_.facets), wall});
  return flushed + Vec3{sum.value[0], sum.value[1], sum.value[2]};
}

inline void System::nodal_impulse(int wall, std::span<Vec3> impulse) const {
  require_wall(wall);
  const HostWall& w = walls_.walls[wall];
  base::require_internal(walls_.rows_host[wall].nodal, "nodal impulses are kept for meshes with a target only");
  base::require_internal(impulse.size() == static_cast<std::size_t>(w.nodes), "impulse of another mesh");
  if (!node_impulse_is_here_) {
    fetch_node_impulse();
    queue_.wait();
  }
  std::copy_n(node_impulse_host_.data() + w.first_node, w.nodes, impulse.begin());
}

// ---- contacts
/// As PairRows::each() says, for every pair of grains that touches; the period has the way of ghosts in a ring too.
template <class Visit>
void System::each_contact(Visit&& visit) const {
  if (rows_moved_) return;
  Downloads take;
  const PairRows rows = pair_rows(take, false);
  each_pair([&](int i, int row, const double* kept, int numbers) {
    rows.look(i, row, kept, numbers,
              [&](int a, int j, const Meeting<double>& meeting, const kernels::PairParameters& parameters,
                  const Vec3& force, Vec3 period) {
                period.x += ghosts_.shift_of(j);
                visit(a, j, meeting, parameters, force, period);
              });
  });
}

/// Calls visit(i, row of j, history, numbers) for every listed pair, in the numbering of the lists.
template <class Visit>
void System::each_pair(Visit&& visit) const {
#if !defined(TRACKBED_DEM_CUDA)
  if (sweeps()) {
    sweep_lists_.each(visit);
    return;
  }
#endif
  const auto first = download(pairs_.first);
  const auto second = download(pairs_.second_row.empty() ? pairs_.second : pairs_.second_row);
  const auto history = pairs_.kept_numbers();
  for (std::size_t c = 0; c < first.size(); ++c)
    visit(first[c], second[c], history.data() + c * pairs_.history_stride, pairs_.history_stride);
}

/// Grains of own rows and ghosts.
inline std::vector<std::int64_t> System::row_ids() const {
  auto ids = download(grains_.id);
  for (std::size_t row = ids.size(); in_company() && row < ghosts_.keys.size(); ++row)
    ids.push_back(ghosts_.keys[row].grain);
  return ids;
}

/// A pair with a ghost is told of by the part that holds the grain with the lower number.
inline bool System::is_elsewhere(int i, int j, const std::vector<std::int64_t>& ids) const {
  return j >= ghosts_.first && ids[static_cast<std::size_t>(j)] < ids[static_cast<std::size_t>(i)];
}

inline std::vector<GrainContact> System::grain_contacts() const {
  const auto place = download(grains_.place);
  const auto ids = row_ids();
  std::vector<GrainContact> contacts;
  each_contact([&](int i, int j, const Meeting<double>& meeting, const kernels::PairParameters&, const Vec3& force,
                   const Vec3& period) {
    if (is_elsewhere(i, j, ids)) return;
    contacts.push_back(
        {ids[i], ids[j], place[i].position, place[j].position + period, force, meeting.touch.overlap, period});
  });
  return contacts;
}

inline std::vector<WallContact> System::wall_contacts() const {
  if (rows_moved_) return {};
  Downloads take;
  return near_wall_rows(take).contacts();
}

/// Sweeps put it together now: their lists are spread over the threads' own memory.
inline std::function<Picture()> System::picture() const {
  if (sweeps() || in_company()) return Simulation::picture();
  const auto snapshot = begin_snapshot(pictured_);
  const auto take = [&](const auto& rows) { return snapshot->take(queue_, rows); };
  GrainRows grains = grain_rows(take);
  PairRows pairs;
  NearWallRows walls;
  if (!rows_moved_) {
    pairs = pair_rows(take, true);
    walls = near_wall_rows(take);
  }
  snapshot->end(queue_);
  return [snapshot, grains, pairs = std::move(pairs), walls] {
    snapshot->wait();
    Picture picture{grains.grains(), {}, walls.contacts()};
    pairs.each([&](int i, int j, const Meeting<double>& meeting, const kernels::PairParameters&, const Vec3& force,
                   const Vec3& period) {
      picture.grain_contacts.push_back({walls.id[i], walls.id[j], pairs.place[i].position,
                                        pairs.place[j].position + period, force, meeting.touch.overlap, period});
    });
    return picture;
  };
}

inline Counts System::counts() const {
  Counts counts;
  counts.grains = bodies_.any() ? bodies_.size() : grains_.size();
  counts.spheres = grains_.size();
  counts.wall_candidates = near_walls_.size();
  const auto ids = row_ids();
  each_contact([&](int i, int j, const Meeting<double>&, const kernels::PairParameters&, const Vec3&, const Vec3&) {
    counts.contacts += !is_elsewhere(i, j, ids);
  });
  counts.candidate_pairs = pairs_.size();
  std::size_t list_bytes = pairs_.bytes();
#if !defined(TRACKBED_DEM_CUDA)
  counts.candidate_pairs += sweep_lists_.near_pairs();
  list_bytes += sweep_lists_.bytes() + planes_.bytes();
#endif
  counts.wall_contacts =
      reduce(near_walls_.size(), CountWallContacts{pointer(near_walls_.state)}, 0, thrust::plus<int>());
  counts.rebuilds = rebuilds_;
  counts.steps = steps_;
  counts.bytes = grains_.bytes() + bodies_.bytes() + list_bytes + walls_.bytes() + near_walls_.bytes() +
                 bonds_.bytes() + images_.bytes();
  return counts;
}

// ---- stable steps
/// Stiffest linear spring that grains of this material may meet [N/m], shear with its share in rotation; 0: none.
inline double System::stiffest_spring(int material) const {
  const int count = static_cast<int>(setup_.materials.size());
  double stiffest = 0;
  for (int other = 0; other < count; ++other)
    for (const auto* table : {&grain_parameters_host_, &wall_parameters_host_}) {
      const auto& pair = (*table)[material * count + other];
      stiffest = std::fmax(stiffest, std::fmax(pair.normal_stiffness, 3.5 * pair.shear_stiffness));
    }
  return stiffest;
}

inline StableStep System::stable_step() const {
  StableStep step{std::numeric_limits<double>::infinity(), "no grains"};
  const auto place = download(grains_.place);
  const auto motion = download(grains_.motion);
  const Rows<const Quad> motions{motion.data(), grains_.parts};
  const auto material = download(grains_.material);
  const auto ids = download(grains_.id);
  std::vector<double> springs;
  for (std::size_t m = 0; m < setup_.materials.size(); ++m) springs.push_back(stiffest_spring(static_cast<int>(m)));
  int limiter = 0;
  bool by_spring = false;
  for (int g = 0; g < grains_.size(); ++g) {
    const Material& m = setup_.materials[material[g]];
    const double shear_modulus = m.young_modulus / (2 * (1 + m.poisson_ratio));
    const double rayleigh =
        std::numbers::pi * place[g].radius * std::sqrt(m.density / shear_modulus) / (0.1631 * m.poisson_ratio + 0.8766);
    // Four contacts in one direction, each with a partner that moves against it: omega^2 = 8 k / m.
    const double spring = 2 / std::sqrt(8 * springs[material[g]] / motions.translation(g).number);
    const double limit = springs[material[g]] > 0 ? spring : rayleigh;
    if (limit > step.limit || (limit == step.limit && ids[g] > ids[limiter])) continue;
    step.limit = limit;
    limiter = g;
    by_spring = springs[material[g]] > 0;
  }
  if (ids.empty()) return step;
  char text[200];
  std::snprintf(text, sizeof text, "%s grain %lld (radius %.4g mm, %s)",
                by_spring ? "linear springs (omega^2 = 8 k / m) on" : "Rayleigh wave over",
                static_cast<long long>(ids[limiter]), 1e3 * place[limiter].radius,
                setup_.materials[material[limiter]].name.c_str());
  step.limiter = text;
  return with_bonds(step);
}

inline GrainSpring spring_of(const kernels::PairParameters& pair, double radius, double mass, double overlap) {
  const double patch = std::sqrt(radius * overlap);
  GrainSpring s;
  if (pair.normal_stiffness > 0) {  // linear springs
    s.normal_stiffness = pair.normal_stiffness;
    s.shear_stiffness = pair.friction > 0 ? pair.shear_stiffness : 0;
    s.normal_damping = pair.normal_viscosity;
    s.shear_damping = pair.shear_viscosity;
  } else {
    s.normal_stiffness = 2 * pair.effective_young_modulus * patch;
    s.shear_stiffness = pair.friction > 0 ? 8 * pair.effective_shear_modulus * patch : 0;
    s.normal_damping = pair.dissipative_coefficient * s.normal_stiffness;
  }
  const double dashpot = 2 * pair.damping_ratio * std::sqrt(mass * s.normal_stiffness);
  s.normal_damping += dashpot;
  s.shear_damping += pair.friction > 0 ? pair.shear_damping * dashpot : 0;
  return s;
}

/// Of grains, or of bodies where there are any.
inline std::vector<GrainInertia> System::inertias() const {
  const auto place = download(grains_.place);
  const auto motion = download(grains_.motion);
  const Rows<const Quad> motions{motion.data(), grains_.parts};
  const auto ids = download(grains_.id);
  std::vector<GrainInertia> all;
  const auto body_of_sphere = download(bodies_.of_sphere);
  const auto moments = download(bodies_.inertia);
  const auto body_ids = download(bodies_.id);
  const bool clumps = bodies_.any();
  for (int b = 0; b < bodies_.size(); ++b)
    all.push_back({0, std::fmin(moments[b].x, std::fmin(moments[b].y, moments[b].z)), body_ids[b]});
  for (int g = 0; g < grains_.size(); ++g) {
    const double mass = motions.translation(g).number, r = place[g].radius;
    if (clumps)
      all[body_of_sphere[g]].mass = mass;
    else
      all.push_back({mass, setup_.rotations ? 0.4 * mass * r * r : 0, ids[g]});
  }
  return all;
}

inline StableStep System::contact_stable_step() const {
  const auto place = download(grains_.place);
  const auto motion = download(grains_.motion);
  const Rows<const Quad> motions{motion.data(), grains_.parts};
  const auto material = download(grains_.material);
  const int materials = static_cast<int>(setup_.materials.size());
  const auto body_of_sphere = download(bodies_.of_sphere);
  const auto centres = download(bodies_.place);
  const bool clumps = bodies_.any();
  std::vector<GrainInertia> masses = inertias();
  std::vector<int> body_of_wall(walls_.walls.size(), -1);  // walls that are bodies follow the grains
  for (std::size_t w = 0; w < walls_.walls.size(); ++w) {
    if (!walls_.walls[w].body) continue;
    body_of_wall[w] = static_cast<int>(masses.size());
    masses.push_back({walls_.walls[w].body->is.mass, walls_.walls[w].body->least_moment(), -1});
  }
  const auto attach = [&](GrainSpring& s, int sphere, const Vec3& from_sphere) {
    s.grain = clumps ? body_of_sphere[sphere] : sphere;
    s.lever = from_sphere;
    if (clumps) s.lever += place[sphere].position - centres[s.grain].position;
  };
  std::vector<GrainSpring> springs = bond_springs();
  each_contact(
      [&](int i, int j, const Meeting<double>& m, const kernels::PairParameters& parameters, const Vec3&, const Vec3&) {
        auto s = spring_of(parameters, m.touch.effective_radius, m.touch.effective_mass, m.touch.overlap);
        s.normal = m.touch.normal;
        attach(s, i, -m.arm_i * s.normal);
        springs.push_back(s);
        if (j >= ghosts_.first) return;
        attach(s, j, m.arm_j * s.normal);
        springs.push_back(s);
      });
  const auto grain = rows_moved_ ? std::vector<int>{} : download(near_walls_.grain);
  const auto start = download(near_walls_.start);
  const auto candidate = download(near_walls_.candidate);
  const auto state = download(near_walls_.state);
  const auto facets = download(walls_.facets);
  for (std::size_t w = 0; w < grain.size(); ++w)
    for (int c = start[w]; c < start[w + 1]; ++c) {
      if (!(state[c].overlap > 0)) continue;
      const int g = grain[w];
      const int wall = facets[candidate[c]].wall, wall_material = walls_.rows_host[wall].material;
      auto s = spring_of(wall_parameters_host_[material[g] * materials + wall_material], place[g].radius,
                         motions.translation(g).number, state[c].overlap);
      s.normal = state[c].normal;
      attach(s, g, -(place[g].radius - state[c].overlap) * s.normal);
      s.other_is_free = body_of_wall[wall] >= 0;
      springs.push_back(s);
      if (!s.other_is_free) continue;
      s.grain = body_of_wall[wall];
      s.lever =
          place[g].position - (place[g].radius - state[c].overlap) * s.normal - walls_.walls[wall].body->state.centre;
      springs.push_back(s);
    }
  return contact_step(masses, springs);
}

inline std::vector<NodeSpring> System::node_springs(int wall) const {
  require_wall(wall);
  std::vector<NodeSpring> springs(walls_.walls[wall].nodes);
  if (rows_moved_ || near_walls_.size() == 0) return springs;
  const auto place = download(grains_.place);
  const auto motion = download(grains_.motion);
  const Rows<const Quad> motions{motion.data(), grains_.parts};
  const auto material = download(grains_.material);
  const int materials = static_cast<int>(setup_.materials.size()), first = walls_.walls[wall].first_node;
  const auto grain = download(near_walls_.grain), start = download(near_walls_.start);
  const auto candidate = download(near_walls_.candidate);
  const auto state = download(near_walls_.state);
  const auto facets = download(walls_.facets);
  const auto parts = download(walls_.parts);
  const auto faces = download(walls_.faces);
  const WallGeometry geometry{facets.data(), nullptr, nullptr, parts.empty() ? nullptr : parts.data(), faces.data()};
  for (std::size_t w = 0; w < grain.size(); ++w)
    for (int c = start[w]; c < start[w + 1]; ++c) {
      if (!(state[c].overlap > 0) || facets[candidate[c]].wall != wall) continue;
      const int g = grain[w];
      const auto spring = spring_of(wall_parameters_host_[material[g] * materials + walls_.rows_host[wall].material],
                                    place[g].radius, motions.translation(g).number, state[c].overlap);
      const Carriers carriers(geometry, candidate[c], state[c].weights);
      double sum = 0;  // above 1 where shape functions of the second order have both signs
      for (int k = 0; k < carriers.number && carriers.node[k] >= 0; ++k) sum += std::fabs(carriers.share[k]);
      for (int k = 0; k < carriers.number && carriers.node[k] >= 0; ++k) {
        NodeSpring& node = springs[carriers.node[k] - first];
        const double share = sum * std::fabs(carriers.share[k]);
        node.stiffness += share * std::fmax(spring.normal_stiffness, spring.shear_stiffness);
        node.damping += share * spring.normal_damping;
      }
    }
  return springs;
}

}  // namespace dem::TRACKBED_DEM_SYSTEM
