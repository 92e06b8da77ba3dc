#pragma once
// Forces between grains and walls: one call per grain that has walls near it. A plane and a facet are treated alike, so
// a planar wall and the same wall as a mesh give the same forces (Double Hierarchy, Irazabal2017 ch. 4: see
// kernels/wall_geometry.hpp). Arm of the force: from the grain's centre to the contact point on the wall.
// Facets that are parts of one face of the second order (core/wall_facets.hpp) lead to the same point, which counts
// once, with the first of them.
//
// Tangential history lives with the (grain, facet) candidate. A grain that slides or rolls from one facet to the next
// hands it on: a new contact takes the history of a contact with the same wall that ended in this step, if the normals
// differ by less than 60 degrees.
#include "dem/core/contact_pass.hpp"
#include "dem/core/wall_facets.hpp"

namespace dem::TRACKBED_DEM_SYSTEM {

struct WallLedger {
  double loss_friction = 0, loss_damping = 0;    // [J] since the last flush
  double elastic_normal = 0, elastic_shear = 0;  // [J] stored now
  double work = 0;                               // [J] of the moving wall on the grain, since the last flush
  double loss_rolling = 0;                       // [J] since the last flush
};

/// What a grain has received from a coupled mesh since the last flush, for the ledger.
struct Passed {
  Vec3 impulse, angular;  // [N s], [N m s] about the origin
};

/// Where a grain has met a facet in this step, before and after the hierarchy. Such rows lie beside the candidates: of
/// a grain's own memory on a GPU there would have to be enough for every thread that could be at work.
struct WallFound {
  enum Is : int { nothing, hidden, touching };
  Vec3 vector{};           // [m] from the point to the grain's centre
  double weights[4] = {};  // as of WallState
  int is = nothing;
};

/// Ledger: energies are tracked; Couples: some rolling model acts in the contact.
template <class Law, bool Ledger, bool Couples>
struct WallPass {
  using ContactLaw = Law;
  static constexpr int numbers = history_layout(Law::history, Ledger, Couples ? rolling_c : no_rolling).total;

  WallGeometry geometry;
  const Vec3 *node_velocity, *node_displacement;  // null: nothing moves
  const Place* place;
  Rows<const Quad> motion;  // velocities of this instant and masses
  const int* grain_material;
  const kernels::PairParameters* parameters;  // grain material × wall material
  int materials;
  const int *grain, *start;  // grains with candidates, and their ranges
  const int* candidate;      // facets
  WallState* state;
  WallFound* found;  // of this step
  double* history;   // `numbers` per candidate
  WallSum* sum;
  Vec3* impulse;        // [N s] received by the grain, since the last flush
  NodalImpulse* nodal;  // null: no mesh is coupled
  int nodal_rows;       // per candidate
  WallLedger* ledger;
  Passed* passed;  // null: not tracked, or no mesh is coupled
  int* unstable;
  double maximum_overlap;
  kernels::Interval time;
  double dt;  // [s] of the step that ends now; 0: forces at the start

  TRACKBED_FLATTEN TRACKBED_HD void operator()(int w) const {
    const int g = grain[w], first = start[w], last = start[w + 1];
    find(first, last, place[g]);
    if (last - first > 1) {  // most grains near a wall have one candidate: nothing to hide, nothing to inherit
      hide(first, last);
      for (int c = first; c < last; ++c)
        if (found[c].is == WallFound::touching && !has_history(c)) inherit(first, last, c);
    }
    WallSum total;
    for (int c = first; c < last; ++c) {
      if (found[c].is == WallFound::touching)
        press(c, g, found[c].vector, found[c].weights, total);
      else if (state[c].overlap > 0)
        leave(c, g);
    }
    sum[w] = total;
  }

  TRACKBED_HD bool has_history(int c) const {
    const double* const own = history + static_cast<std::size_t>(c) * numbers;
    for (int k = 0; k < numbers; ++k)
      if (own[k] != 0) return true;
    return false;
  }

  TRACKBED_HD void find(int first, int last, const Place& p) const {
    for (int c = first; c < last; ++c) {
      WallFound& here = found[c];
      here.is = WallFound::nothing;
      const auto contact = geometry.nearest(candidate[c], p.position, p.radius);
      if (contact.feature == kernels::Feature::none) continue;
      here.vector = p.position - contact.point;
      if (geometry.part && known(first, c)) continue;
      for (int k = 0; k < 4; ++k) here.weights[k] = contact.weights[k];
      here.is = WallFound::touching;
    }
  }

