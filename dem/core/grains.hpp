#pragma once
// The grains' rows on the backend, and how they are added, removed and reordered.
#include <algorithm>
#include <numbers>

#include "dem/core/cell_grid.hpp"
#include "dem/dem.hpp"

namespace dem::TRACKBED_DEM_SYSTEM {

template <class T>
struct Gather {
  const T* from;
  const int* order;
  T* to;
  int parts;  // rows per grain
  TRACKBED_HD void operator()(int k) const {
    for (int part = 0; part < parts; ++part) to[parts * k + part] = from[parts * order[k] + part];
  }
};

template <class T>
void reorder(Vector<T>& v, const Vector<int>& order, int parts = 1) {
  if (v.empty()) return;
  Vector<T> sorted(parts * order.size());
  launch(static_cast<int>(order.size()), Gather<T>{pointer(v), pointer(order), pointer(sorted), parts});
  v.swap(sorted);
}

/// Writes `host` behind the first `before` entries; what lay there is lost.
template <class T>
void append(Vector<T>& v, const std::vector<T>& host, std::size_t before) {
  v.resize(before + host.size());
  if (!host.empty()) thrust::copy(host.begin(), host.end(), v.begin() + before);
}
template <class T>
void append(Vector<T>& v, const std::vector<T>& host) {
  append(v, host, v.size());
}

struct SetMass {
  const Place* place;
  const int* material;
  const double* density;  // of the materials
  Rows<Quad> state, motion;
  TRACKBED_HD void operator()(int g) const {
    const double r = place[g].radius;
    const double mass = density[material[g]] * (4.0 / 3.0) * std::numbers::pi * r * r * r;
    motion.translation(g).number = mass;
    state.translation(g).number = 1 / mass;
    if (state.parts == 2) state.rotation(g).number = 1 / (0.4 * mass * r * r);
  }
};

struct Radii {
  double smallest = HUGE_VAL, largest = 0;
};
struct RadiiOf {
  const Place* place;
  TRACKBED_HD Radii operator()(int g) const { return {place[g].radius, place[g].radius}; }
};
struct JoinRadii {
  TRACKBED_HD Radii operator()(const Radii& a, const Radii& b) const {
    return {std::fmin(a.smallest, b.smallest), std::fmax(a.largest, b.largest)};
  }
};

/// Rows of grains. Ghosts (ghosts.hpp) may stand behind them, in `material` and `old_of_new` too; then `place`,
/// `motion` and `pull` may end with spare rows that belong to no grain.
struct Grains {
  bool own_state = true;  // false: bodies own it (bodies.hpp), and `state` and `pull`s between steps are theirs
  int parts = 2;          // 1: nothing rotates
  Vector<Place> place;
  Vector<Quad> state, motion, pull;  // see leapfrog.hpp
  Vector<Vec3> listed;               // positions at the last list build
  Vector<int> material;
  Vector<std::int64_t> id;
  Vector<GrainLedger> ledger;  // empty while nothing needs it; of bodies where there are any
  Vector<int> old_of_new;      // index under the numbering of the present contact lists, -1: not in them

  int size() const { return static_cast<int>(id.size()); }
  Rows<Quad> states() { return {pointer(state), parts}; }
  Rows<Quad> motions() { return {pointer(motion), parts}; }
  Rows<Quad> pulls() { return {pointer(pull), parts}; }
  Rows<const Quad> states() const { return {pointer(state), parts}; }
  Rows<const Quad> motions() const { return {pointer(motion), parts}; }

  void add(std::span<const Grain> grains) {
    std::vector<Place> places;
    std::vector<Quad> states;
    std::vector<int> materials;
    std::vector<std::int64_t> ids;
    for (const Grain& g : grains) {
      places.push_back({g.position, g.radius});
      states.push_back({g.velocity, 0});
      if (parts == 2) states.push_back({g.angular_velocity, 0});
      materials.push_back(g.material);
      ids.push_back(g.id);
    }
    const std::size_t before = id.size();
    append(place, places, before);
    if (own_state) append(state, states, parts * before);
    append(motion, states, parts * before);
    append(pull, std::vector<Quad>(states.size()), parts * before);
    append(material, materials, before);
    append(id, ids);
    if (own_state && !ledger.empty()) ledger.resize(id.size());
    append(old_of_new, std::vector<int>(grains.size(), -1), before);
  }

  /// New grain k is the present grain order[k]; grains that are not named are gone.
  void keep(const Vector<int>& order) {
    reorder(place, order);
    reorder(state, order, parts);
    reorder(motion, order, parts);
    reorder(pull, order, parts);
    reorder(material, order);
    reorder(id, order);
    reorder(ledger, order);
    reorder(old_of_new, order);
  }

  void sort_by_bucket(const CellGrid& grid, Vector<int>& bucket) {
    bucket.resize(size());
    launch(size(), BucketOf{grid, pointer(place), pointer(bucket)});
    Vector<int> order(size());
    thrust::sequence(policy(), order.begin(), order.end());
    thrust::stable_sort_by_key(policy(), bucket.begin(), bucket.end(), order.begin());
    keep(order);
  }

  /// Rows past the first n that touch nothing: of images, until these are put in their places, and spare ones.
  void make_spare_rows(int grains_and_ghosts, int rows) {
    const auto n = static_cast<std::size_t>(grains_and_ghosts);
    make_room(n + rows);
    append(place, std::vector<Place>(rows, {{}, -1}), n);
    append(motion, std::vector<Quad>(parts * rows, {{}, 1}), parts * n);
    append(pull, std::vector<Quad>(parts * rows), parts * n);
  }

  /// Room for so many rows with those of ghosts and images, and no more: a list that grows by a few would double.
  void make_room(std::size_t rows) {
    place.reserve(rows);
    motion.reserve(parts * rows);
    pull.reserve(parts * rows);
  }

  std::size_t bytes() const {
    return bytes_of(place) + bytes_of(state) + bytes_of(motion) + bytes_of(pull) + bytes_of(listed) +
           bytes_of(material) + bytes_of(id) + bytes_of(ledger) + bytes_of(old_of_new);
  }
};

struct CopyVelocities {
  Rows<Quad> from, to;
  TRACKBED_HD void operator()(int g) const {
    to.translation(g).vector = from.translation(g).vector;
    if (to.parts == 2) to.rotation(g).vector = from.rotation(g).vector;
  }
};

struct CopyPositions {
  const Place* place;
  Vec3* listed;
  TRACKBED_HD void operator()(int g) const { listed[g] = place[g].position; }
};

}  // namespace dem::TRACKBED_DEM_SYSTEM
