#include "coupling/results.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/error.hpp"
#include "base/quantity.hpp"

namespace coupling {

namespace {

double frequency(std::span<const double> time, std::span<const double> values) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  const double level = (*low + *high) / 2;
  double first = 0, last = 0;
  int crossings = 0;
  for (std::size_t i = 1; i < values.size(); ++i)
    if (values[i - 1] < level && values[i] >= level) {
      last = time[i - 1] + (level - values[i - 1]) / (values[i] - values[i - 1]) * (time[i] - time[i - 1]);
      if (crossings++ == 0) first = last;
    }
  return crossings > 1 ? (crossings - 1) / (last - first) : std::nan("");
}

/// tau of a swing a e^(-tau t) cos(omega t) about any place: the ways from one turn to the next shrink as e^(-tau t);
/// the line through their logarithms, as far down as a thousandth of the longest. NaN with fewer than three turns.
double decay(std::span<const double> time, std::span<const double> values) {
  std::vector<double> turns, at;
  for (std::size_t i = 1; i + 1 < values.size(); ++i) {
    const double before = values[i] - values[i - 1], after = values[i + 1] - values[i];
    if (before * after >= 0) continue;
    const double shift = 0.5 * (before + after) / (before - after);  // vertex of the parabola through the three
    at.push_back(time[i] + shift * (time[i + 1] - time[i]));
    turns.push_back(values[i] + 0.25 * shift * (before + after));
  }
  double longest = 0, n = 0, t = 0, w = 0, tt = 0, tw = 0;
  for (std::size_t k = 1; k < turns.size(); ++k) longest = std::max(longest, std::abs(turns[k] - turns[k - 1]));
  for (std::size_t k = 1; k < turns.size(); ++k) {
    const double way = std::abs(turns[k] - turns[k - 1]), middle = 0.5 * (at[k] + at[k - 1]);
    if (way < 1e-3 * longest) break;
    n += 1;
    t += middle;
    w += std::log(way);
    tt += middle * middle;
    tw += middle * std::log(way);
  }
  return n > 1 ? -(n * tw - t * w) / (n * tt - t * t) : std::nan("");
}

/// Largest value before the series falls through its mid-range level for the first time.
double first_peak(std::span<const double> values) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  const double level = (*low + *high) / 2;
  double peak = values.front();
  for (const double value : values) {
    if (peak > level && value < level) break;
    peak = std::max(peak, value);
  }
  return peak;
}

double largest_magnitude(std::span<const double> values) {
  double largest = 0;
  for (const double value : values) largest = std::max(largest, std::abs(value));
  return largest;
}

/// Value when `over` first reaches the level, from either side; NaN when it never does.
double value_at(std::span<const double> values, std::span<const double> over, double level) {
  for (std::size_t i = 1; i < over.size(); ++i) {
    if ((over[i - 1] < level) == (over[i] < level)) continue;
    const double share = (level - over[i - 1]) / (over[i] - over[i - 1]);
    return values[i - 1] + share * (values[i] - values[i - 1]);
  }
  return std::nan("");
}

std::size_t probe_index(const Scene& scene, const std::string& name) {
  for (std::size_t p = 0; p < scene.probes.size(); ++p)
    if (scene.probes[p].name == name) return p;
  throw base::InternalError("result of an unknown probe");
}

}  // namespace

std::vector<double> moving_mean(std::span<const double> time, std::span<const double> values, double width) {
  std::vector<double> means;
  std::size_t first = 0, end = 0;
  double sum = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    for (; end < values.size() && time[end] <= time[i] + 0.5 * width; ++end) sum += values[end];
    for (; time[first] < time[i] - 0.5 * width; ++first) sum -= values[first];
    means.push_back(sum / static_cast<double>(end - first));
  }
  return means;
}

double take(const std::string& how, std::span<const double> time, std::span<const double> values,
            std::span<const double> over, double level) {
  if (values.empty()) return std::nan("");
  if (how == "first") return values.front();
  if (how == "last") return values.back();
  if (how == "min") return *std::min_element(values.begin(), values.end());
  if (how == "max") return *std::max_element(values.begin(), values.end());
  if (how == "first_peak") return first_peak(values);
  if (how == "rise") return *std::max_element(values.begin(), values.end()) - values.front();
  if (how == "max_abs") return largest_magnitude(values);
  if (how == "mean") return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  if (how == "range")
    return *std::max_element(values.begin(), values.end()) - *std::min_element(values.begin(), values.end());
  if (how == "frequency") return frequency(time, values);
  if (how == "decay") return decay(time, values);
  if (how == "at") return value_at(values, over, level);
  if (how == "ratio") return largest_magnitude(values) / largest_magnitude(over);
  throw base::InternalError("unknown way to take a result");
}

std::vector<Outcome> evaluate(const Scene& scene, const Series& series) {
  std::vector<Outcome> outcomes;
  if (series.time.empty()) return outcomes;  // stopped before the measured stage
  for (const auto& result : scene.results) {
    const auto& taken = series.columns[probe_index(scene, result.probe)];
    const auto values = result.smoothed > 0 ? moving_mean(series.time, taken, result.smoothed) : taken;
    const auto& over = result.over.empty() ? values : series.columns[probe_index(scene, result.over)];
    const double value = result.scale * take(result.take, series.time, values, over, result.level);
    Outcome outcome;
    outcome.result = &result;
    outcome.value = value / base::parse_unit(result.unit).to_si(1);
    if (result.expected && *result.expected != 0) outcome.relative_error = value / *result.expected - 1;
    if (result.expected_range)
      outcome.within = value >= (*result.expected_range)[0] && value <= (*result.expected_range)[1];
    outcomes.push_back(outcome);
  }
  return outcomes;
}

std::string table(std::span<const Outcome> outcomes) {
  if (outcomes.empty()) return {};
  std::size_t width = 6;
  for (const auto& outcome : outcomes) width = std::max(width, outcome.result->name.size());
  std::string text =
      fmt::format("{:<{}}  {:>12} {:<8} {:<22} {}\n", "result", width, "value", "unit", "expected", "source");
  for (const auto& outcome : outcomes) {
    const auto& result = *outcome.result;
    const double factor = base::parse_unit(result.unit).to_si(1);
    std::string expected = "-";
    if (outcome.relative_error)
      expected = fmt::format("{:.5g} ({:+.2f} %)", *result.expected / factor, 100 * *outcome.relative_error);
    if (outcome.within)
      expected = fmt::format("{:.4g} .. {:.4g} ({})", (*result.expected_range)[0] / factor,
                             (*result.expected_range)[1] / factor, *outcome.within ? "within" : "OUTSIDE");
    text += fmt::format("{:<{}}  {:>12.5g} {:<8} {:<22} {}\n", result.name, width, outcome.value,
                        result.unit.empty() ? "-" : result.unit, expected, result.source);
  }
  return text;
}

}  // namespace coupling
