#include <petscsys.h>

#include "fem/fem.hpp"
#include "fem/nodal_field.hpp"

namespace fem {

Library::Library(MPI_Comm comm) {
  PETSC_COMM_WORLD = comm;
  check_petsc(PetscOptionsSetValue(nullptr, "-no_signal_handler", "true"));  // signals are the program's own business
  check_petsc(PetscInitializeNoArguments());
  check_petsc(PetscPushErrorHandler(PetscReturnErrorHandler, nullptr));
}

Library::~Library() {
  PetscPopErrorHandler();
  PetscFinalize();
}

}  // namespace fem
