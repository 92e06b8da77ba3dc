#pragma once
// The messages of a coupling window between the DEM rank and the FEM ranks (also within one process, by messages to
// itself): skin states one way, nodal forces the other. Each FEM rank sends and gets only the skin nodes it owns.
// Both messages start with a status word, so that a failure on one side stops the other instead of hanging it; who
// failed and why is told by agree() after the loop.
#include <mpi.h>

#include <array>
#include <span>
#include <vector>

#include "base/columns.hpp"
#include "base/skin.hpp"
#include "coupling/roles.hpp"
#include "coupling/window.hpp"
#include "dem/dem.hpp"
#include "fem/fem.hpp"

namespace coupling {

class Exchange {
 public:
  /// Collective over the world: tells the DEM rank every skin and who owns which node. `model` is null off the FEM
  /// ranks.
  Exchange(const Roles&, const fem::Model* model, const CouplingSettings& = {});

  /// The skins, on every rank.
  const std::vector<base::Skin>& skins() const { return skins_; }
  /// 1 / mass [1/kg] of the nodes of skin s, on the DEM rank.
  const std::vector<double>& mobility(std::size_t s) const { return mobility_[s]; }

  // ---- FEM side
  /// Call when a window begins, before predict(): a parabola leaves with the velocities that the nodes have then.
  void begin_window(const fem::Model&);
  /// Sends positions of the owned nodes at the window's end: as they are after predict() (ahead = 0), or extrapolated
  /// with the present velocity over `ahead` seconds; and velocities, of the end or of the start (SkinMotion).
  void send_skins(const fem::Model&, double ahead, bool failed);
  /// Takes the nodal impulses of a window. False when the DEM side has failed.
  bool receive_impulses();
  /// Nodal forces = the impulses last received / window [s].
  void apply(fem::Model&, double window);

  // ---- DEM side
  /// Takes the skin states into the DEM's meshes `walls[s]`. False when the FEM side has failed.
  bool receive_skins(dem::Simulation&, std::span<const int> walls);
  /// Sends the nodal impulses of the last advance().
  void send_impulses(const dem::Simulation&, std::span<const int> walls, bool failed);
  /// Ends the sends of this window; call once per window on every rank.
  void finish_window();

  /// Largest |impulse given + impulse taken| / sum |nodal impulse| over the windows closed so far (DEM rank).
  double momentum_error() const { return momentum_error_; }
  double seconds() const { return seconds_; }        // [s] packing, posting, unpacking
  double seconds_waited() const { return waited_; }  // [s] waiting for the other side

  /// What the next window's balance of momentum needs of this one, for a checkpoint: the DEM rank's into `grains`,
  /// that of all FEM ranks into `bodies` of the first one. Collective.
  void save(base::Columns& grains, base::Columns& bodies) const;
  void restore(const base::Columns& grains, const base::Columns& bodies);

 private:
  void save_waiting(base::Columns& bodies) const;
  void restore_waiting(const base::Columns& bodies);

  struct Peer {
    int rank = 0;                         // world rank
    std::vector<std::vector<int>> nodes;  // per skin: owned skin nodes
    std::vector<double> out, in;
    MPI_Request out_request = MPI_REQUEST_NULL, in_request = MPI_REQUEST_NULL;
  };

  struct Impulse {   // on the grains in one window
    base::Vec3 sum;  // [N s]
    double all = 0;  // [N s] sum of |nodal impulse|
  };

  const Roles& roles_;
  const CouplingSettings settings_;
  std::vector<base::Skin> skins_;
  std::vector<std::vector<double>> mobility_;
  std::vector<Peer> fem_peers_;                                             // on the DEM rank: one per FEM rank
  Peer dem_peer_;                                                           // on a FEM rank
  std::vector<std::vector<base::Vec3>> positions_, velocities_, impulses_;  // per skin, whole
  std::vector<std::vector<base::Vec3>> leaving_;  // [m/s] per skin, owned nodes: velocities as the window began
  std::vector<std::vector<base::Vec3>> waiting_;  // [N s] per skin, owned nodes: impulses last received
  std::vector<base::Vec3> local_positions_, local_velocities_, local_forces_;
  base::Vec3 applied_;            // [N s] sum of force x window of this FEM rank in the window before
  Impulse given_, given_before_;  // of the last window and the one before it (DEM rank)
  double momentum_error_ = 0, seconds_ = 0, waited_ = 0;
};

}  // namespace coupling
