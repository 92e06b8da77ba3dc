#pragma once
// summary.json: what a run was, did and found, for programs; the end table is for people.
#include <chrono>
#include <map>
#include <span>
#include <string>

#include "coupling/grain_end.hpp"
#include "coupling/ledger.hpp"
#include "coupling/packing.hpp"
#include "coupling/results.hpp"

namespace coupling {

struct Summary {
  std::string scene, title, status = "failed", message;   // status: completed | unstable | failed
  double time_simulated = 0, wall = 0, packing_wall = 0;  // [s]
  double earlier_wall = 0;                                // [s] before the run was restarted
  std::chrono::steady_clock::time_point begun = std::chrono::steady_clock::now();
  std::string restarted_from;                   // checkpoint; empty: from the start
  int ranks = 1, dem_ranks = 0, fem_ranks = 0;  // a lone rank may be of both kinds
  int threads = 1;                              // of every DEM rank
  std::string backend, device, precision = "double";
  std::string solver;                 // of the bodies; empty without any
  std::vector<fem::BodyModes> modes;  // of a modal scene
  std::int64_t grains = 0, spheres = 0, elements = 0;
  std::int64_t dem_steps = 0, fem_steps = 0, windows = 0;
  double dem_dt = 0, fem_dt = 0;  // [s]
  std::string dem_limiter, fem_limiter;
  std::string coupling_limiter, window_limiter;  // of the live contacts: DEM step, and window
  std::map<std::string, double> seconds;         // dem, fem, exchange, waiting, output [s]
  double momentum_error = 0;
  std::int64_t skin_nodes = 0;       // of coupled scenes
  std::vector<PairTraffic> traffic;  // by DEM ranks, in this life of the run
  bool measured = false;             // the ledger covers something
  Ledger ledger;
  double porosity = 0, coordination = 0;  // of the packing
  double porosity_asked = 0, packing_friction = 0;
  std::vector<PackingStep> packing_steps;
  bool packed = false, packing_from_cache = false;
  std::size_t dem_bytes = 0;

  double wall_so_far() const {
    return earlier_wall + std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  }
};

/// The text of summary.json.
std::string to_json(const Summary&, std::span<const Outcome>);

}  // namespace coupling
