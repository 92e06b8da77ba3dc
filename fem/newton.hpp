#pragma once
// Newton-Raphson for the equations that an implicit step, or an equilibrium, comes to, from a guess u0:
//   R(u) = f(u, v) + d (u - u0) + c D (u - u0) - b = 0,  v = v0 + c (u - u0)
// f inner forces, d a diagonal (inertia and mass damping), D dashpots at nodes, b what is given. Held components keep
// their displacement. PETSc's SNES iterates, KSP solves: a factorisation (MUMPS), or for large models conjugate
// gradients with algebraic multigrid that knows the rigid motions (GMRES where the tangent has no symmetry).
// Converged: |R| <= 1e-10 max(|f|, |b|), or the rounding of f, 1e-15 |diag(K) u|; or below 1e-7 max(|f|, |b|) when an
// iteration does not halve it any more (elements that turn with their mean rotation round at their places, not at u).
// The tangent is made once for a step length where all laws are linear, and at every iteration otherwise. Source:
// Hughes, The Finite Element Method (2000), 9.1 and 9.4; Li2021 2.2.
#include <span>
#include <string>

#include "fem/assembly.hpp"
#include "fem/tangent.hpp"

namespace fem {

struct Dashpot {  // at an owned node
  int node;
  double drag[3][3];  // [N s/m]
};

class Newton {
 public:
  Newton(const SolverSettings&, const Layout&, const Assembly&, const Tangent&, std::span<const double> inverse_mass);

  struct Terms {                        // of the owned components
    std::span<const double> diagonal;   // [N/m] d; empty: none
    std::span<const double> given;      // [N] b
    std::span<const Dashpot> dashpots;  // D
    NodalField* velocities = nullptr;   // [m/s] come as v0 and go as v; null: at rest
    double rate = 0;                    // [1/s] c
  };
  /// From here on d and c are others than before.
  void forget() { built_ = false; }
  /// [N/m] diagonal of the last tangent, of the owned components: by it the rounding of forces is judged.
  std::vector<double> diagonal() const;
  void set_diagonal(std::span<const double>);
  /// Displacements come as the guess and go as the solution, `inner` goes as their inner forces; the ghosts of the
  /// displacements are up to date. Collective; throws base::UnstableError on every rank, opened by `head`, when no
  /// solution is found.
  void solve(NodalField& displacements, NodalField& inner, const Terms&, const std::string& head);

 private:
  void residual(Vec x, Vec r);
  void rebuild();
  void add_dashpots();
  void converged(int iteration, double residual, SNESConvergedReason*);
  bool factorises() const;

  const SolverSettings& settings_;
  const Layout& layout_;
  const Assembly& assembly_;
  const Tangent& tangent_;
  std::span<const double> inverse_mass_;
  Matrix matrix_;
  Vector unknowns_, residual_, diagonal_;  // diagonal_: of K alone [N/m]
  NewtonSolution solver_;
  bool built_ = false;
  double last_residual_ = 0;  // [N]
  // of the call under way
  NodalField *displacements_ = nullptr, *inner_ = nullptr;
  Terms terms_;
  std::vector<double> guess_, guessed_velocity_;
  Vector added_;  // to the diagonal
};

}  // namespace fem
