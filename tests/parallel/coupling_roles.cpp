// Who holds grains and who elements, for every way to ask for it, and what is refused: on all ranks alike.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <mpi.h>

#include "coupling/agree.hpp"
#include "coupling/roles.hpp"

namespace {

using coupling::RankWishes;
using coupling::Roles;
using coupling::Scene;

int rank() {
  int number = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &number);
  return number;
}
int ranks() {
  int number = 1;
  MPI_Comm_size(MPI_COMM_WORLD, &number);
  return number;
}
int size_of(MPI_Comm communicator) {
  int size = 0;
  if (communicator != MPI_COMM_NULL) MPI_Comm_size(communicator, &size);
  return size;
}

Scene scene(bool grains, bool bodies) {
  Scene made;
  made.file = "track.toml";
  if (grains) made.grains.emplace();
  if (bodies) made.bodies.resize(1);
  return made;
}

/// What Roles says, "" if nothing; the same on all ranks or the test fails.
std::string refusal(const Scene& of, const RankWishes& wishes) {
  const auto failure = coupling::caught([&] { const Roles roles(MPI_COMM_WORLD, of, wishes); });
  EXPECT_TRUE(failure.kind == coupling::Failure::none || failure.kind == coupling::Failure::user);
  const int length = static_cast<int>(failure.text.size());
  int longest = 0;
  MPI_Allreduce(&length, &longest, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
  EXPECT_EQ(length, longest) << failure.text;
  return failure.text;
}

TEST(Roles, OneRankHoldsGrainsUnlessMoreAreAskedFor) {
  const Roles roles(MPI_COMM_WORLD, scene(true, true));
  const bool lone = ranks() == 1;
  EXPECT_TRUE(roles.coupled);
  EXPECT_EQ(roles.dem_ranks, 1);
  EXPECT_EQ(roles.fem_ranks, lone ? 1 : ranks() - 1);
  EXPECT_EQ(roles.is_dem, rank() == 0);
  EXPECT_EQ(roles.is_fem, lone || rank() > 0);
  EXPECT_FALSE(roles.is_worker);
  EXPECT_EQ(roles.rank, rank());
  EXPECT_EQ(roles.size, ranks());
  EXPECT_EQ(roles.dem_here, 1);
  EXPECT_EQ(roles.fem_here, ranks() - 1);
}

TEST(Roles, WorkersAreNoPartOfTheCrew) {
  if (ranks() < 3) GTEST_SKIP();
  const Roles roles(MPI_COMM_WORLD, scene(true, true), {2, ""});
  EXPECT_EQ(roles.is_dem, rank() == 0);
  EXPECT_EQ(roles.is_worker, rank() == 1);
  EXPECT_EQ(roles.is_fem, rank() >= 2);
  EXPECT_EQ(roles.rank, (std::array{0, -1, 1})[static_cast<std::size_t>(rank())]);
  EXPECT_EQ(size_of(roles.world), rank() == 1 ? 0 : 2);
  EXPECT_EQ(size_of(roles.dem), rank() < 2 ? 2 : 0);
  EXPECT_EQ(size_of(roles.fem), rank() < 2 ? 0 : 1);
  EXPECT_EQ(roles.first_fem_rank, 1);
  EXPECT_EQ(roles.is_fem_root(), rank() == 2);
  EXPECT_EQ(roles.all_ranks, 3);
  EXPECT_EQ(roles.dem_here, 2);
  if (rank() < 2) {
    EXPECT_EQ(roles.dem_number_here, rank());
  }
}

TEST(Roles, WithoutBodiesAllHoldGrainsAndWithoutGrainsNobody) {
  const Roles grains(MPI_COMM_WORLD, scene(true, false)), bodies(MPI_COMM_WORLD, scene(false, true));
  EXPECT_EQ(grains.dem_ranks, ranks());
  EXPECT_EQ(grains.fem_ranks, 0);
  EXPECT_EQ(grains.is_worker, rank() > 0);
  EXPECT_EQ(grains.is_root(), rank() == 0);
  EXPECT_EQ(grains.size, rank() == 0 ? 1 : 0);
  EXPECT_EQ(bodies.dem_ranks, 0);
  EXPECT_EQ(bodies.fem_ranks, ranks());
  EXPECT_EQ(bodies.rank, rank());
  EXPECT_EQ(bodies.first_fem_rank, 0);
}

// mpirun -n 1 … --role fem : -n N-1 … --role dem: the DEM ranks still come first.
TEST(Roles, RolesPutDemRanksFirst) {
  if (ranks() < 2) GTEST_SKIP();
  const Roles roles(MPI_COMM_WORLD, scene(true, true), {std::nullopt, rank() == 0 ? "fem" : "dem"});
  EXPECT_EQ(roles.dem_ranks, ranks() - 1);
  EXPECT_EQ(roles.is_fem, rank() == 0);
  EXPECT_EQ(roles.is_dem, rank() == 1);
  EXPECT_EQ(roles.is_worker, rank() > 1);
  EXPECT_EQ(roles.rank, (std::array{1, 0, -1})[static_cast<std::size_t>(std::min(rank(), 2))]);
  int number = -1;
  if (roles.dem != MPI_COMM_NULL) MPI_Comm_rank(roles.dem, &number);
  EXPECT_EQ(number, rank() - 1);
}

TEST(Roles, WhatTheSceneCannotUseIsRefused) {
  const auto of = [](int number) { return fmt::format("{} rank{}", number, number == 1 ? "" : "s"); };
  const int n = ranks();
  EXPECT_EQ(refusal(scene(true, true), {n + 1, ""}),
            fmt::format("--dem-ranks {}: {} in all, and the bodies of track.toml need one at least; start mpirun with "
                        "-n {} or more, or take fewer DEM ranks",
                        n + 1, of(n), n + 2));
  EXPECT_EQ(refusal(scene(true, false), {n + 1, ""}),
            fmt::format("--dem-ranks {}: track.toml has no deformable body, so all of {} hold grains; leave it out, or "
                        "start mpirun with -n {}",
                        n + 1, of(n), n + 1));
  EXPECT_EQ(refusal(scene(false, true), {1, ""}), "--dem-ranks 1: track.toml has no grains; leave it out");
  EXPECT_EQ(refusal(scene(false, true), {std::nullopt, "dem"}),
            "--role dem: track.toml has no grains; start all ranks without --role");
  EXPECT_EQ(refusal(scene(true, false), {std::nullopt, "fem"}),
            "--role fem: track.toml has no deformable body; start all ranks without --role");
  for (const char* role : {"dem", "fem"})
    EXPECT_EQ(
        refusal(scene(true, true), {std::nullopt, role}),
        fmt::format("--role: all of {} have the role {}; track.toml needs ranks of both roles, or none with a role",
                    of(n), role));
  EXPECT_EQ(refusal(scene(true, false), {std::nullopt, "dem"}), "");
  if (n == 1) return;
  EXPECT_NE(refusal(scene(true, true), {n, ""}).find("the bodies of track.toml need one at least"), std::string::npos);
  EXPECT_EQ(
      refusal(scene(true, true), {std::nullopt, rank() == 0 ? "dem" : ""}),
      fmt::format("--role: given to 1 rank of {}; give every part of the mpirun line --role dem or --role fem, or "
                  "none",
                  n));
  EXPECT_EQ(refusal(scene(true, true), {2, rank() == 0 ? "dem" : "fem"}),
            "--dem-ranks 2: but --role dem is given to 1 rank; leave one of the two out");
  EXPECT_EQ(refusal(scene(true, true), {rank() == 0 ? std::optional(1) : std::nullopt, ""}),
            "--dem-ranks: 1 on some ranks, none on others; give every part of the mpirun line the same, or none");
  EXPECT_EQ(refusal(scene(true, true), {1 + rank() % 2, ""}),
            "--dem-ranks: 2 on some ranks, 1 on others; give every part of the mpirun line the same, or none");
}

TEST(Roles, BondsNeedOneDemRank) {
  if (ranks() == 1) GTEST_SKIP();
  Scene bonded = scene(true, false);
  bonded.grains->bonding.gap = 1e-3;
  EXPECT_EQ(
      refusal(bonded, {}),
      fmt::format("track.toml: has bonds, which need one DEM rank, and {} ranks would hold grains; start with one "
                  "rank, without mpirun",
                  ranks()));
  bonded.bodies.resize(1);
  EXPECT_EQ(refusal(bonded, {}), "");
  if (ranks() == 2) return;
  EXPECT_EQ(refusal(bonded, {2, ""}),
            "track.toml: has bonds, which need one DEM rank, and 2 ranks would hold grains; start with --dem-ranks 1");
}

}  // namespace
