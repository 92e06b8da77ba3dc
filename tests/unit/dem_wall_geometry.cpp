// Double Hierarchy (dem/kernels/wall_geometry.hpp; Irazabal2017 section 4.3): points, weights and elimination.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "dem/kernels/wall_geometry.hpp"

using base::Vec3;
using namespace dem::kernels;

namespace {

const Vec3 triangle[3] = {{0, 0, 0}, {2, 0, 0}, {0, 1, 0}};
const Vec3 warped[4] = {{0, 0, 0}, {1, 0, 0.05}, {1.1, 0.9, -0.04}, {-0.1, 1, 0.06}};

Vec3 weighted_point(const Vec3* nodes, int count, const FacetContact& contact) {
  Vec3 p;
  for (int i = 0; i < count; ++i) p += contact.weights[i] * nodes[i];
  return p;
}

void expect_valid(const Vec3* nodes, int count, const FacetContact& contact) {
  ASSERT_NE(contact.feature, Feature::none);
  double sum = 0;
  for (double w : contact.weights) {
    EXPECT_GE(w, 0);
    sum += w;
  }
  EXPECT_NEAR(sum, 1, 1e-14);
  EXPECT_LT(norm(weighted_point(nodes, count, contact) - contact.point), 1e-14);
}

/// Nearest distance over a fine grid of the surface: an upper bound that the exact answer may not exceed.
double grid_distance(const Vec3* nodes, int count, const Vec3& centre) {
  double best = 1e300;
  const int n = 25;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= (count == 3 ? n - i : n); ++j) {
      const double u = double(i) / n, v = double(j) / n;
      const Vec3 p = count == 3 ? (1 - u - v) * nodes[0] + u * nodes[1] + v * nodes[2]
                                : (1 - u) * (1 - v) * nodes[0] + u * (1 - v) * nodes[1] + u * v * nodes[2] +
                                      (1 - u) * v * nodes[3];
      best = std::min(best, norm(centre - p));
    }
  return best;
}

std::vector<bool> hierarchy(const std::vector<Vec3>& vectors) {
  bool keep[16];
  distance_hierarchy(vectors.data(), int(vectors.size()), keep);
  return std::vector<bool>(keep, keep + vectors.size());
}

// Planar convex quadrilaterals far from parallelograms (the sides of a funnel): the nearest point is that of the two
// triangles that the quadrilateral consists of.
TEST(WallGeometry, TrapezoidIsItsTwoTriangles) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> any(-1, 1);
  int tried = 0;
  while (tried < 20000) {
    Vec3 nodes[4] = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    for (Vec3& node : nodes) node += 0.9 * Vec3{any(random), any(random), 0};
    bool convex = true;
    for (int a = 0; a < 4; ++a)
      convex = convex && cross(nodes[(a + 1) % 4] - nodes[a], nodes[(a + 2) % 4] - nodes[(a + 1) % 4]).z > 0.05;
    if (!convex) continue;
    ++tried;
    const Vec3 centre{2 * any(random), 2 * any(random), any(random)};
    const double reach = 10;
    const auto found = closest_on_facet(nodes, 4, centre, reach);
    const Vec3 other[3] = {nodes[0], nodes[2], nodes[3]};
    const double expected = std::min(norm(closest_on_facet(nodes, 3, centre, reach).point - centre),
                                     norm(closest_on_facet(other, 3, centre, reach).point - centre));
    ASSERT_NEAR(norm(found.point - centre), expected, 1e-9)
        << "nodes " << nodes[0].x << ' ' << nodes[0].y << ' ' << nodes[1].x << ' ' << nodes[1].y << ' ' << nodes[2].x
        << ' ' << nodes[2].y << ' ' << nodes[3].x << ' ' << nodes[3].y << " centre " << centre.x << ' ' << centre.y
        << ' ' << centre.z;
  }
}

}  // namespace

