#pragma once
// What a simulation is made of, and what is changed between two calls of advance().
#include <unordered_map>

#include "dem/core/system_queue.hpp"
#include "dem/core/system_slabs.hpp"
#include "dem/law_parameters.hpp"

namespace dem::TRACKBED_DEM_SYSTEM {

inline System::System(const Setup& setup, Backend backend) : setup_(setup), backend_(backend) {
  const std::size_t materials = setup.materials.size();
  base::require_user(materials > 0, "dem: at least one material is needed");
  base::require_user(setup.interactions.size() == materials * materials,
                     "dem: interactions must be a square table, materials x materials");
  base::require_user(setup.skin >= 0 && setup.maximum_overlap > 0, "dem: skin and maximum overlap must be positive");
  for (const Period& along : setup.periods) base::require_user(along.length >= 0, "dem: a period must not be negative");
  periods_ = periods_of(setup.periods);
  join_company();
  grains_.parts = setup.rotations ? 2 : 1;
  upload(std::vector<Control>(1), control_);
  control_host_.make(2);
  upload_parameters();
}

inline void System::mark_grains_changed() {
  list_is_stale_ = forces_are_stale_ = true;
  gravity_referenced_ = false;
}

inline void System::upload_parameters() {
  const auto& materials = setup_.materials;
  const int count = static_cast<int>(materials.size());
  std::vector<double> densities;
  const auto before = grain_parameters_host_;
  const auto walls_before = wall_parameters_host_;
  grain_parameters_host_.clear();
  wall_parameters_host_.clear();
  smooth_ = true;
  mixed_laws_ = brakes_ = couples_ = false;
  for (int a = 0; a < count; ++a) {
    densities.push_back(materials[a].density);
    for (int b = 0; b < count; ++b) {
      const Interaction& between = setup_.interactions[a * count + b];
      for (const bool wall : {false, true}) {
        auto pair = interaction_parameters(materials[a], materials[b], between, wall);
        if (!setup_.rotations) pair.rolling = no_rolling;
        smooth_ = smooth_ && pair.law == smooth_law;
        mixed_laws_ = mixed_laws_ || pair.law > 0;
        brakes_ = brakes_ || pair.rolling == rolling_brof;
        couples_ = couples_ || pair.rolling == rolling_a || pair.rolling == rolling_c;
        (wall ? wall_parameters_host_ : grain_parameters_host_).push_back(pair);
      }
    }
  }
  // Where the laws differ from pair to pair, a row of numbers is as long as the longest.
  for (auto* table : {&grain_parameters_host_, &wall_parameters_host_})
    for (auto& pair : *table) pair.flips = history_of(pair).flips;
  upload(densities, density_);
  upload(grain_parameters_host_, grain_parameters_);
  upload(wall_parameters_host_, wall_parameters_);
  const auto differ = [](const kernels::PairParameters& x, const kernels::PairParameters& y) {
    return x.law != y.law || x.rolling != y.rolling;
  };
  const auto changed = [&](const auto& old, const auto& now) {
    return !std::equal(old.begin(), old.end(), now.begin(), now.end(),
                       [&](const auto& x, const auto& y) { return !differ(x, y); });
  };
  if (changed(before, grain_parameters_host_) || changed(walls_before, wall_parameters_host_)) list_is_stale_ = true;
}

/// What one contact of this pair keeps when contacts are taken one by one: the rolling numbers end the row.
inline HistoryLayout System::history_of(const kernels::PairParameters& pair) const {
  const int law = smooth_ ? 0 : mixed_laws_ ? AnyLaw::history : kernels::HertzMindlin::history;
  const bool ledger = setup_.track_energy;
  HistoryLayout layout = history_layout(law, ledger, couples_ ? rolling_c : no_rolling);
  const int own = law_history(pair.law);
  layout.flips = history_layout(own, ledger, no_rolling).flips;
  if (couples_) layout.flips |= 7u << layout.law;
  return layout;
}

inline void System::set_masses() {
  if (bodies_.any()) return set_body_masses();
  launch(grains_.size(), SetMass{pointer(grains_.place), pointer(grains_.material), pointer(density_), grains_.states(),
                                 grains_.motions()});
}

inline void System::add_grains(std::span<const Grain> grains) {
  const int materials = static_cast<int>(setup_.materials.size());
  for (const Grain& g : grains) {
    base::require_user(g.radius > 0, "dem: a grain's radius must be positive");
    base::require_user(g.material >= 0 && g.material < materials, "dem: a grain names a material that does not exist");
    base::require_user(setup_.materials[g.material].density > 0, "dem: a grain's material has no density");
    base::require_user(g.shape < static_cast<int>(shapes_.size()), "dem: a grain names a shape that does not exist");
  }
  if (grains.empty()) return;
  settle_gravity();
  drop_ghosts();
  const bool clumps = std::any_of(grains.begin(), grains.end(), [](const Grain& g) { return g.shape >= 0; });
  if (clumps && !bodies_.any()) make_bodies();
  const auto own = in_company() ? own_grains(grains) : std::vector<Grain>{};
  if (in_company()) grains = own;
  if (clumps || bodies_.any()) {
    add_bodies(grains);
  } else {
    grains_.add(grains);
    set_masses();
  }
  mark_grains_changed();
  rows_moved_ = true;
}

inline void System::remove_grains(std::span<const std::int64_t> ids) {
  std::vector<std::int64_t> gone(ids.begin(), ids.end());
  std::sort(gone.begin(), gone.end());
  std::vector<int> order;
  const auto present = download(bodies_.any() ? bodies_.id : grains_.id);
  for (std::size_t g = 0; g < present.size(); ++g)
    if (!std::binary_search(gone.begin(), gone.end(), present[g])) order.push_back(static_cast<int>(g));
  if (order.size() == present.size()) return;
  settle_gravity();
  flush_losses();
  drop_ghosts();
  Vector<int> kept;
  upload(order, kept);
  if (bodies_.any())
    bodies_.keep(kept, grains_);
  else
    grains_.keep(kept);
  mark_grains_changed();
  rows_moved_ = true;
}

inline void System::set_grains(std::span<const Grain> changed) {
  settle_gravity();
  mark_grains_changed();
  if (bodies_.any()) return set_bodies(changed);
  std::unordered_map<std::int64_t, const Grain*> by_id;
  for (const Grain& g : changed) by_id[g.id] = &g;
  const auto ids = download(grains_.id);
  auto place = download(grains_.place);
  auto state = download(grains_.state);
  for (std::size_t k = 0; k < ids.size(); ++k) {
    const auto found = by_id.find(ids[k]);
    if (found == by_id.end()) continue;
    place[k].position = found->second->position;
    const Rows<Quad> rows{state.data(), grains_.parts};
    rows.translation(static_cast<int>(k)).vector = found->second->velocity;
    if (grains_.parts == 2) rows.rotation(static_cast<int>(k)).vector = found->second->angular_velocity;
  }
  upload(place, grains_.place);
  upload(state, grains_.state);
  launch(grains_.size(), CopyVelocities{grains_.states(), grains_.motions()});
}

inline void System::set_material(int material, const Material& m) {
  base::require_internal(material >= 0 && material < static_cast<int>(setup_.materials.size()), "no such material");
  settle_gravity();
  setup_.materials[material] = m;
  upload_parameters();
  set_masses();
  mark_grains_changed();
}

inline void System::set_interaction(int a, int b, const Interaction& between) {
  const int count = static_cast<int>(setup_.materials.size());
  base::require_internal(a >= 0 && a < count && b >= 0 && b < count, "no such material");
  setup_.interactions[a * count + b] = setup_.interactions[b * count + a] = between;
  upload_parameters();
  forces_are_stale_ = true;
}

inline void System::set_gravity(Vec3 gravity) {
  settle_gravity();
  setup_.gravity = gravity;
  gravity_referenced_ = false;
  forces_are_stale_ = true;
}

inline void System::set_grain_damping(double alpha) {
  base::require_user(alpha >= 0, "dem: grain damping must not be negative");
  alpha_ = alpha;
}

inline void System::require_wall(int wall) const {
  base::require_internal(wall >= 0 && wall < static_cast<int>(walls_.walls.size()), "no such wall");
}

inline int System::add_plane(const Plane& plane, int material) {
  const double length = norm(plane.normal);
  base::require_user(length > 0, "dem: a plane needs a normal");
  list_is_stale_ = forces_are_stale_ = true;
  const WallRow row{.plane_normal = (1 / length) * plane.normal, .material = material};
  return walls_.add(row, {plane.point}, {Facet{.node = {0, -1, -1, -1}}});
}

/// The faces of the second order of a mesh, and what its facets are of them.
inline std::pair<std::vector<Face>, std::vector<FacePart>> faces_of(const base::Skin& skin) {
  std::vector<Face> faces(skin.faces.size());
  std::vector<FacePart> parts(skin.face_of.size());
  const std::string head = "dem: mesh " + skin.body;
  base::require_user(parts.empty() || parts.size() == skin.facets.size(),
                     head + " does not say it of every facet what it is a part of");
  for (std::size_t f = 0; f < faces.size(); ++f)
    for (int k = 0; k < 8; ++k) {
      const int node = skin.faces[f][k];
      base::require_user((node >= 0 || k >= 6) && node < static_cast<int>(skin.nodes.size()),
                         head + " has a face with a node that does not exist");
      faces[f].node[k] = node;
    }
  for (std::size_t f = 0; f < parts.size(); ++f) {
    parts[f].face = skin.face_of[f];
    if (parts[f].face < 0) continue;
    base::require_user(parts[f].face < static_cast<int>(faces.size()),
                       head + " has a facet of a face that does not exist");
    const Face& face = faces[parts[f].face];
    for (int k = 0; k < 4 && skin.facets[f][k] >= 0; ++k) {
      const int* end = face.node + face.nodes();
      const int* found = std::find(face.node, end, skin.facets[f][k]);
      base::require_user(found != end, head + " has a facet with a node that its face has not");
      parts[f].corner[k] = static_cast<int>(found - face.node);
    }
  }
  return {faces, parts};
}

inline int System::add_mesh(const base::Skin& skin, int material, bool two_sided) {
  std::vector<Facet> facets;
  for (const auto& nodes : skin.facets) {
    for (int k = 0; k < 4; ++k)
      base::require_user((nodes[k] >= 0 || k == 3) && nodes[k] < static_cast<int>(skin.nodes.size()),
                         "dem: mesh " + skin.body + " has a facet with a node that does not exist");
    facets.push_back({.node = {nodes[0], nodes[1], nodes[2], nodes[3]}});
  }
  list_is_stale_ = forces_are_stale_ = true;
  auto [faces, parts] = faces_of(skin);
  return walls_.add({.material = material, .two_sided = two_sided}, skin.nodes, std::move(facets), std::move(faces),
                    std::move(parts));
}

inline void System::remove_wall(int wall) {
  require_wall(wall);
  if (setup_.track_energy) {
    flush_losses();
    const base::Energy held = pending();
    if (!taken_away_) taken_away_ = held.elastic_normal + held.elastic_shear;
    if (walls_.walls[wall].body && is_first_part()) totals_.work_walls -= walls_.walls[wall].body->kinetic();
  }
  walls_.remove(wall);
  list_is_stale_ = forces_are_stale_ = true;
}

inline void System::set_wall_velocity(int wall, Vec3 velocity) {
  require_wall(wall);
  walls_.set_velocity(wall, velocity);
}

inline void System::set_wall_body(int wall, const WallBody& body) {
  require_wall(wall);
  base::require_user(body.mass > 0, "dem: a wall that moves as a body needs a mass > 0");
  for (int axis = 0; axis < 3; ++axis)
    base::require_user(!body.turns[axis] || body.inertia[axis] > 0,
                       "dem: a wall that may turn needs a moment of inertia > 0 about that axis");
  base::require_user(download(walls_.facets)[walls_.walls[wall].first_facet].node[1] >= 0,
                     "dem: a plane cannot be a body: it has no end; use a mesh");
  walls_.set_body(wall, body);
  list_is_stale_ = forces_are_stale_ = true;
}

inline void System::set_wall_load(int wall, Vec3 force, Vec3 torque) {
  require_wall(wall);
  base::require_internal(walls_.walls[wall].body.has_value(), "a load on a wall that is no body");
  walls_.walls[wall].body->force = force;
  walls_.walls[wall].body->torque = torque;
}

inline WallBodyState System::wall_body(int wall) const {
  require_wall(wall);
  base::require_internal(walls_.walls[wall].body.has_value(), "the state of a wall that is no body");
  return walls_.walls[wall].body->state;
}

inline Vec3 System::wall_displacement(int wall) const {
  require_wall(wall);
  const HostWall& w = walls_.walls[wall];
  return w.moved + (w.body ? w.body->displacement() : Vec3{});
}

inline Vec3 System::wall_velocity(int wall) const {
  require_wall(wall);
  const HostWall& w = walls_.walls[wall];
  return w.body ? w.body->state.velocity : w.velocity;
}

inline void System::set_mesh_target(int wall, std::span<const Vec3> positions, std::span<const Vec3> velocities,
                                    MeshWay way) {
  require_wall(wall);
  const std::size_t nodes = walls_.walls[wall].nodes;
  base::require_internal(positions.size() == nodes && velocities.size() == nodes, "target of another mesh");
  const auto send = [this](const auto&... arguments) { send_nodes(arguments...); };
  if (walls_.set_target(wall, positions, velocities, way, send)) list_is_stale_ = true;
}

inline void System::know_mesh_nodes(int wall, std::span<const int> nodes, std::span<const int> fresh,
                                    std::span<const Vec3> positions, std::span<const Vec3> velocities) {
  require_wall(wall);
  walls_.know(wall, nodes, fresh, positions, velocities);
  list_is_stale_ = true;
}

}  // namespace dem::TRACKBED_DEM_SYSTEM
