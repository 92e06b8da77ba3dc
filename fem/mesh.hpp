#pragma once
// The checked mesh of one body: elements of one kind with their material regions, and the named groups.
#include <mpi.h>

#include <map>
#include <string>
#include <vector>

#include "fem/fem.hpp"
#include "fem/gmsh_reader.hpp"

namespace fem {

struct Group {
  std::vector<int> nodes;          // rising
  std::vector<Facet> facets;       // outward from the element they belong to; empty unless a surface
  std::vector<int> facet_regions;  // per facet: the material of that element
  bool outside = true;             // every facet belongs to exactly one element
};

struct Mesh {
  std::vector<Vec3> nodes;  // [m] translated
  int element_nodes = 0;
  std::vector<int> elements;     // element_nodes each
  std::vector<int> regions;      // per element: which of Body::materials
  std::vector<int> rigid_parts;  // per element: its part, joined by faces (hinges.hpp); empty: all are one
  std::map<std::string, Group> groups;
  std::vector<int> shared;  // per node: whose unknowns it shares (periodic.hpp); empty: each has its own

  int unknown_of(int node) const { return shared.empty() ? node : shared[node]; }
  int element_count() const { return static_cast<int>(regions.size()); }
  const int* element(int e) const { return elements.data() + static_cast<std::size_t>(e) * element_nodes; }
  Vec3 centre(int e) const;
};

/// Checks all of a body that needs no mesh. Throws base::UserError.
void check_body(const Body&);

/// Reads the body's mesh on the first rank, checks it and hands it to every rank. Collective; throws base::UserError on
/// every rank.
Mesh read_mesh(MPI_Comm, const Body&);

/// The group of that name, or a base::UserError that lists those that exist. `key` is the scene's word for it.
const Group& find_group(const Mesh&, const Body&, const Origin&, const std::string& key, const std::string& group);

}  // namespace fem
