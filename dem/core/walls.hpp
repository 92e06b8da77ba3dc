#pragma once
// The walls themselves: geometry on the backend, motion, and how far they have moved since the last list build.
#include <algorithm>
#include <optional>

#include "base/error.hpp"
#include "dem/core/columns.hpp"
#include "dem/core/grains.hpp"
#include "dem/core/wall_drive.hpp"
#include "dem/core/wall_pass.hpp"

namespace dem::TRACKBED_DEM_SYSTEM {

struct HostWall : WallWay {
  int first_facet = 0, facets = 0;
  std::vector<Vec3> from{}, to{};    // [m] of the present target motion, on the host
  std::vector<Vec3> leaves{};        // [m/s] at its start, on a parabola
  std::vector<Vec3> bow{};           // [m] of a parabola, see MoveToTarget; while it is on its way
  std::vector<Vec3> listed{};        // [m] at the last list build
  std::vector<int> unknown{};        // per node: 1 where targets are not true; empty: nowhere
  std::vector<Face> faces{};         // of the second order, by nodes of this wall
  std::optional<MovingBody> body{};  // of WallMotion::body
  Vec3 impulse{};                    // [N s] on grains in the present advance(), flushed part
};

inline double largest_distance(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double squared = 0;
  for (std::size_t k = 0; k < a.size(); ++k) squared = std::max(squared, norm2(a[k] - b[k]));
  return std::sqrt(squared);
}

/// Bound of what a wall has moved between two states: its nodes, and what its faces have gained in distance from their
/// parts. Convex along straight ways of the nodes.
inline double largest_shift(const HostWall& wall, const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double bent = 0;
  for (const Face& face : wall.faces) {
    Vec3 moved[8];
    for (int k = 0; k < face.nodes(); ++k) moved[k] = a[face.node[k]] - b[face.node[k]];
    bent = std::max(bent, kernels::departure(moved, face.nodes()));
  }
  return largest_distance(a, b) + bent;
}

/// Rows of nodes that are sent to the backend for a way to a target.
enum NodeRows { target_places, target_velocities, parabola_bows, parabola_starts, parabola_ends, kinds_of_node_rows };

class Walls {
 public:
  std::vector<HostWall> walls;
  std::vector<WallRow> rows_host;
  bool rows_changed = false;
  Vector<WallRow> rows;
  Vector<Facet> facets;
  Vector<FacePart> parts;  // per facet; empty without faces of the second order
  Vector<Face> faces;
  Vector<int> planes;  // facets that are planes
  Vector<Vec3> position;
  Vector<int> wall_of_node;
  Vector<Vec3> velocity, displacement;                                  // empty while nothing has moved
  Vector<Vec3> from_position, from_velocity, to_position, to_velocity;  // empty without target motions
  Vector<Vec3> bow;                                                     // [m] of nodes on parabolas; empty without any
  Vector<Vec3> body_offset;   // [m] of nodes from their body's centre; empty without bodies
  Vector<Vec3> node_impulse;  // [N s] flushed part; empty without coupled meshes

  bool any() const { return !walls.empty(); }
  bool nodal() const {
    return std::any_of(rows_host.begin(), rows_host.end(), [](const WallRow& row) { return row.nodal; });
  }
  bool moving() const {
    return std::any_of(walls.begin(), walls.end(),
                       [](const HostWall& w) { return w.motion != WallMotion::fixed || w.largest_bow > 0; });
  }
  int nodal_rows() const { return faces.empty() ? 1 : 2; }
  WallGeometry geometry() const {
    return {pointer(facets), pointer(rows), pointer(position), pointer(parts), pointer(faces)};
  }

  /// `second_order`, `made_of`: the mesh's faces of the second order and which facet is what of them, or nothing.
  int add(const WallRow& row, const std::vector<Vec3>& nodes, std::vector<Facet> mesh,
          std::vector<Face> second_order = {}, std::vector<FacePart> made_of = {}) {
    const int number = static_cast<int>(walls.size());
    HostWall wall;
    wall.first_node = static_cast<int>(position.size());
    wall.nodes = static_cast<int>(nodes.size());
    wall.first_facet = static_cast<int>(facets.size());
    wall.facets = static_cast<int>(mesh.size());
    for (Facet& f : mesh) {
      f.wall = number;
      for (int& node : f.node)
        if (node >= 0) node += wall.first_node;
    }
    if (mesh.size() == 1 && mesh[0].node[1] < 0) append(planes, std::vector<int>{wall.first_facet});
    append(position, nodes);
    append(wall_of_node, std::vector<int>(nodes.size(), number));
    append(facets, mesh);
    wall.faces = second_order;
    add_faces(wall, second_order, made_of);
    walls.push_back(wall);
    rows_host.push_back(row);
    rows_changed = true;
    for (auto* v : {&body_offset, &velocity, &displacement, &from_position, &from_velocity, &to_position, &to_velocity,
                    &node_impulse, &bow})
      if (!v->empty()) v->resize(position.size());
    return number;
  }

