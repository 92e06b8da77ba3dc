// What `gpu-check` says of a GPU, as far as no GPU is needed for it: bytes of a step, floors, targets and verdicts.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/benchmarks/gpu_report.hpp"

namespace {

using namespace benchmarks;

/// A million of them, in a bed with so many candidates and contacts each.
StepContents spheres(double pairs, double contacts) {
  return {.grains = 1e6, .spheres = 1e6, .pairs = 1e6 * pairs, .contacts = 1e6 * contacts};
}

// Formulas: docs/performance.md, table of the kernels on a GPU. p = 3.1, c = 2.3: 567, 441 and 1010 bytes; floor 0.34
// ms for a million spheres at 3.0 TB/s.
TEST(GpuReport, BytesOfSpheresAreThoseOfTheTable) {
  const StepBytes bytes = step_bytes(spheres(3.1, 2.3));
  EXPECT_NEAR(bytes.motion, 1e6 * (356 + 68 * 3.1), 1);
  EXPECT_NEAR(bytes.contacts, 1e6 * (96 + 40 * 3.1 + 96 * 2.3), 1);
  EXPECT_EQ(bytes.walls, 0);
  EXPECT_NEAR(bytes.total() / 3.0e12, 0.34e-3, 0.005e-3);
  StepContents mixed = spheres(3.1, 2.3);
  mixed.mixed = true;
  EXPECT_NEAR(step_bytes(mixed).motion, 1e6 * (356 + 36 * 3.1), 1);
  EXPECT_NEAR(step_bytes(mixed).contacts, 1e6 * (96 + 40 * 3.1 + 32 * 2.3), 1);
}

// Per sphere of a clump of n: 284 / n + 252 + 68 p, and as for any sphere 96 + 40 p + 96 c.
TEST(GpuReport, BytesOfClumpsAreThoseOfTheTable) {
  StepContents clumps = spheres(2, 1);
  clumps.clumps = true;
  clumps.grains = 1e5;
  const StepBytes bytes = step_bytes(clumps);
  EXPECT_NEAR(bytes.motion, 1e6 * (28.4 + 252 + 136), 1);
  EXPECT_NEAR(bytes.contacts, 1e6 * (96 + 80 + 96), 1);
}

// 196 for a grain near a wall with its facet, 64 more where they are apart, 352 where they touch; its sum is 64 of the
// motion.
TEST(GpuReport, BytesOfWallsAreThoseOfTheTable) {
  StepContents near = spheres(0, 0);
  const double without = step_bytes(near).motion;
  near.wall_candidates = 1000;
  near.wall_contacts = 400;
  EXPECT_NEAR(step_bytes(near).walls, 1000 * 196 + 600 * 64 + 400 * 352, 1e-6);
  EXPECT_NEAR(step_bytes(near).motion - without, 64000, 1e-6);
}

// Names as the compiler mangles them.
TEST(GpuReport, KernelsAreKnownByTheirNames) {
  EXPECT_EQ(kernel_of("_ZN3dem11cuda_system14largest_kernelINS0_7MoveAllINS0_8LeapfrogI"), motion);
  EXPECT_EQ(kernel_of("_ZN3dem11cuda_system11each_kernelINS0_11UnlessStaleINS0_11ContactPassI"), contacts);
  EXPECT_EQ(kernel_of("_ZN3dem11cuda_system11each_kernelINS0_11UnlessStaleINS0_8WallPassI"), walls);
  EXPECT_EQ(kernel_of("_ZN3dem11cuda_system11each_kernelINS0_9BeginStepEEEviT_"), others);
}

// 2 MB at 1 TB/s are 2 us; ten steps that took 40 us in all took 4 us each: half of the time is the floor's.
TEST(GpuReport, ShareOfTheFloorByKernel) {
  const std::string rows =
      kernel_rows("bed", {.motion = 2e6, .contacts = 1e6, .walls = 0}, 1e4, 1e12,
                  {{"MoveAll", 30e-6}, {"MoveAll again", 10e-6}, {"ContactPass", 10e-6}, {"sum", 5e-6}}, 10);
  EXPECT_EQ(rows,
            "| bed | motion (`MoveAll`) | 200 | 0.002 | 0.004 | 50 % |\n"
            "| bed | contacts (`ContactPass`) | 100 | 0.001 | 0.001 | 100 % |\n"
            "| bed | walls (`WallPass`, beside contacts) | 0 | 0 | 0 | – |\n"
            "| bed | all others | – | – | 0.0005 | – |\n");
  const std::string floors = kernel_rows("bed", {.motion = 2e6, .contacts = 1e6, .walls = 0}, 1e4, 1e12, {}, 0);
  EXPECT_EQ(floors,
            "| bed | motion (`MoveAll`) | 200 | 0.002 | not measured | – |\n"
            "| bed | contacts (`ContactPass`) | 100 | 0.001 | not measured | – |\n"
            "| bed | walls (`WallPass`, beside contacts) | 0 | 0 | not measured | – |\n");
}

// The figures of the issue, each from both sides: one that was compared the wrong way round would hold here.
TEST(GpuReport, VerdictsComeFromTheTargets) {
  const auto said = [](double step, double memory) {
    return verdicts(
        {{.bed = "1000000 spheres, double", .step = step, .grains = 1e6, .spheres = 1e6, .memory = memory}});
  };
  EXPECT_EQ(said(0.9e-3, 0.6e9),
            "| bed | target | measured | verdict |\n|---|---|---|---|\n"
            "| 1000000 spheres, double | ≥ 1 G sphere-steps/s | 1.11 | held |\n"
            "| 1000000 spheres, mixed | ≥ 2 G sphere-steps/s | – | not measured |\n"
            "| 1000000 spheres, double | ≤ 0.7 GB per million spheres | 0.6 | held |\n"
            "| 1000000 spheres, mixed | ≤ 0.7 GB per million spheres | – | not measured |\n"
            "| 1000000 three-sphere clumps, mixed | ≥ 0.4 G clump-steps/s | – | not measured |\n"
            "| 31000 ten-sphere clumps, double | ≤ 0.25 ms/step | – | not measured |\n"
            "| 10000 spheres, double | ≤ 0.05 ms/step | – | not measured |\n");
  const std::string slow = said(1.1e-3, 0.8e9);
  EXPECT_NE(slow.find("≥ 1 G sphere-steps/s | 0.909 | **not held** |"), std::string::npos) << slow;
  EXPECT_NE(slow.find("≤ 0.7 GB per million spheres | 0.8 | **not held** |"), std::string::npos) << slow;
  for (const Target& target : targets()) {
    EXPECT_TRUE(holds(target, target.limit));
    EXPECT_EQ(holds(target, 1.01 * target.limit), target.at_least);
    EXPECT_EQ(holds(target, 0.99 * target.limit), !target.at_least);
    EXPECT_FALSE(holds(target, std::nan("")));
  }
}

// Clumps count as clumps where the target says so, spheres as spheres; without a device nothing is said of its memory.
TEST(GpuReport, RatesCountWhatTheTargetCounts) {
  const std::vector<Measured> all{
      {.bed = "1000000 three-sphere clumps, mixed", .step = 2e-3, .grains = 1e6, .spheres = 3e6, .memory = {}},
      {.bed = "31000 ten-sphere clumps, double", .step = 0.2e-3, .grains = 31e3, .spheres = 31e4, .memory = {}},
      {.bed = "1000000 spheres, mixed", .step = 1e-3, .grains = 1e6, .spheres = 1e6, .memory = {}}};
  EXPECT_DOUBLE_EQ(*value_of(targets()[4], all), 0.5);
  EXPECT_DOUBLE_EQ(*value_of(targets()[5], all), 0.2);
  EXPECT_FALSE(value_of(targets()[3], all));
}

}  // namespace
