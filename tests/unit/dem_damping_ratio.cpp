// Restitution to damping ratio for Hertz contacts that cannot pull (dem/damping_ratio.hpp).
#include <gtest/gtest.h>

#include <cmath>

#include "base/error.hpp"
#include "dem/damping_ratio.hpp"

// Values found by integrating the contact numerically. For contacts that may pull the answer is
// sqrt(5/6) (-ln e) / sqrt(ln^2 e + pi^2): 0.416 instead of 0.668 at e = 0.2.
TEST(DampingRatio, KnownValues) {
  const double known[][2] = {{0.2, 0.66753}, {0.4, 0.32362}, {0.5, 0.23303}, {0.6, 0.16510}, {0.8, 0.06788}};
  for (const auto& [restitution, ratio] : known) EXPECT_NEAR(dem::damping_ratio(restitution), ratio, 5e-6);
  EXPECT_EQ(dem::damping_ratio(1), 0);
}

TEST(DampingRatio, InverseToRounding) {
  for (double e : {1e-6, 0.01, 0.13, std::exp(-2.0), 0.14, 0.3, 0.7, 0.99, 0.999999})
    EXPECT_NEAR(dem::restitution_of(dem::damping_ratio(e)) / e, 1, 1e-8) << e;
  EXPECT_GT(dem::damping_ratio(0.1), dem::damping_ratio(0.2));
}

TEST(DampingRatio, RefusesWhatIsNoRestitution) {
  for (double e : {0.0, -0.1, 1.0001, std::nan("")}) EXPECT_THROW(dem::damping_ratio(e), base::UserError);
}