  /// True when another part of the same face has led to the point of candidate c.
  TRACKBED_HD bool known(int first, int c) const {
    const int on = geometry.part[candidate[c]].face;
    const Vec3 vector = found[c].vector;
    for (int other = first; other < c && on >= 0; ++other)
      if (found[other].is && geometry.part[candidate[other]].face == on &&
          norm2(found[other].vector - vector) <= 1e-12 * norm2(vector))
        return true;
    return false;
  }

  /// The distance hierarchy, and what faces of the second order add to it.
  TRACKBED_HD void hide(int first, int last) const {
    for (int c = first; c < last; ++c) {
      if (!found[c].is) continue;
      bool hidden = false;
      for (int other = first; other < last && !hidden; ++other)
        hidden = found[other].is && kernels::is_hidden(found[c].vector, found[other].vector, other < c);
      if (hidden || (geometry.part && is_on_common_side(first, last, c))) found[c].is = WallFound::hidden;
    }
  }

  /// A point on the side of a face is no contact where the face beyond the side has a nearer one.
  TRACKBED_HD bool is_on_common_side(int first, int last, int c) const {
    const FacePart& part = geometry.part[candidate[c]];
    if (part.face < 0 || found[c].weights[2] < 0) return false;
    const Face& face = geometry.face[part.face];
    const int from = face.node[static_cast<int>(found[c].weights[2])];
    const int to = face.node[static_cast<int>(found[c].weights[3])];
    for (int n = first; n < last; ++n) {
      if (!found[n].is) continue;
      const int other = geometry.part[candidate[n]].face;
      if (other < 0 || other == part.face || norm2(found[n].vector) >= norm2(found[c].vector)) continue;
      bool has_from = false, has_to = false;
      for (const int node : geometry.face[other].node) {
        has_from = has_from || node == from;
        has_to = has_to || node == to;
      }
      if (has_from && has_to) return true;
    }
    return false;
  }

  /// The contact of candidate `heir` is new: the history of a contact with the same wall that has just ended becomes
  /// its own.
  TRACKBED_HD void inherit(int first, int last, int heir) const {
    const double length = norm(found[heir].vector);
    if (!(length > 0)) return;
    const Vec3 normal = (1 / length) * found[heir].vector;
    int donor = -1;
    double best = 0.5;
    for (int c = first; c < last; ++c) {
      const WallState& s = state[c];
      if (!(s.overlap > 0) || geometry.facet[candidate[c]].wall != geometry.facet[candidate[heir]].wall) continue;
      const double alike = dot(s.normal, normal);
      if (found[c].is == WallFound::touching || alike <= best || !has_history(c)) continue;
      best = alike;
      donor = c;
    }
    if (donor < 0) return;
    Kept<double, numbers>(history, donor).write(history, heir);
    Kept<double, numbers>().write(history, donor);
  }

