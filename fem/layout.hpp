#pragma once
// Which rank has which elements and nodes, of all bodies together. Elements are cut by recursive coordinate bisection
// (each cut halves the work along the longest side), so the result depends on nothing but the meshes and the number of
// ranks. A node belongs to the lowest rank that has one of its elements. Three numberings of nodes:
//   global  bodies one after another, as in their meshes; the same for every number of ranks
//   petsc   global numbers sorted by owner: what PETSc's vectors use
//   local   on one rank: its own nodes, body by body, in the order in which its elements meet them; then ghosts
// A node that shares another's unknowns (periodic.hpp) has that one's petsc number, and is a ghost wherever it is.
#include <mpi.h>

#include <span>
#include <vector>

#include "fem/mesh.hpp"

namespace fem {

struct Layout {
  Layout(MPI_Comm, const std::vector<Mesh>&);

  MPI_Comm comm;
  int rank = 0, ranks = 1;
  std::vector<int> first_node;         // global number of each body's first node; one more at the end
  std::vector<int> unknown_of_global;  // global number of the node whose unknowns it has: mostly its own
  std::vector<int> petsc_of_global;
  int owned = 0;                           // nodes of this rank
  std::vector<int> ghosts;                 // petsc numbers, rising
  std::vector<int> global_of_local;        // owned, then ghosts
  std::vector<int> local_of_global;        // -1: not here
  std::vector<int> first_owned;            // local number of each body's first owned node; one more at the end
  std::vector<std::vector<int>> elements;  // per body: this rank's, along a space-filling curve

  int local_count() const { return static_cast<int>(global_of_local.size()); }
  int global_count() const { return first_node.back(); }
  /// Local number of a body's node, or of that whose unknowns it shares, if this rank owns it, else -1.
  int owned_node(int body, int node) const {
    const int local = local_of_global[unknown_of_global[first_node[body] + node]];
    return local < owned ? local : -1;
  }
  /// The same of several nodes, those that are owned, each once, rising.
  std::vector<int> owned_nodes(int body, std::span<const int> nodes) const;
};

}  // namespace fem
