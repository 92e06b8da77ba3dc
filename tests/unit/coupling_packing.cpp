// The packing's cache and the refusals that need no simulation.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "base/error.hpp"
#include "coupling/packing.hpp"
#include "coupling/packing_cache.hpp"
#include "coupling/packing_region.hpp"

namespace {

namespace fs = std::filesystem;

/// A scene with a floor and a box to fill.
coupling::Scene box_scene() {
  coupling::Scene scene;
  scene.grains.emplace();
  coupling::GrainsScene& grains = *scene.grains;
  grains.materials = {{"ballast", 1e9, 0.2, 2700}};
  grains.interactions = {{0.6, 0.4, 0.2}};
  coupling::WallScene floor;
  floor.name = "floor";
  floor.plane = dem::Plane{{0, 0, 0}, {0, 0, 1}};
  grains.walls = {floor};
  grains.packing.emplace();
  grains.packing->grading = {{0.0224, 0}, {0.063, 1}};
  grains.packing->young_modulus = 0.24e9;
  grains.packing->friction = 0.1;
  grains.packing->origin = "scene.toml:3";
  coupling::PackingLayer layer;
  layer.box = {{0, 0, 0}, {0.2, 0.2, 0.2}};
  layer.origin = "scene.toml:9";
  grains.packing->layers = {layer};
  return scene;
}

std::string refusal(const coupling::Scene& scene, const std::vector<base::Skin>& skins = {}) {
  try {
    coupling::PackingReport report;
    coupling::pack(scene, skins, dem::Backend::omp, report);
  } catch (const base::UserError& error) {
    return error.what();
  }
  return "";
}

class PackingCache : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("trackbed-cache-" + std::to_string(getpid()));
    setenv("TRACKBED_CACHE", folder_.c_str(), 1);
  }
  void TearDown() override { fs::remove_all(folder_); }

  static std::vector<dem::Grain> some_grains() {
    std::vector<dem::Grain> grains(3);
    for (int i = 0; i < 3; ++i) {
      auto& grain = grains[static_cast<std::size_t>(i)];
      grain.id = i;
      grain.position = {0.1 * i, -1.0 / 3.0, 1e-17 * i};
      grain.radius = 0.01 + 1e-9 * i;
    }
    return grains;
  }
  fs::path file(const std::string& key) const { return folder_ / ("packing-" + key + ".csv"); }
  fs::path folder_;
};

// Decimal text of too few digits would come back near, not equal.
TEST_F(PackingCache, ComesBackBitIdentical) {
  const auto grains = some_grains();
  coupling::PackingReport written, read;
  written.grains = 3;
  written.porosity = 0.1 + 0.3;
  written.coordination = 5.0 / 3.0;
  written.friction = 0.1 + 0.2;
  written.steps = {{"growth", 1, 0, 1.0 / 3.0, 0.4}, {"erode", 2, 17, 0.38, 1}};
  coupling::store_packing("0123", grains, written);
  const auto back = coupling::load_packing("0123", read);
  ASSERT_TRUE(back);
  ASSERT_EQ(back->size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ((*back)[i].id, grains[i].id);
    EXPECT_EQ((*back)[i].position.y, grains[i].position.y);
    EXPECT_EQ((*back)[i].position.z, grains[i].position.z);
    EXPECT_EQ((*back)[i].radius, grains[i].radius);
  }
  EXPECT_EQ(read.porosity, written.porosity);
  EXPECT_EQ(read.coordination, written.coordination);
  EXPECT_EQ(read.friction, written.friction);
  ASSERT_EQ(read.steps.size(), 2u);
  EXPECT_EQ(read.steps[0].porosity_before, 1.0 / 3.0);
  EXPECT_EQ(read.steps[1].what, "erode");
  EXPECT_EQ(read.steps[1].number, 2);
  EXPECT_EQ(read.steps[1].taken, 17);
  EXPECT_TRUE(read.from_cache);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1) << "a temporary file was left behind";
}

