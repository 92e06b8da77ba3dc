// Grains that are made larger between steps: radii, masses, spheres of clumps, and lists that know of it.
#include <gtest/gtest.h>

#include <cmath>

#include "base/error.hpp"
#include "dem/dem.hpp"
#include "tests/dem_backend.hpp"

namespace {

using dem::Vec3;

std::unique_ptr<dem::Simulation> simulation(int lanes) {
  dem::Setup setup;
  setup.materials = {{"stone", 1e7, 0.25, 2500}};
  setup.interactions = {{0.5, 0.7, 0}};
  setup.lanes = lanes;
  return dem_test::create(setup);
}

// Two spheres of 10 mm with 8 mm between them, out of each other's lists; at 1.5 times their size they overlap by 2 mm.
// A list that does not know of it finds no contact.
TEST(DemGrowth, SpheresMeetWhenTheyGrow) {
  for (const int lanes : {0, 1}) {
    const auto sim = simulation(lanes);
    const int floor = sim->add_plane({{0, 0, 0}, {0, 0, 1}}, 0);
    const std::vector<dem::Grain> grains{{.position = {0, 0, 0.014}, .radius = 0.01, .id = 4},
                                         {.position = {0.028, 0, 0.1}, .radius = 0.01, .id = 9},
                                         {.position = {0, 0.5, 0.1}, .radius = 0.01, .id = 10},
                                         {.position = {0.028, 0.5, 0.1}, .radius = 0.01, .id = 11}};
    sim->add_grains(grains);
    sim->advance(0, 1e-6);
    EXPECT_TRUE(sim->grain_contacts().empty());
    const std::vector<std::int64_t> ids{4, 10, 11, 77};
    sim->scale_grains(ids, 1.5);
    sim->advance(0, 1e-6);
    const auto contacts = sim->grain_contacts();
    ASSERT_EQ(contacts.size(), 1u);
    EXPECT_NEAR(contacts[0].overlap, 0.002, 1e-12);
    const auto walls = sim->wall_contacts();
    ASSERT_EQ(walls.size(), 1u);
    EXPECT_EQ(walls[0].wall, floor);
    EXPECT_EQ(walls[0].id, 4);
    EXPECT_NEAR(walls[0].overlap, 0.001, 1e-12);
    EXPECT_EQ(sim->grains()[1].radius, 0.01) << "a grain that was not named grew";
  }
}

// m ~ f^3 and I ~ f^5 show in the kinetic energy at unchanged velocities; of a clump the moments are those of its
// spheres grown about its centre.
TEST(DemGrowth, MassesAndInertiasFollow) {
  const std::vector<dem::Sphere> two{{{0, 0, 0}, 0.01}, {{0.012, 0, 0}, 0.01}};
  for (const bool clump : {false, true}) {
    const auto energy = [&](Vec3 velocity, Vec3 spin, double factor) {
      const auto sim = simulation(0);
      dem::Grain grain{.radius = 0.01, .velocity = velocity, .angular_velocity = spin, .id = 1};
      if (clump) {
        const dem::Clump shape = dem::make_clump(two);
        grain.shape = sim->add_shape(shape);
        grain.radius = shape.reach;
      }
      sim->add_grains({&grain, 1});
      const std::vector<std::int64_t> ids{1};
      if (factor != 1) sim->scale_grains(ids, factor);
      return sim->energy().kinetic;
    };
    EXPECT_NEAR(energy({1, 2, 0}, {}, 1.3) / energy({1, 2, 0}, {}, 1), std::pow(1.3, 3), 1e-12);
    EXPECT_NEAR(energy({}, {3, 1, 0}, 1.3) / energy({}, {3, 1, 0}, 1), std::pow(1.3, 5), 1e-12);
  }
}

TEST(DemGrowth, SpheresOfAClumpMoveApart) {
  const std::vector<dem::Sphere> two{{{0, 0, 0}, 0.01}, {{0.012, 0, 0}, 0.01}};
  const auto sim = simulation(0);
  const dem::Clump shape = dem::make_clump(two);
  const dem::Grain grain{.position = {1, 2, 3}, .radius = shape.reach, .id = 1, .shape = sim->add_shape(shape)};
  sim->add_grains({&grain, 1});
  const std::vector<std::int64_t> ids{1};
  sim->scale_grains(ids, 2);
  const auto spheres = sim->spheres();
  ASSERT_EQ(spheres.size(), 2u);
  EXPECT_NEAR(norm(spheres[0].position - spheres[1].position), 0.024, 1e-12);
  EXPECT_NEAR(norm(0.5 * (spheres[0].position + spheres[1].position) - grain.position), 0, 1e-12);
  EXPECT_EQ(spheres[0].radius, 0.02);
  EXPECT_NEAR(sim->grains()[0].radius, 2 * shape.reach, 1e-15);
}

TEST(DemGrowth, FactorMustBePositive) {
  const auto sim = simulation(0);
  for (const double factor : {0.0, -1.0, std::nan("")}) EXPECT_THROW(sim->scale_grains({}, factor), base::UserError);
}

}  // namespace
