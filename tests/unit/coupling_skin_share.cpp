// Which nodes of a skin an interval along x needs: those of every facet and face that reaches into it, no others.
#include <gtest/gtest.h>

#include "coupling/skin_share.hpp"

namespace {

using coupling::everything;
using coupling::Interval;

/// A strip of `cells` unit squares along x; node 2 k lies at (k, 0), 2 k + 1 at (k, 1).
base::Skin strip(int cells) {
  base::Skin skin;
  for (int k = 0; k <= cells; ++k)
    for (const double y : {0.0, 1.0}) skin.nodes.push_back({1.0 * k, y, 0});
  for (int k = 0; k < cells; ++k) skin.facets.push_back({2 * k, 2 * k + 2, 2 * k + 3, 2 * k + 1});
  return skin;
}

std::vector<int> all_nodes(const base::Skin& skin) {
  std::vector<int> nodes;
  for (int k = 0; k < static_cast<int>(skin.nodes.size()); ++k) nodes.push_back(k);
  return nodes;
}

TEST(SkinShare, NodesOfAllFacetsThatReachIn) {
  const auto skin = strip(10);
  const auto reaches = coupling::reaches_of_nodes(skin);
  const auto owned = all_nodes(skin);
  // The cells from 3 to 4, 4 to 5, 5 to 6 reach into [3.5, 5.5].
  const auto shared = coupling::shared_nodes(reaches, owned, {3.5, 5.5}, {});
  EXPECT_EQ(shared.all, (std::vector<int>{6, 7, 8, 9, 10, 11, 12, 13}));
  EXPECT_EQ(shared.fresh, shared.all);
  // All of it lies within one cell.
  EXPECT_EQ(coupling::shared_nodes(reaches, owned, {3.4, 3.6}, {}).all, (std::vector<int>{6, 7, 8, 9}));
  EXPECT_EQ(coupling::shared_nodes(reaches, owned, everything, {}).all, owned);
  EXPECT_TRUE(coupling::shared_nodes(reaches, owned, {}, everything).all.empty());
  EXPECT_TRUE(coupling::shared_nodes(reaches, owned, {10.5, 20}, everything).all.empty());
}

TEST(SkinShare, FreshAreThoseThatWereNotSharedBefore) {
  const auto skin = strip(10);
  const std::vector<int> owned{0, 9, 11, 20};  // at x = 0, 4, 5, 10
  const auto shared = coupling::shared_nodes(coupling::reaches_of_nodes(skin), owned, {3.5, 10}, {0, 3.5});
  EXPECT_EQ(shared.all, (std::vector<int>{1, 2, 3}));
  EXPECT_EQ(shared.fresh, (std::vector<int>{2, 3}));
}

// A quad8 face of four plane parts: a grain near one of them may touch the face anywhere, so all its nodes are needed,
// and where it is curved it may bulge beyond them.
TEST(SkinShare, FacesOfTheSecondOrderAreTakenWhole) {
  base::Skin skin;
  skin.nodes = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {1, 0, 0}, {2, 1, 0}, {1, 2, 0}, {0, 1, 0}};
  skin.faces = {{0, 1, 2, 3, 4, 5, 6, 7}};
  skin.facets = {{0, 4, 7, -1}, {4, 1, 5, -1}, {5, 2, 6, -1}, {6, 3, 7, -1}, {4, 5, 6, 7}};
  skin.face_of = {0, 0, 0, 0, 0};
  const auto reaches = coupling::reaches_of_nodes(skin);
  const auto owned = all_nodes(skin);
  EXPECT_EQ(coupling::shared_nodes(reaches, owned, {1.9, 2.5}, {}).all, owned);
  EXPECT_EQ(coupling::shared_nodes(reaches, owned, {2.1, 2.5}, {}).all, owned);
  EXPECT_TRUE(coupling::shared_nodes(reaches, owned, {3.1, 4}, {}).all.empty());
}

}  // namespace