TEST_F(PackingCache, DamageIsNoticed) {
  coupling::PackingReport report;
  report.grains = 3;
  coupling::store_packing("0123", some_grains(), report);
  EXPECT_FALSE(coupling::load_packing("4567", report));
  fs::copy_file(file("0123"), file("4567"));
  EXPECT_FALSE(coupling::load_packing("4567", report)) << "a file under another key was taken";
  fs::resize_file(file("0123"), fs::file_size(file("0123")) - 5);
  EXPECT_FALSE(coupling::load_packing("0123", report)) << "a truncated file was taken";
  std::ofstream(file("0123")) << "nonsense";
  EXPECT_FALSE(coupling::load_packing("0123", report));
  EXPECT_FALSE(report.from_cache);
}

TEST_F(PackingCache, FolderThatCannotBeWrittenIsNoError) {
  std::ofstream(folder_.string()) << "a file where the folder should be";
  coupling::PackingReport report;
  EXPECT_NO_THROW(coupling::store_packing("0123", some_grains(), report));
  EXPECT_FALSE(coupling::load_packing("0123", report));
}

TEST_F(PackingCache, KeyFollowsWhatDecidesThePacking) {
  const coupling::Scene scene = box_scene();
  const std::string key = coupling::packing_key(scene, {}, dem::Backend::omp);
  EXPECT_EQ(key, coupling::packing_key(box_scene(), {}, dem::Backend::omp));
  coupling::Scene other = scene;
  other.grains->packing->seed = 2;
  EXPECT_NE(key, coupling::packing_key(other, {}, dem::Backend::omp));
  other = scene;
  other.grains->walls[0].plane->point.z = -0.1;
  EXPECT_NE(key, coupling::packing_key(other, {}, dem::Backend::omp));
  other = scene;
  other.grains->interactions[0].law = "hysteretic";
  EXPECT_NE(key, coupling::packing_key(other, {}, dem::Backend::omp));
  other = scene;
  other.grains->interactions[0].damping_mode = 1;
  EXPECT_NE(key, coupling::packing_key(other, {}, dem::Backend::omp));
  // The same square, its facets and nodes numbered differently, as another number of ranks may do.
  base::Skin one{"ground", {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2, -1}, {0, 2, 3, -1}}};
  base::Skin two{"ground", {{1, 1, 0}, {0, 1, 0}, {0, 0, 0}, {1, 0, 0}}, {{2, 0, 1, -1}, {3, 0, 2, -1}}};
  EXPECT_EQ(coupling::packing_key(scene, {one}, dem::Backend::omp),
            coupling::packing_key(scene, {two}, dem::Backend::omp));
  two.nodes[0].x = 1.1;
  EXPECT_NE(coupling::packing_key(scene, {one}, dem::Backend::omp),
            coupling::packing_key(scene, {two}, dem::Backend::omp));
}

TEST(PackingRegion, VolumeLeavesOutBodiesAndWalls) {
  coupling::Scene scene = box_scene();
  scene.grains->walls[0].plane->point.z = 0.05;
  const coupling::PackingRegion region(scene, {});
  EXPECT_NEAR(region.volume(0), 0.006, 1e-9);
  EXPECT_EQ(region.sides().size(), 4u);
}

TEST(PackingRefusal, NothingBelow) {
  coupling::Scene scene = box_scene();
  scene.grains->walls.clear();
  EXPECT_EQ(
      refusal(scene),
      "scene.toml:3: packing: nothing carries the ballast; give a [[wall]] or a [[body]] with a skin below the lowest "
      "layer (z = 0 m)");
}

TEST(PackingRefusal, LayerWithoutThickness) {
  coupling::Scene scene = box_scene();
  scene.grains->packing->layers[0].box.upper.z = 0;
  EXPECT_EQ(refusal(scene), "scene.toml:9: packing.layer.box has no volume (0.2 x 0.2 x 0 m); every edge must be > 0");
}

TEST(PackingRefusal, BoxThatWallsFill) {
  coupling::Scene scene = box_scene();
  scene.grains->walls[0].plane->point.z = 1.5;
  EXPECT_EQ(refusal(scene),
            "scene.toml:9: packing.layer: the box has room for 0 m3, less than one grain; bodies and walls "
            "fill it, or it is too small");
}

TEST(PackingRefusal, BoxNarrowerThanTheGrains) {
  coupling::Scene scene = box_scene();
  scene.grains->packing->layers[0].box.upper.x = 0.05;
  EXPECT_EQ(refusal(scene),
            "scene.toml:9: packing.layer: the box to pour grains into is narrower than the largest grain");
}

}  // namespace
