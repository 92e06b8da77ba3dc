#pragma once
// Who does what: all ranks split into DEM ranks, which hold the grains, and FEM ranks; a lone rank is both. A scene
// without bodies has no FEM rank, one without grains no DEM rank.
// The first DEM rank and the FEM ranks are the crew, which runs the scene. The other DEM ranks, the workers, do what
// the first one says (slab_server.hpp).
#include <mpi.h>

#include <optional>
#include <string>

#include "coupling/scene.hpp"

namespace coupling {

/// What the command line of this rank asks for.
struct RankWishes {
  std::optional<int> dem_ranks;
  std::string role;  // dem | fem; empty: by the rank's number
};

class Roles {
 public:
  /// Collective over all ranks. Throws base::UserError, the same on every one, when the scene has no use for the ranks
  /// as they are wished.
  Roles(MPI_Comm all, const Scene&, const RankWishes& = {});
  ~Roles();
  Roles(const Roles&) = delete;
  Roles& operator=(const Roles&) = delete;

  MPI_Comm world = MPI_COMM_NULL;                          // the crew, the DEM rank first; MPI_COMM_NULL for workers
  MPI_Comm dem = MPI_COMM_NULL;                            // ranks with grains; MPI_COMM_NULL elsewhere
  MPI_Comm fem = MPI_COMM_NULL;                            // ranks with finite elements; MPI_COMM_NULL elsewhere
  MPI_Comm joint = MPI_COMM_NULL;                          // all ranks of a coupled scene, those with grains first
  int rank = -1, size = 0;                                 // in the crew
  bool is_dem = false, is_fem = false, is_worker = false;  // is_dem: the first rank with grains
  bool coupled = false;                                    // both kinds exist
  int dem_rank = 0;                                        // crew's rank of the grains
  int first_fem_rank = 0;                                  // crew's rank of the first FEM rank
  int dem_ranks = 0, fem_ranks = 0;
  int all_ranks = 1;               // a lone rank may be of both kinds
  int dem_here = 0, fem_here = 0;  // ranks on this machine that have grains, and that have nothing but elements
  int dem_number_here = 0;         // of a rank with grains, among those on this machine
  bool is_root() const { return rank == 0; }  // writes history, summary and progress; has the grains if there are any
  bool is_fem_root() const { return is_fem && rank == first_fem_rank; }
};

}  // namespace coupling
