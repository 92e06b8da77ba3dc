#pragma once
// What the backend stores. Grains are rows (a contact reads whole rows of two grains that lie anywhere); contacts are
// columns of rows read in order. Alignment keeps a row within one cache line. Kernels copy rows as a whole: a GPU then
// moves 16 bytes at a time; by references to their parts, whose alignment is less, it would move 8.
#include <cstdint>

#include "dem/core/backend.hpp"
#include "dem/kernels/pair_parameters.hpp"

namespace dem::TRACKBED_DEM_SYSTEM {

// ---- grains
struct alignas(32) Place {
  Vec3 position{};    // [m]
  double radius = 0;  // [m]
};
/// A vector with a number beside it. Where grains turn, two of them make the row of one grain (Rows<>): first for
/// translation, then for rotation; otherwise the first alone.
struct alignas(32) Quad {
  Vec3 vector{};
  double number = 0;
};
template <class Row>
struct Rows {
  Row* row = nullptr;
  int parts = 1;
  TRACKBED_HD Row& translation(int g) const { return row[parts * g]; }
  TRACKBED_HD Row& rotation(int g) const { return row[2 * g + 1]; }
};
/// The same vector in other numbers.
template <class To, class From>
TRACKBED_HD inline Vector3<To> as(const Vector3<From>& v) {
  return {static_cast<To>(v.x), static_cast<To>(v.y), static_cast<To>(v.z)};
}
struct GrainLedger {
  double loss_rolling = 0;  // [J]
  double loss_damping = 0;  // [J]
};

/// Why a pass gives up; 0: it does not.
enum Trouble : int { overlap_too_large = 1 };

// ---- pairs of grains
/// Force on i; j gets the opposite. Each grain's arm is -(radius - half_overlap) normal: both forces act at one point,
/// so linear and angular momentum of the pair are kept to rounding. Real: what the law is computed in.
template <class Real>
struct alignas(8 * sizeof(Real)) PairForce {
  Vector3<Real> force{};   // [N]
  Real rolling = 0;        // [N m] resistance limit e_c |F_n|
  Vector3<Real> moment{};  // [N] normal × force
  Real half_overlap = 0;   // [m] 0: no contact
};
/// What `pairs_per_ledger` pairs that follow each other have noted down together.
struct ContactLedger {
  double loss_friction = 0, loss_damping = 0;    // [J] since the last flush
  double elastic_normal = 0, elastic_shear = 0;  // [J] stored now
  double loss_rolling = 0;                       // [J] since the last flush
};

// ---- walls: planes are facets with one node, the plane's point
struct Facet {
  int node[4] = {-1, -1, -1, -1};  // node[3] = -1: triangle; node[1] = -1: plane
  int wall = 0;
  int live = 1;
};
/// A face of the second order (base/face.hpp); node[6] = -1: triangle.
struct Face {
  int node[8] = {-1, -1, -1, -1, -1, -1, -1, -1};
  TRACKBED_HD int nodes() const { return node[6] < 0 ? 6 : 8; }
};
/// What a facet is of such a face; beside the facets, only where a mesh has such faces.
struct FacePart {
  int face = -1;                     // -1: of none
  int corner[4] = {-1, -1, -1, -1};  // the facet's nodes, by their numbers in the face
};
struct WallRow {
  Vec3 plane_normal{};
  int material = 0;
  int two_sided = 0;
  int moves = 0;      // its nodes have velocities and displacements
  int interface = 0;  // its work counts as interface work
  int body = 0;       // it is part of the system: its work on grains is internal
  int nodal = 0;      // nodal impulses are kept
};
/// State of one (grain, facet) candidate; all zero while it carries no force. Its law's history lies beside it.
struct WallState {
  Vec3 force{};            // [N] on the grain
  double overlap = 0;      // [m]
  Vec3 normal{};           // towards the grain
  double weights[4] = {};  // of the facet's nodes; of a part of a face as in WallGeometry::nearest()
};
/// A row of eight numbers (dem/leap.hpp).
struct alignas(32) WallSum {
  Vec3 force{};        // [N]
  double rolling = 0;  // [N m]
  Vec3 torque{};       // [N m]
};
/// Sums since the last flush; where a mesh has faces of the second order a candidate has two such rows.
struct NodalImpulse {
  Vec3 node[4];  // [N s] to the nodes of the facet, or of the face that it is a part of
};

}  // namespace dem::TRACKBED_DEM_SYSTEM
