#pragma once
// Owners of PETSc's and SLEPc's objects: destroyed with the last one that holds them.
#include <petscksp.h>
#include <petscsnes.h>

#include <utility>

namespace fem {

template <class Object, PetscErrorCode (*destroy)(Object*)>
class PetscHandle {
 public:
  PetscHandle() = default;
  ~PetscHandle() { destroy(&object_); }
  PetscHandle(PetscHandle&& other) noexcept : object_(std::exchange(other.object_, nullptr)) {}
  PetscHandle& operator=(PetscHandle&& other) noexcept {
    std::swap(object_, other.object_);
    return *this;
  }
  operator Object() const { return object_; }
  /// Where PETSc's Create functions put the object.
  Object* place() { return &object_; }

 private:
  Object object_ = nullptr;
};

using Matrix = PetscHandle<Mat, MatDestroy>;
using Vector = PetscHandle<Vec, VecDestroy>;
using LinearSolution = PetscHandle<KSP, KSPDestroy>;
using NewtonSolution = PetscHandle<SNES, SNESDestroy>;

}  // namespace fem
