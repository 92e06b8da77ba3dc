// Laboratory tests on ballast: the quick scenes find what their headers promise.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/regression/run_helper.hpp"

namespace {

using namespace regression;

/// Runs a quick scene.
nlohmann::json run_laboratory(const std::string& name, const std::string& changes = "") {
  const fs::path out = scratch() / name;
  const auto finished =
      trackbed("run " + scene("quick/" + name + ".toml") + changes + " --overwrite --out " + out.string());
  EXPECT_EQ(finished.status, 0) << finished.output;
  if (finished.status != 0) return {};
  auto json = summary(out);
  EXPECT_EQ(json["status"], "completed");
  EXPECT_LT(json["energy"]["relative_error"].get<double>(), 0.02) << name << changes;
  return json;
}
double result(const nlohmann::json& json, const std::string& name) {
  return json.empty() ? NAN : json["results"][name]["value"].get<double>();
}

/// Every result of the scene as it is that has an expected range must lie in it.
nlohmann::json judge(const nlohmann::json& json) {
  int judged = 0;
  for (const auto& [name, value] : json["results"].items()) {
    if (!value.contains("within")) continue;
    ++judged;
    EXPECT_TRUE(value["within"].get<bool>()) << name << " = " << value["value"];
  }
  EXPECT_GT(judged, 0);
  return json;
}

TEST(Laboratories, AngleOfRepose) { judge(run_laboratory("angle_of_repose")); }

// The same slope of spheres shows what the procedure reads: 40 degrees at a rolling friction of 0.2 (Irazabal2017
// Fig. 6.4), and much less without. One bed is some 3 degrees off: the mean of four is asked.
TEST(Laboratories, AngleOfReposeOfClumps) {
  const auto spheres = [](const std::string& rolling_friction) {
    double sum = 0;
    for (int seed = 1; seed <= 4; ++seed)
      sum += result(run_laboratory("angle_of_repose_clumps",
                                   " --set 'packing.shapes=[]' --set time.dem_fraction=0.3 --set packing.seed=" +
                                       std::to_string(seed) +
                                       " --set wall.floor.rolling_friction=1 --set wall.crest.rolling_friction=0"
                                       " --set wall.gate.rolling_friction=0 --set grains.rolling_friction=" +
                                       rolling_friction),
                    "angle_of_repose");
    return sum / 4;
  };
  judge(run_laboratory("angle_of_repose_clumps"));
  const double braked = spheres("0.2");
  EXPECT_NEAR(braked, 40, 4);
  EXPECT_GT(braked, spheres("0") + 8);
}

TEST(Laboratories, Oedometer) { judge(run_laboratory("oedometer")); }

// Irazabal2017 6.3.3, 6.3.4: dense stones contract, then dilate; the friction angle falls with normal stress; friction
// that falls with contact stress lowers the shear stress, the more the larger its exponent.
TEST(Laboratories, DirectShear) {
  const auto at = [](const std::string& stress, const std::string& more = "") {
    return run_laboratory("direct_shear", " --set 'wall.plate.load.1.history.value=" + stress + "'" + more);
  };
  const auto falling = [&](const std::string& exponent) {
    return at("51 kPa",
              " --set grains.law=stress_friction --set 'grains.critical_stress=5.17 MPa'"
              " --set grains.friction_exponent=" +
                  exponent);
  };
  const auto own = judge(run_laboratory("direct_shear"));
  const auto light = at("27 kPa"), heavy = at("75 kPa");
  for (const auto& run : {light, own, heavy}) {
    EXPECT_GT(result(run, "contraction"), 0.05);  // [mm]
    EXPECT_GT(result(run, "dilation"), 0.5);
  }
  EXPECT_GT(result(light, "peak_friction_angle"), result(own, "peak_friction_angle"));
  EXPECT_GT(result(own, "peak_friction_angle"), result(heavy, "peak_friction_angle"));
  const double constant = result(own, "shear_stress_at_20mm");
  const double weak = result(falling("-0.05"), "shear_stress_at_20mm");
  const double strong = result(falling("-0.15"), "shear_stress_at_20mm");
  EXPECT_LT(weak, constant);
  EXPECT_LT(strong, weak);
}

// The force grows by 0.72 of the load on the rails: 0.7247 measured, 0.7442 computed (Irazabal2017 6.10, 6.11).
TEST(Laboratories, LateralResistance) {
  const std::vector<double> loads{0, 15, 35};  // [kN]
  double mean_load = 0, mean_force = 0;
  std::vector<double> forces;
  for (const double load : loads) {
    const std::string change = " --set 'wall.sleeper.load.1.history.value=" + std::to_string(load) + " kN'";
    const auto run =
        load == 0 ? judge(run_laboratory("lateral_resistance")) : run_laboratory("lateral_resistance", change);
    forces.push_back(result(run, "peak_lateral_force"));
    mean_load += load / 3;
    mean_force += forces.back() / 3;
  }
  double product = 0, square = 0;
  for (std::size_t k = 0; k < loads.size(); ++k) {
    product += (loads[k] - mean_load) * (forces[k] - mean_force);
    square += (loads[k] - mean_load) * (loads[k] - mean_load);
  }
  EXPECT_NEAR(product / square, 0.72, 0.06);
}

}  // namespace
