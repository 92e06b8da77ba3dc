#pragma once
// Checkpoints of a run: checkpoint-NNNN.h5 in its folder, the last two of them, each with everything that the steps to
// come and the results depend on. A checkpoint is taken right after a window, before what the window's end calls for
// (rows, pictures, the next stage): that is done again when the run goes on. Taking one leaves no trace in the run, so
// that a run that was interrupted anywhere and restarted on as many ranks and threads repeats the uninterrupted one bit
// for bit. One file for all ranks, written by the root: the grains' columns under `grains/`, the bodies', gathered by
// global numbers on the first FEM rank, under `bodies/`, the run's own under `run/`.
#include <filesystem>
#include <optional>
#include <string>

#include "base/columns.hpp"
#include "coupling/roles.hpp"
#include "coupling/run.hpp"

namespace coupling {

/// Raise it whenever columns change their meaning.
constexpr int checkpoint_format = 3;

/// All of `part` into `all`, under the group's name; and back.
void add_group(base::Columns& all, const std::string& group, base::Columns part);
base::Columns group_of(const base::Columns& all, const std::string& group);

/// Columns from one rank to another.
void send_columns(const base::Columns&, int to, MPI_Comm);
base::Columns receive_columns(int from, MPI_Comm);

/// The checkpoints of one run directory; on the root.
class CheckpointFolder {
 public:
  explicit CheckpointFolder(std::filesystem::path directory) : directory_(std::move(directory)) {}
  /// Adds format, code version and the scene's values, writes the next file, removes the last but two.
  void write(base::Columns, const Scene&);
  /// The run goes on from this one; what an earlier life wrote after it goes.
  void go_on_from(const std::filesystem::path& checkpoint);
  /// The last one written or gone on from; empty: none yet.
  const std::filesystem::path& last() const { return last_; }

 private:
  std::filesystem::path directory_, last_;
  int number_ = 0;
};

/// The checkpoints in a folder, the newest first.
std::vector<std::filesystem::path> checkpoints_in(const std::filesystem::path& directory);

struct Restart {
  std::filesystem::path file;
  base::Columns columns;  // the root has all, FEM ranks have those of the bodies, every rank has the run's
};

/// What --restart asks for: a file, a folder (its newest checkpoint that can be read), or `auto` (the run directory's,
/// if it has any; else nothing). Collective. Throws base::UserError on every rank when the checkpoint does not fit:
/// another format, version or backend, other values of the scene.
std::optional<Restart> find_restart(const RunOptions&, const Scene&, const Roles&,
                                    const std::filesystem::path& run_directory);

}  // namespace coupling
