#pragma once
// The simulation's side of clumps: making bodies, their masses, their step, and their host copies.
#include <unordered_map>

#include "dem/core/system.hpp"

namespace dem::TRACKBED_DEM_SYSTEM {

inline int System::add_shape(const Clump& shape) {
  base::require_user(shape.reach > 0 && shape.volume > 0, "dem: a clump's shape needs spheres");
  shapes_.push_back(shape);
  return static_cast<int>(shapes_.size()) - 1;
}

/// From now on every grain is a body.
inline void System::make_bodies() {
  base::require_user(setup_.rotations, "dem: clumps need rotations");
  const auto present = grains();
  Vector<int> none;
  grains_.keep(none);
  grains_.own_state = false;
  release(grains_.state);
  upload(std::vector<int>{0}, bodies_.start);
  if (!present.empty()) add_bodies(present);
}

inline void System::add_bodies(std::span<const Grain> grains) {
  std::vector<Grain> spheres;
  std::vector<Place> places;
  std::vector<Quad> states;
  std::vector<kernels::Quaternion> orientations;
  std::vector<Vec3> offsets, inertias;
  std::vector<double> volumes;
  std::vector<int> materials, shapes, starts, owners;
  std::vector<std::int64_t> ids;
  const int first_sphere = grains_.size();
  const std::size_t before = bodies_.size();
  int body = static_cast<int>(before);
  for (const Grain& g : grains) {
    const Sphere alone{{}, g.radius};
    const Clump* shape = g.shape < 0 ? nullptr : &shapes_[g.shape];
    const double scale = shape ? g.radius / shape->reach : 1;
    const double ball = 4.0 / 3.0 * std::numbers::pi * g.radius * g.radius * g.radius;
    const double two_fifths = 0.4 * g.radius * g.radius;
    for (const Sphere& s : shape ? std::span<const Sphere>(shape->spheres) : std::span<const Sphere>(&alone, 1)) {
      offsets.push_back(shape ? scale * s.position : s.position);
      Grain sphere = g;
      sphere.radius = shape ? scale * s.radius : s.radius;
      spheres.push_back(sphere);
      owners.push_back(body);
    }
    places.push_back({g.position, g.radius});
    states.push_back({g.velocity, 0});
    states.push_back({g.angular_velocity, 0});
    orientations.push_back(kernels::normalised(g.orientation));
    inertias.push_back(shape ? scale * scale * shape->inertia : Vec3{two_fifths, two_fifths, two_fifths});
    volumes.push_back(shape ? scale * scale * scale * shape->volume : ball);
    materials.push_back(g.material);
    shapes.push_back(g.shape);
    ids.push_back(g.id);
    starts.push_back(first_sphere + static_cast<int>(spheres.size()));
    ++body;
  }
  grains_.add(spheres);
  append(bodies_.place, places);
  append(bodies_.state, states);
  append(bodies_.pull, std::vector<Quad>(states.size()));
  append(bodies_.orientation, orientations);
  append(bodies_.inertia, inertias);  // over mass, until set_body_masses()
  append(bodies_.inertia_per_mass, inertias);
  append(bodies_.volume, volumes);
  append(bodies_.material, materials);
  append(bodies_.shape, shapes);
  append(bodies_.id, ids);
  append(bodies_.start, starts);
  append(bodies_.of_sphere, owners);
  append(bodies_.offset, offsets);
  if (!grains_.ledger.empty()) grains_.ledger.resize(ids.size() + before);
  set_body_masses();
  carry_spheres();
}

struct SetBodyMass {
  const double* volume;
  const Vec3* inertia_per_mass;
  const int* material;
  const double* density;  // of the materials
  const int* start;
  Rows<Quad> state, motion;  // of bodies, of spheres
  Vec3* inertia;
  TRACKBED_HD void operator()(int b) const {
    const double mass = density[material[b]] * volume[b];
    state.translation(b).number = 1 / mass;
    inertia[b] = mass * inertia_per_mass[b];
    for (int s = start[b]; s < start[b + 1]; ++s) motion.translation(s).number = mass;
  }
};

inline void System::set_body_masses() {
  launch(bodies_.size(), SetBodyMass{pointer(bodies_.volume), pointer(bodies_.inertia_per_mass),
                                     pointer(bodies_.material), pointer(density_), pointer(bodies_.start),
                                     bodies_.states(), grains_.motions(), pointer(bodies_.inertia)});
}

struct PlaceSpheres {
  CarrySpheres carry;
  const Place* place;
  const kernels::Quaternion* orientation;
  Rows<const Quad> state;
  TRACKBED_HD void operator()(int b) const {
    carry(b, place[b].position, orientation[b], state.translation(b).vector, state.rotation(b).vector);
  }
};

inline void System::carry_spheres() {
  const CarrySpheres carry{pointer(bodies_.start), pointer(bodies_.offset), pointer(grains_.place), grains_.motions()};
  launch(bodies_.size(),
         PlaceSpheres{carry, pointer(bodies_.place), pointer(bodies_.orientation), std::as_const(bodies_).states()});
}

inline void System::set_bodies(std::span<const Grain> changed) {
  std::unordered_map<std::int64_t, const Grain*> by_id;
  for (const Grain& g : changed) by_id[g.id] = &g;
  const auto ids = download(bodies_.id);
  auto place = download(bodies_.place);
  auto state = download(bodies_.state);
  auto orientation = download(bodies_.orientation);
  const Rows<Quad> rows{state.data(), 2};
  for (int b = 0; b < bodies_.size(); ++b) {
    const auto found = by_id.find(ids[b]);
    if (found == by_id.end()) continue;
    const Grain& g = *found->second;
    place[b].position = g.position;
    rows.translation(b).vector = g.velocity;
    rows.rotation(b).vector = g.angular_velocity;
    orientation[b] = kernels::normalised(g.orientation);
  }
  upload(place, bodies_.place);
  upload(state, bodies_.state);
  upload(orientation, bodies_.orientation);
  carry_spheres();
}

/// Calls visit(number of bodies, pass of the integrator over them).
template <class Forces, class Visit>
void System::with_body_leap(const Integrator& spheres, const Forces& forces, const Visit& visit) {
  Integrator integrator = spheres;
  integrator.place = pointer(bodies_.place);
  integrator.state = bodies_.states();
  integrator.pull = bodies_.pulls();
  const CarrySpheres carry{pointer(bodies_.start), pointer(bodies_.offset), pointer(grains_.place), grains_.motions()};
  kernels::with_rotation_scheme(setup_.rotation_scheme, [&](auto scheme) {
    visit(bodies_.size(), LeapBodies<Forces, decltype(scheme)>{integrator,
                                                               grains_.pulls(),
                                                               forces,
                                                               carry,
                                                               pointer(bodies_.orientation),
                                                               pointer(bodies_.inertia),
                                                               pointer(grains_.listed),
                                                               {},
                                                               bonds_.any()});
  });
}

}  // namespace dem::TRACKBED_DEM_SYSTEM
