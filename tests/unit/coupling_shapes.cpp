// Clumps in scenes: sizes, turns, the mix that is poured, and every message a wrong shape gives.
#include <regex>

#include "coupling/measure.hpp"
#include "coupling/packing.hpp"
#include "coupling/packing_cache.hpp"
#include "coupling/shapes.hpp"
#include "dem/dimensions.hpp"
#include "dem/output.hpp"
#include "tests/unit/coupling_scene_file.hpp"

namespace {

using namespace scene_tests;

const std::string two_shapes = R"([[grains.shape]]
name = "rod"
file = "rod.csv"
[[grains.shape]]
name = "ball"
file = "ball.csv"
)";
const std::string one_rod = R"([[grain]]
position = [0.0, 0.0, "1 m"]
shape = "rod"
)";

class Shapes : public SceneFile {
 protected:
  Shapes() {
    write("rod.csv", "x,y,z,radius\n0,0,-0.01,0.01\n0,0,0,0.01\n0,0,0.01,0.01\n");  // along z
    write("ball.csv", "0,0,0,0.02\n");
  }
};

TEST_F(Shapes, SizeIsTheSieveAndOrientationTurnsTheFilesAxes) {
  const std::string turned = one_rod + "size = \"40 mm\"\norientation = [\"90 deg\", 0, 0]\n";
  const Scene scene = read(grains + two_shapes + one_rod + turned + stage);
  const auto& part = *scene.grains;
  const auto clumps = coupling::clumps(part.shapes);
  const auto ends = [&](const dem::Grain& grain) {
    const auto spheres = dem::placed_spheres(grain, clumps);
    return std::make_pair(spheres, spheres.front().position - spheres.back().position);
  };
  EXPECT_NEAR(coupling::sieve_size(part.list.at(0), part.shapes), 0.02, 1e-6);  // as in its file: 20 mm across
  EXPECT_NEAR(std::abs(ends(part.list[0]).second.z), 0.02, 1e-8);
  const auto [spheres, axis] = ends(part.list.at(1));  // twice as long, z turned into y
  EXPECT_NEAR(std::abs(axis.y), 0.04, 1e-6);
  EXPECT_NEAR(axis.z, 0, 1e-8);
  EXPECT_NEAR(spheres.at(1).radius, 0.02, 1e-6);
  EXPECT_NEAR(dem::volume(part.list[1], clumps), 8 * dem::volume(part.list[0], clumps), 1e-9);
  EXPECT_EQ(coupling::sphere_count(part.list, part.shapes), 6);
  write("resolved.toml", scene.resolved_toml);
  const Scene again = coupling::read_scene("resolved.toml");
  EXPECT_EQ(again.grains->list.at(1).radius, part.list[1].radius);
  EXPECT_EQ(again.grains->list[1].orientation.x, part.list[1].orientation.x);
}

// Of half rods and half balls every size has the same mix, so that the volume asked for is poured and the grading kept.
TEST_F(Shapes, MixHasTheSharesAndTheVolumeAskedFor) {
  const std::string shapes = "shapes = [\"rod\", \"ball\"]\nshape_shares = [3, 1]\n[[packing.layer]]";
  const std::string text = std::regex_replace(packing, std::regex("\\[\\[packing.layer\\]\\]"), shapes);
  const Scene scene = read(grains + two_shapes + stage + text);
  const auto& part = *scene.grains;
  const coupling::ShapeMix mix(*part.packing, part.shapes);
  EXPECT_GT(mix.around(), 1);
  const double solid = 0.05;  // [m3]
  const dem::SieveCurve curve{{0.0224, 0}, {0.063, 1}};
  const auto all = mix.grains(dem::sample_radii(curve, solid / mix.solid(), 1), 1);
  const auto clumps = coupling::clumps(part.shapes);
  std::size_t balls = 0;
  double total = 0, small = 0, up = 0;
  for (const auto& grain : all) {
    const double own = dem::volume(grain, clumps), size = coupling::sieve_size(grain, part.shapes);
    balls += grain.shape == 1;
    total += own;
    small += size < 0.0427 ? own : 0;  // the curve's middle
    up += std::abs(to_space(grain.orientation, base::Vec3{1, 0, 0}).z) / static_cast<double>(all.size());
    const auto around = coupling::sphere_around(grain, part.shapes);
    for (const auto& sphere : dem::placed_spheres(grain, clumps))
      EXPECT_LE(norm(sphere.position - around.position) + sphere.radius, around.radius * (1 + 1e-9));
  }
  EXPECT_EQ(balls, all.size() / 4);
  EXPECT_NEAR(total / solid, 1, 0.02);
  EXPECT_NEAR(small / total, 0.5, 0.02);
  EXPECT_NEAR(up, 0.5, 0.05);  // mean |cos| over the sphere
  const auto again = mix.grains(dem::sample_radii(curve, solid / mix.solid(), 1), 1);
  EXPECT_EQ(again.back().orientation.w, all.back().orientation.w);
}