  void remove(int wall) {
    const HostWall& w = walls[wall];
    std::vector<Facet> dead = download(facets);
    for (int f = w.first_facet; f < w.first_facet + w.facets; ++f) dead[f].live = 0;
    upload(dead, facets);
    std::vector<int> left;
    for (int f : download(planes))
      if (dead[f].live) left.push_back(f);
    upload(left, planes);
    stop(wall);
  }

  void set_velocity(int wall, const Vec3& v) {
    HostWall& w = walls[wall];
    if (w.body) return w.body->drive(v);
    allocate_motion();
    forget_target(wall);
    w.velocity = v;
    if (!(norm2(v) > 0)) return stop(wall);
    w.motion = WallMotion::rigid;
    mark(wall, true, false);
    launch(w.nodes, MoveRigidly{pointer(position), pointer(velocity), pointer(displacement), w.first_node, v, 0});
  }

  void set_body(int wall, const WallBody& is) {
    HostWall& w = walls[wall];
    allocate_motion();
    forget_target(wall);
    stop(wall);
    MovingBody body(is);
    std::vector<Vec3> offsets(w.nodes);
    thrust::copy(position.begin() + w.first_node, position.begin() + w.first_node + w.nodes, offsets.begin());
    for (Vec3& offset : offsets) {
      offset -= is.centre;
      body.reach = std::max(body.reach, norm(offset));
    }
    body_offset.resize(position.size());
    thrust::copy(offsets.begin(), offsets.end(), body_offset.begin() + w.first_node);
    w.body = body;
    w.motion = WallMotion::body;
    mark(wall, true, false);
    rows_host[wall].body = 1;
    rows_changed = true;
  }

  bool bodies() const {
    return std::any_of(walls.begin(), walls.end(), [](const HostWall& w) { return w.motion == WallMotion::body; });
  }

  /// Returns true when this is the first target of the wall, from which on its nodal impulses are kept. Rows of nodes
  /// go to the backend by send(kind, rows, where to); two copies of one kind to the same place may overtake each other.
  template <class Send>
  bool set_target(int wall, std::span<const Vec3> positions, std::span<const Vec3> velocities, MeshWay way,
                  const Send& send) {
    HostWall& w = walls[wall];
    allocate_motion();
    w.way = way;
    w.leaves.clear();
    w.bow.clear();
    w.largest_bow = 0;
    for (auto* v : {&from_position, &from_velocity, &to_position, &to_velocity, &node_impulse})
      v->resize(position.size());
    if (w.motion == WallMotion::target && !w.fresh_target)
      w.from = w.to;
    else if (!w.fresh_target) {
      w.from.resize(w.nodes);
      const auto first = position.begin() + w.first_node;
      thrust::copy(first, first + w.nodes, w.from.begin());
    }
    if (w.listed.empty()) {
      w.listed = w.from;
      for (Vec3& p : w.listed) p -= w.rigid_shift;
      w.rigid_shift = {};
    }
    w.to.assign(positions.begin(), positions.end());
    std::vector<Vec3> speeds(velocities.begin(), velocities.end());
    for (std::size_t n = 0; n < w.unknown.size(); ++n) {
      if (!w.unknown[n]) continue;
      w.to[n] = w.from[n];
      speeds[n] = {};
    }
    send(target_places, w.to, pointer(to_position), w.first_node);
    send(target_velocities, speeds, pointer(to_velocity), w.first_node);
    if (way == MeshWay::parabola) {
      w.leaves = std::move(speeds);
      bow.resize(position.size());
    }
    w.shift_from = largest_shift(w, w.from, w.listed);
    w.shift_to = largest_shift(w, w.to, w.listed);
    w.motion = WallMotion::target;
    w.fresh_target = true;
    const bool first = !rows_host[wall].nodal;
    rows_host[wall].nodal = 1;
    rows_changed = rows_changed || first;
    mark(wall, true, true);
    return first;
  }

