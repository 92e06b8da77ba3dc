#include "fem/modes.hpp"

#include <slepceps.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "fem/communication.hpp"

namespace fem {
namespace {

using Eigenproblem = PetscHandle<EPS, EPSDestroy>;
using Indices = PetscHandle<IS, ISDestroy>;

class Problem {
 public:
  Problem(const ModesInput& in, int body)
      : in_(in),
        body_(body),
        first_(3 * in.layout.first_owned[body]),
        size_(3 * in.layout.first_owned[body + 1] - first_) {
    PetscInt start = 0;
    check_petsc(MatGetOwnershipRange(in.stiffness, &start, nullptr));
    Indices rows;
    check_petsc(ISCreateStride(in.layout.comm, size_, start + first_, 1, rows.place()));
    check_petsc(MatCreateSubMatrix(in.stiffness, rows, rows, MAT_INITIAL_MATRIX, stiffness_.place()));
    check_petsc(MatSetOption(stiffness_, MAT_SYMMETRIC, PETSC_TRUE));
    check_petsc(MatCreateAIJ(in.layout.comm, size_, size_, PETSC_DETERMINE, PETSC_DETERMINE, 1, nullptr, 0, nullptr,
                             mass_.place()));
    for (int i = 0; i < size_; ++i) {
      PetscInt row = 0;
      check_petsc(MatGetOwnershipRange(mass_, &row, nullptr));
      check_petsc(MatSetValue(mass_, row + i, row + i, mass(i), INSERT_VALUES));
    }
    check_petsc(MatAssemblyBegin(mass_, MAT_FINAL_ASSEMBLY));
    check_petsc(MatAssemblyEnd(mass_, MAT_FINAL_ASSEMBLY));
    check_petsc(MatSetOption(mass_, MAT_SYMMETRIC, PETSC_TRUE));
  }

  FoundModes solve(int count, const Mechanisms& mechanisms) {
    double free = 0;
    for (int i = 0; i < size_; ++i) free += mass(i) > 0;
    sum(in_.layout.comm, &free, 1);
    const int wanted = std::min<int>(count, static_cast<int>(free) - static_cast<int>(mechanisms.free.size()));
    FoundModes found;
    if (wanted <= 0) return found;
    Eigenproblem problem;
    check_petsc(EPSCreate(in_.layout.comm, problem.place()));
    check_petsc(EPSSetOperators(problem, stiffness_, mass_));
    check_petsc(EPSSetProblemType(problem, EPS_GHEP));
    check_petsc(EPSSetType(problem, EPSKRYLOVSCHUR));
    check_petsc(EPSSetDimensions(problem, wanted, PETSC_DEFAULT, PETSC_DEFAULT));
    check_petsc(EPSSetTolerances(problem, 1e-9, 500));
    check_petsc(EPSSetWhichEigenpairs(problem, EPS_TARGET_MAGNITUDE));
    check_petsc(EPSSetTarget(problem, shift()));
    invert(problem);
    auto rigid = rigid_vectors(mechanisms);
    std::vector<Vec> deflated(rigid.begin(), rigid.end());
    if (!deflated.empty())
      check_petsc(EPSSetDeflationSpace(problem, static_cast<PetscInt>(deflated.size()), deflated.data()));
    Vector start = start_vector();
    Vec first = start;
    check_petsc(EPSSetInitialSpace(problem, 1, &first));
    check_petsc(EPSSolve(problem));
    PetscInt converged = 0;
    check_petsc(EPSGetConverged(problem, &converged));
    base::require_internal(converged >= wanted, "too few modes found");
    Vector shape;
    check_petsc(MatCreateVecs(stiffness_, shape.place(), nullptr));
    for (int k = 0; k < wanted; ++k) {
      PetscScalar value = 0;
      check_petsc(EPSGetEigenpair(problem, k, &value, nullptr, shape, nullptr));
      keep(value, shape, found);
    }
    return found;
  }

 private:
  double mass(int i) const { return in_.inverse_mass[first_ + i] > 0 ? in_.mass[first_ + i] : 0; }

