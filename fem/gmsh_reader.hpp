#pragma once
// What gmsh makes of a .geo or .msh file, as it is: cells, and the physical groups by name. Runs on one rank only.
#include <array>
#include <map>
#include <string>
#include <vector>

#include "base/vec3.hpp"
#include "fem/fem.hpp"

namespace fem {

using Facet = std::array<int, 4>;  // node numbers; [3] = -1 for a triangle

struct RawMesh {
  std::vector<Vec3> nodes;                             // [m] only those that a cell uses
  int cell_nodes = 0;                                  // 8: hexahedra, 4: tetrahedra
  std::vector<std::array<int, 8>> cells;               // gmsh's order; tetrahedra use the first four
  std::vector<int> cell_volume;                        // gmsh's tag of the volume that each cell fills
  std::map<std::string, std::vector<int>> volumes;     // physical volume: tags
  std::map<std::string, std::vector<Facet>> surfaces;  // physical surface: facets, orientation as gmsh left it
  std::map<std::string, std::vector<int>> nodes_of;    // physical group of any dimension: its nodes, rising
};

/// The text in front of every message about a body.
std::string message_head(const Origin&, const std::string& body);

/// Meshes or reads body.mesh_file. Throws base::UserError: no file, gmsh's own complaints, unknown mesh parameters,
/// cells other than straight-sided hexahedra or tetrahedra.
RawMesh read_with_gmsh(const Body&);

}  // namespace fem
