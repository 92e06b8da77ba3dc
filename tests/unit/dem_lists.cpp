// Neighbour lists: candidates equal those of a double loop; histories live through list builds; a list is never stale.
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <random>
#include <set>

#include "base/error.hpp"
#include "dem/core/list_length.hpp"
#include "dem/dem.hpp"
#include "tests/dem_backend.hpp"

namespace {

using dem::Vec3;

dem::Setup setup_of(double friction) {
  dem::Setup setup;
  setup.materials = {{"stone", 1e7, 0.25, 2500}};
  setup.interactions = {{friction, 0.7, 0}};
  return setup;
}

std::vector<dem::Grain> cloud(int number, double side, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(0, side), radius(0.01, 0.035);
  std::vector<dem::Grain> grains;
  for (int k = 0; k < number; ++k) {
    const Vec3 p{place(random), place(random), place(random)};
    grains.push_back({.position = p, .radius = radius(random), .id = 7 * k + 3});
  }
  return grains;
}

// Formula: |x_i - x_j| < r_i + r_j + skin over all i < j. A grid that misses a neighbour cell, or enters a pair twice
// where the torus folds onto itself, gives another number.
TEST(DemLists, CandidatesEqualTheDoubleLoop) {
  for (const double side : {0.05, 0.3, 1.0}) {
    auto setup = setup_of(0.5);
    setup.skin = 0.004;
    setup.maximum_overlap = 10;
    const auto sim = dem_test::create(setup);
    auto grains = cloud(200, side, 1);
    grains.push_back(
        {.position = {1e6, -3e5, 20}, .radius = 0.02, .id = 1});  // far away: shares a bucket with somebody
    sim->add_grains(grains);
    sim->advance(0, 1e-6);
    std::int64_t candidates = 0;
    std::set<std::pair<std::int64_t, std::int64_t>> expected, found;
    for (std::size_t i = 0; i < grains.size(); ++i)
      for (std::size_t j = i + 1; j < grains.size(); ++j) {
        const double gap = norm(grains[i].position - grains[j].position) - grains[i].radius - grains[j].radius;
        candidates += gap < setup.skin;
        if (gap < 0) expected.insert(std::minmax(grains[i].id, grains[j].id));
      }
    for (const auto& contact : sim->grain_contacts()) found.insert(std::minmax(contact.id_i, contact.id_j));
    EXPECT_EQ(sim->counts().candidate_pairs, candidates) << side;
    EXPECT_EQ(found, expected) << side;
  }
}

std::vector<dem::Grain> heap_after(double skin, std::int64_t* rebuilds) {
  auto setup = setup_of(0.5);
  setup.skin = skin;
  setup.gravity = {3, 0, -9.81};
  const auto sim = dem_test::create(setup);
  sim->add_plane({{0, 0, 0}, {0, 0, 1}}, 0);
  sim->add_grains(std::vector<dem::Grain>{{.position = {0, 0, 0.0199}, .radius = 0.02, .id = 5},
                                          {.position = {0.0396, 0, 0.02}, .radius = 0.02, .id = 2},
                                          {.position = {0.02, 0.001, 0.054}, .radius = 0.02, .id = 9}});
  sim->advance(1000, 1e-5);
  *rebuilds = sim->counts().rebuilds;
  return sim->grains();
}

// The same fall with a list built nearly every step and with one built once. A history lost or turned around at a build
// changes the tangential forces of the sliding heap by their whole size.
TEST(DemLists, HistorySurvivesListBuilds) {
  std::int64_t many = 0, one = 0;
  const auto often = heap_after(1e-5, &many), once = heap_after(0.5, &one);
  EXPECT_GT(many, 30);
  EXPECT_EQ(one, 1);
  for (std::size_t k = 0; k < once.size(); ++k) {
    EXPECT_LT(norm(often[k].position - once[k].position), 1e-13);
    EXPECT_LT(norm(often[k].angular_velocity - once[k].angular_velocity), 1e-9 * norm(once[k].angular_velocity));
  }
}

// A fast grain and a moving wall must find what they run into, however thick the skin was chosen.
TEST(DemLists, MovingWallIsFound) {
  const auto sim = dem_test::create(setup_of(0));
  const int plane = sim->add_plane({{0, 0, 0}, {0, 0, 1}}, 0);
  base::Skin sheet;
  sheet.nodes = {{-1, -1, 1}, {-1, 1, 1}, {1, 1, 1}, {1, -1, 1}};
  sheet.facets = {{0, 1, 2, 3}};
  const int roof = sim->add_mesh(sheet, 0, true);
  sim->add_grains(std::vector<dem::Grain>{{.position = {0, 0, 0.5}, .radius = 0.02, .id = 1}});
  sim->set_wall_velocity(plane, {0, 0, 2});
  sim->set_wall_velocity(roof, {0, 0, -1});
  sim->advance(23990, 1e-5);  // the plane comes up first, after 0.24 s
  EXPECT_EQ(sim->grains()[0].velocity.z, 0);
  sim->advance(1000, 1e-5);
  EXPECT_GT(sim->grains()[0].velocity.z, 2);
}

// A pair keeps its shear spring (four numbers) only with friction, the energy of that spring only with the ledger. The
// sweep keeps a block of four pairs for one; taken one by one up to 32 pairs also have a row of the ledger (five
// numbers).
TEST(DemLists, WithoutFrictionAndWallsNothingIsKeptForThem) {
  for (const int lanes : {1, 2}) {
    std::size_t bytes[3];
    for (int variant = 0; variant < 3; ++variant) {
      auto setup = setup_of(variant == 0 ? 0 : 0.5);
      setup.track_energy = variant == 2;
      setup.lanes = lanes;
      const auto sim = dem_test::create(setup);
      sim->add_grains(std::vector<dem::Grain>{{.position = {0, 0, 0}, .radius = 0.02, .id = 1},
                                              {.position = {0.039, 0, 0}, .radius = 0.02, .id = 2}});
      sim->advance(1, 1e-6);
      EXPECT_EQ(sim->counts().contacts, 1);
      bytes[variant] = sim->counts().bytes;
    }
    const std::size_t number = sizeof(double);
    EXPECT_EQ(bytes[1] - bytes[0], lanes * 4 * number);
    EXPECT_EQ(bytes[2] - bytes[1], lanes == 1 ? 6 * number : 2 * number);
  }
}

// Formula: docs/performance.md, section on GPUs: 272 bytes a sphere (no walls), 108 a pair, with the ledger 8 more and
// 40 for every 32 pairs. Columns that grow by a few rows would be up to twice as long as they must be.
TEST(DemLists, WhatASphereAndAPairTake) {
  for (const bool ledger : {false, true}) {
    auto setup = setup_of(0.5);
    setup.track_energy = ledger;
    setup.lanes = 1;
    const auto sim = dem_test::create(setup);
    std::vector<dem::Grain> chain;
    for (int k = 0; k < 100; ++k) chain.push_back({.position = {0.0399 * k, 0, 0}, .radius = 0.02, .id = k});
    sim->add_grains(chain);
    sim->advance(1, 1e-6);
    const auto counts = sim->counts();
    ASSERT_EQ(counts.candidate_pairs, 99);
    const std::size_t ends = 2 * sizeof(int);  // of the two lists of a grain
    EXPECT_EQ(counts.bytes, 272 * 100 + ends + (ledger ? 116 * 99 + 40 * 4 : 108 * 99));
  }
}

// One more than an int counts would come out as a negative length.
TEST(DemLists, LongerThanIndicesCountIsRefused) {
  EXPECT_EQ(dem::list_length(2147483647), 2147483647);
  std::string text;
  try {
    dem::list_length(2147483648);
  } catch (const base::MachineError& error) {
    text = error.what();
  }
  EXPECT_EQ(
      text,
      "a list of 2147483648 neighbours is needed, at most 2147483647 are possible on one rank; share the grains out "
      "over more (--dem-ranks)");
}

std::string message_of(const std::function<void()>& run) {
  try {
    run();
  } catch (const base::UnstableError& e) {
    return e.what();
  }
  return "no error";
}

TEST(DemLists, BrokenStatesStopTheRun) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (int variant = 0; variant < 3; ++variant) {
    const auto sim = dem_test::create(setup_of(0.5));
    std::vector<dem::Grain> grains{{.position = {0, 0, 0}, .radius = 0.02, .id = 41},
                                   {.position = {1, 0, 0}, .radius = 0.02, .id = 42}};
    (variant == 0 ? grains[1].position : variant == 1 ? grains[1].velocity : grains[1].angular_velocity).y = nan;
    sim->add_grains(grains);
    const auto text = message_of([&] { sim->advance(1, 1e-6); });
    EXPECT_NE(text.find("grain 42: "), std::string::npos) << text;
    EXPECT_NE(text.find("not finite"), std::string::npos) << text;
  }
  auto setup = setup_of(0.5);
  setup.maximum_overlap = 0.3;
  for (const double overlap : {0.29, 0.31}) {
    const auto sim = dem_test::create(setup);
    sim->add_plane({{0, 0, 0}, {0, 0, 1}}, 0);
    sim->add_grains(std::vector<dem::Grain>{{.position = {0, 0, 0.02 * (1 - overlap)}, .radius = 0.02, .id = 8}});
    const auto text = message_of([&] { sim->advance(1, 1e-6); });
    EXPECT_EQ(text.find("grain 8: overlap with a wall is 0.31 of its radius") != std::string::npos, overlap > 0.3)
        << text;
  }
}

TEST(DemLists, NoContactsBetweenRemovalAndTheNextStep) {
  dem::Setup setup;
  setup.materials = {{"stone", 1e8, 0.25, 2500}};
  setup.interactions = {{0.5, 0.5, 0}};
  const auto sim = dem_test::create(setup);
  sim->add_plane({{0, 0, 0}, {0, 0, 1}}, 0);
  std::vector<dem::Grain> row;
  for (int k = 0; k < 4; ++k) row.push_back({.position = {0.0399 * k, 0, 0.01999}, .radius = 0.02, .id = k});
  sim->add_grains(row);
  sim->advance(1, 1e-6);
  EXPECT_EQ(sim->grain_contacts().size(), 3u);
  sim->remove_grains(std::vector<std::int64_t>{0});
  EXPECT_TRUE(sim->grain_contacts().empty());
  EXPECT_TRUE(sim->wall_contacts().empty());
  sim->advance(0, 1e-6);
  EXPECT_EQ(sim->grain_contacts().size(), 2u);
  EXPECT_EQ(sim->wall_contacts().size(), 3u);
}

}  // namespace