  /// A thousandth of the square of (wave speed / size), below zero: slender beams have their lowest modes near it.
  double shift() const {
    const Mesh& mesh = in_.meshes[body_];
    Vec3 lower = mesh.nodes.front(), upper = lower;
    for (const auto& node : mesh.nodes) {
      for (int c = 0; c < 3; ++c) {
        lower[c] = std::min(lower[c], node[c]);
        upper[c] = std::max(upper[c], node[c]);
      }
    }
    double speed2 = 0;  // [m2/s2] E / rho
    for (const auto& material : in_.setup.bodies[body_].materials)
      speed2 = std::max(speed2, material.young_modulus / material.density);
    return -1e-3 * speed2 / base::norm2(upper - lower);
  }

  void invert(EPS problem) const {
    ST transformation = nullptr;
    KSP solver = nullptr;
    PC factors = nullptr;
    check_petsc(EPSGetST(problem, &transformation));
    check_petsc(STSetType(transformation, STSINVERT));
    check_petsc(STGetKSP(transformation, &solver));
    check_petsc(KSPSetType(solver, KSPPREONLY));
    check_petsc(KSPGetPC(solver, &factors));
    check_petsc(PCSetType(factors, PCCHOLESKY));
    check_petsc(PCFactorSetMatSolverType(factors, MATSOLVERMUMPS));
  }

  std::vector<Vector> rigid_vectors(const Mechanisms& mechanisms) const {
    std::vector<Vector> vectors(mechanisms.free.size());
    for (std::size_t k = 0; k < vectors.size(); ++k) {
      check_petsc(MatCreateVecs(stiffness_, vectors[k].place(), nullptr));
      fill(vectors[k], [&](int node, int c) {
        const Mechanism& free = mechanisms.free[k];
        if (mechanisms.part_of_node[node] != free.part) return 0.0;
        return free.at(in_.meshes[body_].nodes[node])[c];
      });
    }
    return vectors;
  }

  /// The same numbers on any number of ranks, without symmetry.
  Vector start_vector() const {
    Vector vector;
    check_petsc(MatCreateVecs(stiffness_, vector.place(), nullptr));
    fill(vector, [](int node, int c) { return 1 + 0.5 * std::sin(12.9898 * node + 78.233 * c); });
    return vector;
  }

  template <class Value>
  void fill(Vec vector, Value&& value) const {
    double* values = nullptr;
    check_petsc(VecGetArray(vector, &values));
    for (int i = 0; i < size_; ++i) {
      const int node = in_.layout.global_of_local[(first_ + i) / 3] - in_.layout.first_node[body_];
      values[i] = mass(i) > 0 ? value(node, i % 3) : 0;
    }
    check_petsc(VecRestoreArray(vector, &values));
  }

  void keep(double eigenvalue, Vec shape, FoundModes& found) const {
    const double* values = nullptr;
    check_petsc(VecGetArrayRead(shape, &values));
    std::vector<double> own(values, values + size_);
    check_petsc(VecRestoreArrayRead(shape, &values));
    double sums[4] = {};  // phi M phi, phi M e_d
    for (int i = 0; i < size_; ++i) {
      sums[0] += mass(i) * own[i] * own[i];
      sums[1 + i % 3] += mass(i) * own[i];
    }
    sum(in_.layout.comm, sums, 4);
    for (double& value : own) value /= std::sqrt(sums[0]);
    Mode mode{std::sqrt(std::max(0.0, eigenvalue)) / (2 * std::numbers::pi), {}};
    for (int c = 0; c < 3; ++c) mode.effective_mass[c] = sums[1 + c] * sums[1 + c] / sums[0];
    found.modes.push_back(mode);
    found.shapes.push_back(std::move(own));
  }

  const ModesInput& in_;
  int body_, first_, size_;
  Matrix stiffness_, mass_;
};

}  // namespace

FoundModes find_modes(const ModesInput& input, int body, int count, const Mechanisms& mechanisms) {
  return Problem(input, body).solve(count, mechanisms);
}

}  // namespace fem
