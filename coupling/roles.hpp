#pragma once
// Who does what: the world's ranks split into one DEM rank and the FEM ranks; a lone rank is both.
// A scene without bodies has no FEM rank, one without grains no DEM rank.
#include <mpi.h>

#include "coupling/scene.hpp"

namespace coupling {

class Roles {
 public:
  /// Collective over the world. Throws base::UserError when the scene has no use for that many ranks.
  Roles(MPI_Comm world, const Scene&);
  ~Roles();
  Roles(const Roles&) = delete;
  Roles& operator=(const Roles&) = delete;

  MPI_Comm world = MPI_COMM_NULL;
  MPI_Comm fem = MPI_COMM_NULL;  // ranks with finite elements; MPI_COMM_NULL elsewhere
  int rank = 0, size = 1;
  bool is_dem = false, is_fem = false;
  bool coupled = false;    // both kinds exist
  int dem_rank = 0;        // world rank of the grains
  int first_fem_rank = 0;  // world rank of the first FEM rank
  int fem_ranks = 0;
  bool is_root() const { return rank == 0; }  // writes history, summary and progress; has the grains if there are any
  bool is_fem_root() const { return is_fem && rank == first_fem_rank; }
};

}  // namespace coupling
