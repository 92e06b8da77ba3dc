#pragma once
// The tangent stiffness K = d f / d u of all bodies as one PETSc matrix, from the elements' own force kernels: every
// element and every law, present or future, has its matrix without a second formulation. Where velocities follow
// displacements by dv = c du (Newmark's method), f is f(u, v(u)) and viscous forces have their part in K.
//   K_ij = f_i(e_j, c e_j)                            where f is linear: exact
//   K_ij = (f_i(u + h e_j, v + c h e_j) - f_i(u - h e_j, v - c h e_j)) / (2 h)  otherwise, at the present state, h a
//                                                     strain of 1e-7
// Elements are computed in blocks in which none shares a node with another, so that one pass over a block gives the
// same column of every element's matrix. Whether a law is linear is found by trial: f(-w) = -f(w) and f(2 w) = 2 f(w)
// for a strain of order one. Rows and columns that a support holds keep their diagonal only.
#include <span>
#include <vector>

#include "fem/assembly.hpp"
#include "fem/layout.hpp"
#include "fem/petsc_handle.hpp"

namespace fem {

class Tangent {
 public:
  /// `inverse_mass`: zero where a support holds an owned component. Collective.
  Tangent(const std::vector<Mesh>&, const Layout&, const Assembly&, std::span<const double> inverse_mass);

  /// A matrix of zeros with room for K. Collective.
  Matrix make() const;
  struct State {                  // ghosts up to date
    const double* displacements;  // [m] of the local nodes
    const double* velocities;     // [m/s] null: at rest
    double rate;                  // [1/s] c
  };
  /// K at a state and with what the laws remember. Collective.
  void assemble(Mat matrix, const State& state) const { assemble(matrix, &state); }
  /// K of small motions about the start, undamped. Collective.
  void assemble(Mat matrix) const { assemble(matrix, nullptr); }
  bool is_linear() const { return linear_; }
  /// Unknowns of all ranks, held ones included.
  std::int64_t size() const { return 3 * static_cast<std::int64_t>(layout_.global_count()); }
  /// Hands the matrix the rigid motions that algebraic multigrid needs. Collective.
  void add_rigid_motions(Mat) const;

 private:
  struct Part {  // elements of one kind and material on this rank
    const ElementBlock* block;
    bool linear;
    double size;  // [m] of its first element
  };
  using Batches = std::pair<int, int>;  // of a part: first, one past the last
  /// [element][column][row] of the elements' matrices; without a state: of small motions about the start.
  std::vector<double> matrices(const Part&, Batches, const State*) const;
  void assemble(Mat, const State*) const;
  static bool responds_linearly(const Part&);

  const Layout& layout_;
  std::vector<Part> parts_;
  std::vector<Vec3> places_;                      // [m] of the local nodes
  std::vector<char> held_;                        // local components
  std::vector<PetscInt> near_nodes_, far_nodes_;  // per owned node: neighbours on this rank and on others
  bool linear_ = true;
};

}  // namespace fem
