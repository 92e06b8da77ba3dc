#pragma once
// Clumps: rigid bodies of spheres. Spheres are the rows that contacts see (grains.hpp); bodies own mass, inertia and
// motion. Present only when a scene has clumps; then every grain is a body, a sphere being a body of one sphere. The
// spheres of a body lie side by side.
//   F = sum F_s,  T = sum T_s + (x_s - x) x F_s;   translation: velocity Verlet as in leapfrog.hpp; rotation: kernels/
//   rotation.hpp;   x_s = x + q d_s q^-1,  v_s = v + omega x (x_s - x)
// Source: Irazabal2017 5.3 (5.17-5.21).
#include "dem/core/grains.hpp"
#include "dem/core/leapfrog.hpp"
#include "dem/kernels/rotation.hpp"

namespace dem::TRACKBED_DEM_SYSTEM {

struct Bodies {
  Vector<Place> place;       // centre of mass, reach
  Vector<Quad> state, pull;  // as of grains, two per body; .number: inverse mass, nothing
  Vector<kernels::Quaternion> orientation;
  Vector<Vec3> inertia, inertia_per_mass;  // [kg m2], [m2] principal moments
  Vector<double> volume;                   // [m3]
  Vector<int> material, shape;
  Vector<std::int64_t> id;
  Vector<int> start;         // first sphere of each body, and the end
  Vector<int> of_sphere;     // body of each sphere
  Vector<Vec3> offset;       // [m] of each sphere from its body's centre, in the body frame
  Vector<int> sphere_entry;  // spheres sorted by bucket

  int size() const { return static_cast<int>(id.size()); }
  bool any() const { return !start.empty(); }
  Rows<Quad> states() { return {pointer(state), 2}; }
  Rows<const Quad> states() const { return {pointer(state), 2}; }
  Rows<Quad> pulls() { return {pointer(pull), 2}; }

  std::size_t bytes() const {
    return bytes_of(place) + bytes_of(state) + bytes_of(pull) + bytes_of(orientation) + bytes_of(inertia) +
           bytes_of(inertia_per_mass) + bytes_of(volume) + bytes_of(material) + bytes_of(shape) + bytes_of(id) +
           bytes_of(start) + bytes_of(of_sphere) + bytes_of(offset) + bytes_of(sphere_entry);
  }

  /// New body k is the present body order[k]; bodies that are not named are gone, and so are their spheres.
  void keep(const Vector<int>& order, Grains& spheres) {
    const auto old_start = download(start), chosen = download(order);
    std::vector<int> sphere_order, new_start{0}, owner;
    for (std::size_t k = 0; k < chosen.size(); ++k) {
      for (int s = old_start[chosen[k]]; s < old_start[chosen[k] + 1]; ++s) {
        sphere_order.push_back(s);
        owner.push_back(static_cast<int>(k));
      }
      new_start.push_back(static_cast<int>(sphere_order.size()));
    }
    Vector<int> sphere_rows;
    upload(sphere_order, sphere_rows);
    Vector<GrainLedger> ledger;  // of bodies
    ledger.swap(spheres.ledger);
    spheres.keep(sphere_rows);
    reorder(ledger, order);
    ledger.swap(spheres.ledger);
    reorder(offset, sphere_rows);
    upload(owner, of_sphere);
    upload(new_start, start);
    reorder(place, order);
    reorder(state, order, 2);
    reorder(pull, order, 2);
    reorder(orientation, order);
    reorder(inertia, order);
    reorder(inertia_per_mass, order);
    reorder(volume, order);
    reorder(material, order);
    reorder(shape, order);
    reorder(id, order);
  }

  /// Bodies in the order of their centres' buckets; `bucket` and sphere_entry then hold the spheres by bucket.
  void sort_by_bucket(const CellGrid& grid, Grains& spheres, Vector<int>& bucket) {
    bucket.resize(size());
    launch(size(), BucketOf{grid, pointer(place), pointer(bucket)});
    Vector<int> order(size());
    thrust::sequence(policy(), order.begin(), order.end());
    thrust::stable_sort_by_key(policy(), bucket.begin(), bucket.end(), order.begin());
    keep(order, spheres);
    bucket.resize(spheres.size());
    launch(spheres.size(), BucketOf{grid, pointer(spheres.place), pointer(bucket)});
    sphere_entry.resize(spheres.size());
    thrust::sequence(policy(), sphere_entry.begin(), sphere_entry.end());
    thrust::stable_sort_by_key(policy(), bucket.begin(), bucket.end(), sphere_entry.begin());
  }
};

/// Puts the spheres of a body where it is and gives them its motion.
struct CarrySpheres {
  const int* start;
  const Vec3* offset;
  Place* sphere;
  Rows<Quad> motion;

