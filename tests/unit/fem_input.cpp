// What fem answers to wrong input: who, which key, what was found, and what to do. A code that lets one of these
// through would compute nonsense or stop without a word.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "base/error.hpp"
#include "tests/fem_helper.hpp"

namespace {

using fem_test::box;
using fem_test::history;

testing::Environment* const petsc = testing::AddGlobalTestEnvironment(new fem_test::PetscEnvironment);

/// The message of the error that making a model of this body gives.
std::string message_of(const fem::Body& body) {
  try {
    fem::Model::create(MPI_COMM_SELF, {{body}, {}});
  } catch (const base::UserError& error) {
    return error.what();
  }
  return "no error";
}

std::string written(const std::string& name, const std::string& text) {
  const auto file = std::filesystem::temp_directory_path() / ("trackbed_" + std::to_string(getpid()) + "_" + name);
  std::ofstream(file) << text;
  return file.string();
}

void expect_message(const fem::Body& body, const std::vector<std::string>& parts) {
  const std::string message = message_of(body);
  for (const auto& part : parts) EXPECT_NE(message.find(part), std::string::npos) << message << "\nlacks: " << part;
}

/// A mesh file with one hexahedron of these corners in the physical volume "solid".
std::string one_hexahedron(const std::string& corners) {
  return "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 1 \"solid\"\n$EndPhysicalNames\n$Nodes\n8\n" +
         corners + "$EndNodes\n$Elements\n1\n1 5 2 1 1 1 2 3 4 5 6 7 8\n$EndElements\n";
}

TEST(FemInput, GoodBodyIsTaken) { EXPECT_EQ(message_of(box("hex8", {})), "no error"); }

TEST(FemInput, MissingMeshFile) {
  auto body = box("hex8", {});
  body.mesh_file = "nowhere.geo";
  expect_message(body, {"scene.toml:3: body \"box\": mesh = \"nowhere.geo\"; there is no such file"});
}

TEST(FemInput, BrokenGeometryQuotesGmsh) {
  auto body = box("hex8", {});
  body.mesh_parameters.clear();
  body.mesh_file = written("broken.geo", "Point(1) = {0, 0, 0;\n");
  expect_message(body,
                 {"scene.toml:3: body \"box\": mesh = ", "gmsh cannot make a mesh of it: ", "line 1", "syntax error"});
}

TEST(FemInput, BrokenMeshFile) {
  auto body = box("hex8", {});
  body.mesh_parameters.clear();
  body.mesh_file = written("broken.msh", "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n8\n1 0 0\n");
  expect_message(body, {"scene.toml:3: body \"box\": mesh = ", "gmsh cannot make a mesh of it: "});
}

TEST(FemInput, UnknownMeshParameterListsThoseThere) {
  auto body = box("hex8", {});
  body.mesh_parameters["lenght"] = 2;
  expect_message(body, {"mesh_parameters.lenght = 2", "has no such parameter",
                        "it has: cells_x, cells_y, cells_z, height, length, width"});
}

TEST(FemInput, NoThickness) {
  auto body = box("hex8", {1, 1, 0, 1, 1, 1});
  expect_message(body, {"length, width and height must be positive"});
}

TEST(FemInput, FlatElementNamesItsPlace) {
  auto body = box("hex8", {});
  body.mesh_parameters.clear();
  body.mesh_file =
      written("flat.msh", one_hexahedron("1 0 0 0\n2 2 0 0\n3 2 2 0\n4 0 2 0\n5 0 0 0\n6 2 0 0\n7 2 2 0\n8 0 2 0\n"));
  expect_message(body, {"element 1 at (1, 1, 0) m is flat or inside out", "a layer of no thickness"});
}

TEST(FemInput, InvertedElementNamesItsPlace) {
  auto body = box("hex8", {});
  body.mesh_parameters.clear();
  body.mesh_file = written(
      "inverted.msh", one_hexahedron("1 0 0 0\n2 2 0 0\n3 2 2 0\n4 0 2 0\n5 0 0 1\n6 2 0 1\n7 -1 -1 1\n8 0 2 1\n"));
  expect_message(body, {"element 1 at (0.625, 0.625, 0.5) m is flat or inside out"});
}

TEST(FemInput, CellThatIsThereTwice) {
  auto body = box("hex8", {});
  body.mesh_parameters.clear();
  std::string mesh = one_hexahedron("1 0 0 0\n2 2 0 0\n3 2 2 0\n4 0 2 0\n5 0 0 1\n6 2 0 1\n7 2 2 1\n8 0 2 1\n");
  const std::string one = "$Elements\n1\n1 5 2 1 1 1 2 3 4 5 6 7 8\n";
  mesh.replace(mesh.find(one), one.size(), "$Elements\n2\n1 5 2 1 1 1 2 3 4 5 6 7 8\n2 5 2 1 1 2 3 4 1 6 7 8 5\n");
  body.mesh_file = written("twice.msh", mesh);
  for (const char* element : {"hex8", "hex20", "tet4"}) {
    body.element = element;
    expect_message(body, {"scene.toml:3: body \"box\": elements 1 and 2 at (1, 1, 0.5) m have the same corners; the "
                          "mesh holds this cell twice, with twice its mass and stiffness; take one out"});
  }
}

TEST(FemInput, UnknownGroupsListThoseThere) {
  const std::string groups = "it has: solid, x_max, x_min, y_max, y_min, z_max, z_min";
  auto body = box("hex8", {});
  body.supports = {{"left", {true, true, true}, "scene.toml:9"}};
  expect_message(body, {"scene.toml:9: body \"box\": support.group = \"left\"", groups});
  body.supports.clear();
  body.loads = {
      {"push", "right", fem::LoadKind::face_total, {1, 0, 0}, history([](double) { return 1; }), "scene.toml:11"}};
  expect_message(body, {"scene.toml:11: body \"box\": load.group = \"right\"", groups});
  body.loads.clear();
  body.skin = {"upper"};
  expect_message(body, {"skin = \"upper\"", groups});
  body.skin = {"solid"};
  expect_message(body, {"skin = \"solid\" is not an outer surface"});
  body.skin.clear();
  body.materials[0].group = "concrete";
  expect_message(body, {"scene.toml:7: body \"box\": material.group = \"concrete\"", "it has: solid"});
}

TEST(FemInput, MaterialsCoverEveryCellOnce) {
  auto body = box("hex8", {});
  body.mesh_parameters.clear();
  body.mesh_file = TRACKBED_SOURCE_FOLDER "/meshes/ground.geo";
  body.materials[0].group = "formation";
  expect_message(body, {"the physical volume \"subgrade\" has no material"});
  body.materials.push_back(body.materials[0]);
  expect_message(body, {"material.group = \"formation\" shares cells with material.group = \"formation\""});
  body.materials.clear();
  expect_message(body, {"has no material"});
}

TEST(FemInput, MaterialRanges) {
  auto body = box("hex8", {});
  body.materials[0].poisson_ratio = 0.5;
  expect_message(body, {"scene.toml:7: body \"box\": poisson_ratio = 0.5; must be in (-1, 0.5)", "hex8_bbar"});
  body = box("hex8", {});
  body.materials[0].young_modulus = 0;
  expect_message(body, {"young_modulus = 0; must be > 0 Pa"});
  body = box("hex8", {});
  body.materials[0].density = -1;
  expect_message(body, {"density = -1; must be > 0 kg/m3"});
  body = box("hex8", {});
  body.materials[0].law = "rubber";
  expect_message(body, {"law = \"rubber\"; must be one of: linear_elastic, kelvin_voigt, left_cauchy_green"});
}

TEST(FemInput, ElementThatDoesNotFitTheMesh) {
  auto body = box("hex27", {});
  expect_message(body,
                 {"element = \"hex27\"; must be one of: hex8, hex8_bbar, hex8_incompatible, hex8_one_point, hex20, "
                  "hex20_reduced, tet4, tet10"});
  body.element = "hex8";
  body.mesh_parameters.clear();
  body.mesh_file =
      written("tetrahedra.geo",
              "SetFactory(\"Built-in\"); Point(1) = {0,0,0,1}; Point(2) = {1,0,0,1}; Point(3) = {0,1,0,1}; "
              "Line(1) = {1,2}; Line(2) = {2,3}; Line(3) = {3,1}; Curve Loop(1) = {1,2,3}; Plane Surface(1) = {1}; "
              "o[] = Extrude {0,0,1} { Surface{1}; }; Physical Volume(\"solid\") = {o[1]};\n");
  expect_message(body, {"element = \"hex8\" needs hexahedra", "holds tetrahedra", "use element = \"tet4\""});
  for (const char* element : {"tet4", "tet10"}) {
    body.element = element;
    EXPECT_EQ(message_of(body), "no error");
  }
}

/// The unit cube as one hexahedron of twenty nodes in gmsh's order; the middle of its edge 0-1 at the given height.
std::string one_hex20(double height) {
  std::string nodes = "1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 0 0 1\n6 1 0 1\n7 1 1 1\n8 0 1 1\n";
  nodes += "9 .5 0 " + std::to_string(height) + "\n10 0 .5 0\n11 0 0 .5\n12 1 .5 0\n13 1 0 .5\n14 .5 1 0\n15 1 1 .5\n";
  nodes += "16 0 1 .5\n17 .5 0 1\n18 0 .5 1\n19 1 .5 1\n20 .5 1 1\n";
  return "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 1 \"solid\"\n$EndPhysicalNames\n$Nodes\n20\n" +
         nodes +
         "$EndNodes\n$Elements\n1\n1 17 2 1 1 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20\n$EndElements\n";
}

// A wrong order of the middle nodes would turn the cube inside out somewhere, or give it another volume.
TEST(FemInput, MeshesOfTheSecondOrder) {
  auto body = box("hex20", {});
  body.mesh_parameters.clear();
  body.mesh_file = written("hex20.msh", one_hex20(0));
  const auto model = fem::Model::create(MPI_COMM_SELF, {{body}, {}});
  EXPECT_EQ(model->counts()[0].nodes, 20);
  EXPECT_NEAR(model->counts()[0].mass, 2350, 1e-9);
  body.element = "hex8";
  expect_message(body, {"element = \"hex8\" has no middle nodes", "use element = \"hex20\", or mesh with"});
  body.element = "tet10";
  expect_message(body, {"element = \"tet10\" needs tetrahedra, or hexahedra of 8 nodes to cut"});
  body.element = "hex20";
  body.mesh_file = written("bent.msh", one_hex20(1.9));
  expect_message(body, {"element 1 at (0.5, 0.5, 0.595) m is bent inside out by its middle nodes"});
}

// Made by gmsh or cut here, second-order boxes have the volume of the box, and groups have their middles.
TEST(FemInput, BoxesOfTheSecondOrder) {
  for (const char* element : {"hex20", "hex20_reduced", "tet10"}) {
    const auto model = fem::Model::create(MPI_COMM_SELF, {{box(element, {1, 2, 3, 2, 1, 1})}, {}});
    EXPECT_EQ(model->counts()[0].elements, std::string(element) == "tet10" ? 12 : 2);
    EXPECT_EQ(model->counts()[0].nodes, std::string(element) == "tet10" ? 45 : 32);
    EXPECT_NEAR(model->counts()[0].mass, 6 * 2350, 1e-8);
    auto held = box(element, {1, 2, 3, 2, 1, 1});
    held.supports = {{"x_min", {true, true, true}, ""}};
    held.loads = {{"push", "x_min", fem::LoadKind::nodal_total, {1, 0, 0}, history([](double) { return 1; }), ""}};
    expect_message(held, {"is held by supports"});  // all of its nodes, middles too
  }
}

TEST(FemInput, BoundariesThatCannotBe) {
  auto body = box("hex8", {});
  body.supports = {{"x_min", {true, true, true}, "scene.toml:9"}};
  body.motions = {{"shake",
                   "x_min",
                   fem::PrescribedMotion::Kind::displacement,
                   {true, false, false},
                   history([](double) { return 0; }),
                   "scene.toml:12"}};
  expect_message(body,
                 {"scene.toml:12: body \"box\": motion.group = \"x_min\" has nodes that a support or another motion "
                  "leads along x"});
  body.motions.clear();
  body.absorbing = {{"solid", "scene.toml:14"}};
  expect_message(body, {"scene.toml:14: body \"box\": absorbing.group = \"solid\" is not an outer surface"});
  body.absorbing.clear();
  body.stiffness_damping = -1;
  expect_message(body, {"stiffness_damping = -1; must be >= 0 s"});
}

TEST(FemInput, PeriodicFacesThatDoNotFit) {
  auto body = box("hex8", {});
  body.periodic = {{"x_min", "z_max", "scene.toml:9"}};
  expect_message(body, {"scene.toml:9: body \"box\": node ",
                        " of periodic.second = \"z_max\" at (1, -0.5, 0.5) m has no partner at (1, -0.5, -0.5) m in "
                        "\"x_min\"; mesh both faces alike"});
  body.periodic = {{"x_min", "x_min", ""}};
  expect_message(body, {"periodic.second = \"x_min\" lies where periodic.first = \"x_min\" does"});
  body.periodic = {{"x_min", "solid", ""}};
  expect_message(body, {"periodic.second = \"solid\" is not an outer surface of the body"});
  body.periodic = {{"left", "x_max", ""}};
  expect_message(body, {"periodic.first = \"left\"; the mesh has no such physical group; it has: "});
}

TEST(FemInput, LoadOnAHeldGroup) {
  auto body = box("hex8", {});
  body.supports = {{"x_min", {true, true, true}, "scene.toml:9"}};
  body.loads = {
      {"push", "x_min", fem::LoadKind::face_total, {1, 0, 0}, history([](double) { return 1; }), "scene.toml:11"}};
  expect_message(body, {"scene.toml:11: body \"box\": load.group = \"x_min\" is held by supports", "do nothing"});
}

TEST(FemInput, LoadOverAnAreaNeedsASurface) {
  auto body = box("hex8", {});
  body.loads = {
      {"push", "solid", fem::LoadKind::traction, {1, 0, 0}, history([](double) { return 1; }), "scene.toml:11"}};
  expect_message(body, {"load.group = \"solid\" is not a surface", "nodal_total"});
}

TEST(FemInput, TwoBodiesOfOneName) {
  try {
    fem::Model::create(MPI_COMM_SELF, {{box("hex8", {}), box("tet4", {})}, {}});
    FAIL() << "taken";
  } catch (const base::UserError& error) {
    EXPECT_STREQ(error.what(), "scene.toml:3: body \"box\": there are two bodies of this name");
  }
}

}  // namespace
