// Keys of a packing's methods, target and regions: what they mean, and what is refused.
#include <set>

#include "coupling/check.hpp"
#include "coupling/packing.hpp"
#include "coupling/packing_cache.hpp"
#include "tests/unit/coupling_scene_file.hpp"

namespace {

using namespace scene_tests;

/// Line 8 is [packing.layer]'s first own line; the region tables come after it.
std::string scene_with(const std::string& in_packing, const std::string& in_layer = "", const std::string& after = "") {
  return grains + "[packing]\ngrading = [ [\"22.4 mm\", 0.0], [\"63 mm\", 1.0] ]\nfriction = 0.1\n" + in_packing +
         "[[packing.layer]]\nbox = { lower = [0.0, 0.0, 0.0], upper = [1.0, 1.0, 0.3] }\n" + in_layer + after + stage;
}

const std::string loosen_box = "[[packing.loosen]]\nbox = { lower = [0.2, 0.2, 0.0], upper = [0.5, 0.8, 0.3] }\n";
const std::string erode_box = "[[packing.erode]]\nbox = { lower = [0.2, 0.2, 0.0], upper = [0.5, 0.8, 0.3] }\n";

class PackingKeys : public SceneFile {};

TEST_F(PackingKeys, AbsentMeansPouredAndSound) {
  const Scene scene = read(scene_with(""));
  const auto& packing = *scene.grains->packing;
  EXPECT_FALSE(packing.layers[0].growth);
  EXPECT_FALSE(packing.layers[0].vibration);
  EXPECT_FALSE(packing.tolerance);
  EXPECT_EQ(packing.tries, 1);
  EXPECT_TRUE(packing.loosened.empty());
  EXPECT_TRUE(packing.eroded.empty());
}

TEST_F(PackingKeys, GrowthHasDefaultsThatAreShown) {
  const Scene scene = read(scene_with("", "method = \"growth\"\n"));
  const auto& growth = scene.grains->packing->layers[0].growth;
  ASSERT_TRUE(growth);
  EXPECT_EQ(growth->start, 0.625);
  EXPECT_EQ(growth->overlap, 0.02);
  EXPECT_EQ(growth->gravity_factor, 30);
  EXPECT_NE(scene.resolved_toml.find("gravity_factor"), std::string::npos);
  write("resolved.toml", scene.resolved_toml);
  EXPECT_EQ(coupling::read_scene("resolved.toml").grains->packing->layers[0].growth->damping, 100);
}

TEST_F(PackingKeys, ValuesComeInSi) {
  const Scene scene = read(scene_with(
      "tolerance = \"1 %\"\ntries = 4\n",
      "vibration = { amplitude = \"2 mm\", frequency = \"30 Hz\", time = \"500 ms\", direction = [0.0, 3.0, 4.0] }\n",
      loosen_box + "share = 0.1\nfriction = 0.6\n" + erode_box +
          "above = { point = [0.0, 0.0, 0.1], normal = [0.0, 0.0, 2.0] }\n"));
  const auto& packing = *scene.grains->packing;
  EXPECT_EQ(packing.tolerance, 0.01);
  EXPECT_EQ(packing.tries, 4);
  const auto& shake = packing.layers[0].vibration;
  ASSERT_TRUE(shake);
  EXPECT_EQ(shake->amplitude, 0.002);
  EXPECT_EQ(shake->frequency, 30);
  EXPECT_EQ(shake->time, 0.5);
  EXPECT_NEAR(shake->direction.y, 0.6, 1e-15);
  ASSERT_EQ(packing.loosened.size(), 1u);
  EXPECT_EQ(packing.loosened[0].share, 0.1);
  EXPECT_EQ(packing.loosened[0].friction, 0.6);
  ASSERT_EQ(packing.eroded.size(), 1u);
  ASSERT_TRUE(packing.eroded[0].above);
  EXPECT_EQ(packing.eroded[0].above->normal.z, 1);
  EXPECT_EQ(packing.eroded[0].settle, 1);
}

// A bed made another way must not come out of the cache.
TEST_F(PackingKeys, DecideTheCachesKey) {
  const auto key = [](const std::string& text) { return coupling::packing_key(read(text), {}, dem::Backend::omp); };
  const std::string shaken = "vibration = { amplitude = 0.001, frequency = 30, time = 1 }\n";
  const std::vector<std::string> keys{key(scene_with("")),
                                      key(scene_with("", "method = \"growth\"\n")),
                                      key(scene_with("", "method = \"growth\"\ngrowth = { start = 0.5 }\n")),
                                      key(scene_with("", shaken)),
                                      key(scene_with("tolerance = 0.01\n")),
                                      key(scene_with("tolerance = 0.01\ntries = 2\n")),
                                      key(scene_with("", "", loosen_box + "share = 0.1\n")),
                                      key(scene_with("", "", loosen_box + "share = 0.2\n")),
                                      key(scene_with("", "", erode_box))};
  EXPECT_EQ(std::set<std::string>(keys.begin(), keys.end()).size(), keys.size());
}

TEST_F(PackingKeys, CheckShowsThem) {
  write("check.toml", scene_with("tolerance = 0.02\ntries = 3\n",
                                 "method = \"growth\"\nvibration = { amplitude = 0.001, frequency = 30, time = 1 }\n",
                                 loosen_box + "share = 0.25\n" + erode_box) +
                          "[[wall]]\nname = \"floor\"\nplane = { point = [0, 0, 0], normal = [0, 0, 1] }\n");
  coupling::RunOptions options;
  options.scene = "check.toml";
  options.backend = "omp";
  const std::string text = coupling::check(options);
  for (const char* part :
       {"packing: porosity 0.4 asked, refused when farther away than 0.02, 3 tries\n",
        "layer 1: grown from 0.625 of the size, then pressed by 30 times gravity, shaken 1 mm at 30 Hz for 1 s, "
        "levelled by a plate\n",
        "loosened: (0.2, 0.2, 0) .. (0.5, 0.8, 0.3) m, 25 % of its grains taken out\n",
        "eroded: (0.2, 0.2, 0) .. (0.5, 0.8, 0.3) m\n"})
    EXPECT_NE(text.find(part), std::string::npos) << part << "is not in:\n" << text;
}

TEST_F(PackingKeys, NonsenseIsRefused) {
  const auto expect = [](const std::string& text, const std::string& message) {
    const std::string said = error_of(text);
    EXPECT_EQ(said.rfind(message, 0), 0u) << said;
  };
  expect(scene_with("", "method = \"pouring\"\n"),
         "a.toml:10: packing.layer.method = \"pouring\"; must be one of: gravity, growth");
  expect(scene_with("", "growth = { start = 0.5 }\n"),
         "a.toml:10: packing.layer.growth; method = \"gravity\" grows no grains; remove it, or choose "
         "method = \"growth\"");
  expect(scene_with("", "method = \"growth\"\ngrowth = { start = 1.0 }\n"), "a.toml:11: packing.layer.growth.start = ");
  expect(scene_with("", "method = \"growth\"\ngrowth = { stat = 0.5 }\n"), "a.toml:11: packing.layer.growth.stat");
  expect(scene_with("", "vibration = { amplitude = 0.001, frequency = 30, time = 1, direction = [0, 0, 0] }\n"),
         "a.toml:10: packing.layer.vibration.direction = [0.0, 0.0, 0.0]; must not be zero; give the direction of the "
         "motion");
  expect(scene_with("", "vibration = { amplitude = -0.001, frequency = 30, time = 1 }\n"),
         "a.toml:10: packing.layer.vibration.amplitude = -0.001");
  expect(scene_with("tries = 3\n"),
         "a.toml:8: packing.tries = 3; nothing says when a bed is good enough; give packing.tolerance, or remove it");
  expect(scene_with("", "", loosen_box),
         "a.toml:10: packing.loosen; nothing loosens it; "
         "give share (of the grains to take out), or a friction above packing.friction");
  expect(scene_with("", "", loosen_box + "friction = 0.05\n"),
         "a.toml:12: packing.loosen.friction = 0.05; loosens nothing: packing.friction is 0.1; give a larger one, or "
         "share instead");
  expect(scene_with("", "", loosen_box + "share = 1.0\n"), "a.toml:12: packing.loosen.share = 1");
  expect(
      scene_with("", "", "[[packing.erode]]\nbox = { lower = [2.0, 0.0, 0.0], upper = [3.0, 1.0, 0.3] }\n"),
      "a.toml:11: packing.erode.box; from (2, 0, 0) to (3, 1, 0.3) m it lies outside every packing.layer.box; move it "
      "into the bed");
}

}  // namespace
