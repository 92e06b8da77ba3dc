// Walls that move in scenes: what is read, what is refused, and probes of probes.
#include <gtest/gtest.h>

#include "coupling/wall_mesh.hpp"
#include "tests/unit/coupling_scene_file.hpp"

namespace {

using namespace scene_tests;

const std::string two_stages = R"([[stage]]
name = "wait"
duration = "20 ms"
[[stage]]
name = "pull"
duration = "20 ms"
measure = true
)";

const std::string plate = R"([[wall]]
name = "plate"
mesh = "box.geo"
body = { mass = "20 kg", moves = ["z"], weighs = false, damping = 40.0 }
motion = [ { stage = "pull", velocity = ["0.02 m/s", 0.0, 0.0] } ]
removed_at = "pull"
[[wall.load]]
kind = "stress"
area = "0.09 m2"
direction = [0.0, 0.0, -1.0]
history = { kind = "step", value = "27 kPa", start = "1 ms", start_stage = "pull" }
)";

TEST_F(SceneFile, WallMovesAsABodyUnderALoad) {
  const Scene scene = read(grains + one_grain + two_stages + plate);
  const auto& wall = scene.grains->walls.at(0);
  ASSERT_TRUE(wall.body);
  EXPECT_EQ(wall.body->is.mass, 20);
  EXPECT_TRUE(wall.body->is.moves[2] && !wall.body->is.moves[0] && !wall.body->is.turns[0]);
  EXPECT_FALSE(wall.body->is.weighs);
  EXPECT_FALSE(wall.body->centre);
  ASSERT_EQ(wall.body->loads.size(), 1u);
  EXPECT_EQ(wall.body->loads[0].direction.z, -0.09);
  EXPECT_EQ(wall.body->loads[0].history->value(0.0209), 0);
  EXPECT_EQ(wall.body->loads[0].history->value(0.0211), 27e3);
  ASSERT_EQ(wall.motions.size(), 1u);
  EXPECT_EQ(wall.motions[0].stage, 1);
  EXPECT_EQ(wall.motions[0].velocity.x, 0.02);
  EXPECT_EQ(wall.removed_at, 1);
}

TEST_F(SceneFile, WallMistakes) {
  const auto error = [&](const std::string& wall) { return error_of(grains + one_grain + two_stages + wall); };
  const std::string plane = "[[wall]]\nname = \"floor\"\nplane = { point = [0,0,0], normal = [0,0,1] }\n";
  EXPECT_NE(error(plane + "body = { mass = 1.0 }\n").find("a plane cannot be a body"), std::string::npos);
  EXPECT_NE(error(plane + "removed_at = \"pul\"\n").find("\"pull\""), std::string::npos);
  EXPECT_NE(error(plane + "packing_only = true\nrun_only = true\n").find("set one of the two"), std::string::npos);
  const std::string mesh = "[[wall]]\nname = \"plate\"\nmesh = \"box.geo\"\n";
  EXPECT_NE(error(mesh + "body = { mass = 1.0, turns = [\"x\"] }\n").find("turns about x needs a moment of inertia"),
            std::string::npos);
  EXPECT_NE(error(mesh + "body = { mass = 0.0 }\n").find("a.toml:"), std::string::npos);
  EXPECT_NE(
      error(mesh + "[[wall.load]]\nkind = \"force\"\ndirection = [1,0,0]\nhistory = { kind = \"constant\", value = "
                   "\"1 N\" }\n")
          .find("only a wall that is a body takes loads"),
      std::string::npos);
}

const std::string floor_force = R"([[wall]]
name = "floor"
plane = { point = [0,0,0], normal = [0,0,1] }
[[probe]]
name = "push"
kind = "contact_force"
wall = "floor"
component = "x"
[[probe]]
name = "weight"
kind = "contact_force"
wall = "floor"
[[probe]]
name = "way"
kind = "wall_displacement"
wall = "floor"
component = "x"
)";

