// A state that is saved and restored goes on as if nothing had happened; saving leaves no trace.
#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "base/error.hpp"
#include "dem/clump.hpp"
#include "dem/dem.hpp"
#include "tests/dem_backend.hpp"

namespace {

using dem::Vec3;

constexpr double step = 1e-4;  // [s]

/// A floor, a wall that pushes, and no grains yet.
std::unique_ptr<dem::Simulation> empty_box(int lanes) {
  dem::Setup setup;
  setup.materials = {{"stone", 1e7, 0.25, 2500}};
  setup.interactions = {{.friction = 0.5, .restitution = 0.7, .rolling_friction = 0.1}};
  setup.gravity = {0, 0, -9.81};
  setup.lanes = lanes;
  auto sim = dem_test::create(setup);
  sim->add_plane({{0, 0, 0}, {0, 0, 1}}, 0);
  sim->set_wall_velocity(sim->add_plane({{-0.03, 0, 0}, {1, 0, 0}}, 0), {0.3, 0, 0});
  return sim;
}

std::unique_ptr<dem::Simulation> falling_grains(int lanes) {
  auto sim = empty_box(lanes);
  std::vector<dem::Grain> grains;
  for (int k = 0; k < 48; ++k)
    grains.push_back({.position = {0.041 * (k % 4) + 0.003 * (k / 16), 0.042 * (k / 4 % 4), 0.021 + 0.043 * (k / 16)},
                      .radius = 0.02,
                      .velocity = {0.2 * (k % 3), -0.1 * (k % 2), -0.5},
                      .id = 3 * k});
  sim->add_grains(grains);
  sim->advance(300, step);
  return sim;
}

/// Largest distance [m] of a grain's places in both.
double apart(const dem::Simulation& one, const dem::Simulation& other) {
  const auto a = one.grains(), b = other.grains();
  EXPECT_EQ(a.size(), b.size());
  double largest = 0;
  for (std::size_t k = 0; k < std::min(a.size(), b.size()); ++k)
    largest = std::max(largest, norm(a[k].position - b[k].position));
  return largest;
}

// One by one as on a GPU, and in sweeps. A restored run that lost friction's history, or makes its lists at another
// time, differs in the last digits at once.
TEST(DemState, GoesOnBitForBit) {
  for (const int lanes : {0, 1}) {
    const auto saved = falling_grains(lanes), untouched = falling_grains(lanes), restored = empty_box(lanes);
    const auto columns = saved->save();
    restored->restore(columns);
    EXPECT_EQ(restored->save(), columns);
    for (auto* sim : {saved.get(), untouched.get(), restored.get()}) sim->advance(400, step);
    EXPECT_GT(untouched->energy().loss_friction, 0);
    EXPECT_EQ(apart(*saved, *untouched), 0) << lanes;
    EXPECT_EQ(apart(*restored, *untouched), 0) << lanes;
    EXPECT_EQ(restored->energy().loss_friction, untouched->energy().loss_friction);
    EXPECT_EQ(restored->energy().loss_rolling, untouched->energy().loss_rolling);
    EXPECT_EQ(restored->counts().rebuilds, untouched->counts().rebuilds);
  }
}

// Another machine's vectors: lists are made anew, histories taken over. Without them springs of friction would start at
// zero: grains would be microns off.
TEST(DemState, GoesOnWithOtherVectors) {
  const auto two = falling_grains(2), four = empty_box(4);
  four->restore(two->save());
  two->advance(20, step);
  four->advance(20, step);
  EXPECT_LT(apart(*two, *four), 1e-13);
}

void expect_equal(const dem::Picture& picture, const dem::Picture& expected) {
  ASSERT_EQ(picture.grains.size(), expected.grains.size());
  for (std::size_t k = 0; k < picture.grains.size(); ++k) {
    const dem::Grain &a = picture.grains[k], &b = expected.grains[k];
    EXPECT_EQ(a.id, b.id);
    EXPECT_EQ(a.shape, b.shape);
    EXPECT_EQ(a.radius, b.radius);
    EXPECT_EQ(norm(a.position - b.position) + norm(a.velocity - b.velocity), 0);
    EXPECT_EQ(norm(a.angular_velocity - b.angular_velocity), 0);
    EXPECT_EQ(a.orientation.w, b.orientation.w);
  }
  ASSERT_EQ(picture.grain_contacts.size(), expected.grain_contacts.size());
  for (std::size_t k = 0; k < picture.grain_contacts.size(); ++k) {
    const dem::GrainContact &a = picture.grain_contacts[k], &b = expected.grain_contacts[k];
    EXPECT_EQ(a.id_i, b.id_i);
    EXPECT_EQ(a.id_j, b.id_j);
    EXPECT_EQ(norm(a.force - b.force) + norm(a.position_j - b.position_j) + norm(a.period - b.period), 0);
  }
  ASSERT_EQ(picture.wall_contacts.size(), expected.wall_contacts.size());
  for (std::size_t k = 0; k < picture.wall_contacts.size(); ++k) {
    const dem::WallContact &a = picture.wall_contacts[k], &b = expected.wall_contacts[k];
    EXPECT_EQ(a.id, b.id);
    EXPECT_EQ(a.wall, b.wall);
    EXPECT_EQ(norm(a.force - b.force) + norm(a.point - b.point), 0);
  }
}

// What is asked for is of that instant, whenever it is fetched: rows that were read later would have moved on, lists
// been made anew. Two pictures may be asked for before either is fetched, and one after both.
TEST(DemState, PicturesAndStatesAreOfTheInstantOfAsking) {
  for (const auto& [lanes, precision] : std::vector<std::pair<int, dem::Precision>>{
           {0, dem::Precision::full}, {1, dem::Precision::full}, {1, dem::Precision::mixed}}) {
    dem::Setup setup;
    setup.materials = {{"stone", 1e7, 0.25, 2500}};
    setup.interactions = {{.friction = 0.5, .restitution = 0.7}};
    setup.gravity = {0, 0, -9.81};
    setup.lanes = lanes;
    setup.precision = precision;
    setup.periods[0] = {0, 0.16};
    const auto sim = dem_test::create(setup);
    sim->add_plane({{0, 0, 0}, {0, 0, 1}}, 0);
    sim->add_shape(dem::make_clump(std::vector<dem::Sphere>{{{-0.4, 0, 0}, 0.6}, {{0.4, 0, 0}, 0.6}}));
    std::vector<dem::Grain> grains;
    for (int k = 0; k < 48; ++k)
      grains.push_back({.position = {0.04 * (k % 4) + 0.002, 0.042 * (k / 4 % 4), 0.021 + 0.041 * (k / 16)},
                        .radius = 0.02,
                        .velocity = {0.2 * (k % 3), -0.1 * (k % 2), -0.5},
                        .id = 3 * k,
                        .shape = k % 3 ? -1 : 0});
    sim->add_grains(grains);
    sim->advance(40, step);  // the lowest ones press on the floor
    const auto now = [&] { return dem::Picture{sim->grains(), sim->grain_contacts(), sim->wall_contacts()}; };
    const dem::Picture first = now();
    ASSERT_GT(first.grain_contacts.size(), 10u);
    ASSERT_GT(first.wall_contacts.size(), 5u);
    EXPECT_TRUE(std::any_of(first.grain_contacts.begin(), first.grain_contacts.end(),
                            [](const dem::GrainContact& contact) { return norm(contact.period) > 0; }));
    const base::Columns state = sim->save();
    expect_equal(sim->picture()(), first);  // at once: what is on its way is waited for
    EXPECT_EQ(sim->saved()(), state);
    auto first_later = sim->picture();
    auto state_later = sim->saved();
    const auto before = sim->counts().rebuilds;
    sim->advance(300, step);
    EXPECT_GT(sim->counts().rebuilds, before);
    const dem::Picture second = now();
    auto second_later = sim->picture();
    sim->advance(100, step);
    expect_equal(second_later(), second);
    expect_equal(first_later(), first);
    EXPECT_EQ(state_later(), state);
    first_later = second_later = nullptr;
    const dem::Picture third = now();
    auto third_later = sim->picture();
    sim->advance(100, step);
    expect_equal(third_later(), third);
    sim->remove_grains(std::vector<std::int64_t>{0});  // its contacts are not known until the next step
    EXPECT_TRUE(sim->picture()().grain_contacts.empty());
    EXPECT_EQ(sim->picture()().grains.size(), third.grains.size() - 1);
  }
}

TEST(DemState, WhatDoesNotFitIsRefused) {
  auto columns = falling_grains(0)->save();
  const auto message = [&](dem::Simulation& into) {
    try {
      into.restore(columns);
    } catch (const base::UserError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  const auto more_walls = empty_box(0);
  more_walls->add_plane({{1, 0, 0}, {-1, 0, 0}}, 0);
  EXPECT_EQ(message(*more_walls), "the walls are others");
  const bool cuda = dem_test::backend() == dem::Backend::cuda;
  const std::string here = cuda ? "cuda" : "omp", there = cuda ? "omp" : "cuda";
  columns["backend"] = there;
  EXPECT_EQ(message(*empty_box(0)), "its grains were computed with the backend " + there + ", not " + here);
  columns["backend"] = here;
  columns.erase("clock");
  EXPECT_EQ(message(*empty_box(0)), "column clock has another number of values");
}

}  // namespace
