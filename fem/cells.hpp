#pragma once
// Cells and their faces: the split of hexahedra into tetrahedra, the test for crossed or flat cells, and which cell a
// facet of a named surface belongs to.
#include <array>
#include <string>
#include <vector>

#include "fem/gmsh_reader.hpp"

namespace fem {

/// Cuts every hexahedron into the six tetrahedra round its diagonal 0-6 (Kuhn), 0 being its corner nearest to
/// (-1, -1, -1), so that boxes and other cells in rows and layers give meshes that fit together; facets are cut along.
/// Throws base::UserError with `head` where neighbouring cells' diagonals do not meet.
void split_into_tetrahedra(RawMesh&, const std::string& head);

/// Makes cells of the second order: a node on the straight middle of every edge, also in groups that have the edge.
void add_middle_nodes(RawMesh&);

/// Throws base::UserError with `head`, the cell and its place where a cell is flat or inside out.
void check_volumes(const RawMesh&, const std::string& head);

/// Throws base::UserError with `head`, both cells and their place where two cells have the same corners.
void check_doubles(const RawMesh&, const std::string& head);

/// The facets of a mesh's cells, each outward from its cell.
class FaceTable {
 public:
  explicit FaceTable(const RawMesh&);
  struct Found {
    Facet facet = no_facet;  // outward from the first cell that has it
    int cells = 0;           // how many cells have it
    int cell = -1;           // the first
  };
  Found find(const Facet&) const;
  int boundary_faces() const;
  /// Per cell the number of its part, parts being joined by faces and numbered by their first cell; empty: all are one.
  std::vector<int> rigid_parts(int cells) const;

 private:
  struct Entry {
    std::array<int, 4> key;
    Facet facet;
    int cell;
  };
  std::vector<Entry> entries_;
};

}  // namespace fem
