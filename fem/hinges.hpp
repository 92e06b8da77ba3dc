#pragma once
// Hinges inside a body: cells that share a face move as one rigid part where nothing strains; parts that meet in an
// edge or a node only can turn against each other there without force. A static system with such a motion is singular,
// a vibration has it at 0 Hz. The linear test of a mechanism (Pellegrino & Calladine 1986, int. J. Solids Struct. 22,
// doi:10.1016/0020-7683(86)90014-4), with the six motions of rigid_motions.hpp for every part:
//   u_p(x) = u_q(x) at every corner that the parts p, q share, and at nodes that share their unknowns (periodic.hpp);
//   u_p(x) = 0 along every component held there.
// Its null space holds the motions of the whole, which rigid_motions.hpp finds, and those of parts against each other.
// Corners alone join parts: an edge is a hinge, however its middle node lies. Parts with three shared corners off one
// line are one. Where more than `most_parts` are left in a connected mesh, only motions of a single part are found.
#include <array>
#include <string>
#include <vector>

#include "fem/mesh.hpp"

namespace fem {

constexpr int most_parts = 150;  // six unknowns each, in a dense matrix

struct Hinge {
  Vec3 from, to;           // [m] ends of the edge; alike: a node
  std::vector<Vec3> axes;  // unit vectors, independent: what the parts can turn about
  struct Side {
    int cells = 0;
    Vec3 centre;  // [m] of its box
  };
  Side first, second;
  bool is_edge() const { return base::norm(to - from) > 0; }
};

struct Hinges {
  int motions = 0;            // independent ones, beyond those of the whole mesh; at least so many with many parts
  std::vector<Hinge> joints;  // that turn; none where parts only slide against each other across a periodic seam
};

/// `held`: per node, the components that supports hold.
Hinges find_hinges(const Mesh&, const std::vector<std::array<bool, 3>>& held);

/// "its 1 cell round (…) m and 2 cells round (…) m share no more than the edge from (…) to (…) m and turn against each
/// other about the axis (0, 1, 0)"; empty where there are none.
std::string describe(const Hinges&);

}  // namespace fem
