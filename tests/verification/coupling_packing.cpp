// A small box of ballast packed by gravity: porosity of random sphere packings, repeatability, grading kept, cache.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "base/error.hpp"
#include "coupling/measure.hpp"
#include "coupling/packing.hpp"
#include "dem/grading.hpp"
#include "dem/output.hpp"
#include "tests/packing_helper.hpp"

namespace {

namespace fs = std::filesystem;

constexpr double edge = 0.25;  // [m]

coupling::Scene cube_scene() {
  return packing_box({edge, edge, edge}, {{0.0224, 0}, {0.0315, 0.12}, {0.040, 0.48}, {0.050, 0.85}, {0.063, 1}}, 0.42);
}

void expect_same(const std::vector<dem::Grain>& a, const std::vector<dem::Grain>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(a[i].id, b[i].id);
    ASSERT_EQ(a[i].radius, b[i].radius) << i;
    for (int axis = 0; axis < 3; ++axis) ASSERT_EQ(a[i].position[axis], b[i].position[axis]) << i;
  }
}

// Random packings of spheres lie between random close (porosity 0.36 for equal spheres) and random loose (0.45)
// packing; low friction goes towards the dense end. Source: Irazabal2017 6.3 packs railway ballast spheres to 0.394.
TEST(Packing, CubeOfBallast) {
  const fs::path folder = fs::temp_directory_path() / ("trackbed-packing-" + std::to_string(getpid()));
  setenv("TRACKBED_CACHE", folder.c_str(), 1);
  coupling::Scene scene = cube_scene();
  coupling::PackingReport report;
  dem::set_threads(1);
  const auto grains = coupling::pack(scene, {}, dem::Backend::omp, report);

  EXPECT_FALSE(report.from_cache);
  EXPECT_EQ(report.grains, static_cast<std::int64_t>(grains.size()));
  EXPECT_GT(report.grains, 300);
  EXPECT_LT(report.grains, 500);
  EXPECT_GT(report.porosity, 0.36);
  EXPECT_LT(report.porosity, 0.52);
  EXPECT_GT(report.coordination, 3);
  EXPECT_LT(report.coordination, 7);

  std::vector<double> radii;
  for (std::size_t i = 0; i < grains.size(); ++i) {
    const dem::Grain& grain = grains[i];
    EXPECT_EQ(grain.id, static_cast<std::int64_t>(i));
    EXPECT_EQ(base::norm(grain.velocity), 0);
    // At 0.24 GPa a grain under 50 kPa dents by a few per cent of its radius.
    const double dent = 0.1 * grain.radius;
    for (int axis = 0; axis < 3; ++axis) EXPECT_GT(grain.position[axis] - grain.radius, -dent) << i;
    EXPECT_LT(grain.position.x + grain.radius, edge + dent);
    EXPECT_LT(grain.position.y + grain.radius, edge + dent);
    EXPECT_LT(grain.position.z + grain.radius, edge + 0.5 * grain.radius) << "the plate left a grain standing out";
    radii.push_back(grain.radius);
  }
  const std::vector<double> sizes{0.0315, 0.040, 0.050, 0.063};
  for (const dem::Sieve& row : dem::sieve(radii, sizes)) {
    double wanted = 0;
    for (const auto& [size, passing] : scene.grains->packing->grading) wanted = size == row.size ? passing : wanted;
    EXPECT_NEAR(row.passing, wanted, 0.05) << row.size;
  }

  const auto cached = coupling::pack(scene, {}, dem::Backend::omp, report);
  EXPECT_TRUE(report.from_cache);
  expect_same(grains, cached);

  scene.grains->packing->use_cache = false;
  dem::set_threads(2);
  const auto again = coupling::pack(scene, {}, dem::Backend::omp, report);
  EXPECT_FALSE(report.from_cache);
  expect_same(grains, again);
  dem::set_threads(1);
  fs::remove_all(folder);
}

