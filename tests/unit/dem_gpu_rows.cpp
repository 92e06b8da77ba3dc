// The bytes that docs/performance.md and `gpu-check` count with are those of the rows that the kernels read and write.
#include <gtest/gtest.h>

#include "dem/core/bodies.hpp"
#include "dem/core/wall_pass.hpp"
#include "tests/benchmarks/gpu_report.hpp"

namespace {

using namespace dem::omp_system;

TEST(RowsOfAGpu, AreAsLongAsTheCountsSay) {
  const benchmarks::RowBytes row;
  EXPECT_EQ(sizeof(Place), row.place);
  EXPECT_EQ(sizeof(Quad), row.quad);
  EXPECT_EQ(sizeof(Vec3), row.vector);
  EXPECT_EQ(sizeof(dem::kernels::Quaternion), row.quaternion);
  EXPECT_EQ(sizeof(int), row.index);
  EXPECT_EQ(sizeof(WallSum), row.wall_sum);
  EXPECT_EQ(sizeof(WallState), row.wall_state);
  EXPECT_EQ(sizeof(WallFound), row.wall_found);
  EXPECT_EQ(sizeof(Facet), row.facet);
  EXPECT_EQ(sizeof(NodalImpulse), row.nodal);
}

// A pair leaves eight numbers and, with hertz_mindlin and no energy ledger, keeps four; so does a grain at a wall.
TEST(RowsOfAGpu, PairsKeepFourNumbersAndLeaveEight) {
  const benchmarks::RowBytes row;
  using Pass = ContactPass<dem::kernels::HertzMindlin, double, false, false>;
  using MixedPass = ContactPass<dem::kernels::HertzMindlin, float, false, false>;
  using AtWall = WallPass<dem::kernels::HertzMindlin, false, false>;
  EXPECT_EQ(sizeof(PairForce<double>), row.pair_force * sizeof(double));
  EXPECT_EQ(sizeof(PairForce<float>), row.pair_force * sizeof(float));
  EXPECT_EQ(Pass::numbers, row.history);
  EXPECT_EQ(MixedPass::numbers, row.history);
  EXPECT_EQ(AtWall::numbers * sizeof(double), row.wall_history);
}

}  // namespace
