#include "coupling/run_files.hpp"

#include <fmt/core.h>
#include <fmt/format.h>
#include <unistd.h>

#include "base/error.hpp"

namespace coupling {

namespace fs = std::filesystem;

void check_run_directory(const fs::path& directory, bool overwrite) {
  const std::string head = fmt::format("--out {}: ", directory.string());
  std::error_code error;
  if (fs::exists(directory, error)) {
    base::require_user(fs::is_directory(directory), head + "is a file; name a folder");
    const bool empty = fs::is_empty(directory, error);
    base::require_user(!error, head + "no permission to read it; choose a folder of yours");
    base::require_user(overwrite || empty,
                       head +
                           "the folder exists; nothing was written; give another --out, or --overwrite to replace the "
                           "run in it");
    base::require_user(empty || fs::exists(directory / "scene.resolved.toml"),
                       head +
                           "holds no Trackbed run (no scene.resolved.toml), so --overwrite will not empty it; remove "
                           "it yourself or give another --out");
    base::require_user(access(directory.c_str(), W_OK | X_OK) == 0,
                       head + "no permission to write there; choose a folder of yours");
    return;
  }
  const fs::path above = fs::absolute(directory).lexically_normal().parent_path();
  for (fs::path place = above;; place = place.parent_path()) {  // the nearest folder that exists must take new ones
    if (fs::exists(place, error)) {
      base::require_user(fs::is_directory(place) && access(place.c_str(), W_OK | X_OK) == 0,
                         fmt::format("{}cannot be made in {} (Permission denied); choose a place you may write to",
                                     head, place.string()));
      return;
    }
    if (place == place.parent_path()) return;
  }
}

namespace {

/// What a run leaves behind beside checkpoints, log and summary: tables, and each .pvd with the folder of its data.
std::vector<fs::path> results_in(const fs::path& directory) {
  std::vector<fs::path> results;
  for (const auto& entry : fs::directory_iterator(directory)) {
    const fs::path& path = entry.path();
    const std::string name = path.filename().string();
    if (path.extension() == ".pvd" && fs::exists(directory / path.stem())) results.push_back(directory / path.stem());
    if (path.extension() == ".pvd" || name == "scene.resolved.toml" || name == "history.csv" ||
        name == "sieve_curve.csv" || name == "spectra.csv" || name == "contact_forces.csv")
      results.push_back(path);
  }
  return results;
}

void remove_run(const fs::path& directory) {
  std::error_code error;
  std::vector<fs::path> gone = results_in(directory);
  gone.insert(gone.end(), {directory / "pictures", directory / "summary.json", directory / "run.log"});
  for (const auto& entry : fs::directory_iterator(directory)) {
    const std::string name = entry.path().filename().string();
    if (name.ends_with(".part") || (name.starts_with("checkpoint-") && name.ends_with(".h5")))
      gone.push_back(entry.path());
  }
  for (const fs::path& path : gone) {
    fs::remove_all(path, error);
    if (error) throw base::MachineError(fmt::format("{}: cannot be removed ({})", path.string(), error.message()));
  }
}

}  // namespace

void copy_results(const fs::path& from, const fs::path& to) {
  for (const fs::path& path : results_in(from)) {
    std::error_code error;
    fs::copy(path, to / path.filename(), fs::copy_options::recursive | fs::copy_options::overwrite_existing, error);
    if (error) throw base::MachineError(fmt::format("{}: cannot be copied ({})", path.string(), error.message()));
  }
}

void make_run_directory(const fs::path& directory, bool overwrite) {
  check_run_directory(directory, overwrite);
  std::error_code error;
  if (fs::exists(directory, error)) return remove_run(directory);
  fs::create_directories(directory, error);
  base::require_user(!error, fmt::format("--out {}: cannot be made ({}); choose a place you may write to",
                                         directory.string(), error.message()));
}

void write_file(const fs::path& path, const std::string& text) {
  const fs::path temporary = path.string() + ".part";
  {
    std::ofstream file(temporary, std::ios::binary);
    file << text;
    file.flush();
    if (!file) throw base::MachineError(fmt::format("{}: cannot be written; is the disk full?", temporary.string()));
  }
  std::error_code error;
  fs::rename(temporary, path, error);
  if (error) throw base::MachineError(fmt::format("{}: cannot be written ({})", path.string(), error.message()));
}

HistoryFile::HistoryFile(const fs::path& path, std::span<const std::string> columns) : path_(path), file_(path) {
  file_ << fmt::format("{}\n", fmt::join(columns, ","));
  if (!file_.flush()) throw base::MachineError(fmt::format("{}: cannot be written; is the disk full?", path.string()));
}

HistoryFile::HistoryFile(const fs::path& path, std::uintmax_t kept) : path_(path) {
  std::error_code error;
  const std::uintmax_t there = fs::file_size(path, error);
  base::require_user(!error && there >= kept,
                     fmt::format("{}: {} bytes, the checkpoint was written after {}; put the file back, or start a new "
                                 "run without --restart",
                                 path.string(), error ? 0 : there, kept));
  fs::resize_file(path, kept, error);
  if (!error) file_.open(path, std::ios::app);
  if (error || !file_) throw base::MachineError(fmt::format("{}: cannot be written", path.string()));
}

std::uintmax_t HistoryFile::size() {
  file_.seekp(0, std::ios::end);
  return static_cast<std::uintmax_t>(file_.tellp());
}

void HistoryFile::row(std::span<const double> values) {
  file_ << fmt::format("{:.12g}\n", fmt::join(values, ","));
  if (!file_.flush()) throw base::MachineError(fmt::format("{}: cannot be written; is the disk full?", path_.string()));
}

}  // namespace coupling
