#include "coupling/checkpoint.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <charconv>

#include "base/version.hpp"
#include "coupling/agree.hpp"
#include "coupling/column_file.hpp"
#include "coupling/scene_changes.hpp"

namespace coupling {
namespace {

namespace fs = std::filesystem;

constexpr int column_tag = 41;

/// NNNN of checkpoint-NNNN.h5; -1: another file.
int number_of(const fs::path& file) {
  constexpr std::string_view head = "checkpoint-", tail = ".h5";
  const std::string name = file.filename().string();
  if (!name.starts_with(head) || !name.ends_with(tail) || name.size() <= head.size() + tail.size()) return -1;
  int number = -1;
  const char *first = name.data() + head.size(), *last = name.data() + name.size() - tail.size();
  const auto [end, error] = std::from_chars(first, last, number);
  return error == std::errc() && end == last ? number : -1;
}

fs::path named(const fs::path& directory, int number) {
  return directory / fmt::format("checkpoint-{:04d}.h5", number);
}

/// Throws base::UserError unless a run of this scene may go on from these columns.
void require_fit(const fs::path& file, const base::Columns& columns, const Scene& scene) {
  const auto& format = base::column<std::vector<int>>(columns, "run/format");
  const auto& version = base::column<std::string>(columns, "run/code_version");
  base::require_user(
      format == std::vector{checkpoint_format} && version == base::code_version(),
      fmt::format("{}: written by Trackbed {}{}, this is {}; restart with that version, or start a new "
                  "run without --restart",
                  file.string(), version.empty() ? "of another kind" : version,
                  format.size() == 1 ? fmt::format(", format {}", format[0]) : "", base::code_version()));
  const auto changes =
      changed_values(base::column<std::string>(columns, "run/scene_values"), scene_values(scene.resolved_toml));
  base::require_user(
      changes.empty(),
      fmt::format("{}: the scene is not the one that this run was started with: {}; restart with the scene as it was "
                  "(scene.resolved.toml in the run directory), or start a new run without --restart",
                  file.string(), fmt::join(changes, "; ")));
}

fs::path newest_sound(const std::vector<fs::path>& files) {
  for (std::size_t k = 0; k + 1 < files.size(); ++k) {
    try {
      read_columns(files[k], "");
      return files[k];
    } catch (const DamagedFile& damage) {
      spdlog::warn("{}; taking the one before", damage.what());
    }
  }
  return files.back();
}

/// The file that --restart means; empty: none.
fs::path choose(const std::string& asked, const fs::path& run_directory) {
  if (asked == "auto") {
    const auto files = checkpoints_in(run_directory);
    return files.empty() ? fs::path() : newest_sound(files);
  }
  std::error_code ignored;
  if (!fs::is_directory(asked, ignored)) return asked;
  const auto files = checkpoints_in(asked);
  base::require_user(!files.empty(),
                     fmt::format("--restart {}: the folder holds no checkpoint-NNNN.h5; name another, or "
                                 "start a new run without --restart",
                                 asked));
  return newest_sound(files);
}

std::string broadcast(std::string text, MPI_Comm communicator) {
  int length = static_cast<int>(text.size());
  MPI_Bcast(&length, 1, MPI_INT, 0, communicator);
  text.resize(static_cast<std::size_t>(length));
  MPI_Bcast(text.data(), length, MPI_CHAR, 0, communicator);
  return text;
}

/// In pieces that MPI can count.
template <class Transfer>
void in_pieces(std::size_t bytes, const Transfer& transfer) {
  constexpr std::size_t largest = 1 << 30;
  for (std::size_t first = 0; first < bytes; first += largest)
    transfer(first, static_cast<int>(std::min(largest, bytes - first)));
}

}  // namespace

void add_group(base::Columns& all, const std::string& group, base::Columns part) {
  for (auto& [name, column] : part) all[group + name] = std::move(column);
}

base::Columns group_of(const base::Columns& all, const std::string& group) {
  base::Columns part;
  for (auto known = all.lower_bound(group); known != all.end() && known->first.starts_with(group); ++known)
    part[known->first.substr(group.size())] = known->second;
  return part;
}

void send_columns(const base::Columns& columns, int to, MPI_Comm communicator) {
  int count = static_cast<int>(columns.size());
  MPI_Send(&count, 1, MPI_INT, to, column_tag, communicator);
  for (const auto& [name, column] : columns) {
    std::visit(
        [&](const auto& values) {
          const std::int64_t header[3] = {static_cast<std::int64_t>(name.size()),
                                          static_cast<std::int64_t>(column.index()),
                                          static_cast<std::int64_t>(values.size())};
          MPI_Send(header, 3, MPI_INT64_T, to, column_tag, communicator);
          MPI_Send(name.data(), static_cast<int>(name.size()), MPI_CHAR, to, column_tag, communicator);
          const auto* bytes = reinterpret_cast<const char*>(values.data());
          in_pieces(values.size() * sizeof values[0], [&](std::size_t first, int length) {
            MPI_Send(bytes + first, length, MPI_BYTE, to, column_tag, communicator);
          });
        },
        column);
  }
}

base::Columns receive_columns(int from, MPI_Comm communicator) {
  const std::array<base::Column, std::variant_size_v<base::Column>> kinds{
      std::vector<double>(), std::vector<float>(), std::vector<int>(), std::vector<std::int64_t>(), std::string()};
  const auto receive = [&](void* to, int count, MPI_Datatype type) {
    MPI_Recv(to, count, type, from, column_tag, communicator, MPI_STATUS_IGNORE);
  };
  base::Columns columns;
  int count = 0;
  receive(&count, 1, MPI_INT);
  for (int k = 0; k < count; ++k) {
    std::int64_t header[3];
    receive(header, 3, MPI_INT64_T);
    std::string name(static_cast<std::size_t>(header[0]), ' ');
    receive(name.data(), static_cast<int>(name.size()), MPI_CHAR);
    base::Column& column = columns[name] = kinds[static_cast<std::size_t>(header[1])];
    std::visit(
        [&](auto& values) {
          values.resize(static_cast<std::size_t>(header[2]));
          auto* bytes = reinterpret_cast<char*>(values.data());
          in_pieces(values.size() * sizeof values[0],
                    [&](std::size_t first, int length) { receive(bytes + first, length, MPI_BYTE); });
        },
        column);
  }
  return columns;
}

void CheckpointFolder::write(base::Columns columns, const Scene& scene) {
  columns["run/format"] = std::vector{checkpoint_format};
  columns["run/code_version"] = std::string(base::code_version());
  columns["run/scene_values"] = scene_values(scene.resolved_toml);
  const fs::path file = named(directory_, number_ + 1);
  write_columns(file, columns);
  last_ = file;
  ++number_;
  std::error_code ignored;
  fs::remove(named(directory_, number_ - 2), ignored);
}

void CheckpointFolder::go_on_from(const fs::path& checkpoint) {
  last_ = checkpoint;
  number_ = std::max(0, number_of(checkpoint));
  std::error_code ignored;
  for (const fs::path& file : checkpoints_in(directory_))
    if (number_of(file) > number_) fs::remove(file, ignored);
}

std::vector<fs::path> checkpoints_in(const fs::path& directory) {
  std::vector<fs::path> files;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(directory, ignored))
    if (number_of(entry.path()) >= 0) files.push_back(entry.path());
  std::ranges::sort(files, std::greater<>(), number_of);
  return files;
}

std::optional<Restart> find_restart(const RunOptions& options, const Scene& scene, const Roles& roles,
                                    const fs::path& run_directory) {
  if (options.restart.empty()) return std::nullopt;
  Restart restart;
  std::string file;
  agree(roles.world, [&] {
    base::require_user(!scene.is_modal(), fmt::format("{}: a modal scene has no steps to go on with; run it without "
                                                      "--restart",
                                                      scene.file.string()));
    if (!roles.is_root()) return;
    restart.file = choose(options.restart, run_directory);
    file = restart.file.string();
    if (file.empty()) return;
    restart.columns = read_columns(restart.file, "");
    require_fit(restart.file, restart.columns, scene);
  });
  file = broadcast(file, roles.world);
  if (file.empty()) return std::nullopt;
  agree(roles.world, [&] {
    if (roles.is_root()) return;
    restart.file = file;
    add_group(restart.columns, "run/", read_columns(restart.file, "run/"));
    add_group(restart.columns, "bodies/", read_columns(restart.file, "bodies/"));
  });
  return restart;
}

}  // namespace coupling