// Without side walls the bed slumps once it is free, and what rolls out of the box is taken out. The contacts that are
// counted then are those of the grains that stayed: with the lists of before, numbers of grains that are gone are read.
TEST(Packing, GrainsThatLeaveTheBoxAreForgotten) {
  coupling::Scene scene = cube_scene();
  scene.grains->packing->use_cache = false;
  scene.grains->packing->young_modulus = 0.02e9;
  scene.grains->packing->layers[0].plate = false;
  scene.grains->packing->layers[0].box.upper = {edge, edge, 0.5 * edge};
  coupling::PackingReport report;
  const std::size_t between_walls = coupling::pack(scene, {}, dem::Backend::omp, report).size();
  scene.grains->walls.resize(1);  // the floor
  const auto grains = coupling::pack(scene, {}, dem::Backend::omp, report);
  EXPECT_GT(grains.size(), 20u);
  EXPECT_LT(grains.size(), between_walls) << "nothing left the box: the test shows nothing";
  EXPECT_GT(report.coordination, 1);
  EXPECT_LT(report.coordination, 6);
  for (const auto& grain : grains) EXPECT_LT(grain.position.x, edge + grain.radius);
}

// Stones of the library: they keep their shares and the grading's sizes, lie inside the walls with every sphere, and
// fill what their unions' volume says. Adding up spheres would give a porosity below zero.
TEST(Packing, CubeOfClumps) {
  coupling::Scene scene = cube_scene();
  auto& part = *scene.grains;
  for (const char* name : {"stone1.clump10", "stone8.clump10"}) {
    const auto file = fs::path(TRACKBED_SOURCE_FOLDER) / "meshes" / "ballast" / (std::string(name) + ".csv");
    part.shapes.push_back(coupling::read_shape(name, file));
  }
  coupling::Packing& packing = *part.packing;
  packing.grading = {{0.060, 0}, {0.063, 1}};
  packing.young_modulus = 0.02e9;
  packing.shapes = {0, 1};
  packing.shape_shares = {0.5, 0.5};
  packing.use_cache = false;
  packing.layers[0].plate = false;
  packing.layers[0].box.upper = {edge, edge, 0.15};
  dem::set_threads(1);
  coupling::PackingReport report;
  const auto grains = coupling::pack(scene, {}, dem::Backend::omp, report);
  ASSERT_GT(grains.size(), 30u);
  const auto clumps = coupling::clumps(part.shapes);
  std::size_t first = 0;
  double solid = 0;
  for (const auto& grain : grains) {
    first += grain.shape == 0;
    solid += dem::volume(grain, clumps);
    EXPECT_GE(coupling::sieve_size(grain, part.shapes), 0.060);
    EXPECT_LE(coupling::sieve_size(grain, part.shapes), 0.063);
    for (const auto& sphere : dem::placed_spheres(grain, clumps))
      for (int axis = 0; axis < 2; ++axis) {
        EXPECT_GT(sphere.position[axis] - sphere.radius, -0.003);
        EXPECT_LT(sphere.position[axis] + sphere.radius, edge + 0.003);
      }
  }
  EXPECT_NEAR(static_cast<double>(first) / static_cast<double>(grains.size()), 0.5, 0.1);
  EXPECT_GT(report.coordination, 2);
  EXPECT_LT(report.coordination, 8);
  EXPECT_GT(report.porosity, 0.2);
  EXPECT_LT(report.porosity, 0.55);
  std::vector<dem::GrainSphere> spheres;
  for (const auto& grain : grains)
    for (const auto& sphere : dem::placed_spheres(grain, clumps))
      spheres.push_back({sphere.position, sphere.radius, grain.id});
  const coupling::Box everything{{-0.01, -0.01, -0.01}, {edge + 0.01, edge + 0.01, 0.30}};
  const base::Vec3 size = everything.upper - everything.lower;
  const double filled = 1 - coupling::porosity(spheres, everything, 0.003);
  EXPECT_NEAR(filled * size.x * size.y * size.z / solid, 1, 0.01);
}

