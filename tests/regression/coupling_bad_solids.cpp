// What a user who describes a solid wrongly is told, by `trackbed check` and by `trackbed run`: exit 2, the line, what
// was found and what to do; nothing is written.
#include <gtest/gtest.h>

#include <vector>

#include "tests/regression/run_helper.hpp"

namespace {

using namespace regression;

struct Case {
  const char *name, *fem;  // [fem], or nothing
  const char* mesh;        // "" for the box of the meshes folder
  const char *material, *parts;
  std::vector<const char*> said;
};
std::ostream& operator<<(std::ostream& out, const Case& wrong) { return out << wrong.name; }

constexpr const char* sound = "young_modulus = 1e9\npoisson_ratio = 0.2\ndensity = 2000\n";

/// One hexahedron in "solid"; its corner 7 is where it turns the cell inside out.
constexpr const char* inverted =
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 1 \"solid\"\n$EndPhysicalNames\n$Nodes\n8\n"
    "1 0 0 0\n2 2 0 0\n3 2 2 0\n4 0 2 0\n5 0 0 1\n6 2 0 1\n7 -1 -1 1\n8 0 2 1\n$EndNodes\n"
    "$Elements\n1\n1 5 2 1 1 1 2 3 4 5 6 7 8\n$EndElements\n";

/// Two hexahedra that share an edge along y, the first on its "foot"; the load along y does not turn them.
constexpr const char* hinged =
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n3 1 \"solid\"\n2 2 \"foot\"\n$EndPhysicalNames\n"
    "$Nodes\n14\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 0 0 1\n6 1 0 1\n7 1 1 1\n8 0 1 1\n9 2 0 1\n10 2 1 1\n"
    "11 1 0 2\n12 2 0 2\n13 2 1 2\n14 1 1 2\n$EndNodes\n"
    "$Elements\n3\n1 5 2 1 1 1 2 3 4 5 6 7 8\n2 5 2 1 1 6 9 10 7 11 12 13 14\n3 3 2 2 2 1 2 3 4\n$EndElements\n";
constexpr const char* on_foot = "[[body.support]]\ngroup = \"foot\"\nfix = [\"x\", \"y\", \"z\"]\n";

/// One hexahedron that is there twice.
constexpr const char* twice =
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 1 \"solid\"\n$EndPhysicalNames\n$Nodes\n8\n"
    "1 0 0 0\n2 2 0 0\n3 2 2 0\n4 0 2 0\n5 0 0 1\n6 2 0 1\n7 2 2 1\n8 0 2 1\n$EndNodes\n"
    "$Elements\n2\n1 5 2 1 1 1 2 3 4 5 6 7 8\n2 5 2 1 1 1 2 3 4 5 6 7 8\n$EndElements\n";

struct BadSolids : testing::TestWithParam<Case> {};

TEST_P(BadSolids, AreRefused) {
  const Case& wrong = GetParam();
  const fs::path file = scratch() / (std::string(wrong.name) + ".toml"), out = scratch() / wrong.name;
  std::string mesh = std::string(TRACKBED_SOURCE_FOLDER) + "/meshes/box.geo";
  if (*wrong.mesh) {
    mesh = (scratch() / (std::string(wrong.name) + ".msh")).string();
    std::ofstream(mesh) << wrong.mesh;
  }
  std::ofstream(file) << wrong.fem << "[[body]]\nname = \"block\"\nmesh = \"" << mesh << "\"\n[[body.material]]\n"
                      << wrong.material << wrong.parts << "[[stage]]\nname = \"rest\"\nduration = 1e-3\n";
  for (const std::string& command :
       {"check '" + file.string() + "'", "run '" + file.string() + "' --out '" + out.string() + "'"}) {
    const auto finished = trackbed(command);
    EXPECT_EQ(finished.status, 2) << command << "\n" << finished.output;
    for (const char* part : wrong.said)
      EXPECT_NE(finished.output.find(part), std::string::npos) << command << "\n"
                                                               << finished.output << "\nlacks " << part;
  }
  EXPECT_FALSE(fs::exists(out));
}

INSTANTIATE_TEST_SUITE_P(
    Solids, BadSolids,
    testing::Values(
        Case{"inverted",
             "",
             inverted,
             sound,
             "",
             {"inverted.toml:1: body \"block\": ", "element 1 at (0.625, 0.625, 0.5) m is flat or inside out"}},
        Case{"no_group",
             "",
             "",
             sound,
             "[[body.support]]\ngroup = \"left\"\nfix = [\"x\"]\n",
             {"no_group.toml:8: body \"block\": support.group = \"left\"; the mesh has no such physical group; it has: "
              "solid, x_max, x_min, y_max, y_min, z_max, z_min"}},
        Case{"no_volume",
             "",
             "",
             "group = \"concrete\"\nyoung_modulus = 1e9\npoisson_ratio = 0.2\ndensity = 2000\n",
             "",
             {"no_volume.toml:4: body \"block\": material.group = \"concrete\"", "it has: solid"}},
        Case{"incompressible",
             "",
             "",
             "young_modulus = 1e9\npoisson_ratio = 0.5\ndensity = 2000\n",
             "",
             {"incompressible.toml:", "poisson_ratio = 0.5; must be in (-1, 0.5)"}},
        Case{"weightless",
             "",
             "",
             "young_modulus = 1e9\npoisson_ratio = 0.2\ndensity = -2000\n",
             "",
             {"weightless.toml:7: body.block.material.density = -2000", "must be > 0"}},
        Case{"held_load",
             "",
             "",
             sound,
             "[[body.support]]\ngroup = \"x_min\"\nfix = [\"x\"]\n[[body.load]]\nname = \"push\"\nkind = "
             "\"face_total\"\n"
             "group = \"x_min\"\ndirection = [1, 0, 0]\nhistory = { kind = \"constant\", value = 1 }\n",
             {"held_load.toml:11: body \"block\": load.group = \"x_min\" is held by supports in the direction of the "
              "load; "
              "the load would do nothing"}},
        Case{"loose",
             "[fem]\nsolver = \"static\"\n",
             "",
             sound,
             "[[body.support]]\ngroup = \"z_min\"\nfix = [\"z\"]\n",
             {"loose.toml:3: body \"block\": nothing holds it against translation along x, translation along y, "
              "rotation "
              "about z through (1.2, 0, 0) m; there is no equilibrium, the static system is singular; add a "
              "[[body.support]] that fixes it"}},
        Case{"hinged",
             "[fem]\nsolver = \"static\"\n",
             hinged,
             sound,
             on_foot,
             {"hinged.toml:3: body \"block\": 1 cell round (0.5, 0.5, 0.5) m and 1 cell round (1.5, 0.5, 1.5) m share "
              "no more than the edge from (1, 0, 1) to (1, 1, 1) m and turn against each other about the axis (0, 1, "
              "0): there is no equilibrium, the static system is singular; join the cells by whole faces in the mesh, "
              "or hold both sides by supports"}},
        Case{"twice",
             "",
             twice,
             sound,
             "",
             {"twice.toml:1: body \"block\": elements 1 and 2 at (1, 1, 0.5) m have the same corners; the mesh holds "
              "this cell twice"}},
        Case{"far_probe",
             "",
             "",
             sound,
             "[[probe]]\nname = \"u\"\nkind = \"displacement\"\nbody = \"block\"\npoint = [0, 0, 50]\ncomponent = "
             "\"z\"\n",
             {"far_probe.toml:8: probe \"u\": body \"block\": point = (0, 0, 50) m lies ",
              "lies 49.9 m from the nearest node, at (0, 0, 0.11) m", "farther than the elements there are large"}},
        Case{"seam",
             "",
             "",
             sound,
             "[[body.periodic]]\nfirst = \"x_min\"\nsecond = \"z_max\"\n",
             {"seam.toml:8: body \"block\": node ", " of periodic.second = \"z_max\" at (",
              ") m in \"x_min\"; mesh both faces alike (transfinite, or Periodic Surface in the .geo)"}}),
    [](const auto& info) { return std::string(info.param.name); });

// In time a hinge is well posed: the scene runs, with a word in the check and in the log.
TEST(Hinges, AreSaidInDynamics) {
  const fs::path mesh = scratch() / "hinge.msh", file = scratch() / "hinge.toml", out = scratch() / "hinge";
  std::ofstream(mesh) << hinged;
  std::ofstream(file) << "[[body]]\nname = \"block\"\nmesh = \"" << mesh.string() << "\"\n[[body.material]]\n"
                      << sound << on_foot << "[[stage]]\nname = \"rest\"\nduration = 1e-4\n";
  for (const std::string& command :
       {"check '" + file.string() + "'", "run '" + file.string() + "' --out '" + out.string() + "'"}) {
    const auto finished = trackbed(command);
    EXPECT_EQ(finished.status, 0) << command << "\n" << finished.output;
    EXPECT_NE(finished.output.find("turn against each other about the axis (0, 1, 0): nothing resists it"),
              std::string::npos)
        << finished.output;
  }
}

}  // namespace