  TRACKBED_HD void operator()(int b, const Vec3& centre, const kernels::Quaternion& orientation, const Vec3& velocity,
                              const Vec3& angular_velocity) const {
    for (int s = start[b]; s < start[b + 1]; ++s) {
      const Vec3 arm = to_space(orientation, offset[s]);
      sphere[s].position = centre + arm;
      motion.translation(s).vector = velocity + cross(angular_velocity, arm);
      motion.rotation(s).vector = angular_velocity;
    }
  }
};

/// Leapfrog (leapfrog.hpp) of bodies; `integrator` has the spheres' rows for walls, pulls and motion, the bodies' for
/// place and state.
template <class Forces, class Scheme>
struct LeapBodies {
  Integrator integrator;
  Rows<Quad> sphere_pull;
  Forces forces;
  CarrySpheres carry;
  kernels::Quaternion* orientation;
  const Vec3* inertia;
  const Vec3* listed;  // positions of spheres at which the list was built
  Phase phase;
  bool pulled;  // see Leapfrog

  TRACKBED_FLATTEN TRACKBED_HD double operator()(int b) const { return pass(b, phase); }
  TRACKBED_HD double pass(int b, const Phase& phase) const {
    const Vec3 centre = integrator.place[b].position;
    Quad t = integrator.state.translation(b), r = integrator.state.rotation(b);
    kernels::RigidRotation turning{orientation[b], r.vector};
    Pull p;
    if (phase.ends) {
      for (int s = carry.start[b]; s < carry.start[b + 1]; ++s) {
        const bool forces_in_pull = std::is_same_v<Forces, SummedForces> || pulled;
        Pull one;
        if (forces_in_pull) one = read(sphere_pull, s);
        forces.add(s, one);
        integrator.add_walls(s, one);
        p.force += one.force;
        p.torque += one.torque + cross(carry.sphere[s].position - centre, one.force);
        p.rolling += one.rolling;
        if (forces_in_pull) sphere_pull.translation(s) = sphere_pull.rotation(s) = {};
      }
      end_step(b, phase.ended, t, turning, p);
    } else {
      p = read(integrator.pull, b);
    }
    if (!phase.begins) {
      orientation[b] = turning.orientation;
      r.vector = turning.angular_velocity;
      integrator.state.translation(b) = t;
      integrator.state.rotation(b) = r;
      integrator.pull.translation(b).vector = p.force;
      integrator.pull.rotation(b).vector = p.torque;
      return 0;
    }
    const double dt = integrator.dt, first = integrator.kick(), last = integrator.at_end * dt;
    t.vector += first * p.force;
    const Vec3 moved = centre + dt * t.vector;
    integrator.place[b].position = moved;
    Scheme::begin_step(turning, inertia[b], (Scheme::halves ? 2 * first / dt : 1) * p.torque, dt);
    orientation[b] = turning.orientation;
    r.vector = turning.angular_velocity;
    integrator.state.translation(b) = t;
    integrator.state.rotation(b) = r;
    kernels::RigidRotation seen = turning;
    Scheme::finish_step(seen, inertia[b], (2 * integrator.at_end) * p.torque, dt);
    carry(b, moved, turning.orientation, t.vector + last * p.force, seen.angular_velocity);
    bool finite = norm2(r.vector) < 1e200;
    double squared = 0;
    for (int s = carry.start[b]; s < carry.start[b + 1]; ++s) {
      const double way = norm2(carry.sphere[s].position - listed[s]);
      finite = finite && way < 1e100;
      squared = std::fmax(squared, way);
    }
    return finite ? squared : HUGE_VAL;
  }

  TRACKBED_HD static Pull read(const Rows<Quad>& rows, int k) {
    const Quad t = rows.translation(k), r = rows.rotation(k);
    return {t.vector, r.vector, t.number};
  }

  /// As Integrator::end_step; leaves the acceleration and the torque (damping and rolling included) in `p`.
  TRACKBED_HD void end_step(int b, double ended, Quad& t, kernels::RigidRotation& r, Pull& p) const {
    const double half = integrator.at_end * ended;
    const double alpha = integrator.alpha, hold = 1 / (1 + alpha * half);
    const Vec3 free = t.number * p.force + integrator.gravity;
    t.vector = hold * (t.vector + half * free);
    p.force = free - alpha * t.vector;
    Vec3 braking;
    if (integrator.rolling && p.rolling > 0) {
      braking = kernels::bounded_rolling_torque(angular_momentum(r, inertia[b]), p.torque, p.rolling, integrator.dt);
      p.torque += braking;
    }
    if (ended > 0) Scheme::finish_step(r, inertia[b], (2 * integrator.at_end) * p.torque, ended);
    r.angular_velocity *= hold;
    if (alpha > 0) p.torque -= alpha * angular_momentum(r, inertia[b]);
    if (!integrator.ledger) return;
    GrainLedger& lost = integrator.ledger[b];
    lost.loss_rolling -= ended * dot(braking, r.angular_velocity);
    if (alpha > 0)
      lost.loss_damping += alpha * ended * (norm2(t.vector) / t.number + 2 * kernels::rotational_energy(r, inertia[b]));
  }
};

struct SumBodyKinetic {
  Rows<const Quad> state;
  const kernels::Quaternion* orientation;
  const Vec3* inertia;
  TRACKBED_HD void operator()(int b, Sums<1>& s) const {
    s.value[0] += 0.5 * norm2(state.translation(b).vector) / state.translation(b).number +
                  kernels::rotational_energy({orientation[b], state.rotation(b).vector}, inertia[b]);
  }
};

}  // namespace dem::TRACKBED_DEM_SYSTEM