TEST_F(SceneFile, ProbesOfProbes) {
  const Scene scene = read(grains + one_grain + stage + floor_force + R"([[probe]]
name = "slope"
kind = "angle"
of = ["push", "weight"]
[[probe]]
name = "area"
kind = "sum"
of = ["way"]
factors = [-0.3]
offset = 0.09
unit = "m2"
[[probe]]
name = "stress"
kind = "quotient"
of = ["push", "area"]
[[result]]
name = "stress_at_20mm"
probe = "stress"
take = "at"
over = "way"
level = "20 mm"
smoothed = "5 ms"
unit = "kPa"
)");
  EXPECT_EQ(scene.probes.at(3).unit, "rad");
  EXPECT_EQ(scene.probes.at(4).unit, "m2");
  EXPECT_EQ(scene.probes.at(4).of, std::vector<std::size_t>{2});
  EXPECT_EQ(scene.probes.at(5).unit, "N/m2");
  EXPECT_EQ(scene.results.at(0).level, 0.02);
  EXPECT_EQ(scene.results.at(0).smoothed, 0.005);
}

TEST_F(SceneFile, MistakesInProbesOfProbes) {
  const auto error = [&](const std::string& rest) { return error_of(grains + one_grain + stage + floor_force + rest); };
  const auto sum = [](const std::string& rest) { return "[[probe]]\nname = \"s\"\nkind = \"sum\"\n" + rest; };
  EXPECT_NE(error(sum("of = [\"later\"]\n")).find("probe before this one"), std::string::npos);
  EXPECT_NE(error(sum("of = [\"push\", \"way\"]\n")).find("adds m to N"), std::string::npos);
  EXPECT_NE(error(sum("of = [\"push\"]\nfactors = [1.0, 2.0]\n")).find("2 factors for 1 probes"), std::string::npos);
  EXPECT_NE(error(sum("of = [\"push\"]\nunit = \"kN\"\n")).find("must be an SI unit"), std::string::npos);
  EXPECT_NE(error("[[probe]]\nname = \"a\"\nkind = \"angle\"\nof = [\"push\", \"way\"]\n").find("make no angle"),
            std::string::npos);
  const std::string result = "[[result]]\nname = \"r\"\nprobe = \"push\"\n";
  EXPECT_NE(error(result + "take = \"at\"\nover = \"way\"\n").find("\"level\" is missing"), std::string::npos);
  EXPECT_NE(error(result + "level = \"1 mm\"\n").find("only take = \"at\" has a level"), std::string::npos);
}

// Faces as gmsh makes them: those of an extruded solid look either way.
TEST(WallMesh, FacesOfASolidLookOutwards) {
  coupling::WallScene wall;
  wall.name = "sleeper";
  wall.mesh = TRACKBED_SOURCE_FOLDER "/meshes/box.geo";
  wall.mesh_parameters = {{"length", 2.0}, {"cells_x", 3}, {"cells_y", 2}, {"cells_z", 1}};
  wall.translation = {-1, 5, 0.4};
  const base::Skin skin = coupling::read_wall_mesh(wall);
  EXPECT_EQ(skin.facets.size(), 2u * (3 * 2 + 3 * 1 + 2 * 1));
  base::Vec3 area;
  for (const auto& facet : skin.facets) {
    const auto node = [&](int k) { return skin.nodes[static_cast<std::size_t>(facet[static_cast<std::size_t>(k)])]; };
    const base::Vec3 middle = 0.25 * (node(0) + node(1) + node(2) + node(3));
    const base::Vec3 normal = 0.5 * cross(node(2) - node(0), node(3) - node(1));
    EXPECT_GT(dot(normal, middle - base::Vec3{0, 5, 0.4}), 0) << middle.x << ' ' << middle.y << ' ' << middle.z;
    area += normal;
  }
  EXPECT_LT(norm(area), 1e-12);
}

}  // namespace
