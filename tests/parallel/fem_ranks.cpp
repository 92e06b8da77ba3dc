// One rank and several: every rank also runs the whole model alone, so the answer to compare with is at hand. A ghost
// that is not exchanged, or a node counted twice, shows in the first steps; what is allowed is the rounding of another
// order of sums.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "base/error.hpp"
#include "tests/fem_helper.hpp"

namespace {

using base::Vec3;
using fem::Quantity;

testing::Environment* const petsc = testing::AddGlobalTestEnvironment(new fem_test::PetscEnvironment);

/// A sleeper of tetrahedra above ground of hexahedra, both with skins, weight, damping and a load.
fem::Setup track() {
  fem::Setup setup;
  setup.gravity = {0, 0, -9.81};
  auto sleeper = fem_test::box("tet4", {});
  sleeper.name = "sleeper";
  sleeper.mesh_file = TRACKBED_SOURCE_FOLDER "/meshes/sleeper.geo";
  sleeper.mesh_parameters = {{"cells_x", 3}, {"cells_y", 13}, {"cells_z", 2}};
  sleeper.translation = {0.3, 0, 0.3};
  sleeper.gravity = true;
  sleeper.damping = 20;
  sleeper.supports = {{"symmetry", {false, true, false}, ""}};
  sleeper.loads = {{"seat",
                    "rail_seat",
                    fem::LoadKind::face_total,
                    {0, 0, -1},
                    fem_test::history([](double t) { return 4e4 * std::sin(900 * t); }),
                    ""}};
  sleeper.skin = {"bottom", "sides", "end"};
  auto ground = fem_test::box("hex8_bbar", {});
  ground.name = "ground";
  ground.mesh_file = TRACKBED_SOURCE_FOLDER "/meshes/ground.geo";
  ground.mesh_parameters = {{"cells_x", 3}, {"cells_y", 12}, {"cells_formation", 2}, {"cells_subgrade", 3}};
  ground.materials = {{"formation", "linear_elastic", 120e6, 0.3, 2000, ""},
                      {"subgrade", "linear_elastic", 60e6, 0.3, 1900, ""}};
  ground.supports = {
      {"base", {true, true, true}, ""}, {"cut_x", {true, false, false}, ""}, {"cut_y0", {false, true, false}, ""}};
  ground.skin = {"top"};
  setup.bodies = {sleeper, ground};
  return setup;
}

/// 200 steps with forces on the skins that depend on place and velocity, as contacts do.
void run(fem::Model& model, double dt) {
  for (int i = 0; i < 200; ++i) {
    model.predict(dt);
    for (int s = 0; s < 2; ++s) {
      const auto count = model.owned_skin_nodes(s).size();
      std::vector<Vec3> places(count), velocities(count), forces(count);
      model.skin_state(s, places, velocities);
      for (std::size_t n = 0; n < count; ++n) {
        forces[n] = Vec3{0, 0, 50 * std::sin(20 * places[n].y) * (s == 0 ? 1 : -1)} - velocities[n] * 1e3;
      }
      model.set_skin_forces(s, forces);
    }
    model.inner_forces();
    model.correct(dt);
  }
}

void expect_near(const Vec3& a, const Vec3& b, double scale) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], 1e-10 * scale);
}

TEST(FemRanks, OneModelOnAnyNumberOfRanks) {
  const auto together = fem::Model::create(MPI_COMM_WORLD, track()), alone = fem::Model::create(MPI_COMM_SELF, track());
  EXPECT_NEAR(together->stable_step().limit, alone->stable_step().limit, 1e-9 * alone->stable_step().limit);
  EXPECT_EQ(together->stable_step().limiter, alone->stable_step().limiter);
  const double dt = 0.9 * alone->stable_step().limit;
  run(*together, dt);
  run(*alone, dt);

  for (std::size_t b = 0; b < 2; ++b) {
    EXPECT_EQ(together->counts()[b].elements, alone->counts()[b].elements);
    EXPECT_NEAR(together->counts()[b].mass, alone->counts()[b].mass, 1e-12 * alone->counts()[b].mass);
  }
  double moved = 0, speed = 0;
  for (int s = 0; s < 2; ++s) {
    const auto& skin = alone->skins()[s];
    ASSERT_EQ(together->skins()[s].facets, skin.facets);
    ASSERT_EQ(together->skins()[s].faces, skin.faces);
    ASSERT_EQ(together->skins()[s].face_of, skin.face_of);
    ASSERT_EQ(together->skins()[s].nodes.size(), skin.nodes.size());
    const auto all = alone->owned_skin_nodes(s), mine = together->owned_skin_nodes(s);
    std::vector<Vec3> places(all.size()), velocities(all.size()), here(mine.size()), here_velocities(mine.size());
    alone->skin_state(s, places, velocities);
    together->skin_state(s, here, here_velocities);
    std::vector<int> place_of(skin.nodes.size(), -1);
    for (std::size_t n = 0; n < all.size(); ++n) {
      place_of[all[n]] = static_cast<int>(n);
      moved = std::max(moved, base::norm(places[n] - skin.nodes[all[n]]));
      speed = std::max(speed, base::norm(velocities[n]));
    }
    for (std::size_t n = 0; n < mine.size(); ++n) {
      expect_near(here[n], places[place_of[mine[n]]], moved + 1e-5);  // places are known to 1e-16 m
      expect_near(here_velocities[n], velocities[place_of[mine[n]]], speed);
    }
    int owned = static_cast<int>(mine.size());
    MPI_Allreduce(MPI_IN_PLACE, &owned, 1, MPI_INT, MPI_SUM, MPI_COMM_WORLD);
    EXPECT_EQ(owned, static_cast<int>(skin.nodes.size())) << "every skin node has one owner";
  }
  EXPECT_GT(moved, 1e-7);
  const auto a = together->energy(), b = alone->energy();
  for (auto term : {&base::Energy::kinetic, &base::Energy::strain, &base::Energy::work_loads,
                    &base::Energy::work_gravity, &base::Energy::work_interface, &base::Energy::loss_damping}) {
    EXPECT_NEAR(a.*term, b.*term, 1e-10 * b.kinetic);
  }
  expect_near(together->probe_group("sleeper", "rail_seat", Quantity::displacement),
              alone->probe_group("sleeper", "rail_seat", Quantity::displacement), moved);
  expect_near(together->probe_point("ground", {0.3, 0.75, 0}, Quantity::velocity),
              alone->probe_point("ground", {0.3, 0.75, 0}, Quantity::velocity), speed);
}

