// Ways to take a result from a probe's series, and the end table.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "coupling/results.hpp"

namespace {

using coupling::take;

struct Wave {
  std::vector<double> time, values;
};

// w(t) = offset - amplitude cos(2 pi f t)
Wave wave(double offset, double amplitude, double frequency, double duration, int samples) {
  Wave result;
  for (int i = 0; i <= samples; ++i) {
    const double t = duration * i / samples;
    result.time.push_back(t);
    result.values.push_back(offset - amplitude * std::cos(2 * std::numbers::pi * frequency * t));
  }
  return result;
}

TEST(Results, TakeOfAKnownSeries) {
  const std::vector<double> time{0, 1, 2, 3}, values{2, -5, 4, 1}, over{1, 2, 8, 3};
  EXPECT_EQ(take("first", time, values, values), 2);
  EXPECT_EQ(take("last", time, values, values), 1);
  EXPECT_EQ(take("min", time, values, values), -5);
  EXPECT_EQ(take("max", time, values, values), 4);
  EXPECT_EQ(take("rise", time, values, values), 2);
  EXPECT_EQ(take("max_abs", time, values, values), 5);
  EXPECT_EQ(take("mean", time, values, values), 0.5);
  EXPECT_EQ(take("range", time, values, values), 9);
  EXPECT_EQ(take("ratio", time, values, over), 5.0 / 8.0);
  EXPECT_EQ(take("at", time, values, over, 5), -0.5);  // halfway between the second and the third sample
  EXPECT_TRUE(std::isnan(take("at", time, values, over, 9)));
}

TEST(Results, MovingMeanTakesItsWindow) {
  const std::vector<double> time{0, 1, 2, 3, 10}, values{2, -5, 6, 1, 8};
  EXPECT_EQ(coupling::moving_mean(time, values, 2), (std::vector<double>{-1.5, 1, 2.0 / 3, 3.5, 8}));
}

TEST(Results, FrequencyOfAnOffsetWave) {
  // A swing about a static offset: counting crossings of zero would find none. Linear interpolation of the crossings
  // leaves an error of order (samples per period)^-2.
  const auto w = wave(3.0, 1.0, 27.21, 0.2, 4000);
  EXPECT_NEAR(take("frequency", w.time, w.values, w.values), 27.21, 27.21e-5);
}

TEST(Results, DecayOfASwingAboutAnyPlace) {
  // A code that takes heights above zero instead of ways between turns is misled by the offset; one that goes down to
  // the noise, by the noise.
  std::vector<double> time, values;
  for (int i = 0; i <= 4000; ++i) {
    time.push_back(i * 1e-4);
    values.push_back(3 + std::exp(-50 * time.back()) * std::cos(2 * std::numbers::pi * 100 * time.back()) +
                     1e-9 * (i % 2));
  }
  EXPECT_NEAR(take("decay", time, values, values), 50, 0.01);
  EXPECT_TRUE(std::isnan(take("decay", {time.data(), 40}, {values.data(), 40}, values)));  // no turn yet
}

TEST(Results, FirstPeakIsNotTheLargest) {
  // Two swings, the second one larger; "max" would give 3.
  const std::vector<double> time{0, 1, 2, 3, 4, 5, 6}, values{0, 1.9, 2, 1.8, 0.1, 3, 0};
  EXPECT_EQ(take("first_peak", time, values, values), 2);
}

TEST(Results, FrequencyNeedsTwoRisingCrossings) {
  const auto w = wave(0.0, 1.0, 10.0, 0.1, 100);
  EXPECT_TRUE(std::isnan(take("frequency", w.time, w.values, w.values)));
}

TEST(Results, OutcomeInTheAskedUnitAgainstExpectation) {
  coupling::Scene scene;
  coupling::Probe probe;
  probe.name = "w";
  scene.probes = {probe};
  coupling::Result peak;
  peak.name = "tip";
  peak.probe = "w";
  peak.take = "max";
  peak.unit = "um";
  peak.expected = 100e-6;
  coupling::Result range = peak;
  range.name = "range";
  range.expected.reset();
  range.expected_range = {110e-6, 120e-6};
  scene.results = {peak, range};
  coupling::Series series;
  series.time = {0, 1};
  series.columns = {{0.0, 102e-6}};
  const auto outcomes = coupling::evaluate(scene, series);
  ASSERT_EQ(outcomes.size(), 2u);
  EXPECT_NEAR(outcomes[0].value, 102, 1e-9);
  EXPECT_NEAR(*outcomes[0].relative_error, 0.02, 1e-12);
  EXPECT_FALSE(*outcomes[1].within);
  const auto text = coupling::table(outcomes);
  EXPECT_NE(text.find("+2.00 %"), std::string::npos) << text;
  EXPECT_NE(text.find("OUTSIDE"), std::string::npos) << text;
}

}  // namespace