TEST_F(Shapes, Mistakes) {
  const std::string head = grains + two_shapes;
  const auto grain = [&](const std::string& lines) {
    return error_of(head + "[[grain]]\nposition = [0, 0, 0]\n" + lines + stage);
  };
  EXPECT_EQ(grain(""),
            "a.toml:11: grain; has neither radius nor shape; give radius for a sphere, shape (and size) for another "
            "grain");
  EXPECT_EQ(grain("radius = 0.1\nshape = \"rod\"\n"),
            "a.toml:11: grain; has both a radius and a shape; give radius for a sphere, shape (and size) for another "
            "grain");
  EXPECT_EQ(grain("shape = \"rood\"\n"), "a.toml:13: grain.shape = \"rood\"; no such shape; did you mean \"rod\"?");
  EXPECT_EQ(grain("radius = 0.1\norientation = [0, 0, 1]\n"),
            "a.toml:14: grain.orientation = [0.0, 0.0, 1.0]; a sphere has none; remove it, or give a shape instead of "
            "the radius");
  EXPECT_EQ(error_of(head + one_rod + stage, {{"grains.rotations", "false"}}),
            "--set: grains.rotations = false; grains of shape \"rod\" turn; remove it");
  EXPECT_EQ(error_of(head + "[[grains.shape]]\nname = \"rod\"\nfile = \"ball.csv\"\n" + one_rod + stage),
            "a.toml:12: grains.shape.rod.name = \"rod\"; a shape of this name stands at a.toml:6; rename one");
  write("rod.csv", "0,0,0,0.01\n0,0,1,0.01\n");
  const std::string apart = error_of(head + one_rod + stage);
  EXPECT_EQ(apart.substr(0, 40), "a.toml:7: grains.shape.rod.file = \"" + fs::absolute("r").string().substr(0, 5));
  EXPECT_NE(apart.find("\"; no shape: "), std::string::npos) << apart;
  const auto packed = [&](const std::string& lines) {
    return error_of(head + stage +
                    std::regex_replace(packing, std::regex("\\[\\[packing.layer\\]\\]"), lines + "[[packing.layer]]"));
  };
  write("rod.csv", "0,0,0,0.01\n");
  EXPECT_EQ(packed("shapes = [\"ball\", \"bal\"]\n"),
            "a.toml:17: packing.shapes[2] = \"bal\"; no such shape; did you mean \"ball\"?");
  EXPECT_EQ(packed("shapes = [\"ball\"]\nshape_shares = [0.5, 0.5]\n"),
            "a.toml:18: packing.shape_shares = [0.5, 0.5]; 2 shares for 1 shapes; give one for every name in shapes");
}

TEST_F(Shapes, PackingFingerprintsFollowTheSpheres) {
  const std::string text =
      grains + two_shapes + stage +
      std::regex_replace(packing, std::regex("\\[\\[packing.layer\\]\\]"), "shapes = [\"rod\"]\n[[packing.layer]]") +
      "[[wall]]\nname = \"floor\"\nplane = { point = [0,0,0], normal = [0,0,1] }\n";
  const auto prints = [&](const std::vector<Override>& overrides = {}) {
    const Scene scene = read(text, overrides);
    return std::make_pair(scene.packing_hash, coupling::packing_key(scene, {}, dem::Backend::omp));
  };
  const auto first = prints();
  const auto other_shape = prints({{"packing.shapes", "[\"ball\"]"}});
  EXPECT_NE(first.first, other_shape.first);
  EXPECT_NE(first.second, other_shape.second);
  write("rod.csv", "0,0,0,0.01\n0,0,0.01,0.01\n");
  const auto other_file = prints();
  EXPECT_NE(first.first, other_file.first);
  EXPECT_NE(first.second, other_file.second);
}

TEST_F(Shapes, CacheKeepsShapeAndOrientation) {
  setenv("TRACKBED_CACHE", "cache", 1);
  const Scene scene = read(grains + two_shapes + one_rod + "orientation = [0.3, -0.2, 0.7]\n" + one_grain + stage);
  coupling::PackingReport report;
  report.grains = 2;
  coupling::store_packing("0123", scene.grains->list, report);
  const auto back = coupling::load_packing("0123", report);
  ASSERT_TRUE(back);
  for (std::size_t i = 0; i < 2; ++i) {
    const dem::Grain &was = scene.grains->list[i], &is = (*back)[i];
    EXPECT_EQ(is.shape, was.shape);
    EXPECT_EQ(is.radius, was.radius);
    EXPECT_EQ(is.orientation.w, was.orientation.w);
    EXPECT_EQ(is.orientation.z, was.orientation.z);
  }
}

// Two clumps that touch at three pairs of spheres are one neighbour each; three would be what contacts alone say.
TEST(ClumpMeasure, CoordinationCountsNeighbourGrains) {
  std::vector<dem::Grain> grains(2);
  grains[1].id = 1;
  std::vector<dem::GrainContact> contacts(3);
  for (auto& contact : contacts) contact.id_i = 0, contact.id_j = 1;
  std::swap(contacts[1].id_i, contacts[1].id_j);
  EXPECT_EQ(coupling::coordination(grains, contacts, {{-1, -1, -1}, {1, 1, 1}}), 1);
}

}  // namespace
