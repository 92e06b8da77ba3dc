#pragma once
// A vector of three components per node in PETSc's ghosted form: owned nodes first, then copies of the neighbours'
// nodes.
#include <petscvec.h>

#include "base/error.hpp"
#include "fem/layout.hpp"

namespace fem {

inline void check_petsc(PetscErrorCode code) {
  if (code != 0) throw base::MachineError("PETSc failed with error code " + std::to_string(code));
}

class NodalField {
 public:
  explicit NodalField(const Layout& layout) : owned_(3 * layout.owned), local_(3 * layout.local_count()) {
    check_petsc(VecCreateGhostBlock(layout.comm, 3, owned_, PETSC_DECIDE, static_cast<PetscInt>(layout.ghosts.size()),
                                    layout.ghosts.data(), &vector_));
    Vec local = nullptr;  // shares its numbers with vector_
    check_petsc(VecGhostGetLocalForm(vector_, &local));
    check_petsc(VecSet(local, 0.0));
    check_petsc(VecGetArray(local, &data_));
    double* const data = data_;  // the numbers of a plain PETSc vector stay where they are
    check_petsc(VecRestoreArray(local, &data_));
    data_ = data;
    check_petsc(VecGhostRestoreLocalForm(vector_, &local));
  }
  ~NodalField() { VecDestroy(&vector_); }
  NodalField(const NodalField&) = delete;
  NodalField& operator=(const NodalField&) = delete;

  double* data() { return data_; }  // [owned, then ghosts][3]
  const double* data() const { return data_; }
  int owned_size() const { return owned_; }  // numbers, not nodes
  int local_size() const { return local_; }

  /// Owners' numbers to the ghosts; nothing may change the owned ones in between.
  void begin_to_ghosts() { check_petsc(VecGhostUpdateBegin(vector_, INSERT_VALUES, SCATTER_FORWARD)); }
  void end_to_ghosts() { check_petsc(VecGhostUpdateEnd(vector_, INSERT_VALUES, SCATTER_FORWARD)); }
  /// Ghosts' numbers added to the owners'; the owned ones may be added to in between.
  void begin_add_from_ghosts() { check_petsc(VecGhostUpdateBegin(vector_, ADD_VALUES, SCATTER_REVERSE)); }
  void end_add_from_ghosts() { check_petsc(VecGhostUpdateEnd(vector_, ADD_VALUES, SCATTER_REVERSE)); }

 private:
  Vec vector_ = nullptr;
  double* data_ = nullptr;
  int owned_, local_;
};

}  // namespace fem
