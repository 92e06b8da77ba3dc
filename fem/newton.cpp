#include "fem/newton.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "fem/communication.hpp"

namespace fem {
namespace {

constexpr std::int64_t largest_factorised = 150000;  // unknowns; above, multigrid is faster and needs less memory
constexpr double wanted_accuracy = 1e-10, accepted_rest = 1e-7, rounding = 1e-15;

/// What PETSc can call back: it is C, nothing may be thrown through it.
template <class Call>
PetscErrorCode guarded(Call&& call) {
  try {
    call();
    return 0;
  } catch (const std::exception&) {
    return PETSC_ERR_LIB;
  }
}

}  // namespace

Newton::Newton(const SolverSettings& settings, const Layout& layout, const Assembly& assembly, const Tangent& tangent,
               std::span<const double> inverse_mass)
    : settings_(settings),
      layout_(layout),
      assembly_(assembly),
      tangent_(tangent),
      inverse_mass_(inverse_mass),
      matrix_(tangent.make()) {
  for (Vector* vector : {&unknowns_, &residual_, &diagonal_, &added_})
    check_petsc(MatCreateVecs(matrix_, vector->place(), nullptr));
  check_petsc(SNESCreate(layout.comm, solver_.place()));
  check_petsc(SNESSetType(solver_, SNESNEWTONLS));
  check_petsc(SNESSetTolerances(solver_, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT, 50, 10000));
  check_petsc(SNESSetFunction(
      solver_, residual_,
      [](SNES, Vec x, Vec r, void* self) { return guarded([&] { static_cast<Newton*>(self)->residual(x, r); }); },
      this));
  check_petsc(SNESSetJacobian(
      solver_, matrix_, matrix_,
      [](SNES, Vec, Mat, Mat, void* self) { return guarded([&] { static_cast<Newton*>(self)->rebuild(); }); }, this));
  check_petsc(SNESSetConvergenceTest(
      solver_,
      [](SNES, PetscInt iteration, PetscReal, PetscReal, PetscReal residual, SNESConvergedReason* reason, void* self) {
        return guarded([&] { static_cast<Newton*>(self)->converged(iteration, residual, reason); });
      },
      this, nullptr));
  SNESLineSearch search = nullptr;
  check_petsc(SNESGetLineSearch(solver_, &search));
  check_petsc(SNESLineSearchSetType(search, SNESLINESEARCHBASIC));
  KSP ksp = nullptr;
  PC preconditioner = nullptr;
  check_petsc(SNESGetKSP(solver_, &ksp));
  check_petsc(KSPGetPC(ksp, &preconditioner));
  if (factorises()) {
    check_petsc(KSPSetType(ksp, KSPPREONLY));
    check_petsc(PCSetType(preconditioner, tangent.is_linear() ? PCCHOLESKY : PCLU));
    check_petsc(PCFactorSetMatSolverType(preconditioner, MATSOLVERMUMPS));
  } else {
    check_petsc(KSPSetType(ksp, tangent.is_linear() ? KSPCG : KSPGMRES));
    check_petsc(KSPSetTolerances(ksp, 1e-8, PETSC_DEFAULT, PETSC_DEFAULT, 2000));
    check_petsc(PCSetType(preconditioner, PCGAMG));
    tangent.add_rigid_motions(matrix_);
  }
}

bool Newton::factorises() const {
  return settings_.linear_solver == LinearSolver::direct ||
         (settings_.linear_solver == LinearSolver::automatic && tangent_.size() <= largest_factorised);
}

void Newton::residual(Vec x, Vec r) {
  const double* values = nullptr;
  check_petsc(VecGetArrayRead(x, &values));
  std::copy_n(values, displacements_->owned_size(), displacements_->data());
  check_petsc(VecRestoreArrayRead(x, &values));
  const double* u = displacements_->data();
  displacements_->begin_to_ghosts();
  if (terms_.velocities) {
    for (std::size_t i = 0; i < guess_.size(); ++i)
      terms_.velocities->data()[i] = guessed_velocity_[i] + terms_.rate * (u[i] - guess_[i]);
    if (assembly_.viscous()) terms_.velocities->begin_to_ghosts();
  }
  assembly_.inner_forces(*displacements_, terms_.velocities, *inner_);
  const double* f = inner_->data();
  double* result = nullptr;
  check_petsc(VecGetArray(r, &result));
  for (std::size_t i = 0; i < guess_.size(); ++i) {
    result[i] = f[i] - terms_.given[i];
    if (!terms_.diagonal.empty()) result[i] += terms_.diagonal[i] * (u[i] - guess_[i]);
  }
  for (const auto& dashpot : terms_.dashpots) {
    const int first = 3 * dashpot.node;
    for (int c = 0; c < 3; ++c) {
      for (int d = 0; d < 3; ++d)
        result[first + c] += terms_.rate * dashpot.drag[c][d] * (u[first + d] - guess_[first + d]);
    }
  }
  for (std::size_t i = 0; i < guess_.size(); ++i) {
    if (inverse_mass_[i] == 0) result[i] = 0;
  }
  check_petsc(VecRestoreArray(r, &result));
}

void Newton::rebuild() {
  if (built_ && tangent_.is_linear()) return;
  tangent_.assemble(matrix_,
                    {displacements_->data(), terms_.velocities ? terms_.velocities->data() : nullptr, terms_.rate});
  check_petsc(MatGetDiagonal(matrix_, diagonal_));
  if (!terms_.diagonal.empty()) {
    double* values = nullptr;
    check_petsc(VecGetArray(added_, &values));
    for (std::size_t i = 0; i < guess_.size(); ++i) values[i] = inverse_mass_[i] > 0 ? terms_.diagonal[i] : 0;
    check_petsc(VecRestoreArray(added_, &values));
    check_petsc(MatDiagonalSet(matrix_, added_, ADD_VALUES));
  }
  if (!terms_.dashpots.empty()) add_dashpots();
  built_ = true;
}

void Newton::add_dashpots() {
  for (const auto& dashpot : terms_.dashpots) {
    const PetscInt first = 3 * layout_.petsc_of_global[layout_.global_of_local[dashpot.node]];
    for (int c = 0; c < 3; ++c) {
      for (int d = 0; d < 3; ++d) {
        if (inverse_mass_[3 * dashpot.node + c] == 0 || inverse_mass_[3 * dashpot.node + d] == 0) continue;
        check_petsc(MatSetValue(matrix_, first + c, first + d, terms_.rate * dashpot.drag[c][d], ADD_VALUES));
      }
    }
  }
  check_petsc(MatAssemblyBegin(matrix_, MAT_FINAL_ASSEMBLY));
  check_petsc(MatAssemblyEnd(matrix_, MAT_FINAL_ASSEMBLY));
}

std::vector<double> Newton::diagonal() const {
  PetscInt size = 0;
  check_petsc(VecGetLocalSize(diagonal_, &size));
  const double* values = nullptr;
  check_petsc(VecGetArrayRead(diagonal_, &values));
  std::vector<double> copy(values, values + size);
  check_petsc(VecRestoreArrayRead(diagonal_, &values));
  return copy;
}

void Newton::set_diagonal(std::span<const double> diagonal) {
  double* values = nullptr;
  check_petsc(VecGetArray(diagonal_, &values));
  std::ranges::copy(diagonal, values);
  check_petsc(VecRestoreArray(diagonal_, &values));
}

void Newton::converged(int iteration, double residual, SNESConvergedReason* reason) {
  *reason = SNES_CONVERGED_ITERATING;
  double squares[3] = {};  // of f, b, diag(K) u
  const double* stiffness = nullptr;
  check_petsc(VecGetArrayRead(diagonal_, &stiffness));
  for (std::size_t i = 0; i < guess_.size(); ++i) {
    squares[0] += inner_->data()[i] * inner_->data()[i];
    squares[1] += inverse_mass_[i] > 0 ? terms_.given[i] * terms_.given[i] : 0;
    squares[2] += std::pow(stiffness[i] * displacements_->data()[i], 2);
  }
  check_petsc(VecRestoreArrayRead(diagonal_, &stiffness));
  sum(layout_.comm, squares, 3);
  const double scale = std::sqrt(std::max(squares[0], squares[1]));
  if (!std::isfinite(residual)) {
    *reason = SNES_DIVERGED_FNORM_NAN;
  } else if (residual <= std::max(wanted_accuracy * scale, rounding * std::sqrt(squares[2]))) {
    *reason = SNES_CONVERGED_FNORM_ABS;
  } else if (iteration > 0 && residual > 0.5 * last_residual_ && residual <= accepted_rest * scale) {
    *reason = SNES_CONVERGED_FNORM_ABS;
  } else if (iteration >= 50) {
    *reason = SNES_DIVERGED_MAX_IT;
  }
  last_residual_ = residual;
}

void Newton::solve(NodalField& displacements, NodalField& inner, const Terms& terms, const std::string& head) {
  displacements_ = &displacements;
  inner_ = &inner;
  terms_ = terms;
  guess_.assign(displacements.data(), displacements.data() + displacements.owned_size());
  if (terms.velocities)
    guessed_velocity_.assign(terms.velocities->data(), terms.velocities->data() + terms.velocities->owned_size());
  double* values = nullptr;
  check_petsc(VecGetArray(unknowns_, &values));
  std::ranges::copy(guess_, values);
  check_petsc(VecRestoreArray(unknowns_, &values));
  SNESConvergedReason reason = SNES_CONVERGED_ITERATING;
  const PetscErrorCode code = SNESSolve(solver_, nullptr, unknowns_);
  check_petsc(SNESGetConvergedReason(solver_, &reason));
  if (code == 0 && reason > 0) {
    displacements.begin_to_ghosts();
    displacements.end_to_ghosts();
    return;
  }
  built_ = false;
  PetscInt iterations = 0;
  PetscReal norm = 0;
  SNESGetIterationNumber(solver_, &iterations);
  SNESGetFunctionNorm(solver_, &norm);
  std::string why = "the residual stays";
  if (reason == SNES_DIVERGED_LINEAR_SOLVE) why = "the linear system is singular or was not solved";
  if (reason == SNES_DIVERGED_FNORM_NAN) why = "forces are beyond all numbers (are loads or moduli absurd?)";
  throw base::UnstableError(fmt::format(
      "{}no equilibrium found: {} after {} Newton iterations (residual {:.3g} N); where laws yield, shorten "
      "time.fem_step, or the loads are more than the bodies can carry",
      head, why, iterations, norm));
}

}  // namespace fem
