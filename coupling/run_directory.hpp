#pragma once
// A finished run as `trackbed render` finds it: what its files say, without drawing anything.
#include <filesystem>
#include <string>
#include <vector>

namespace coupling {

/// One column of history.csv. Its header cell reads `name [unit]`.
struct HistoryColumn {
  std::string name, unit;
  std::vector<double> values;
};

/// history.csv: the probes over time. Empty when the run has none.
struct HistoryTable {
  std::vector<HistoryColumn> columns;  // the first is `time [s]`; all have the same number of values
  bool empty() const { return columns.empty() || columns.front().values.empty(); }
  const std::vector<double>& time() const { return columns.front().values; }
};

/// Rows that end with their line. Throws base::UserError with file:line when one does not fit the header or a cell is
/// no number.
HistoryTable read_history(const std::filesystem::path& csv);

/// One instant of a .pvd collection.
struct TimeLevel {
  double time = 0;             // [s]
  std::filesystem::path file;  // absolute, or relative to where the collection's own path is
};

/// Throws base::UserError when the file is no collection.
std::vector<TimeLevel> read_pvd(const std::filesystem::path& pvd);

struct BodySeries {
  std::string name;
  std::vector<TimeLevel> levels;
};

/// One line of the results table: everything as it is to be shown.
struct ResultLine {
  std::string name, value, unit, expected, source, relative_error;
};

struct RunDirectory {
  std::filesystem::path path;
  std::string title;                 // of the scene; the folder's name when there is no summary
  std::vector<std::string> remarks;  // one line each: how the run ended, how long it took …
  std::vector<ResultLine> results;
  HistoryTable history;
  std::vector<TimeLevel> grains, contacts;
  std::vector<BodySeries> bodies;  // by name
};

/// Reads what is there; parts that a scene does not have may be missing.
/// Throws base::UserError when the folder does not exist or holds neither a summary, nor probes, nor pictures of a
/// state.
RunDirectory open_run_directory(const std::filesystem::path&);

/// The level nearest in time.
const TimeLevel& nearest_level(const std::vector<TimeLevel>&, double time);

/// The moment of a run that is worth a picture: of the levels written (grains, else the first body), the one at which
/// the load is largest. The load is the first column of history.csv in newton whose name contains `load`; without one,
/// the first column in metre whose name contains `settlement`, `displacement` or `tip`; without either: the last level.
struct Moment {
  double time = 0;   // [s]
  std::string text;  // "seat_load = 36.2 kN", or empty
};
Moment peak_moment(const RunDirectory&);

/// Value at a time, linear between rows.
double value_at(const HistoryTable&, const HistoryColumn&, double time);

/// A readable multiple of an SI unit for values up to `largest`: factor to multiply with and the name to print. A
/// `share` is shown in per cent; a bare number (`-`, `1`) has no unit to print.
struct ShownUnit {
  double factor = 1;
  std::string name;
};
ShownUnit readable_unit(const std::string& si_unit, double largest);

/// "peak settlement" from "peak_settlement".
std::string spaced(std::string name);

}  // namespace coupling
