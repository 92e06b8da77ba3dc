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

/// Contacts one grain can have with facets at one instant, before the hierarchy thins them out.
constexpr int maximum_wall_contacts = 32;

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

template <class Law>
struct WallPass {
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
  double* history;  // history_stride numbers per candidate
  int history_stride;
  bool couples;  // some rolling model acts in the contact
  WallSum* sum;
  Vec3* impulse;        // [N s] received by the grain, since the last flush
  NodalImpulse* nodal;  // null: no mesh is coupled
  int nodal_rows;       // per candidate
  WallLedger* ledger;   // null: not tracked
  Passed* passed;       // null: not tracked, or no mesh is coupled
  int* unstable;        // two: overlap, number of contacts
  double maximum_overlap;
  kernels::Interval time;
  double dt;  // [s] of the step that ends now; 0: forces at the start

  struct Found {
    int number = 0;
    int candidate[maximum_wall_contacts];
    Vec3 vector[maximum_wall_contacts];
    double weights[maximum_wall_contacts][4];
    bool keep[maximum_wall_contacts];
  };

  TRACKBED_HD void operator()(int w) const {
    const int g = grain[w];
    if (start[w + 1] - start[w] == 1) {
      WallSum total;
      only_one(start[w], g, total);
      sum[w] = total;
      return;
    }
    Found found;
    find(w, g, found);
    for (int m = 0; m < found.number; ++m)
      if (found.keep[m] && !has_history(found.candidate[m])) inherit(w, m, found);
    WallSum total;
    int m = 0;
    for (int c = start[w]; c < start[w + 1]; ++c) {
      while (m < found.number && found.candidate[m] < c) ++m;
      if (m < found.number && found.candidate[m] == c && found.keep[m])
        press(c, g, found.vector[m], found.weights[m], total);
      else if (state[c].overlap > 0)
        leave(c, g);
    }
    sum[w] = total;
  }

  /// Most grains near a wall have one candidate: no hierarchy, nothing to inherit.
  TRACKBED_FLATTEN TRACKBED_HD void only_one(int c, int g, WallSum& total) const {
    const Place p = place[g];
    const auto contact = geometry.nearest(candidate[c], p.position, p.radius);
    if (contact.feature != kernels::Feature::none)
      press(c, g, p.position - contact.point, contact.weights, total);
    else if (state[c].overlap > 0)
      leave(c, g);
  }

  TRACKBED_HD bool has_history(int c) const {
    for (int k = 0; k < history_stride; ++k)
      if (history[c * history_stride + k] != 0) return true;
    return false;
  }

  TRACKBED_HD void find(int w, int g, Found& found) const {
    const Place p = place[g];
    for (int c = start[w]; c < start[w + 1]; ++c) {
      const auto contact = geometry.nearest(candidate[c], p.position, p.radius);
      if (contact.feature == kernels::Feature::none) continue;
      if (found.number == maximum_wall_contacts) {
        unstable[1] = too_many_wall_contacts;
        break;
      }
      if (geometry.part && known(candidate[c], p.position - contact.point, found)) continue;
      found.candidate[found.number] = c;
      found.vector[found.number] = p.position - contact.point;
      for (int k = 0; k < 4; ++k) found.weights[found.number][k] = contact.weights[k];
      ++found.number;
    }
    kernels::distance_hierarchy(found.vector, found.number, found.keep);
    if (geometry.part) drop_common_sides(found);
  }

  /// True when another part of the same face has led to this point.
  TRACKBED_HD bool known(int f, const Vec3& vector, const Found& found) const {
    const int on = geometry.part[f].face;
    for (int m = 0; m < found.number && on >= 0; ++m)
      if (geometry.part[candidate[found.candidate[m]]].face == on &&
          norm2(found.vector[m] - vector) <= 1e-12 * norm2(vector))
        return true;
    return false;
  }

