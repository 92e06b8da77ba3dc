#include "coupling/roles.hpp"

#include <fmt/core.h>

#include "base/error.hpp"

namespace coupling {

Roles::Roles(MPI_Comm world_, const Scene& scene) : world(world_) {
  MPI_Comm_rank(world, &rank);
  MPI_Comm_size(world, &size);
  const bool grains = scene.has_grains(), bodies = scene.has_bodies();
  base::require_user(bodies || size == 1,
                     fmt::format("{}: the scene has no deformable body, so one rank does all its work; found {} ranks; "
                                 "start it without mpirun or with -n 1",
                                 scene.file.string(), size));
  coupled = grains && bodies;
  is_dem = grains && rank == 0;
  first_fem_rank = coupled && size > 1 ? 1 : 0;
  fem_ranks = bodies ? size - first_fem_rank : 0;
  is_fem = bodies && rank >= first_fem_rank;
  MPI_Comm_split(world, is_fem ? 0 : MPI_UNDEFINED, rank, &fem);
}

Roles::~Roles() {
  if (fem != MPI_COMM_NULL) MPI_Comm_free(&fem);
}

}  // namespace coupling
