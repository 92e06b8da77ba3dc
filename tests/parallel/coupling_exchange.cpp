// The exchange between every DEM part and every FEM rank, with stand-ins on both sides: what each pair moves, that the
// parts' pictures of the skin are right wherever they are asked to be, that momentum is passed whole, and that whoever
// fails alone stops all others without a hang. On n ranks: n - 1 with grains, one with bodies (three ranks: also 1 +
// 2).
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <mpi.h>

#include <cmath>
#include <map>
#include <new>

#include "base/error.hpp"
#include "coupling/agree.hpp"
#include "coupling/exchange.hpp"
#include "coupling/slab_simulation.hpp"
#include "tests/parallel/exchange_stand_ins.hpp"

namespace {

using namespace stand_ins;
using coupling::Failure;
using dem::Vec3;

int ranks() {
  int number = 1;
  MPI_Comm_size(MPI_COMM_WORLD, &number);
  return number;
}

coupling::Scene scene() {
  coupling::Scene made;
  made.file = "track.toml";
  made.grains.emplace();
  made.bodies.resize(1);
  return made;
}

/// The sides of one run, window by window.
struct Sides {
  explicit Sides(int dem_ranks, const coupling::CouplingSettings& settings = {})
      : roles(MPI_COMM_WORLD, scene(), {dem_ranks, ""}) {
    const auto maker = [](const dem::Setup& setup, dem::Backend) { return std::make_unique<Grains>(setup); };
    if (roles.is_worker) {
      coupling::serve_slabs(roles.dem, maker, roles.joint);
      return;
    }
    if (roles.is_dem && roles.dem_ranks > 1) crew = std::make_unique<coupling::SlabCrew>(roles.dem, maker, roles.joint);
    if (roles.is_fem) model = std::make_unique<Model>(roles.rank - roles.first_fem_rank, roles.fem_ranks);
    exchange = std::make_unique<coupling::Exchange>(roles, model.get(), settings);
    if (!roles.is_dem) return;
    dem::Setup setup;
    setup.materials.resize(1);
    grains = crew ? crew->make(setup, dem::Backend::omp) : maker(setup, dem::Backend::omp);
    const int wall = grains->add_mesh(exchange->skins()[0], 0, false);
    exchange->join(*grains, crew ? static_cast<coupling::SlabSimulation*>(grains.get()) : nullptr, {wall});
  }
  /// As RunLoop does it; false when somebody has failed.
  bool window(double fail = 0) {
    coupling::FailureText failure;
    bool sound = true;
    if (model) {
      exchange->begin_window(*model);
      model->step();
      const bool fails = fail == 1 && roles.is_fem_root();
      if (!fails || roles.size > 1) exchange->send_skins(*model, 0, fails);
      sound = !fails;
    }
    if (grains && sound)
      failure = coupling::caught([&] { sound = exchange->window(2, fail < 0 ? -fail : 1e-3, fail == 2); });
    failed = failure;
    sound = sound && failure.kind == Failure::none;
    if (model && sound) sound = exchange->receive_impulses();
    if (model && sound) exchange->apply(*model, 2e-3);
    exchange->finish_window();
    return sound;
  }
  coupling::Roles roles;
  std::unique_ptr<coupling::SlabCrew> crew;
  std::unique_ptr<Model> model;
  std::unique_ptr<coupling::Exchange> exchange;
  std::unique_ptr<dem::Simulation> grains;
  coupling::FailureText failed;
};

std::vector<int> layouts() {  // DEM ranks
  if (ranks() == 1) return {1};
  return ranks() == 2 ? std::vector{1} : std::vector{1, 2};
}

TEST(Exchange, PairsMoveWhatTheyShare) {
  for (const int dem_ranks : layouts()) {
    Sides sides(dem_ranks);
    if (sides.roles.is_worker) continue;
    for (int k = 0; k < 3; ++k) EXPECT_TRUE(sides.window());
    if (!sides.grains) continue;
    const auto traffic = sides.exchange->traffic();
    ASSERT_EQ(static_cast<int>(traffic.size()), dem_ranks);
    int sum = 0;
    for (int part = 0; part < dem_ranks; ++part) {
      const auto& of = traffic[static_cast<std::size_t>(part)];
      ASSERT_EQ(static_cast<int>(of.nodes.size()), sides.roles.fem_ranks);
      int nodes = 0;
      for (const int number : of.nodes) nodes += number;
      if (ranks() == 1) {  // one process has the whole skin at hand
        EXPECT_EQ(nodes, skin_nodes());
        return;
      }
      // A slab of `share` metres, grain and skin to spare, and one and a half margins and a cell on either side.
      const double share = bed_length / dem_ranks, extent = share + 2 * spare + 2 * 1.5 * margin(2e-3);
      EXPECT_GE(nodes, nodes_across * extent / cell);
      EXPECT_LE(nodes, nodes_across * (extent / cell + 3)) << "part " << part;
      sum += nodes;
    }
    EXPECT_LT(sum, dem_ranks * skin_nodes() / 4);
  }
}

// Grains drift over the whole skin, which moves too: wherever a grain is, the part has the skin's true places there,
// and where it cannot have them it knows that.
TEST(Exchange, PartsHaveTheSkinRightWhereTheirGrainsAre) {
  for (const auto motion : {coupling::SkinMotion::linear, coupling::SkinMotion::quadratic})
    for (const int dem_ranks : layouts()) {
      Sides sides(dem_ranks, {.skin_motion = motion});
      if (sides.roles.is_worker) continue;
      for (int k = 0; k < 400; ++k) ASSERT_TRUE(sides.window()) << k << ": " << sides.failed.text;
      if (sides.grains) {
        EXPECT_LE(sides.exchange->momentum_error(), 1e-13);
      }
    }
}

TEST(Exchange, ConcurrentMomentumIsPassedWhole) {
  for (const int dem_ranks : layouts()) {
    Sides sides(dem_ranks, {.scheme = coupling::Scheme::concurrent});
    if (sides.roles.is_worker) continue;
    // The bodies take the impulse of the window before: forces first, then what has come.
    for (int k = 0; k < 50; ++k) {
      if (sides.model) {
        sides.model->step();
        sides.exchange->send_skins(*sides.model, 0, false);
      }
      if (sides.grains) {
        ASSERT_TRUE(sides.exchange->window(2, 1e-3, false));
      }
      if (sides.model) {
        sides.exchange->apply(*sides.model, 2e-3);
        ASSERT_TRUE(sides.exchange->receive_impulses());
      }
      sides.exchange->finish_window();
    }
    if (sides.grains) {
      EXPECT_LE(sides.exchange->momentum_error(), 1e-13);
    }
  }
}

/// 1: the bodies; 2: the crew's DEM rank between windows; below 0: this length of step makes the part fail of which
/// Grains::advance() says so.
TEST(Exchange, WhoeverFailsStopsAllOthers) {
  for (const int dem_ranks : layouts())
    for (const double fail : {1.0, 2.0, first_part_fails, last_part_fails, last_part_fails_in_company}) {
      Sides sides(dem_ranks);
      if (sides.roles.is_worker) continue;
      EXPECT_TRUE(sides.window());
      // Both sides must leave the window: without a hang, and knowing that it has failed.
      const bool alone = sides.roles.size == 1;
      EXPECT_FALSE(sides.window(fail < 0 && !sides.grains    ? 0
                                : fail == 2 && !sides.grains ? 0
                                                             : fail))
          << dem_ranks << ", " << fail;
      if (sides.grains && fail < 0) {
        EXPECT_EQ(sides.failed.kind, Failure::machine) << sides.failed.text;
      }
      if (alone) continue;
      const auto agreed =
          coupling::caught([&] { coupling::agree(sides.roles.world, [&] { coupling::raise(sides.failed); }); });
      if (fail < 0) {
        EXPECT_EQ(agreed.text, "out of memory; use fewer grains or a coarser mesh, or more ranks");
      }
    }
}

}  // namespace
