#pragma once
// `trackbed run`: packing, stages, coupling windows, output, summary.
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "coupling/roles.hpp"
#include "coupling/scene.hpp"

namespace coupling {

struct RunOptions {
  std::filesystem::path scene;
  std::optional<std::filesystem::path> out;  // default: runs/<scene name>
  bool overwrite = false;                    // replace an existing run directory
  bool only_check = false;                   // no step will be taken
  std::vector<Override> overrides;
  std::optional<double> until;   // [s] stop early at this simulated time
  std::string backend = "auto";  // auto | omp | cuda
  int threads = 0;               // 0: chosen
  RankWishes ranks;
  std::string restart;  // a checkpoint, a folder that holds some, or `auto`; empty: from the start
};

/// Collective over MPI_COMM_WORLD. Throws the same base:: error on every rank.
void run(const RunOptions&);

}  // namespace coupling
