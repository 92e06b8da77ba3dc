// Room that bodies take up: inside, near, and the collar above an open top.
#include <gtest/gtest.h>

#include "coupling/obstacle.hpp"

namespace {

using coupling::Vec3;

/// Unit cube without top and without the face x = 0 (like a sleeper cut by its plane of symmetry), facets outwards.
base::Skin open_cube() {
  base::Skin skin;
  skin.body = "cube";
  for (const double z : {0.0, 1.0}) {
    for (const Vec3& corner : {Vec3{0, 0, z}, Vec3{1, 0, z}, Vec3{1, 1, z}, Vec3{0, 1, z}})
      skin.nodes.push_back(corner);
  }
  skin.facets = {{0, 3, 2, 1}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}};
  return skin;
}

/// Level square at z = 0 that faces up, as two triangles.
base::Skin ground() {
  base::Skin skin;
  skin.nodes = {{-1, -1, 0}, {2, -1, 0}, {2, 2, 0}, {-1, 2, 0}};
  skin.facets = {{0, 1, 2, -1}, {0, 2, 3, -1}};
  return skin;
}

// A test by the bounding box alone would call the points above the open top free; ray parity upwards likewise.
TEST(Obstacle, OpenTopReachesUp) {
  const coupling::Obstacle cube(open_cube());
  EXPECT_TRUE(cube.inside({0.5, 0.5, 0.5}));
  EXPECT_TRUE(cube.inside({0.01, 0.99, 0.01}));
  EXPECT_TRUE(cube.inside({0.5, 0.5, 3}));
  EXPECT_FALSE(cube.inside({0.5, 0.5, -0.1}));
  EXPECT_FALSE(cube.inside({1.1, 0.5, 0.5}));
}

TEST(Obstacle, BelowTheGroundIsInside) {
  const coupling::Obstacle plane(ground());
  EXPECT_TRUE(plane.inside({0.3, 0.3, -5}));
  EXPECT_TRUE(plane.inside({0.5, 0.5, -1e-6}));  // on the diagonal that both triangles share
  EXPECT_FALSE(plane.inside({0.3, 0.3, 0.1}));
  EXPECT_FALSE(plane.inside({3, 0.3, -1}));
  EXPECT_TRUE(plane.carries({{0, 0, 0}, {1, 1, 1}}, 1e-3));
  EXPECT_FALSE(plane.carries({{5, 5, 0}, {6, 6, 1}}, 1e-3));
}

TEST(Obstacle, NearFacesEdgesAndCorners) {
  const coupling::Obstacle cube(open_cube());
  EXPECT_TRUE(cube.closer_than({0.5, 0.5, -0.1}, 0.11));
  EXPECT_FALSE(cube.closer_than({0.5, 0.5, -0.1}, 0.09));
  EXPECT_TRUE(cube.closer_than({1.1, 0.5, -0.1}, 0.1415));  // edge: sqrt(2) * 0.1
  EXPECT_FALSE(cube.closer_than({1.1, 0.5, -0.1}, 0.1413));
  EXPECT_TRUE(cube.closer_than({1.1, 1.1, -0.1}, 0.1733));  // corner: sqrt(3) * 0.1
  EXPECT_FALSE(cube.closer_than({1.1, 1.1, -0.1}, 0.1731));
  EXPECT_FALSE(cube.closer_than({0.5, 0.5, 1.0}, 0.49));  // no lid there
}

TEST(Obstacle, CollarStandsOnTheOpenRim) {
  const base::Skin rim = coupling::collar(open_cube(), 2);
  ASSERT_EQ(rim.facets.size(), 3u);  // y = 0, x = 1, y = 1; the open face x = 0 has no rim edge on top
  const Vec3 centre{0.5, 0.5, 2};
  for (const auto& facet : rim.facets) {
    const auto node = [&](int i) { return rim.nodes[static_cast<std::size_t>(facet[static_cast<std::size_t>(i)])]; };
    const Vec3 normal = cross(node(1) - node(0), node(3) - node(0));
    EXPECT_GT(dot(normal, (node(0) + node(1) + node(2) + node(3)) * 0.25 - centre), 0) << "a facet faces inwards";
    EXPECT_DOUBLE_EQ(node(0).z, 1);
    EXPECT_DOUBLE_EQ(node(2).z, 3);
  }
  EXPECT_TRUE(coupling::collar(ground(), 2).facets.empty());
}

}  // namespace
