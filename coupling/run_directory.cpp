#include "coupling/run_directory.hpp"

#include <fmt/format.h>
#include <vtkSmartPointer.h>
#include <vtkXMLDataElement.h>
#include <vtkXMLUtilities.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <initializer_list>
#include <map>
#include <nlohmann/json.hpp>
#include <string_view>

#include "base/error.hpp"

namespace coupling {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t' || text.back() == '\r')) text.remove_suffix(1);
  return text;
}

std::vector<std::string_view> cells_of(std::string_view line) {
  std::vector<std::string_view> cells;
  for (std::size_t start = 0; start <= line.size();) {
    const std::size_t comma = std::min(line.find(',', start), line.size());
    cells.push_back(trimmed(line.substr(start, comma - start)));
    start = comma + 1;
  }
  return cells;
}

HistoryColumn column_of(std::string_view header) {
  const std::size_t open = header.rfind('[');
  if (open == std::string_view::npos || header.back() != ']') return {std::string(header), "", {}};
  return {std::string(trimmed(header.substr(0, open))),
          std::string(trimmed(header.substr(open + 1, header.size() - open - 2))),
          {}};
}

bool contains(const std::string& name, std::initializer_list<const char*> words) {
  return std::any_of(words.begin(), words.end(),
                     [&](const char* word) { return name.find(word) != std::string::npos; });
}

double largest_magnitude(const std::vector<double>& values) {
  double largest = 0;
  for (double value : values)
    if (std::isfinite(value)) largest = std::max(largest, std::abs(value));
  return largest;
}

/// A number of summary.json, or the pair of a range, or a text, as it is to be shown.
std::string shown(const json& value) {
  if (value.is_number()) return fmt::format("{:.5g}", value.get<double>());
  if (value.is_string()) return value.get<std::string>();
  if (value.is_array() && value.size() == 2) return shown(value[0]) + " – " + shown(value[1]);
  return value.is_null() ? "" : value.dump();
}

std::string shown(const json& object, const char* key) {
  const auto found = object.find(key);
  return found == object.end() ? "" : shown(*found);
}

void read_summary(const fs::path& file, RunDirectory& run) {
  std::ifstream stream(file);
  const json summary = json::parse(stream, nullptr, false);
  base::require_user(summary.is_object(), file.string() + ": no JSON object; was the run cut off while writing it?");
  if (const auto title = summary.find("title"); title != summary.end()) {
    run.title = shown(*title);
  } else if (const auto scene = summary.find("scene"); scene != summary.end()) {
    run.title = fs::path(shown(*scene)).stem().string();
  }
  const auto remark = [&](const char* words, std::string value) {
    if (!value.empty()) run.remarks.push_back(fmt::format("{}: {}", words, value));
  };
  remark("status", shown(summary, "status"));
  remark("simulated time [s]", shown(summary, "time_simulated_s"));
  remark("wall time [s]", shown(summary, "wall_s"));
  remark("grains", shown(summary, "grains"));
  remark("elements", shown(summary, "elements"));
  remark("ranks", shown(summary, "ranks"));
  remark("backend", shown(summary, "backend"));
  if (const auto energy = summary.find("energy"); energy != summary.end() && energy->is_object())
    remark("relative energy error", shown(*energy, "relative_error"));
  remark("momentum error", shown(summary, "momentum_error"));

  const auto results = summary.find("results");
  if (results == summary.end() || !results->is_object()) return;
  for (const auto& [name, result] : results->items()) {
    if (!result.is_object()) continue;
    ResultLine line{
        name, shown(result, "value"), shown(result, "unit"), shown(result, "expected"), shown(result, "source"), ""};
    if (line.expected.empty()) line.expected = shown(result, "expected_range");
    const auto error = result.find("relative_error");
    if (error != result.end() && error->is_number())
      line.relative_error = fmt::format("{:+.2f} %", 100 * error->get<double>());
    run.results.push_back(line);
  }
}

}  // namespace

HistoryTable read_history(const fs::path& csv) {
  HistoryTable table;
  std::ifstream stream(csv);
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    if (stream.eof()) break;  // torn: its run was killed, or is writing it
    if (trimmed(line).empty() || line.front() == '#') continue;
    const auto cells = cells_of(line);
    if (table.columns.empty()) {
      for (const auto& cell : cells) table.columns.push_back(column_of(cell));
      continue;
    }
    base::require_user(
        cells.size() == table.columns.size(),
        fmt::format("{}:{}: {} cells; the header has {}", csv.string(), number, cells.size(), table.columns.size()));
    for (std::size_t i = 0; i < cells.size(); ++i) {
      double value = 0;
      const char* end = cells[i].data() + cells[i].size();
      const auto [stop, failure] = std::from_chars(cells[i].data(), end, value);
      base::require_user(
          failure == std::errc{} && stop == end,
          fmt::format("{}:{}: {} = '{}'; must be a number", csv.string(), number, table.columns[i].name, cells[i]));
      table.columns[i].values.push_back(value);
    }
  }
  return table;
}

