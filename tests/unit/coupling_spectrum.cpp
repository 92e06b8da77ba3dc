// Spectra of probes against transforms known in closed form.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>

#include "coupling/spectrum.hpp"
#include "tests/unit/coupling_scene_file.hpp"

namespace {

using namespace scene_tests;
using coupling::spectrum;

constexpr double step = 1e-3;  // [s]
constexpr int count = 1000;    // 1 s of samples, so lines are 1 Hz apart

struct Samples {
  std::vector<double> time, values;
};
template <class Of>
Samples sampled(Of&& of) {
  Samples samples;
  for (int i = 0; i < count; ++i) {
    samples.time.push_back(step * i);
    samples.values.push_back(of(step * i));
  }
  return samples;
}
double wave(double frequency, double t) { return std::sin(2 * std::numbers::pi * frequency * t); }

// A sin(2 pi f t) over a whole number of periods T: A T / 2 at f, nothing elsewhere; the mean is no line at zero.
TEST(Spectrum, OfASineIsOneLine) {
  const auto s = sampled([](double t) { return 7 + 3 * wave(50, t); });
  const auto found = spectrum(s.time, s.values, 0);
  ASSERT_EQ(found.frequency.size(), 501u);
  EXPECT_NEAR(found.frequency[50], 50, 1e-9);
  for (std::size_t k = 0; k < found.amplitude.size(); ++k)
    EXPECT_NEAR(found.amplitude[k], k == 50 ? 1.5 : 0.0, 1e-9) << k;
}

// Parzen's window of bandwidth b spreads a line of power P to P W(f - f0) df: its height is 3/4 u df with u = 280/(151
// b), and it is zero 2/u away (here 21.57 Hz for 20 Hz). Power is kept.
TEST(Spectrum, ParzensWindowSpreadsALine) {
  const auto s = sampled([](double t) { return wave(200, t); });
  const auto line = spectrum(s.time, s.values, 0), found = spectrum(s.time, s.values, 20);
  const double u = 280.0 / (151 * 20), power = 0.25;
  EXPECT_NEAR(std::pow(found.amplitude[200], 2), power * 0.75 * u, 2e-4 * power);
  for (const int away : {5, 10}) {
    const double x = 0.5 * std::numbers::pi * u * away;
    EXPECT_NEAR(std::pow(found.amplitude[200 + away], 2), power * 0.75 * u * std::pow(std::sin(x) / x, 4),
                2e-4 * power);
  }
  EXPECT_LT(found.amplitude[222], 0.02 * found.amplitude[200]);
  const auto total = [](const coupling::Spectrum& of) {
    return std::inner_product(of.amplitude.begin(), of.amplitude.end(), of.amplitude.begin(), 0.0);
  };
  EXPECT_NEAR(total(found), total(line), 1e-3 * total(line));
}

// Uneven samples of a slow wave: what straight lines cost is of second order.
TEST(Spectrum, UnevenStepsAreMadeEven) {
  auto s = sampled([](double t) { return wave(5, t); });
  for (int i = 1; i + 1 < count; ++i) {
    s.time[i] += 0.3 * step * std::sin(i);
    s.values[i] = wave(5, s.time[i]);
  }
  EXPECT_NEAR(spectrum(s.time, s.values, 0).amplitude[5], 0.5, 1e-3);
}

// Mobility: velocity 0.2 and 3 times a load's two waves; the file gives 0.2 and 3 at their frequencies.
TEST_F(SceneFile, MobilityIsTheRatioOfSpectra) {
  const auto scene = read(stage + body +
                          "[[probe]]\nname = \"load\"\nkind = \"load\"\nload = \"tip\"\n"
                          "[[probe]]\nname = \"v\"\nkind = \"velocity\"\nbody = \"beam\"\ngroup = \"x_max\"\n"
                          "[[spectrum]]\nname = \"mobility\"\nprobe = \"v\"\nover = \"load\"\n"
                          "[[spectrum]]\nname = \"velocity\"\nprobe = \"v\"\n");
  const auto load = sampled([](double t) { return wave(40, t) + 2 * wave(90, t); });
  const auto velocity = sampled([](double t) { return 0.2 * wave(40, t) + 6 * wave(90, t + 0.001); });
  const auto text = coupling::spectra_text(scene, {load.time, {load.values, velocity.values}});
  std::istringstream lines(text);
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "frequency [Hz],mobility [m/s/(N)],velocity [m/s s]");
  double frequency = 0, mobility = 0;
  while (std::getline(lines, line) && std::sscanf(line.c_str(), "%lf,%lf", &frequency, &mobility) == 2) {
    if (std::abs(frequency - 40) < 0.5) {
      EXPECT_NEAR(mobility, 0.2, 1e-6);
    }
    if (std::abs(frequency - 90) < 0.5) {
      EXPECT_NEAR(mobility, 3, 1e-6);
    }
  }
  EXPECT_NEAR(frequency, 500, 1e-6);
}

TEST_F(SceneFile, SpectraOfUnknownProbesAreRefused) {
  EXPECT_EQ(error_of(stage + body + "[[spectrum]]\nname = \"s\"\nprobe = \"v\"\n"),
            "a.toml:24: spectrum.s.probe = \"v\"; no such probe; known probes: none");
}

}  // namespace
