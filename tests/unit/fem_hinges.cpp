// Hinges inside a body, on bricks of a lattice: how many motions, about which axis, where. A code that counts supports
// of the whole only, or that takes every shared node for a joint, misses them or names sound meshes.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <random>

#include "base/error.hpp"
#include "fem/cells.hpp"
#include "fem/hinges.hpp"
#include "fem/rigid_motions.hpp"
#include "tests/fem_helper.hpp"

namespace {

using base::Vec3;
using Cells = std::vector<std::array<int, 3>>;
using Held = std::vector<std::array<bool, 3>>;

/// Bricks at these places of a lattice of unit cells; `place` maps its points to space.
fem::Mesh bricks(
    const Cells& cells, const std::function<Vec3(Vec3)>& place = [](Vec3 x) { return x; }) {
  constexpr int corner[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  fem::RawMesh raw;
  raw.cell_nodes = 8;
  std::map<std::array<int, 3>, int> numbers;
  fem::Mesh mesh;
  mesh.element_nodes = 8;
  for (const auto& at : cells) {
    std::array<int, 20> cell{};
    for (int a = 0; a < 8; ++a) {
      const std::array<int, 3> point{at[0] + corner[a][0], at[1] + corner[a][1], at[2] + corner[a][2]};
      const auto [known, fresh] = numbers.try_emplace(point, static_cast<int>(mesh.nodes.size()));
      if (fresh) mesh.nodes.push_back(place({double(point[0]), double(point[1]), double(point[2])}));
      cell[a] = known->second;
    }
    raw.cells.push_back(cell);
    mesh.elements.insert(mesh.elements.end(), cell.begin(), cell.begin() + 8);
    mesh.regions.push_back(0);
  }
  mesh.rigid_parts = fem::FaceTable(raw).rigid_parts(mesh.element_count());
  return mesh;
}

/// Holds the components of nodes where `at` says so.
Held held(const fem::Mesh& mesh, const std::array<bool, 3>& along, const std::function<bool(Vec3)>& at) {
  Held held(mesh.nodes.size(), {false, false, false});
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
    if (at(mesh.nodes[i])) held[i] = along;
  }
  return held;
}

Held nothing(const fem::Mesh& mesh) {
  return held(mesh, {}, [](Vec3) { return false; });
}

int motions_of(const fem::Mesh& mesh, const Held& held) { return fem::find_hinges(mesh, held).motions; }

void expect_near(const Vec3& found, const Vec3& expected) {
  EXPECT_LT(base::norm(found - expected), 1e-12) << found.x << " " << found.y << " " << found.z;
}

const Cells on_an_edge{{0, 0, 0}, {1, 0, 1}}, on_a_node{{0, 0, 0}, {1, 1, 1}};

// Turned in space, of 0.1 m: the axis and its ends come with the mesh.
TEST(FemHinges, EdgeIsNamed) {
  const Vec3 e1{2.0 / 3, -1.0 / 3, 2.0 / 3}, e2{2.0 / 3, 2.0 / 3, -1.0 / 3}, e3 = base::cross(e1, e2);
  const auto place = [&](Vec3 x) { return (e1 * x.x + e2 * x.y + e3 * x.z) * 0.1 + Vec3{5, 6, 7}; };
  const auto mesh = bricks(on_an_edge, place);
  for (const bool supported : {true, false}) {
    const auto found = fem::find_hinges(mesh, held(mesh, {true, true, true}, [&](Vec3 x) {
                                          return supported && base::dot(x - Vec3{5, 6, 7}, e3) < 1e-6;
                                        }));
    EXPECT_EQ(found.motions, 1);
    ASSERT_EQ(found.joints.size(), 1u);
    const auto& hinge = found.joints.front();
    ASSERT_EQ(hinge.axes.size(), 1u);
    expect_near(hinge.from, place({1, 0, 1}));
    expect_near(hinge.to, place({1, 1, 1}));
    expect_near(hinge.axes[0], e2);
    expect_near(hinge.first.centre, place({0.5, 0.5, 0.5}));
    EXPECT_EQ(hinge.second.cells, 1);
  }
}

TEST(FemHinges, NodeTurnsAboutThreeAxes) {
  const auto mesh = bricks(on_a_node);
  const auto found = fem::find_hinges(mesh, nothing(mesh));
  EXPECT_EQ(found.motions, 3);
  ASSERT_EQ(found.joints.size(), 1u);
  EXPECT_EQ(found.joints[0].axes.size(), 3u);
  expect_near(found.joints[0].from, {1, 1, 1});
  EXPECT_EQ(fem::describe(found),
            "1 cell round (0.5, 0.5, 0.5) m and 1 cell round (1.5, 1.5, 1.5) m share no more than the node at (1, 1, "
            "1) m and turn against each other about any axis through it");
}

// A roller off the axis locks the far brick, one on the axis or along it does not. Its three components at one node
// leave a brick at a node the turn about the line through both.
TEST(FemHinges, SupportsLock) {
  const auto mesh = bricks(on_an_edge);
  const auto with = [](const fem::Mesh& at, const std::array<bool, 3>& along, Vec3 point) {
    auto all = held(at, {true, true, true}, [](Vec3 x) { return x.z == 0; });
    const auto more = held(at, along, [&](Vec3 x) { return base::norm(x - point) < 1e-9; });
    for (std::size_t i = 0; i < all.size(); ++i) {
      for (int c = 0; c < 3; ++c) all[i][c] = all[i][c] || more[i][c];
    }
    return all;
  };
  EXPECT_EQ(motions_of(mesh, with(mesh, {false, false, true}, {2, 0, 2})), 0);
  EXPECT_EQ(motions_of(mesh, with(mesh, {true, true, true}, {1, 0, 1})), 1);
  EXPECT_EQ(motions_of(mesh, with(mesh, {false, true, false}, {2, 0, 2})), 1);
  const auto ball = bricks(on_a_node);
  const auto found = fem::find_hinges(ball, with(ball, {true, true, true}, {2, 2, 2}));
  EXPECT_EQ(found.motions, 1);
  ASSERT_EQ(found.joints.size(), 1u);
  ASSERT_EQ(found.joints[0].axes.size(), 1u);
  expect_near(found.joints[0].axes[0], Vec3{1, 1, 1} * (1 / std::sqrt(3.0)));
}

// Four bars on four parallel hinges: one motion (Gruebler: 3 (4 - 1) - 2 * 4); three bars on three: none; the same ring
// with a brick in the middle that shares faces with all: none. Two hinges of the same two parts hold each other.
TEST(FemHinges, Rings) {
  const auto four = bricks({{1, 0, 0}, {2, 1, 0}, {1, 2, 0}, {0, 1, 0}});
  const auto found = fem::find_hinges(four, nothing(four));
  EXPECT_EQ(found.motions, 1);
  EXPECT_EQ(found.joints.size(), 4u);
  for (const auto& joint : found.joints) expect_near(joint.axes.at(0), {0, 0, 1});
  EXPECT_NE(fem::describe(found).find("about the axis (0, 0, 1), as others do at 3 more such joints"),
            std::string::npos)
      << fem::describe(found);
  const auto filled = bricks({{1, 0, 0}, {2, 1, 0}, {1, 2, 0}, {0, 1, 0}, {1, 1, 0}});
  EXPECT_TRUE(filled.rigid_parts.empty());
  const auto three = bricks({{0, 0, 0}, {1, 1, 0}, {-1, 1, 0}, {-1, 2, 0}, {0, 2, 0}});
  EXPECT_EQ(three.rigid_parts, (std::vector<int>{0, 1, 2, 2, 2}));
  EXPECT_EQ(motions_of(three, nothing(three)), 0);
  const auto two = bricks({{0, 0, 0}, {1, 0, 0}, {-1, 1, 0}, {-1, 2, 0}, {0, 2, 0}, {1, 2, 0}, {2, 2, 0}, {2, 1, 0}});
  EXPECT_EQ(two.rigid_parts.back(), 1);
  EXPECT_EQ(motions_of(two, nothing(two)), 0);
}

/// Motions of all bricks, each a rigid body of its own, with every node of theirs in common.
int motions_of_single_bricks(const fem::Mesh& mesh, const Held& held) {
  std::map<int, std::vector<int>> cells;  // at each node
  for (int e = 0; e < mesh.element_count(); ++e) {
    for (int a = 0; a < 8; ++a) cells[mesh.element(e)[a]].push_back(e);
  }
  const int size = 6 * mesh.element_count();
  std::vector<std::vector<double>> gram(size, std::vector<double>(size, 0.0));
  const auto add = [&](int node, int c, int one, int other) {  // square of the difference, or of one where other < 0
    std::vector<std::pair<int, double>> row;
    for (const auto& [e, sign] : {std::pair{one, 1.0}, std::pair{other, -1.0}}) {
      for (int k = 0; k < 6 && e >= 0; ++k)
        row.emplace_back(6 * e + k, sign * fem::rigid_motion(k, mesh.nodes[node] - mesh.nodes[mesh.element(e)[0]])[c]);
    }
    for (const auto& [i, x] : row) {
      for (const auto& [j, y] : row) gram[i][j] += x * y;
    }
  };
  for (const auto& [node, of] : cells) {
    for (int c = 0; c < 3; ++c) {
      if (held[node][c]) add(node, c, of[0], -1);
      for (std::size_t i = 1; i < of.size(); ++i) add(node, c, of[i], of[0]);
    }
  }
  for (int rank = 0; rank < size; ++rank) {  // elimination, the largest pivot of the diagonal first
    int pivot = 0;
    for (int i = 1; i < size; ++i) {
      if (gram[i][i] > gram[pivot][pivot]) pivot = i;
    }
    if (gram[pivot][pivot] < 1e-9) return size - rank;
    const auto row = gram[pivot];
    for (int i = 0; i < size; ++i) {
      for (int j = 0; j < size; ++j) gram[i][j] -= row[i] * row[j] / row[pivot];
    }
    gram[pivot][pivot] = 0;
  }
  return 0;
}

// Bricks thrown into 3 x 3 x 2 places, some nodes held: as many motions as without knowing of faces, less those of the
// connected meshes as wholes.
TEST(FemHinges, RandomBricks) {
  std::mt19937 random(7);
  int with = 0;
  for (int trial = 0; trial < 30; ++trial) {
    Cells cells;
    for (int place = 0; place < 18; ++place) {
      if (random() % 5 < 2) cells.push_back({place % 3, place / 3 % 3, place / 9});
    }
    if (cells.empty()) continue;
    const auto mesh = bricks(cells);
    auto some = nothing(mesh);
    for (auto& node : some) {
      for (bool& component : node) component = trial % 2 == 1 && random() % 12 == 0;
    }
    const int wholes = static_cast<int>(fem::find_mechanisms(mesh, some).free.size());
    const auto found = fem::find_hinges(mesh, some);
    EXPECT_EQ(found.motions, motions_of_single_bricks(mesh, some) - wholes) << "trial " << trial;
    EXPECT_EQ(found.motions > 0, !found.joints.empty()) << "trial " << trial;
    with += found.motions > 0;
  }
  EXPECT_GE(with, 10);
}

// Stairs of n bricks, each on an edge of the last: n - 1 motions. Too many for one matrix: the loose end is found.
TEST(FemHinges, Stairs) {
  for (const int steps : {12, fem::most_parts + 10}) {
    Cells cells;
    for (int k = 0; k < steps; ++k) cells.push_back({k, 0, k});
    const auto mesh = bricks(cells);
    const auto found = fem::find_hinges(mesh, held(mesh, {true, true, true}, [](Vec3 x) { return x.z == 0; }));
    EXPECT_EQ(found.motions, steps > fem::most_parts ? 1 : steps - 1);
    EXPECT_EQ(found.joints.size(), steps > fem::most_parts ? 1u : std::size_t(steps - 1));
  }
}

// Three bricks in a row on two hinges: two motions. Where the outer ones' far faces are one, the row is a ring: none.
TEST(FemHinges, SeamsJoin) {
  auto row = bricks({{0, 0, 0}, {1, 0, 1}, {2, 0, 0}});
  const auto foot = held(row, {true, true, true}, [](Vec3 x) { return x.x < 1.5 && x.z == 0; });
  EXPECT_EQ(motions_of(row, foot), 2);
  row.shared.resize(row.nodes.size());
  for (std::size_t i = 0; i < row.nodes.size(); ++i) {
    row.shared[i] = static_cast<int>(i);
    for (std::size_t j = 0; j < i; ++j) {
      if (base::norm(row.nodes[i] - row.nodes[j] - Vec3{3, 0, 0}) < 1e-9) row.shared[i] = static_cast<int>(j);
    }
  }
  EXPECT_EQ(motions_of(row, foot), 0);
}

// ---- through the model
std::string outcome(fem::Solver kind, const fem::Body& body) {
  fem::Setup setup{{body}, {0, 0, 0}};
  setup.solver.kind = kind;
  try {
    const auto warnings = fem::Model::create(MPI_COMM_SELF, setup)->warnings();
    return warnings.empty() ? "nothing" : "warning: " + warnings.at(0);
  } catch (const base::UserError& error) {
    return error.what();
  }
}

// A pull along the axis does not move it: the matrix is singular all the same. Motion in time is well posed.
TEST(FemHinges, WhatTheSolversSay) {
  const auto file = std::filesystem::temp_directory_path() / ("trackbed_" + std::to_string(getpid()) + "_hinge.msh");
  std::ofstream(file) << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n3 1 \"solid\"\n2 2 \"foot\"\n2 3 "
                         "\"end\"\n$EndPhysicalNames\n$Nodes\n14\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 0 0 1\n6 1 0 "
                         "1\n7 1 1 1\n8 0 1 1\n9 2 0 1\n10 2 1 1\n11 1 0 2\n12 2 0 2\n13 2 1 2\n14 1 1 2\n$EndNodes\n"
                         "$Elements\n4\n1 5 2 1 1 1 2 3 4 5 6 7 8\n2 5 2 1 1 6 9 10 7 11 12 13 14\n3 3 2 2 2 1 2 3 4\n"
                         "4 3 2 3 3 9 10 13 12\n$EndElements\n";
  auto body = fem_test::box("hex8", {});
  body.mesh_parameters.clear();
  body.mesh_file = file.string();
  body.supports = {{"foot", {true, true, true}, ""}};
  body.loads = {{"pull", "end", fem::LoadKind::face_total, {0, 1, 0}, fem_test::history([](double) { return 1; }), ""}};
  const std::string what =
      "scene.toml:3: body \"box\": 1 cell round (0.5, 0.5, 0.5) m and 1 cell round (1.5, 0.5, 1.5) m share no more "
      "than the edge from (1, 0, 1) to (1, 1, 1) m and turn against each other about the axis (0, 1, 0): ";
  const std::string remedy = "; join the cells by whole faces in the mesh, or hold both sides by supports";
  EXPECT_EQ(outcome(fem::Solver::statics, body),
            what + "there is no equilibrium, the static system is singular" + remedy);
  EXPECT_EQ(outcome(fem::Solver::modal, body), what + "it would be a mode at 0 Hz" + remedy);
  for (const auto kind : {fem::Solver::explicit_steps, fem::Solver::newmark})
    EXPECT_EQ(outcome(kind, body), "warning: " + what + "nothing resists it" + remedy);
  body.supports.push_back({"end", {true, false, false}, ""});
  EXPECT_EQ(outcome(fem::Solver::statics, body), "nothing");
  std::filesystem::remove(file);
}

TEST(FemHinges, SoundMeshesHaveNone) {
  for (const char* element : {"tet4", "tet10", "hex8", "hex20"}) {
    for (const auto kind : {fem::Solver::modal, fem::Solver::explicit_steps})
      EXPECT_EQ(outcome(kind, fem_test::box(element, {1, 1, 1, 2, 2, 2})), "nothing") << element;
  }
}

}  // namespace