  /// See Simulation::know_mesh_nodes(); lists must be made anew.
  void know(int wall, std::span<const int> nodes, std::span<const int> fresh, std::span<const Vec3> positions,
            std::span<const Vec3> velocities) {
    HostWall& w = walls[wall];
    allocate_motion();
    w.unknown.assign(w.nodes, 1);
    for (const int node : nodes) w.unknown[node] = 0;
    auto place = download(position), speed = download(velocity);
    for (std::size_t k = 0; k < fresh.size(); ++k) {
      place[w.first_node + fresh[k]] = positions[k];
      speed[w.first_node + fresh[k]] = velocities[k];
      if (!w.to.empty()) w.to[fresh[k]] = positions[k];
    }
    upload(place, position);
    upload(speed, velocity);
    find_live(w);
  }

  /// Takes over what the same walls of another part know and these do not.
  void learn(const Walls& other) {
    auto place = download(position), speed = download(velocity);
    const auto other_place = download(other.position), other_speed = download(other.velocity);
    for (std::size_t k = 0; k < walls.size(); ++k) {
      HostWall& w = walls[k];
      const HostWall& from = other.walls[k];
      for (std::size_t n = 0; n < w.unknown.size(); ++n) {
        if (!w.unknown[n] || (!from.unknown.empty() && from.unknown[n])) continue;
        w.unknown[n] = 0;
        place[w.first_node + n] = other_place[w.first_node + n];
        speed[w.first_node + n] = other_speed[w.first_node + n];
        for (auto list : {&HostWall::from, &HostWall::to, &HostWall::listed})
          if (!(w.*list).empty() && !(from.*list).empty()) (w.*list)[n] = (from.*list)[n];
      }
      if (!w.unknown.empty()) find_live(w);
    }
    upload(place, position);
    if (!speed.empty()) upload(speed, velocity);
  }

  /// duration: of the advance that begins [s].
  template <class Send>
  void begin_advance(double duration, const Send& send) {
    for (std::size_t k = 0; k < walls.size(); ++k) {
      HostWall& w = walls[k];
      w.impulse = {};
      if (w.motion != WallMotion::target) continue;
      if (!w.fresh_target) {
        w.shift_from = w.shift_to;
        stop(static_cast<int>(k));
        continue;
      }
      w.fresh_target = false;
      launch(w.nodes, StartWay{pointer(position), pointer(velocity), pointer(from_position), pointer(from_velocity),
                               w.first_node});
      if (w.way == MeshWay::parabola) begin_parabola(w, duration, send);
    }
    clear(node_impulse);
  }

  /// Step k of n.
  void move(int k, int n, double dt, const Vec3& gravity) {
    for (HostWall& w : walls) {
      if (w.motion == WallMotion::body) {
        move_body(w, dt, gravity);
      } else if (w.motion == WallMotion::rigid) {
        launch(w.nodes,
               MoveRigidly{pointer(position), pointer(velocity), pointer(displacement), w.first_node, w.velocity, dt});
        w.move_rigidly(dt);
      } else if (w.motion == WallMotion::target) {
        launch(w.nodes, MoveToTarget{pointer(position), pointer(velocity), pointer(displacement),
                                     pointer(from_position), pointer(from_velocity), pointer(to_position),
                                     pointer(to_velocity), w.way == MeshWay::parabola ? pointer(bow) : nullptr,
                                     w.first_node, k < n ? double(k) / n : 1.0, 1.0 / n});
      }
    }
  }

  /// Bound of the largest displacement of any wall since the list build.
  double shift(double share) const {
    double largest = 0;
    for (const HostWall& w : walls) largest = std::max(largest, w.shift(share));
    return largest;
  }

