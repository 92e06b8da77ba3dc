// Laboratory tests on ballast: the quick scenes find what their headers promise.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/regression/run_helper.hpp"

namespace {

using namespace regression;

/// Runs a quick scene; every result with an expected range must lie in it.
nlohmann::json run_laboratory(const std::string& name) {
  const fs::path out = scratch() / name;
  const auto finished = trackbed("run " + scene("quick/" + name + ".toml") + " --out " + out.string());
  EXPECT_EQ(finished.status, 0) << finished.output;
  if (finished.status != 0) return {};
  auto json = summary(out);
  EXPECT_EQ(json["status"], "completed");
  EXPECT_LT(json["energy"]["relative_error"].get<double>(), 0.02) << name;
  int judged = 0;
  for (const auto& [result, value] : json["results"].items()) {
    if (!value.contains("within")) continue;
    ++judged;
    EXPECT_TRUE(value["within"].get<bool>()) << result << " = " << value["value"];
  }
  EXPECT_GT(judged, 0) << name;
  return json;
}

TEST(Laboratories, AngleOfRepose) { run_laboratory("angle_of_repose"); }
TEST(Laboratories, DirectShear) { run_laboratory("direct_shear"); }
TEST(Laboratories, LateralResistance) { run_laboratory("lateral_resistance"); }
TEST(Laboratories, Oedometer) { run_laboratory("oedometer"); }

}  // namespace
