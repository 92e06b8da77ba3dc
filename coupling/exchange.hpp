#pragma once
// The exchange of a coupling window as the crew sees it: skin states one way, nodal impulses the other, directly
// between every FEM rank (body_end.hpp) and every DEM part (grain_end.hpp), also within one process, by messages to
// itself. Each pair moves the nodes that it shares. All messages start with a status word, so that a failure on one
// side stops the other instead of hanging it; who failed and why is told by agree() after the loop.
#include <memory>
#include <optional>

#include "coupling/body_end.hpp"
#include "coupling/grain_end.hpp"
#include "coupling/roles.hpp"

namespace coupling {

class SlabSimulation;

class Exchange {
 public:
  /// Collective over the crew: tells the DEM rank every skin and who owns which node. `model` is null off the FEM
  /// ranks.
  Exchange(const Roles&, const fem::Model* model, const CouplingSettings& = {});

  /// The skins, on every rank of the crew.
  const std::vector<base::Skin>& skins() const { return is_.skins; }
  /// 1 / mass [1/kg] of the nodes of skin s, on the DEM rank.
  const std::vector<double>& mobility(std::size_t s) const { return mobility_[s]; }

  // ---- FEM side, see BodyEnd
  void begin_window(const fem::Model&);
  void send_skins(const fem::Model&, double ahead, bool failed);
  bool receive_impulses();
  void apply(fem::Model&, double window);
  /// Ends the sends of this window.
  void finish_window();

  // ---- DEM side
  /// Whose meshes `walls[s]` the skins are; `parts`: the same, where it is shared out over several DEM ranks.
  void join(dem::Simulation& grains, SlabSimulation* parts, const std::vector<int>& walls);
  /// One window of all parts. False when the FEM side has failed. refused: this rank cannot go on, the bodies are told.
  bool window(int steps, double dt, bool refused);
  /// By parts.
  std::vector<PairTraffic> traffic() const;

  /// Largest |impulse given + impulse taken| / sum |nodal impulse| over the windows closed so far (DEM rank).
  double momentum_error() const { return momentum_error_; }
  double seconds() const { return seconds_; }        // [s] packing, posting, unpacking; of the part that takes longest
  double seconds_waited() const { return waited_; }  // [s] waiting for the other side

  /// What the next windows need of this one, for a checkpoint: the DEM rank's into `grains`, that of all FEM ranks into
  /// `bodies` of the first one. Collective.
  void save(base::Columns& grains, base::Columns& bodies) const;
  void restore(const base::Columns& grains, const base::Columns& bodies);

 private:
  void restore_ends(const base::Columns& grains);

  struct Impulse {   // on the grains in one window
    base::Vec3 sum;  // [N s]
    double all = 0;  // [N s] sum of |nodal impulse|
  };
  struct Spent {
    double seconds = 0, waited = 0;  // [s]
  };

  const Roles& roles_;
  Interface is_;
  std::vector<std::vector<double>> mobility_;
  std::unique_ptr<BodyEnd> bodies_;    // FEM ranks
  std::unique_ptr<GrainEnd> own_end_;  // the DEM rank, when it is the only one
  dem::Simulation* grains_ = nullptr;  // the DEM rank
  SlabSimulation* parts_ = nullptr;
  Impulse given_, given_before_;  // of the last window and the one before it (DEM rank)
  double momentum_error_ = 0, seconds_ = 0, waited_ = 0;
  std::vector<Spent> spent_;  // by part, in this life of the run
};

}  // namespace coupling