std::vector<TimeLevel> read_pvd(const fs::path& pvd) {
  vtkObject::GlobalWarningDisplayOff();  // a broken file is reported below, in our words
  const auto root = vtkSmartPointer<vtkXMLDataElement>::Take(vtkXMLUtilities::ReadElementFromFile(pvd.c_str()));
  vtkObject::GlobalWarningDisplayOn();
  vtkXMLDataElement* collection = root ? root->FindNestedElementWithName("Collection") : nullptr;
  base::require_user(collection != nullptr, pvd.string() + ": no VTK collection (.pvd)");
  std::vector<TimeLevel> levels;
  for (int i = 0; i < collection->GetNumberOfNestedElements(); ++i) {
    vtkXMLDataElement* entry = collection->GetNestedElement(i);
    TimeLevel level;
    const char* file = entry->GetAttribute("file");
    if (file == nullptr || entry->GetScalarAttribute("timestep", level.time) == 0) continue;
    level.file = pvd.parent_path() / file;
    levels.push_back(level);
  }
  return levels;
}

RunDirectory open_run_directory(const fs::path& path) {
  base::require_user(fs::is_directory(path), path.string() + ": no such folder; give the folder of a finished run");
  RunDirectory run;
  run.path = path;
  run.title = fs::absolute(path / "").parent_path().filename().string();
  const bool has_summary = fs::exists(path / "summary.json");
  if (has_summary) read_summary(path / "summary.json", run);
  if (fs::exists(path / "history.csv")) run.history = read_history(path / "history.csv");
  std::map<std::string, fs::path> collections;
  for (const auto& entry : fs::directory_iterator(path))
    if (entry.path().extension() == ".pvd") collections[entry.path().stem().string()] = entry.path();
  for (const auto& [name, file] : collections) {
    auto levels = read_pvd(file);
    std::erase_if(levels, [](const TimeLevel& level) { return !fs::exists(level.file); });
    if (levels.empty()) continue;
    if (name == "grains")
      run.grains = levels;
    else if (name == "contacts")
      run.contacts = levels;
    else
      run.bodies.push_back({name, levels});
  }
  base::require_user(has_summary || !run.history.empty() || !run.grains.empty() || !run.bodies.empty(),
                     path.string() +
                         ": holds no run (no summary.json, history.csv, grains.pvd or <body>.pvd); "
                         "make one with `trackbed run SCENE --out " +
                         path.string() + "`");
  return run;
}

const TimeLevel& nearest_level(const std::vector<TimeLevel>& levels, double time) {
  base::require_internal(!levels.empty(), "nearest_level: no levels");
  return *std::min_element(levels.begin(), levels.end(), [&](const TimeLevel& a, const TimeLevel& b) {
    return std::abs(a.time - time) < std::abs(b.time - time);
  });
}

double value_at(const HistoryTable& table, const HistoryColumn& column, double time) {
  const auto& times = table.time();
  const auto after = std::lower_bound(times.begin(), times.end(), time);
  if (after == times.begin()) return column.values.front();
  if (after == times.end()) return column.values.back();
  const auto i = static_cast<std::size_t>(after - times.begin());
  const double span = times[i] - times[i - 1];
  const double share = span > 0 ? (time - times[i - 1]) / span : 1;
  return column.values[i - 1] + share * (column.values[i] - column.values[i - 1]);
}

Moment peak_moment(const RunDirectory& run) {
  const auto& levels = !run.grains.empty() || run.bodies.empty() ? run.grains : run.bodies.front().levels;
  if (levels.empty()) return {};
  Moment moment{levels.back().time, ""};
  if (run.history.empty()) return moment;
  const auto first = [&](const char* unit, std::initializer_list<const char*> words) -> const HistoryColumn* {
    for (const auto& column : run.history.columns)
      if (column.unit == unit && contains(column.name, words) && largest_magnitude(column.values) > 0) return &column;
    return nullptr;
  };
  const HistoryColumn* measure = first("N", {"load"});
  if (measure == nullptr) measure = first("m", {"settlement", "displacement", "tip"});
  if (measure == nullptr) return moment;
  double largest = -1;
  for (const auto& level : levels) {
    const double value = std::abs(value_at(run.history, *measure, level.time));
    // A load that stays (a step) is pictured as late as possible: >= would do, but for rounding of equal values.
    if (value < largest * (1 - 1e-9) || !std::isfinite(value)) continue;
    largest = std::max(largest, value);
    moment.time = level.time;
  }
  const auto unit = readable_unit(measure->unit, largest);
  moment.text = fmt::format("{} = {:.3g} {}", spaced(measure->name),
                            value_at(run.history, *measure, moment.time) * unit.factor, unit.name);
  return moment;
}

ShownUnit readable_unit(const std::string& si_unit, double largest) {
  if (si_unit == "m")
    return largest < 1e-3 ? ShownUnit{1e6, "µm"} : (largest < 1 ? ShownUnit{1e3, "mm"} : ShownUnit{1, "m"});
  if (si_unit == "N" || si_unit == "Pa" || si_unit == "J") {
    if (largest >= 1e6) return {1e-6, "M" + si_unit};
    if (largest >= 1e3) return {1e-3, "k" + si_unit};
    if (si_unit == "J" && largest > 0 && largest < 0.1) return {1e3, "mJ"};
  }
  if (si_unit == "share") return {100, "%"};
  if (si_unit == "-" || si_unit == "1") return {1, ""};
  if (si_unit == "m/s2" || si_unit == "m/s^2") return {1, "m/s²"};
  return {1, si_unit};
}

std::string spaced(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

}  // namespace coupling
