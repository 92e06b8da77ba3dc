#include "coupling/spectrum.hpp"

#include <fftw3.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <numeric>

namespace coupling {

namespace {

/// The series at n even steps from its first to its last instant, without its mean.
std::vector<double> even_samples(std::span<const double> time, std::span<const double> values) {
  const std::size_t n = values.size();
  const double step = (time.back() - time.front()) / static_cast<double>(n - 1);
  std::vector<double> even(n);
  std::size_t after = 1;
  for (std::size_t i = 0; i < n; ++i) {
    const double instant = time.front() + step * static_cast<double>(i);
    while (after + 1 < n && time[after] < instant) ++after;
    const double share = (instant - time[after - 1]) / (time[after] - time[after - 1]);
    even[i] = values[after - 1] + share * (values[after] - values[after - 1]);
  }
  const double mean = std::accumulate(even.begin(), even.end(), 0.0) / static_cast<double>(n);
  for (double& value : even) value -= mean;
  return even;
}

std::vector<double> smoothed(const std::vector<double>& power, double step, double bandwidth) {
  const double u = 280 / (151 * bandwidth);
  const auto window = [&](std::size_t distance) {
    const double x = 0.5 * std::numbers::pi * u * step * static_cast<double>(distance);
    return x > 0 ? std::pow(std::sin(x) / x, 4) : 1.0;
  };
  // beyond the third zero the window is below 1e-4 of its height
  const auto reach = static_cast<std::ptrdiff_t>(std::ceil(6 / (u * step)));
  const auto size = static_cast<std::ptrdiff_t>(power.size());
  std::vector<double> weights, means(power.size());
  for (std::ptrdiff_t d = 0; d <= reach; ++d) weights.push_back(window(static_cast<std::size_t>(d)));
  for (std::ptrdiff_t k = 0; k < size; ++k) {
    double sum = 0, weight = 0;
    for (std::ptrdiff_t j = std::max<std::ptrdiff_t>(0, k - reach); j < std::min(size, k + reach + 1); ++j) {
      const double w = weights[static_cast<std::size_t>(std::abs(j - k))];
      sum += w * power[static_cast<std::size_t>(j)];
      weight += w;
    }
    means[static_cast<std::size_t>(k)] = sum / weight;
  }
  return means;
}

std::size_t probe_number(const Scene& scene, const std::string& name) {
  return static_cast<std::size_t>(std::ranges::find(scene.probes, name, &Probe::name) - scene.probes.begin());
}

}  // namespace

Spectrum spectrum(std::span<const double> time, std::span<const double> values, double bandwidth) {
  const std::size_t n = values.size();
  if (n < 4) return {};
  auto samples = even_samples(time, values);
  const double step = (time.back() - time.front()) / static_cast<double>(n - 1);
  const std::size_t lines = n / 2 + 1;
  const std::unique_ptr<fftw_complex[], decltype(&fftw_free)> transform(fftw_alloc_complex(lines), fftw_free);
  const fftw_plan plan =
      fftw_plan_dft_r2c_1d(static_cast<int>(n), samples.data(), transform.get(), FFTW_ESTIMATE | FFTW_PRESERVE_INPUT);
  fftw_execute(plan);
  fftw_destroy_plan(plan);
  const double spacing = 1 / (static_cast<double>(n) * step);
  std::vector<double> power(lines);
  Spectrum result;
  for (std::size_t k = 0; k < lines; ++k) {
    power[k] = step * step * (transform[k][0] * transform[k][0] + transform[k][1] * transform[k][1]);
    result.frequency.push_back(spacing * static_cast<double>(k));
  }
  if (bandwidth > 0) power = smoothed(power, spacing, bandwidth);
  for (const double value : power) result.amplitude.push_back(std::sqrt(value));
  return result;
}

std::string spectra_text(const Scene& scene, const Series& series) {
  if (scene.spectra.empty() || series.time.size() < 4) return {};
  std::string text = "frequency [Hz]";
  std::vector<double> frequency;
  std::vector<std::vector<double>> columns;
  for (const auto& row : scene.spectra) {
    const auto of = [&](const std::string& probe) {
      return spectrum(series.time, series.columns[probe_number(scene, probe)], row.bandwidth);
    };
    auto found = of(row.probe);
    if (!row.over.empty()) {
      const auto under = of(row.over);
      for (std::size_t k = 0; k < found.amplitude.size(); ++k)
        found.amplitude[k] = under.amplitude[k] > 0 ? found.amplitude[k] / under.amplitude[k] : 0;
    }
    frequency = std::move(found.frequency);
    columns.push_back(std::move(found.amplitude));
    text += fmt::format(",{} [{}]", row.name, row.unit);
  }
  text += "\n";
  for (std::size_t k = 0; k < frequency.size(); ++k) {
    text += fmt::format("{:.9g}", frequency[k]);
    for (const auto& column : columns) text += fmt::format(",{:.9g}", column[k]);
    text += "\n";
  }
  return text;
}

}  // namespace coupling