  /// The lists have been built with the walls where they are, `share` of the way to their targets.
  void listed_here(double share) {
    for (HostWall& w : walls) {
      w.rigid_shift = {};
      if (w.listed.empty()) {  // bodies, and what was one: nothing of the way before counts
        w.shift_from = w.shift_to = 0;
        continue;
      }
      if (w.motion != WallMotion::target || w.fresh_target) {
        w.listed.clear();
        w.shift_from = w.shift_to = 0;
        if (!w.fresh_target) continue;
        w.listed = w.from;
      } else {
        for (std::size_t k = 0; k < w.listed.size(); ++k) w.listed[k] = w.from[k] + share * (w.to[k] - w.from[k]);
        for (std::size_t k = 0; k < w.bow.size(); ++k) w.listed[k] += share * (1 - share) * w.bow[k];
      }
      w.shift_from = largest_shift(w, w.from, w.listed);
      w.shift_to = largest_shift(w, w.to, w.listed);
    }
  }

  /// As the backend moves them, and back from there.
  void write_drives(DrivenWall* drives) const {
    for (std::size_t k = 0; k < walls.size(); ++k) {
      drives[k] = {walls[k], {}, {}};
      if (walls[k].body) drives[k].body = *walls[k].body;
    }
  }
  void read_drives(const DrivenWall* drives) {
    for (std::size_t k = 0; k < walls.size(); ++k) {
      static_cast<WallWay&>(walls[k]) = drives[k];
      if (walls[k].body) walls[k].body = drives[k].body;
    }
  }
  WallNodes nodes() {
    return {pointer(wall_of_node),  pointer(position),      pointer(velocity),    pointer(displacement),
            pointer(from_position), pointer(from_velocity), pointer(to_position), pointer(to_velocity),
            pointer(bow),           pointer(body_offset)};
  }

  void upload_rows() {
    upload(rows_host, rows);
    rows_changed = false;
  }

  /// The state of the walls for a checkpoint, or from one; what they are made of is there already.
  template <class Self, class Walk>
  static void walk(Self& self, Walk& walk) {
    const std::size_t nodes = self.position.size();
    walk.rows("walls/planes", self.planes);
    walk.rows("walls/position", self.position);
    walk.rows("walls/velocity", self.velocity);
    walk.rows("walls/displacement", self.displacement);
    walk.rows("walls/from_position", self.from_position);
    walk.rows("walls/from_velocity", self.from_velocity);
    walk.rows("walls/to_position", self.to_position);
    walk.rows("walls/to_velocity", self.to_velocity);
    walk.rows("walls/bow", self.bow);
    walk.rows("walls/body_offset", self.body_offset);
    walk.rows("walls/node_impulse", self.node_impulse);
    auto made = download(self.facets);
    auto seen = download(self.rows);
    std::vector<int> live;
    for (const Facet& facet : made) live.push_back(facet.live);
    walk.rows("walls/live", live);
    walk.numbers("walls/pending", self.rows_changed);
    int seen_rows = static_cast<int>(seen.size());
    walk.numbers("walls/seen", seen_rows);
    if constexpr (Walk::loads) {
      base::require_user(self.position.size() == nodes && live.size() == made.size(), "the walls are others");
      for (std::size_t f = 0; f < made.size(); ++f) made[f].live = live[f];
      upload(made, self.facets);
      seen.assign(self.rows_host.begin(), self.rows_host.begin() + seen_rows);
    }
    for (std::size_t k = 0; k < self.walls.size(); ++k) {
      const std::string name = "walls/" + std::to_string(k);
      walk_wall(self.walls[k], walk, name);
      walk_row(self.rows_host[k], walk, name + "/row");
      if (k < seen.size()) walk_row(seen[k], walk, name + "/seen");
    }
    if constexpr (Walk::loads) upload(seen, self.rows);
  }

  std::size_t bytes() const {
    std::size_t total = bytes_of(rows) + bytes_of(facets) + bytes_of(parts) + bytes_of(faces) + bytes_of(planes) +
                        bytes_of(wall_of_node) + bytes_of(body_offset);
    for (const auto* v : {&position, &velocity, &displacement, &from_position, &from_velocity, &to_position,
                          &to_velocity, &node_impulse, &bow})
      total += bytes_of(*v);
    return total;
  }

