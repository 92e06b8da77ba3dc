#pragma once
// A DEM part's end of the exchange (body_end.hpp has the messages), on every rank with grains.
//
// The part names, per skin, an interval along x whose nodes it is told of. It is wider than where its grains are or may
// come to (dem::Reach) by one and a half margins on either side, a margin being two of the largest grain's radius and
// four times what the fastest grain and the skin go in a window; where less than half a margin or more than three are
// left after a window, a new interval goes out with the impulses and holds from the next window on. Facets beyond it
// are dead to the part, so that no grain ever feels a place that is out of date; and grains that come nearer to them
// than a quarter of a margin stop the run (dem::Simulation::keep_within()). The first interval is the whole line;
// in one process it stays so.
#include <mpi.h>

#include "coupling/skin_share.hpp"
#include "dem/dem.hpp"

namespace coupling {

struct WindowOrder {
  int steps = 0;
  double dt = 0;         // [s]
  bool refused = false;  // the crew cannot go on: the bodies are told so instead
};

/// What one part has to say of a window.
struct WindowReport {
  bool alive = false;              // nobody among the bodies has failed
  base::Vec3 applied;              // [N s] by the bodies in the window before, all of them
  base::Vec3 given;                // [N s] on the grains of this part
  double all = 0;                  // [N s] sum of |nodal impulse|
  double seconds = 0, waited = 0;  // [s] so far: packing and unpacking; waiting for bodies
};

/// What has passed between a part and each FEM rank.
struct PairTraffic {
  std::vector<int> nodes;     // that they share now
  std::vector<double> bytes;  // in all windows, both ways
};

class GrainEnd {
 public:
  GrainEnd(Interface, MPI_Comm joint, int dem_ranks, std::vector<int> walls);
  ~GrainEnd();
  GrainEnd(const GrainEnd&) = delete;
  GrainEnd& operator=(const GrainEnd&) = delete;

  /// Skins in, steps, impulses out. Throws what the steps throw, after the bodies have been told.
  WindowReport window(dem::Simulation&, const WindowOrder&);
  PairTraffic traffic() const;

  /// What the next window depends on. intervals_of(): the part of it that the bodies need too.
  std::vector<double> save() const;
  void restore(const std::vector<double>&);
  static constexpr std::size_t saved_numbers(std::size_t skins) { return 6 * skins + 1; }
  static std::vector<std::array<Interval, 2>> intervals_of(const std::vector<double>& saved, std::size_t skins);

 private:
  struct Peer {
    int rank = 0;
    std::vector<SharedNodes> shared{};                  // per skin
    std::vector<const double*> place{}, fresh_place{};  // per skin, in `in`
    std::vector<double> out{}, in{};
    double bytes = 0;
    bool sound = true;
    MPI_Request out_request = MPI_REQUEST_NULL, in_request = MPI_REQUEST_NULL;
  };
  bool receive();
  void take(dem::Simulation&);
  void know_nodes(dem::Simulation&);
  std::vector<Interval> choose_next(const dem::Simulation&, double window);
  void pack(const dem::Simulation&, const std::vector<Interval>& next);
  void send(bool failed);
  void finish();
  void share();

  const Interface is_;
  MPI_Comm joint_;
  std::vector<int> walls_;
  bool lone_;
  std::vector<std::vector<Interval>> reaches_;  // per skin and node
  std::vector<Peer> peers_;
  std::vector<Interval> before_, now_, moved_;  // per skin; moved_: [m] at the end of the last window
  std::vector<Interval> whole_;                 // per skin: as far as any facet reaches, undeformed
  double skin_way_ = 0;                         // [m] farthest that a skin has gone along x in this window
  double margin_ = 0;                           // [m]
  bool changed_ = true;                         // other nodes than in the window before
  std::vector<std::vector<base::Vec3>> positions_, velocities_, impulses_;  // per skin, whole
  WindowReport report_;
};

}  // namespace coupling