TEST(WallGeometry, TriangleFeaturesAndWeights) {
  auto facet = closest_on_facet(triangle, 3, {0.5, 0.25, 0.3}, 1);
  EXPECT_EQ(facet.feature, Feature::facet);
  EXPECT_NEAR(facet.weights[0], 0.5, 1e-15);  // eq. 4.8: areas opposite to the nodes
  EXPECT_NEAR(facet.weights[1], 0.25, 1e-15);
  EXPECT_NEAR(facet.weights[2], 0.25, 1e-15);
  EXPECT_EQ(facet.weights[3], 0);

  auto edge = closest_on_facet(triangle, 3, {0.5, -0.25, 0.3}, 1);
  EXPECT_EQ(edge.feature, Feature::edge);
  EXPECT_NEAR(edge.weights[0], 0.75, 1e-15);  // eq. 4.17
  EXPECT_NEAR(edge.weights[1], 0.25, 1e-15);

  auto vertex = closest_on_facet(triangle, 3, {2.1, -0.1, 0.3}, 1);
  EXPECT_EQ(vertex.feature, Feature::vertex);
  EXPECT_EQ(vertex.weights[1], 1);
  EXPECT_EQ(norm(vertex.point - triangle[1]), 0);

  EXPECT_EQ(closest_on_facet(triangle, 3, {0.5, 0.25, 1.0}, 1).feature, Feature::none);  // just touching is no contact
  EXPECT_EQ(closest_on_facet(triangle, 3, {2.8, -0.8, 0}, 1).feature, Feature::none);    // in the box, out of reach
}

// A wrong edge order, region test or Newton step gives a point farther than some grid point.
TEST(WallGeometry, NearestPointAgainstGridSearch) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> jitter(-0.2, 0.2), place(-0.6, 1.6), height(-0.5, 0.5);
  int found[4] = {0, 0, 0, 0};
  for (int sample = 0; sample < 200; ++sample) {
    Vec3 nodes[4] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    for (auto& node : nodes) node += {jitter(random), jitter(random), 0.3 * jitter(random)};
    const Vec3 centre{place(random), place(random), height(random)};
    for (int count : {3, 4}) {
      const auto contact = closest_on_facet(nodes, count, centre, 10);
      expect_valid(nodes, count, contact);
      EXPECT_LT(norm(centre - contact.point), grid_distance(nodes, count, centre) + 1e-14) << sample << " " << count;
      ++found[int(contact.feature)];
    }
  }
  for (int feature = 1; feature < 4; ++feature) EXPECT_GT(found[feature], 15);
}

// Planar quadrilateral: the bilinear search must give the projection of eq. 4.5, parallelogram or not.
TEST(WallGeometry, PlanarQuadrilateralIsProjection) {
  const Vec3 parallelogram[4] = {{0, 0, 0}, {2, 0, 0}, {2.5, 1, 0}, {0.5, 1, 0}};
  const Vec3 trapezoid[4] = {{0, 0, 0}, {2, 0, 0}, {1.2, 1, 0}, {0.5, 1, 0}};
  for (const Vec3* nodes : {parallelogram, trapezoid}) {
    const auto contact = closest_on_facet(nodes, 4, {0.9, 0.6, 0.2}, 1);
    EXPECT_EQ(contact.feature, Feature::facet);
    EXPECT_LT(norm(contact.point - Vec3{0.9, 0.6, 0}), 1e-14);
    expect_valid(nodes, 4, contact);
  }
}

// On a warped facet the contact vector is normal to the surface; with the areas of eq. 4.10 the weighted nodes miss the
// point.
TEST(WallGeometry, WarpedQuadrilateralKeepsMoment) {
  const Vec3 centre{0.4, 0.55, 0.3};
  const auto contact = closest_on_facet(warped, 4, centre, 1);
  ASSERT_EQ(contact.feature, Feature::facet);
  expect_valid(warped, 4, contact);
  const Vec3 force = centre - contact.point;
  Vec3 total, moment;
  for (int i = 0; i < 4; ++i) {
    total += contact.weights[i] * force;
    moment += cross(warped[i], contact.weights[i] * force);
  }
  EXPECT_LT(norm(total - force), 1e-15);
  EXPECT_LT(norm(moment - cross(contact.point, force)), 1e-15);
}