 private:
  void add_faces(const HostWall& wall, std::vector<Face>& second_order, std::vector<FacePart>& made_of) {
    if (faces.empty() && second_order.empty()) return;
    made_of.resize(wall.facets);
    for (FacePart& part : made_of)
      if (part.face >= 0) part.face += static_cast<int>(faces.size());
    for (Face& face : second_order)
      for (int& node : face.node)
        if (node >= 0) node += wall.first_node;
    parts.resize(wall.first_facet, FacePart{});
    append(parts, made_of);
    append(faces, second_order);
  }
  template <class Row, class Walk>
  static void walk_row(Row& row, Walk& walk, const std::string& name) {
    walk.numbers(name, row.moves, row.interface, row.body, row.nodal);
  }
  template <class Wall, class Walk>
  static void walk_wall(Wall& wall, Walk& walk, const std::string& name) {
    walk.numbers(name + "/motion", wall.motion, wall.fresh_target, wall.velocity, wall.rigid_shift, wall.moved,
                 wall.shift_from, wall.shift_to, wall.impulse, wall.way);
    walk.rows(name + "/leaves", wall.leaves);
    walk.rows(name + "/from", wall.from);
    walk.rows(name + "/to", wall.to);
    walk.rows(name + "/listed", wall.listed);
    walk.rows(name + "/unknown", wall.unknown);
    bool body = wall.body.has_value();
    walk.numbers(name + "/has_body", body);
    if constexpr (Walk::loads) {
      base::require_user(wall.body || !body, "the walls are others");
      if (!body) wall.body.reset();
    }
    if (body)
      walk.numbers(name + "/body", wall.body->state, wall.body->force, wall.body->torque, wall.body->work_loads,
                   wall.body->work_gravity, wall.body->work_drive, wall.body->loss_damping);
  }
  void move_body(HostWall& w, double dt, const Vec3& gravity) {
    const WallBodyState seen = w.body->begin_step(dt, gravity);
    w.shift_from += dt * w.body->fastest();
    launch(w.nodes, MoveBody{pointer(position), pointer(velocity), pointer(displacement), pointer(body_offset),
                             w.first_node, seen.centre, seen.velocity, seen.angular_velocity, seen.orientation});
  }
  template <class Send>
  void begin_parabola(HostWall& w, double duration, const Send& send) {
    w.bow.resize(w.nodes);
    std::vector<Vec3> arrives(w.nodes);
    for (int k = 0; k < w.nodes; ++k) {
      w.bow[k] = duration * w.leaves[k] - (w.to[k] - w.from[k]);
      arrives[k] = duration > 0 ? w.leaves[k] - (2 / duration) * w.bow[k] : w.leaves[k];
      w.largest_bow = std::max(w.largest_bow, norm(w.bow[k]));
    }
    send(parabola_bows, w.bow, pointer(bow), w.first_node);
    send(parabola_starts, w.leaves, pointer(from_velocity), w.first_node);
    send(parabola_ends, arrives, pointer(to_velocity), w.first_node);
  }
  /// Facets of a wall with nodes that are not known are found by no grain.
  void find_live(const HostWall& w) {
    auto all = download(facets);
    const auto part = download(parts);
    const auto face = download(faces);
    const auto known = [&](const int* node, int count) {
      return std::all_of(node, node + count, [&](int n) { return n < 0 || !w.unknown[n - w.first_node]; });
    };
    for (int f = w.first_facet; f < w.first_facet + w.facets; ++f) {
      const int of = part.empty() ? -1 : part[f].face;
      all[f].live = known(all[f].node, 4) && (of < 0 || known(face[of].node, face[of].nodes()));
    }
    upload(all, facets);
  }
  void allocate_motion() {
    velocity.resize(position.size());
    displacement.resize(position.size());
  }
  void mark(int wall, bool moves, bool interface) {
    WallRow& row = rows_host[wall];
    rows_changed = rows_changed || row.moves != moves || row.interface != interface;
    row.moves = moves;
    row.interface = interface;
  }
  /// A wall that followed a target stays where it is: what it has moved since the list build is kept as a bound.
  void forget_target(int wall) {
    HostWall& w = walls[wall];
    if (w.motion == WallMotion::target && !w.fresh_target) w.shift_from = w.shift_to;
    w.fresh_target = false;
  }
  void stop(int wall) {
    HostWall& w = walls[wall];
    w.motion = WallMotion::fixed;
    w.velocity = {};
    w.body.reset();
    rows_changed = rows_changed || rows_host[wall].body;
    rows_host[wall].body = 0;
    w.fresh_target = false;
    mark(wall, false, rows_host[wall].interface);
    if (velocity.empty()) return;
    launch(w.nodes, MoveRigidly{pointer(position), pointer(velocity), pointer(displacement), w.first_node, {}, 0});
  }
};

}  // namespace dem::TRACKBED_DEM_SYSTEM
