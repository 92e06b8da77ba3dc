#pragma once
// The folder a run leaves behind, and the files a run writes into it itself.
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <vector>

namespace coupling {

/// Throws base::UserError when the folder exists (unless `overwrite`, and then only when it holds an earlier run or
/// nothing) or cannot be written. Writes and removes nothing.
void check_run_directory(const std::filesystem::path&, bool overwrite);

/// Makes the folder after the same checks. With `overwrite` the files of the earlier run go; what is not a run's stays.
void make_run_directory(const std::filesystem::path&, bool overwrite);

/// Writes a whole file through a temporary name. Throws base::MachineError.
void write_file(const std::filesystem::path&, const std::string& text);

/// The pictures and tables of one run directory into another, for a run that goes on there. Throws base::MachineError.
void copy_results(const std::filesystem::path& from, const std::filesystem::path& to);

/// history.csv: a header with units, a row per sample, flushed row by row so that a killed run stays readable.
class HistoryFile {
 public:
  HistoryFile(const std::filesystem::path&, std::span<const std::string> columns);
  /// Goes on with a file after its first `kept` bytes; rows behind them go. Throws base::UserError when it is shorter.
  HistoryFile(const std::filesystem::path&, std::uintmax_t kept);
  /// Bytes written so far.
  std::uintmax_t size();
  /// Throws base::MachineError when the disk is full.
  void row(std::span<const double> values);

 private:
  std::filesystem::path path_;
  std::ofstream file_;
};

}  // namespace coupling