  /// A point on the side of a face is no contact where the face beyond the side has a nearer one.
  TRACKBED_HD void drop_common_sides(Found& found) const {
    for (int m = 0; m < found.number; ++m) {
      const FacePart& part = geometry.part[candidate[found.candidate[m]]];
      if (part.face < 0 || found.weights[m][2] < 0) continue;
      const Face& face = geometry.face[part.face];
      const int from = face.node[static_cast<int>(found.weights[m][2])];
      const int to = face.node[static_cast<int>(found.weights[m][3])];
      for (int n = 0; n < found.number && found.keep[m]; ++n) {
        const int other = geometry.part[candidate[found.candidate[n]]].face;
        if (other < 0 || other == part.face || norm2(found.vector[n]) >= norm2(found.vector[m])) continue;
        bool has_from = false, has_to = false;
        for (const int node : geometry.face[other].node) {
          has_from = has_from || node == from;
          has_to = has_to || node == to;
        }
        if (has_from && has_to) found.keep[m] = false;
      }
    }
  }

  /// Contact m is new: the history of a contact with the same wall that has just ended becomes its own.
  TRACKBED_HD void inherit(int w, int m, const Found& found) const {
    const int heir = found.candidate[m];
    const double length = norm(found.vector[m]);
    if (!(length > 0)) return;
    const Vec3 normal = (1 / length) * found.vector[m];
    int donor = -1;
    double best = 0.5;
    for (int c = start[w]; c < start[w + 1]; ++c) {
      const WallState& s = state[c];
      if (!(s.overlap > 0) || geometry.facet[candidate[c]].wall != geometry.facet[candidate[heir]].wall) continue;
      bool kept = false;
      for (int k = 0; k < found.number; ++k) kept = kept || (found.keep[k] && found.candidate[k] == c);
      const double alike = dot(s.normal, normal);
      if (kept || alike <= best || !has_history(c)) continue;
      best = alike;
      donor = c;
    }
    if (donor < 0) return;
    for (int k = 0; k < history_stride; ++k) {
      history[heir * history_stride + k] = history[donor * history_stride + k];
      history[donor * history_stride + k] = 0;
    }
  }

  TRACKBED_ONE_FUNCTION TRACKBED_HD void press(int c, int g, const Vec3& vector, const double* weights,
                                               WallSum& total) const {
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
    double local[maximum_numbers] = {};
    for (int k = 0; k < history_stride; ++k) local[k] = history[c * history_stride + k];
    const auto contact = ledger ? Law::template press<true>(material, touch, time, local)
                                : Law::template press<false>(material, touch, time, local);
    kernels::Moment<double> turned;
    if (couples) {
      double* numbers = local + history_stride - rolling_numbers(ledger != nullptr);
      const double k_t = shear_stiffness_of(material, local), f_n = contact.normal_force;
      turned = ledger ? resist_rolling<true>(material, meeting, f_n, k_t, time, numbers)
                      : resist_rolling<false>(material, meeting, f_n, k_t, time, numbers);
    }
    for (int k = 0; k < history_stride; ++k) history[c * history_stride + k] = local[k];
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
    if (ledger) {
      WallLedger& l = ledger[c];
      l.loss_friction += contact.loss_friction;
      l.loss_damping += contact.loss_damping;
      l.elastic_normal = contact.elastic_normal;
      l.elastic_shear = contact.elastic_shear + turned.elastic;
      l.loss_rolling += turned.loss;
      l.work += 0.5 * (work + dot(contact.force, wall_step));
    }
  }

  TRACKBED_ONE_FUNCTION TRACKBED_HD void leave(int c, int g) const {
    WallState& s = state[c];
    if (ledger) {
      WallLedger& l = ledger[c];
      double local[maximum_numbers] = {};
      for (int k = 0; k < history_stride; ++k) local[k] = history[c * history_stride + k];
      const int wall_material = geometry.wall[geometry.facet[candidate[c]].wall].material;
      const auto& material = parameters[grain_material[g] * materials + wall_material];
      l.loss_friction += Law::template press<true>(material, {}, time, local).loss_friction;
      if (couples) l.loss_rolling += local[history_stride - 1];
      l.elastic_normal = 0;
      l.elastic_shear = 0;
      if (geometry.wall[geometry.facet[candidate[c]].wall].moves && dt > 0) {
        const Carriers before(geometry, candidate[c], s.weights);
        for (int k = 0; k < before.number && before.node[k] >= 0; ++k)
          l.work += 0.5 * before.share[k] * dot(s.force, node_displacement[before.node[k]]);
      }
    }
    s = {};
    for (int k = 0; k < history_stride; ++k) history[c * history_stride + k] = 0;
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
