// Periodic directions in scenes: what is read, what is refused.
#include <gtest/gtest.h>

#include "coupling/packing.hpp"
#include "tests/unit/coupling_scene_file.hpp"

namespace {

using namespace scene_tests;

const std::string along_x = "[[grains.periodic]]\naxis = \"x\"\nlower = \"-10 cm\"\nupper = 0.5\n";
const std::string packing = R"([[wall]]
name = "floor"
plane = { point = [0,0,0], normal = [0,0,1] }
[packing]
grading = [["20 mm", 0.0], ["40 mm", 1.0]]
young_modulus = "0.24 GPa"
friction = 0.1
target_porosity = 0.4
[[packing.layer]]
box = { lower = [-0.1, 0, 0], upper = [0.5, 0.3, 0.2] }
)";

TEST_F(SceneFile, PeriodicDirection) {
  const Scene scene = read(grains + along_x + packing + stage);
  const auto& periods = scene.grains->periods;
  EXPECT_EQ(periods[0].lower, -0.1);
  EXPECT_EQ(periods[0].length, 0.6);
  EXPECT_EQ(periods[1].length, 0);
  EXPECT_EQ(dem::nearest_image({0.55, 0.55, 0}, periods).x, 0.55 - 0.6);
  EXPECT_EQ(dem::nearest_image({0.55, 0.55, 0}, periods).y, 0.55);
}

TEST_F(SceneFile, PeriodicMistakes) {
  const auto expect_error = [&](const std::string& text, const std::string& part) {
    EXPECT_NE(error_of(text).find(part), std::string::npos) << error_of(text);
  };
  const std::string plane = "[[wall]]\nname = \"end\"\nplane = { point = [0,0,0], normal = [1,0,0.5] }\n";
  expect_error(grains + along_x + one_grain + stage + plane, "cuts the direction x, which is periodic");
  expect_error(grains + along_x + along_x + one_grain + stage, "x is periodic already");
  std::string box = packing;
  box.replace(box.find("upper = [0.5"), 12, "upper = [0.7");
  expect_error(grains + along_x + box + stage, "reaches beyond the periodic faces x = -0.1 m and 0.5 m");
  std::string swapped = along_x;
  swapped.replace(swapped.find("0.5"), 3, "-1");
  expect_error(grains + swapped + one_grain + stage, "does not lie above lower");
}

// A bed in a channel without ends: no wall holds it along x, and it stays; across the faces grains press on grains.
TEST_F(SceneFile, BedWithoutEnds) {
  const std::string sides = R"([[wall]]
name = "left"
plane = { point = [0,0,0], normal = [0,1,0] }
[[wall]]
name = "right"
plane = { point = [0,0.15,0], normal = [0,-1,0] }
)";
  std::string narrow = packing;
  narrow.replace(narrow.find("upper = [0.5, 0.3, 0.2]"), 23, "upper = [0.1, 0.15, 0.12]");
  std::string short_period = along_x;
  short_period.replace(short_period.find("upper = 0.5"), 11, "upper = 0.1");
  Scene scene = read(grains + short_period + narrow + sides + stage);
  scene.grains->packing->use_cache = false;
  coupling::PackingReport report;
  const auto bed = coupling::pack(scene, {}, dem::Backend::omp, report);
  ASSERT_GT(bed.size(), 60u);
  EXPECT_GT(report.porosity, 0.34);
  EXPECT_LT(report.porosity, 0.46);
  dem::Setup setup;
  setup.materials = scene.grains->materials;
  setup.materials[0].young_modulus = scene.grains->packing->young_modulus;
  setup.interactions = scene.grains->interactions;
  setup.periods = scene.grains->periods;
  const auto sim = dem::Simulation::create(setup, dem::Backend::omp);
  sim->add_grains(bed);
  sim->advance(0, 1e-6);
  double left = 0, across = 0;
  for (const auto& contact : sim->grain_contacts()) {
    if (norm(contact.period) == 0) continue;
    ++across;
    left += norm(contact.force);
  }
  EXPECT_GT(across, 10);
  EXPECT_GT(left, 0);
  for (const auto& grain : bed) {
    EXPECT_GT(grain.position.x, -0.1 - 0.01);
    EXPECT_LT(grain.position.x, 0.1 + 0.01);
  }
}

}  // namespace