  TRACKBED_HD void press(int c, int g, const Vec3& vector, const double* weights, WallSum& total) const {
    const Place p = place[g];
    const Facet& facet = geometry.facet[candidate[c]];
    const WallRow& wall = geometry.wall[facet.wall];
    const Carriers carriers(geometry, candidate[c], weights);
    const double length = norm(vector);
    // A plane is also touched from behind: there the vector points backwards and the overlap exceeds the radius.
    const bool plane = facet.node[1] < 0;
    const double side = plane && dot(vector, wall.plane_normal) < 0 ? -1 : 1;
    const double overlap = p.radius - side * length;
    if (overlap > maximum_overlap * p.radius) *unstable = overlap_too_large;
    Vec3 normal = plane ? wall.plane_normal : Vec3{0, 0, 1};
    if (length > 0) normal = (side / length) * vector;

    Meeting<double> meeting;
    kernels::Touch<double>& touch = meeting.touch;
    touch.overlap = overlap;
    touch.effective_radius = p.radius;
    touch.effective_mass = motion.translation(g).number;
    touch.normal = normal;
    touch.velocity = motion.translation(g).vector;
    if (motion.parts == 2) {
      meeting.turning = motion.rotation(g).vector;
      meeting.rolling_inertia = kernels::rolling_inertia(touch.effective_mass, p.radius, 0.0, 0.0);
      touch.velocity -= cross(meeting.turning, vector);
    }
    WallState& s = state[c];
    Vec3 wall_step;   // displacement of the contact point's material with the wall
    double work = 0;  // of the wall on the grain, with the force before
    if (wall.moves) {
      const Carriers before(geometry, candidate[c], s.weights);
      for (int k = 0; k < carriers.number && carriers.node[k] >= 0; ++k) {
        const int node = carriers.node[k];
        const Vec3 step = dt > 0 ? node_displacement[node] : Vec3{};
        touch.velocity -= carriers.share[k] * node_velocity[node];
        wall_step += carriers.share[k] * step;
        work += before.share[k] * dot(s.force, step);
      }
    }

    const auto& material = parameters[grain_material[g] * materials + wall.material];
    Kept<double, numbers> kept(history, c);
    const auto contact = Law::template press<Ledger>(material, touch, time, kept.number);
    kernels::Moment<double> turned;
    if constexpr (Couples) {
      const double k_t = shear_stiffness_after<Law>(material, kept);
      turned = resist_rolling<Ledger>(material, meeting, contact.normal_force, k_t, time,
                                      kept.number + numbers - rolling_numbers(Ledger));
    }
    kept.write(history, c);
    s.force = contact.force;
    s.overlap = overlap;
    s.normal = normal;
    for (int k = 0; k < 4; ++k) s.weights[k] = weights[k];
    total.force += contact.force;
    total.torque += turned.moment - cross(vector, contact.force);
    if (material.rolling == rolling_brof) total.rolling += material.rolling_friction * p.radius * contact.normal_force;

    impulse[c] += dt * contact.force;
    if (nodal && wall.nodal)
      for (int k = 0; k < carriers.number; ++k)
        nodal[nodal_rows * c + k / 4].node[k % 4] -= (carriers.share[k] * dt) * contact.force;
    if (passed && wall.interface) {
      passed[c].impulse += dt * contact.force;
      passed[c].angular += dt * cross(p.position - vector, contact.force);
    }
    if constexpr (Ledger) {
      WallLedger& l = ledger[c];
      l.loss_friction += contact.loss_friction;
      l.loss_damping += contact.loss_damping;
      l.elastic_normal = contact.elastic_normal;
      l.elastic_shear = contact.elastic_shear + turned.elastic;
      l.loss_rolling += turned.loss;
      l.work += 0.5 * (work + dot(contact.force, wall_step));
    }
  }

  TRACKBED_HD void leave(int c, int g) const {
    WallState& s = state[c];
    if constexpr (Ledger) {
      WallLedger& l = ledger[c];
      Kept<double, numbers> kept(history, c);
      const WallRow& wall = geometry.wall[geometry.facet[candidate[c]].wall];
      const auto& material = parameters[grain_material[g] * materials + wall.material];
      l.loss_friction += Law::template press<true>(material, {}, time, kept.number).loss_friction;
      if constexpr (Couples) l.loss_rolling += kept.number[numbers - 1];
      l.elastic_normal = 0;
      l.elastic_shear = 0;
      if (wall.moves && dt > 0) {
        const Carriers before(geometry, candidate[c], s.weights);
        for (int k = 0; k < before.number && before.node[k] >= 0; ++k)
          l.work += 0.5 * before.share[k] * dot(s.force, node_displacement[before.node[k]]);
      }
    }
    s = {};
    Kept<double, numbers>().write(history, c);
  }
};

/// Sums, per node, what the candidates' facets received.
struct GatherNodes {
  const int *start, *entry;  // node -> 4 row + corner
  const NodalImpulse* nodal;
  Vec3* impulse;
  TRACKBED_HD void operator()(int node) const {
    Vec3 total;
    for (int k = start[node]; k < start[node + 1]; ++k) total += nodal[entry[k] / 4].node[entry[k] % 4];
    impulse[node] += total;
  }
};
/// The same on top of what has been flushed, which stays.
struct SumNodes {
  const Vec3* flushed;
  GatherNodes gather;  // .start null: no candidates
  TRACKBED_HD void operator()(int node) const {
    gather.impulse[node] = flushed[node];
    if (gather.start) gather(node);
  }
};

}  // namespace dem::TRACKBED_DEM_SYSTEM
