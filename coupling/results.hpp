#pragma once
// A scene's named outcomes: taken from the samples of the measured stage, compared with what was expected.
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "coupling/scene.hpp"

namespace coupling {

/// The samples of the measured stage, one column per probe.
struct Series {
  std::vector<double> time;                  // [s]
  std::vector<std::vector<double>> columns;  // [probe][sample], SI
};

struct Outcome {
  const Result* result = nullptr;
  double value = 0;                      // in the result's unit
  std::optional<double> relative_error;  // against `expected`
  std::optional<bool> within;            // of the expected range
};

/// first | last | min | max | first_peak (before the first fall through mid-range) | max_abs | mean | range | rise (max
/// - first) | frequency | ratio | at (when `over` first reaches `level`; NaN: never) of a probe's series. `frequency`:
/// from the first to the last rising crossing of the mid-range level, crossings interpolated linearly [Hz].
double take(const std::string& how, std::span<const double> time, std::span<const double> values,
            std::span<const double> over, double level = 0);

/// Mean over all samples within width / 2 [s] of each.
std::vector<double> moving_mean(std::span<const double> time, std::span<const double> values, double width);

/// One outcome per result of the scene; none when nothing was sampled.
std::vector<Outcome> evaluate(const Scene&, const Series&);

/// The table shown at the end of a run.
std::string table(std::span<const Outcome>);

}  // namespace coupling
