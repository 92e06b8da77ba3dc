#pragma once
// What gmsh makes of a .geo or .msh file, as it is: cells, and the physical groups by name. Runs on one rank only.
#include <array>
#include <map>
#include <string>
#include <vector>

#include "base/vec3.hpp"
#include "fem/fem.hpp"

namespace fem {

/// Node numbers: corners, [3] = -1 for a triangle; then the middles of 0-1, 1-2, …, -1 where there are none.
using Facet = std::array<int, 8>;
constexpr Facet no_facet{-1, -1, -1, -1, -1, -1, -1, -1};
inline int corners_of(const Facet& facet) { return facet[3] < 0 ? 3 : 4; }
inline bool has_middles(const Facet& facet) { return facet[4] >= 0; }

/// Corners of a cell with so many nodes.
constexpr int cell_corners(int nodes) { return nodes == 4 || nodes == 10 ? 4 : 8; }

struct RawMesh {
  std::vector<Vec3> nodes;                             // [m] only those that a cell uses
  int cell_nodes = 0;                                  // 8, 20: hexahedra; 4, 10: tetrahedra
  std::vector<std::array<int, 20>> cells;              // gmsh's order; the first cell_nodes are used
  std::vector<int> cell_volume;                        // gmsh's tag of the volume that each cell fills
  std::map<std::string, std::vector<int>> volumes;     // physical volume: tags
  std::map<std::string, std::vector<Facet>> surfaces;  // physical surface: facets, orientation as gmsh left it
  std::map<std::string, std::vector<std::array<int, 2>>> curves;  // physical curve: ends of its lines
  std::map<std::string, std::vector<int>> nodes_of;               // physical group of any dimension: its nodes, rising
};

/// The text in front of every message about a body.
std::string message_head(const Origin&, const std::string& body);

/// Meshes or reads body.mesh_file. A .geo whose cells are of the shape of a second-order element is meshed with middle
/// nodes on its geometry. Throws base::UserError: no file, gmsh's own complaints, unknown mesh parameters, cells other
/// than hexahedra of 8 or 20 or tetrahedra of 4 or 10 nodes.
RawMesh read_with_gmsh(const Body&);

}  // namespace fem
