// Grain sizes from a sieve curve: the sample sieved back is the curve; EN 13450 category A (Irazabal2017 Table 2.1).
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/error.hpp"
#include "dem/grading.hpp"

namespace {

const dem::SieveCurve ballast{{0.0224, 0.01}, {0.0315, 0.12}, {0.040, 0.48}, {0.050, 0.85}, {0.063, 1}};

double volume(const std::vector<double>& radii) {
  double sum = 0;
  for (const double radius : radii) sum += 4.0 / 3.0 * std::numbers::pi * radius * radius * radius;
  return sum;
}

// Drawing by number instead of by mass would put 12 % of the numbers, and under 3 % of the mass, below 31.5 mm.
TEST(Grading, FiveThousandGrainsFollowTheCurve) {
  const double wanted = 5000 * dem::mean_grain_volume(ballast);
  const auto radii = dem::sample_radii(ballast, wanted, 7);
  EXPECT_NEAR(static_cast<double>(radii.size()), 5000, 50);
  EXPECT_NEAR(volume(radii) / wanted, 1, 1e-3);
  const std::vector<double> sizes{0.0224, 0.027, 0.0315, 0.036, 0.040, 0.045, 0.050, 0.056, 0.063};
  for (const dem::Sieve& row : dem::sieve(radii, sizes)) {
    EXPECT_NEAR(row.passing, dem::passing(ballast, row.size), 0.002) << row.size;
  }
}

// By hand: of 1 + 2 + 5 parts of mass 1 passes 30 mm, 3 pass 40 mm; a grain passes the sieve of its own size. By number
// it would be a third and two thirds.
TEST(Grading, SieveWeighsTheGrains) {
  const std::vector<dem::SizedGrain> grains{{0.050, 5e-5}, {0.030, 1e-5}, {0.040, 2e-5}};
  const std::vector<double> sizes{0.020, 0.030, 0.040, 0.063};
  const auto curve = dem::sieve(grains, sizes);
  const std::vector<double> expected{0, 1.0 / 8, 3.0 / 8, 1};
  for (std::size_t i = 0; i < sizes.size(); ++i) EXPECT_DOUBLE_EQ(curve[i].passing, expected[i]) << sizes[i];
  EXPECT_EQ(dem::sieve(std::vector<dem::SizedGrain>{}, sizes).back().passing, 0);
}

TEST(Grading, FewGrainsStillFollowTheCurve) {
  const auto radii = dem::sample_radii(ballast, 300 * dem::mean_grain_volume(ballast), 7);
  const std::vector<double> sizes{0.0315, 0.040, 0.050, 0.063};
  for (const dem::Sieve& row : dem::sieve(radii, sizes)) {
    EXPECT_NEAR(row.passing, dem::passing(ballast, row.size), 0.02) << row.size;
  }
}

// One class of even mass between d and 2 d: mean volume = pi/6 (d2 - d1) / (0.5 (1/d1^2 - 1/d2^2)) = pi/6 d^3 8/3.
TEST(Grading, MeanVolumeOfOneClass) {
  EXPECT_NEAR(dem::mean_grain_volume({{0.02, 0}, {0.04, 1}}), std::numbers::pi / 6 * 8e-6 * 8.0 / 3.0, 1e-15);
}

TEST(Grading, SameSeedSameGrainsEverywhere) {
  const double solid = 1000 * dem::mean_grain_volume(ballast);
  const auto radii = dem::sample_radii(ballast, solid, 1);
  EXPECT_EQ(radii, dem::sample_radii(ballast, solid, 1));
  EXPECT_NE(radii, dem::sample_radii(ballast, solid, 2));
  // std::mt19937_64's 10000th output is fixed by the standard ([rand.predef]); ours must be built on it unchanged.
  dem::Random random(std::mt19937_64::default_seed);
  double last = 0;
  for (int i = 0; i < 10000; ++i) last = random.uniform();
  EXPECT_DOUBLE_EQ(last, static_cast<double>(9981545732273789042ULL >> 11) * 0x1p-53);
}

TEST(Grading, FinesContinueTheFirstSlopeDownToZero) {
  const double slope = 0.11 / (0.0315 - 0.0224);
  EXPECT_NEAR(dem::passing(ballast, 0.0224 - 0.005 / slope), 0.005, 1e-12);
  EXPECT_DOUBLE_EQ(dem::passing(ballast, 0.020), 0);
  for (const double radius : dem::sample_radii(ballast, 0.05, 3)) EXPECT_GE(2 * radius, 0.0224 - 0.01 / slope - 1e-12);
}

TEST(Grading, CategoryA) {
  std::string why;
  EXPECT_TRUE(dem::within_en13450_a(ballast, &why)) << why;
  // The curve that touches the most limits at once: exactly on a limit is within.
  EXPECT_TRUE(dem::within_en13450_a({{0.0224, 0.03}, {0.0315, 0.20}, {0.040, 0.30}, {0.050, 0.70}, {0.063, 1}}));
  EXPECT_FALSE(dem::within_en13450_a({{0.0224, 0.04}, {0.0315, 0.12}, {0.040, 0.48}, {0.050, 0.85}, {0.063, 1}}, &why));
  EXPECT_EQ(why, "passing 22.4 mm is 4 %; EN 13450 category A asks for 0 to 3 %");
  EXPECT_FALSE(dem::within_en13450_a({{0.0224, 0.01}, {0.0315, 0.25}, {0.040, 0.48}, {0.050, 0.72}, {0.063, 1}}, &why));
  EXPECT_EQ(why, "between 31.5 and 50 mm lie 47 %; EN 13450 category A asks for at least 50 %");
}

TEST(Grading, RefusesWhatIsNoCurve) {
  const auto message = [](const dem::SieveCurve& curve) {
    try {
      dem::check_curve(curve);
    } catch (const base::UserError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(message({{0.02, 1}}), "a grading needs two sieves or more");
  EXPECT_EQ(message({{0.04, 0}, {0.02, 1}}), "a grading's sieve sizes must rise");
  EXPECT_EQ(message({{0.02, 0.5}, {0.03, 0.4}, {0.04, 1}}), "a grading's passing must not fall");
  EXPECT_EQ(message({{0.02, 0.5}, {0.03, 0.9}}), "everything must pass a grading's last sieve (passing 1)");
  EXPECT_EQ(message({{0.0, 0.0}, {0.03, 1}}), "a grading's sieve sizes must be > 0");
  EXPECT_EQ(message({{0.01, -0.1}, {0.03, 1}}), "a grading's passing must be in [0, 1]");
}

}  // namespace
