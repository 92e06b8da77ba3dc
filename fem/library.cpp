#include <petscsys.h>
#include <slepcsys.h>

#include "fem/fem.hpp"
#include "fem/nodal_field.hpp"

namespace fem {

Library::Library(MPI_Comm comm) {
  PETSC_COMM_WORLD = comm;
  check_petsc(PetscOptionsSetValue(nullptr, "-no_signal_handler", "true"));  // signals are the program's own business
  check_petsc(SlepcInitializeNoArguments());                                 // starts PETSc too
  check_petsc(PetscPushErrorHandler(PetscReturnErrorHandler, nullptr));
}

Library::~Library() {
  PetscPopErrorHandler();
  if (SlepcInitializeCalled) SlepcFinalize();
}

}  // namespace fem