/// Second-order elements, viscosity, turning, plasticity, motion, pressure and an absorbing side.
fem::Setup mixed_bodies() {
  fem::Setup setup;
  setup.gravity = {0, 0, -9.81};
  auto soil = fem_test::box("hex8_incompatible", {2, 0.6, 0.6, 9, 3, 3});
  soil.name = "soil";
  soil.materials = {{"", "drucker_prager", 60e6, 0.3, 2000, "", 1e3, 1e3, 20e3, 0.5, 0.1}};
  soil.absorbing = {{"x_max", ""}};
  soil.supports = {{"z_min", {false, false, true}, ""}};
  soil.loads = {
      {"foot", "z_max", fem::LoadKind::pressure, {}, fem_test::history([](double t) { return 2e8 * t; }), ""}};
  auto beam = fem_test::box("tet10", {1, 0.2, 0.2, 5, 1, 1});
  beam.name = "beam";
  beam.translation = {0, 0, 2};
  beam.stiffness_damping = 1e-6;
  beam.motions = {{"shake",
                   "x_min",
                   fem::PrescribedMotion::Kind::displacement,
                   {true, true, true},
                   fem_test::history([](double t) { return 1e-4 * (1 - std::cos(5e3 * t)); }),
                   ""}};
  auto top = fem_test::box("hex20_reduced", {1, 0.2, 0.2, 5, 1, 1});
  top.name = "top";
  top.translation = {0, 0, 3};
  top.materials = {{"", "left_cauchy_green", 45e9, 0.2, 2400, "", 1e4, 0}};
  top.skin = {"x_max"};
  setup.bodies = {soil, beam, top};
  return setup;
}

TEST(FemRanks, EveryKindOfBodyOnAnyNumberOfRanks) {
  const auto together = fem::Model::create(MPI_COMM_WORLD, mixed_bodies()),
             alone = fem::Model::create(MPI_COMM_SELF, mixed_bodies());
  EXPECT_NEAR(together->stable_step().limit, alone->stable_step().limit, 1e-9 * alone->stable_step().limit);
  EXPECT_EQ(together->stable_step().limiter, alone->stable_step().limiter);
  const double dt = 0.9 * alone->stable_step().limit;
  for (int i = 0; i < 300; ++i) {
    fem_test::step(*together, dt);
    fem_test::step(*alone, dt);
  }
  const auto a = together->energy(), b = alone->energy();
  EXPECT_GT(b.loss_plastic, 0);
  EXPECT_GT(b.loss_viscous, 0);
  for (auto term : {&base::Energy::kinetic, &base::Energy::strain, &base::Energy::work_loads,
                    &base::Energy::loss_damping, &base::Energy::loss_viscous, &base::Energy::loss_plastic}) {
    EXPECT_NEAR(a.*term, b.*term, 1e-10 * b.work_loads);
  }
  for (const char* body : {"soil", "beam", "top"}) {
    const auto moved = alone->probe_group(body, "x_max", Quantity::displacement);
    expect_near(together->probe_group(body, "x_max", Quantity::displacement), moved, base::norm(moved) + 1e-6);
  }
}

TEST(FemRanks, AWrongInputIsThrownOnEveryRank) {
  auto setup = track();
  setup.bodies[1].mesh_file = "nowhere.geo";
  EXPECT_THROW(fem::Model::create(MPI_COMM_WORLD, setup), base::UserError);
  setup = track();
  setup.bodies[0].skin = {"underside"};
  EXPECT_THROW(fem::Model::create(MPI_COMM_WORLD, setup), base::UserError);
}

TEST(FemRanks, AnUnstableRunIsThrownOnEveryRank) {
  const auto model = fem::Model::create(MPI_COMM_WORLD, track());
  const double dt = 3 * model->stable_step().limit;
  EXPECT_THROW(
      {
        for (int i = 0; i < 2000; ++i) fem_test::step(*model, dt);
      },
      base::UnstableError);
}

TEST(FemRanks, PicturesAndAFullDisk) {
  const auto model = fem::Model::create(MPI_COMM_WORLD, track());
  int rank = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  std::string folder = (std::filesystem::temp_directory_path() / ("trackbed_" + std::to_string(getpid()))).string();
  folder.resize(256, '\0');
  MPI_Bcast(folder.data(), 256, MPI_CHAR, 0, MPI_COMM_WORLD);
  folder = folder.c_str();
  model->write(folder, 0);
  model->write(folder, 0.5);
  if (rank == 0) {
    EXPECT_TRUE(std::filesystem::exists(folder + "/sleeper.pvd"));
    EXPECT_TRUE(std::filesystem::exists(folder + "/ground/ground_0001.vtu"));
    std::filesystem::remove_all(folder);
  }
  EXPECT_THROW(model->write("/proc/no_such_place", 0), base::MachineError);
}

}  // namespace