// A sphere that crosses the shared edge of two warped facets: the distance may not jump.
TEST(WallGeometry, ContinuousAcrossSharedEdge) {
  const Vec3 neighbour[4] = {warped[1], {2, 0.1, 0}, {2.1, 1.1, 0.02}, warped[2]};
  double last = 0;
  for (int step = 0; step <= 400; ++step) {
    const Vec3 centre{0.9 + 0.001 * step, 0.45, 0.3};
    std::vector<Vec3> vectors;
    for (const Vec3* nodes : {warped, neighbour}) {
      const auto contact = closest_on_facet(nodes, 4, centre, 0.45);
      if (contact.feature != Feature::none) vectors.push_back(centre - contact.point);
    }
    const auto keep = hierarchy(vectors);
    double nearest = 1e300;
    for (const Vec3& v : vectors) nearest = std::min(nearest, norm(v));
    EXPECT_GE(std::count(keep.begin(), keep.end(), true), 1);
    if (step > 0) {
      EXPECT_LT(std::abs(nearest - last), 0.0011);
    }
    last = nearest;
  }
}

// Above a ridge both facets find the edge, to the last bit the same point, whichever way each goes round it.
TEST(WallGeometry, SharedEdgeCountsOnce) {
  const Vec3 left[4] = {{-1, 0, -0.3}, {0.1, 0.03, 0.02}, {0.13, 1.1, -0.01}, {-1, 1, -0.4}};
  const Vec3 right[4] = {left[2], left[1], {1.1, 0, -0.3}, {1.2, 1.1, -0.35}};
  const Vec3 centre{0.12, 0.57, 0.3};
  const auto a = closest_on_facet(left, 4, centre, 0.45), b = closest_on_facet(right, 4, centre, 0.45);
  ASSERT_EQ(a.feature, Feature::edge);
  ASSERT_EQ(b.feature, Feature::edge);
  EXPECT_EQ(norm(a.point - b.point), 0);
  EXPECT_EQ(hierarchy({centre - a.point, centre - b.point}), (std::vector<bool>{true, false}));
}

// Table 4.4, both cases: neighbours in one plane are hidden; an edge and a facet at right angles both count.
TEST(WallGeometry, EliminationCases) {
  EXPECT_EQ(hierarchy({{0, 0, 0.9}, {0.2, 0, 0.9}, {-0.1, 0.3, 0.9}}), (std::vector<bool>{true, false, false}));
  EXPECT_EQ(hierarchy({{0.95, 0, 0}, {0.95, 0, 0}, {0.3, 0, 0.9}, {0, 0, 0.9}}),
            (std::vector<bool>{true, false, false, true}));
}

// Folds below 0.8 degrees count once; a clear concave fold counts twice (limit 4.4.2).
TEST(WallGeometry, ToleranceMergesSlightFolds) {
  for (double angle : {1e-6, 1e-3, 1e-2}) {
    const auto keep = hierarchy({{0, 0, 0.9}, {0.9 * std::sin(angle), 0, 0.9 * std::cos(angle)}});
    EXPECT_EQ(std::count(keep.begin(), keep.end(), true), 1) << angle;
  }
  EXPECT_EQ(hierarchy({{0, 0, 0.9}, {0.9 * std::sin(0.1), 0, 0.9 * std::cos(0.1)}}), (std::vector<bool>{true, true}));
}

// Every order of the facets must keep the same vectors; Table 4.3 as printed fails this.
TEST(WallGeometry, HierarchyDoesNotDependOnOrder) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> component(-1, 1);
  for (int sample = 0; sample < 20; ++sample) {
    std::vector<Vec3> vectors;
    while (vectors.size() < 5) {
      const Vec3 v{component(random), component(random), component(random)};
      if (norm(v) > 0.1 && norm(v) < 1) vectors.push_back(v);
    }
    const auto reference = hierarchy(vectors);
    EXPECT_GE(std::count(reference.begin(), reference.end(), true), 1);
    std::vector<int> order{0, 1, 2, 3, 4};
    do {
      std::vector<Vec3> shuffled;
      for (int i : order) shuffled.push_back(vectors[i]);
      const auto keep = hierarchy(shuffled);
      for (int i = 0; i < 5; ++i) EXPECT_EQ(keep[i], reference[order[i]]);
    } while (std::next_permutation(order.begin(), order.end()));
  }
}
