#pragma once
// From a scene file to the two sides ready to step: everything that can be refused is refused here, before anything is
// written.
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "base/columns.hpp"
#include "coupling/exchange.hpp"
#include "coupling/roles.hpp"
#include "coupling/run.hpp"
#include "coupling/scene.hpp"
#include "coupling/slab_server.hpp"
#include "coupling/summary.hpp"
#include "coupling/window.hpp"

namespace coupling {

struct Restart;

class Setup {
 public:
  /// Reads and checks the scene, splits the ranks, meshes the bodies. Collective; throws the same error on every rank.
  /// A worker has nothing but scene and roles afterwards.
  Setup(MPI_Comm all, const RunOptions&);
  ~Setup();
  Setup(const Setup&) = delete;
  Setup& operator=(const Setup&) = delete;

  /// Packs or places the grains, adds the walls, chooses the steps. Collective.
  void place_grains(Summary&);
  /// Instead of that: both sides go on from a checkpoint. Collective.
  void restore(const Restart&, Summary&);
  /// What a checkpoint needs beside the two sides' states: steps, walls, what the summary says of the packing.
  void save(base::Columns& run, const Summary&) const;

  /// Longest DEM step [s] wanted: the hand-set one, or the fraction of the Rayleigh limit.
  double wanted_dem_step() const;
  void look_at_the_start();
  /// The window with no DEM step and no whole longer than these [s]. The same on every rank if these are.
  void choose_window(double longest_step = std::numeric_limits<double>::infinity(),
                     double longest_window = std::numeric_limits<double>::infinity());
  /// Implicit bodies: the longest step wanted that goes into this time [s] a whole number of times.
  void fit_to(double duration);
  /// Without a partner a side has nobody to wait for: as many steps go into the next window as fill this time [s].
  void aim_at(double duration);

  Scene scene;
  RunOptions options;
  std::unique_ptr<Roles> roles;
  std::unique_ptr<fem::Library> library;    // FEM ranks
  std::unique_ptr<fem::Model> bodies;       // FEM ranks
  std::unique_ptr<Exchange> exchange;       // coupled scenes
  std::unique_ptr<SlabCrew> slabs;          // DEM rank, when there are others
  std::unique_ptr<dem::Simulation> grains;  // DEM rank
  dem::Backend backend = dem::Backend::omp;
  std::string backend_text;                  // where grains run, if that needs saying; on ranks with grains
  std::string device;                        // the GPU of the first rank with grains; empty: none used
  int threads = 1;                           // of every DEM rank
  std::vector<base::Skin> skins;             // every rank
  std::vector<int> skin_walls;               // DEM rank: wall number of each skin
  std::vector<int> named_walls;              // DEM rank: wall number of each scene wall, -1 for packing-only ones
  std::vector<fem::BodyCounts> body_counts;  // FEM ranks
  std::string warnings;                      // of the bodies, a line each
  fem::StableStep fem_limit;                 // every rank
  dem::StableStep dem_limit;                 // DEM rank
  Window window;                             // every rank

 private:
  template <class Self, class Of, class Walk>
  static void walk(Self&, Of& summary, Walk&&);
  void make_simulation();
  MakeGrains maker() const;
  void use_threads(int);
  void choose_backend();
  void add_walls();
  int add_mesh_wall(const WallScene&);
  void report_steps() const;
};

}  // namespace coupling
