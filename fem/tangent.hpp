#pragma once
// The tangent stiffness K = d f / d u of all bodies as one PETSc matrix, from the elements' own force kernels: every
// element and every law, present or future, has its matrix without a second formulation.
//   K_ij = f_i(e_j)                                   where f is linear in u: exact
//   K_ij = (f_i(u + h e_j) - f_i(u - h e_j)) / (2 h)  otherwise, at the present displacement, h a strain of 1e-7
// Elements are computed in blocks in which none shares a node with another, so that one pass over a block gives the
// same column of every element's matrix. Whether a law is linear is found by trial: f(-w) = -f(w) and f(2 w) = 2 f(w)
// for a strain of order one. Rows and columns that a support holds keep their diagonal only.
#include <span>
#include <vector>

#include "fem/blocks.hpp"
#include "fem/layout.hpp"
#include "fem/nodal_field.hpp"
#include "fem/petsc_handle.hpp"

namespace fem {

class Tangent {
 public:
  /// `inverse_mass`: zero where a support holds an owned component. Collective.
  Tangent(const Setup&, const std::vector<Mesh>&, const Layout&, std::span<const double> inverse_mass);

  /// A matrix of zeros with room for K. Collective.
  Matrix make() const;
  /// K at displacements whose ghosts are up to date, times `factors[body]` (empty: 1). Collective.
  void assemble(Mat, const NodalField& displacements, std::span<const double> factors = {}) const;
  bool is_linear() const { return linear_; }
  /// Unknowns of all ranks, held ones included.
  std::int64_t size() const { return 3 * static_cast<std::int64_t>(layout_.global_count()); }
  /// Hands the matrix the rigid motions that algebraic multigrid needs. Collective.
  void add_rigid_motions(Mat) const;

 private:
  struct Part {  // elements of one body, kind and material on this rank
    int body, element_nodes;
    std::string element;
    const MaterialRegion* material;
    std::vector<int> connectivity;  // local nodes
    bool linear;
    double size;  // [m] of its first element
  };
  using Elements = std::pair<int, int>;  // of a part: first, one past the last
  /// [element][column][row] of the elements' matrices.
  std::vector<double> matrices(const Part&, Elements, const double* displacements) const;
  std::unique_ptr<ElementBlock> separate_block(const Part&, Elements) const;
  bool responds_linearly(const Part&) const;

  const Layout& layout_;
  std::vector<Part> parts_;
  std::vector<Vec3> places_;                      // [m] of the local nodes
  std::vector<char> held_;                        // local components
  std::vector<PetscInt> near_nodes_, far_nodes_;  // per owned node: neighbours on this rank and on others
  bool linear_ = true;
};

}  // namespace fem
