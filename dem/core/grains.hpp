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
  TRACKBED_HD void operator()(int k) const { to[k] = from[order[k]]; }
};

template <class T>
void reorder(Vector<T>& v, const Vector<int>& order) {
  if (v.empty()) return;
  Vector<T> sorted(order.size());
  launch(static_cast<int>(order.size()), Gather<T>{pointer(v), pointer(order), pointer(sorted)});
  v.swap(sorted);
}

template <class T>
void append(Vector<T>& v, const std::vector<T>& host) {
  const std::size_t before = v.size();
  v.resize(before + host.size());
  thrust::copy(host.begin(), host.end(), v.begin() + before);
}

struct SetMass {
  const Place* place;
  const int* material;
  const double* density;  // of the materials
  Translation* translation;
  Rotation* rotation;
  TRACKBED_HD void operator()(int g) const {
    const double r = place[g].radius;
    const double mass = density[material[g]] * (4.0 / 3.0) * std::numbers::pi * r * r * r;
    translation[g].mass = mass;
    translation[g].inverse_mass = 1 / mass;
    if (!rotation) return;
    rotation[g].inertia = 0.4 * mass * r * r;
    rotation[g].inverse_inertia = 1 / rotation[g].inertia;
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

struct Grains {
  bool rotations = true;
  Vector<Place> place;
  Vector<Translation> translation;
  Vector<Rotation> rotation;  // empty without rotations
  Vector<Vec3> listed;        // positions at the last list build
  Vector<int> material;
  Vector<std::int64_t> id;
  Vector<GrainLedger> ledger;  // empty while nothing needs it
  Vector<int> old_of_new;      // index under the numbering of the present contact lists, -1: not in them

  int size() const { return static_cast<int>(place.size()); }

  void add(std::span<const Grain> grains) {
    std::vector<Place> places;
    std::vector<Translation> translations;
    std::vector<Rotation> rotations_now;
    std::vector<int> materials;
    std::vector<std::int64_t> ids;
    for (const Grain& g : grains) {
      places.push_back({g.position, g.radius});
      translations.push_back({.velocity = g.velocity});
      rotations_now.push_back({.velocity = g.angular_velocity});
      materials.push_back(g.material);
      ids.push_back(g.id);
    }
    append(place, places);
    append(translation, translations);
    if (rotations) append(rotation, rotations_now);
    append(material, materials);
    append(id, ids);
    if (!ledger.empty()) ledger.resize(place.size());
    append(old_of_new, std::vector<int>(grains.size(), -1));
  }

  /// New grain k is the present grain order[k]; grains that are not named are gone.
  void keep(const Vector<int>& order) {
    reorder(place, order);
    reorder(translation, order);
    reorder(rotation, order);
    reorder(material, order);
    reorder(id, order);
    reorder(ledger, order);
    reorder(old_of_new, order);
  }

  void sort_by_bucket(const CellGrid& grid, Vector<int>& bucket) {
    bucket.resize(place.size());
    launch(size(), BucketOf{grid, pointer(place), pointer(bucket)});
    Vector<int> order(place.size());
    thrust::sequence(policy(), order.begin(), order.end());
    thrust::stable_sort_by_key(policy(), bucket.begin(), bucket.end(), order.begin());
    keep(order);
  }

  std::size_t bytes() const {
    return bytes_of(place) + bytes_of(translation) + bytes_of(rotation) + bytes_of(listed) + bytes_of(material) +
           bytes_of(id) + bytes_of(ledger) + bytes_of(old_of_new);
  }
};

struct CopyPositions {
  const Place* place;
  Vec3* listed;
  TRACKBED_HD void operator()(int g) const { listed[g] = place[g].position; }
};

}  // namespace dem::TRACKBED_DEM_SYSTEM