/// Stones that touch at many spheres, of stiffer contacts than one sphere's Rayleigh limit knows of.
coupling::Scene stones_scene(double dem_fraction, double restitution) {
  coupling::Scene scene = packing_box({0.2, 0.2, 0.2}, {{0.040, 0}, {0.050, 1}}, 0.42);
  auto& part = *scene.grains;
  for (const char* name : {"stone1.clump10", "stone8.clump10"}) {
    const auto file = fs::path(TRACKBED_SOURCE_FOLDER) / "meshes" / "ballast" / (std::string(name) + ".csv");
    part.shapes.push_back(coupling::read_shape(name, file));
  }
  scene.time.dem_fraction = dem_fraction;
  part.interactions = {{0.6, restitution, 0}};
  part.packing->shapes = {0, 1};
  part.packing->shape_shares = {0.5, 0.5};
  part.packing->friction = 0.6;
  part.packing->grain_damping = 3;
  part.packing->seed = 2;
  part.packing->use_cache = false;
  part.packing->layers[0].plate = false;
  part.packing->layers[0].overfill = 0;
  return scene;
}

// Steps above the bound of the live contacts end such a packing with stones at a hundred metres per second, or leave
// them pressed into one another. The bed has to be there, as dense as poured stones are, and to stay when it is let go
// on with a step that is surely small: what overlaps too much springs apart faster than anything falls in that time.
TEST(Packing, StepsObeyTheContacts) {
  dem::set_threads(1);
  for (const auto& [fraction, restitution] : {std::pair{0.9, 0.12}, {0.4, 0.12}}) {
    const coupling::Scene scene = stones_scene(fraction, restitution);
    coupling::PackingReport report;
    const auto grains = coupling::pack(scene, {}, dem::Backend::omp, report);
    EXPECT_GT(grains.size(), 60u) << fraction << ", " << restitution;
    EXPECT_GT(report.porosity, 0.34) << fraction << ", " << restitution;
    EXPECT_LT(report.porosity, 0.52) << fraction << ", " << restitution;
    EXPECT_GT(report.coordination, 3) << fraction << ", " << restitution;
    dem::Setup setup;
    setup.materials = scene.grains->materials;
    setup.materials[0].young_modulus = scene.grains->packing->young_modulus;
    setup.interactions = scene.grains->interactions;
    setup.gravity = scene.gravity;
    const auto sim = dem::Simulation::create(setup, dem::Backend::omp);
    for (const auto& shape : scene.grains->shapes) sim->add_shape(shape.clump);
    for (const auto& wall : scene.grains->walls) sim->add_plane(*wall.plane, 0);
    sim->add_grains(grains);
    const double dt = 0.05 * sim->stable_step().limit;
    sim->advance(static_cast<int>(0.02 / dt), dt);
    double fastest = 0;
    for (const auto& grain : sim->grains()) fastest = std::max(fastest, base::norm(grain.velocity));
    EXPECT_LT(fastest, 0.2) << fraction << ", " << restitution;  // 9.81 m/s2 x 0.02 s
  }
}

// A plate that would have to press the grains far below their closest packing stops and says so.
TEST(Packing, PlateThatCannotComeDown) {
  coupling::Scene scene = cube_scene();
  scene.grains->packing->use_cache = false;
  scene.grains->packing->layers[0].box.upper = {edge, edge, 0.02};  // lower than most grains are thick
  scene.grains->packing->layers[0].origin = "scene.toml:9";
  scene.grains->packing->layers[0].overfill = 1;
  std::string message;
  try {
    coupling::PackingReport report;
    coupling::pack(scene, {}, dem::Backend::omp, report);
  } catch (const base::UserError& error) {
    message = error.what();
  }
  EXPECT_EQ(message.rfind("scene.toml:9: packing.layer.plate: cannot come down to z = 0.02 m: ", 0), 0u) << message;
}

}  // namespace
