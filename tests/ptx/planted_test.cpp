// The pretended device computes what the host computes, and finds what is wrong with a kernel or with its host.
#include "tests/ptx/planted.hpp"

#include <cuda_runtime_api.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "tests/ptx/runtime.hpp"
#include "tests/ptx/warp.hpp"

namespace {

class Planted : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(cudaMalloc(reinterpret_cast<void**>(&row), 64 * sizeof(int)), cudaSuccess);
    ASSERT_EQ(cudaMalloc(reinterpret_cast<void**>(&other), 256 * sizeof(int)), cudaSuccess);
    ASSERT_EQ(cudaMallocHost(reinterpret_cast<void**>(&host), 256 * sizeof(int)), cudaSuccess);
    ASSERT_EQ(cudaDeviceSynchronize(), cudaSuccess);
  }
  void TearDown() override {
    ptx::watches_races = false;
    ptx::make_whole();
    cudaFree(row);
    cudaFree(other);
    cudaFreeHost(host);
  }
  static bool fails() { return cudaDeviceSynchronize() == cudaErrorIllegalAddress && ptx::make_whole(); }
  int *row = nullptr, *other = nullptr, *host = nullptr;
};

TEST_F(Planted, WritePastTheEnd) {
  planted::write_past_the_end(row, 63);
  EXPECT_EQ(cudaDeviceSynchronize(), cudaSuccess);
  planted::write_past_the_end(row + 1, 63);
  EXPECT_TRUE(fails());
}

TEST_F(Planted, ReadOfWhatIsFreed) {
  planted::write_past_the_end(row, 63);
  planted::read(row, other, 64);
  EXPECT_EQ(cudaDeviceSynchronize(), cudaSuccess);
  EXPECT_EQ(ptx::findings.unwritten, 0);
  cudaFreeAsync(row, nullptr);
  planted::read(row, other, 64);
  EXPECT_TRUE(fails());
}

TEST_F(Planted, ReadOfWhatWasNeverWritten) {
  planted::write_past_the_end(row, 9);
  planted::read(row, other, 11);
  EXPECT_EQ(cudaDeviceSynchronize(), cudaSuccess);
  EXPECT_EQ(ptx::findings.unwritten, 1);
}

TEST_F(Planted, ReadAcrossWords) {
  planted::write_past_the_end(row, 63);
  planted::read_across_words(row, other);
  EXPECT_TRUE(fails());
}

TEST_F(Planted, ShuffleThatHalfAWarpDoesNotReach) {
  planted::shuffle_with_half_a_warp(other);
  EXPECT_TRUE(fails());
}

TEST_F(Planted, WarpsThatDoNotWaitForEachOther) {
  ptx::watches_races = true;
  planted::exchange_with_barrier(other, 256);
  EXPECT_EQ(cudaMemcpyAsync(host, other, 256 * sizeof(int), cudaMemcpyDeviceToHost, nullptr), cudaSuccess);
  EXPECT_EQ(cudaDeviceSynchronize(), cudaSuccess);
  for (int k = 0; k < 256; ++k) EXPECT_EQ(host[k], 2 * (255 - k));
  EXPECT_EQ(ptx::findings.races, 0);
  planted::exchange_without_barrier(other, 256);
  EXPECT_EQ(cudaDeviceSynchronize(), cudaSuccess);
  EXPECT_GT(ptx::findings.races, 0);
}

TEST_F(Planted, BlocksThatWriteTheSameWord) {
  ptx::watches_races = true;
  planted::all_write_one(row, 1);
  EXPECT_EQ(cudaDeviceSynchronize(), cudaSuccess);
  EXPECT_EQ(ptx::findings.races, 0);
  planted::all_write_one(row, 3);  // 0, which is there already, 1 and 2
  EXPECT_EQ(cudaDeviceSynchronize(), cudaSuccess);
  EXPECT_EQ(ptx::findings.races, 1);
}

TEST_F(Planted, HostThatDoesNotWait) {
  host[0] = 1;
  planted::write(row, 2);
  EXPECT_EQ(cudaMemcpyAsync(host, row, sizeof(int), cudaMemcpyDeviceToHost, nullptr), cudaSuccess);
  EXPECT_EQ(host[0], 1);
  EXPECT_EQ(cudaDeviceSynchronize(), cudaSuccess);
  EXPECT_EQ(host[0], 2);
}

TEST_F(Planted, HostThatReadsTheDevicesMemory) {
  planted::write(row, 2);
  EXPECT_EQ(cudaDeviceSynchronize(), cudaSuccess);
  EXPECT_DEATH(
      {
        volatile int value = *row;
        static_cast<void>(value);
      },
      "");
}

TEST_F(Planted, CapturesRefuseWhatADriverRefuses) {
  cudaStream_t stream = nullptr;
  cudaGraph_t graph = nullptr;
  cudaGraphExec_t exec = nullptr;
  ASSERT_EQ(cudaStreamCreate(&stream), cudaSuccess);
  ASSERT_EQ(cudaStreamBeginCapture(stream, cudaStreamCaptureModeThreadLocal), cudaSuccess);
  EXPECT_EQ(cudaMemcpyAsync(row, host, sizeof(int), cudaMemcpyHostToDevice, stream), cudaSuccess);
  planted::write(row, 5);  // to the default stream
  EXPECT_EQ(cudaGetLastError(), cudaErrorStreamCaptureImplicit);
  EXPECT_EQ(cudaDeviceSynchronize(), cudaErrorStreamCaptureUnsupported);
  void* memory = nullptr;
  EXPECT_EQ(cudaMalloc(&memory, 8), cudaErrorStreamCaptureUnsupported);
  ASSERT_EQ(cudaStreamEndCapture(stream, &graph), cudaSuccess);
  ASSERT_EQ(cudaGraphInstantiate(&exec, graph, 0), cudaSuccess);
  for (const int value : {7, 8}) {  // what is copied is what is there when the graph runs
    host[0] = value;
    ASSERT_EQ(cudaGraphLaunch(exec, stream), cudaSuccess);
    ASSERT_EQ(cudaMemcpyAsync(host + 1, row, sizeof(int), cudaMemcpyDeviceToHost, stream), cudaSuccess);
    ASSERT_EQ(cudaStreamSynchronize(stream), cudaSuccess);
    EXPECT_EQ(host[1], value);
  }
  cudaGraphExecDestroy(exec);
  cudaGraphDestroy(graph);
  cudaStreamDestroy(stream);
}

TEST(PtxNumbers, AreTheHosts) {
  std::mt19937_64 random(3);
  std::vector<planted::Numbers> numbers(1000);
  std::uniform_real_distribution<double> real(-1e6, 1e6);
  for (auto& n : numbers) {
    const int shift = static_cast<int>(random() % 60);
    n = {static_cast<std::int64_t>(random()) >> shift,
         static_cast<std::int64_t>(random() | 1) >> (random() % 30),
         static_cast<std::uint32_t>(random()),
         static_cast<std::uint32_t>(random()),
         real(random),
         real(random),
         static_cast<float>(real(random))};
  }
  const auto results = planted::on_device(numbers);
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    planted::Results host = planted::on_host(numbers[k]), device = results[k];
    EXPECT_NEAR(device.power, host.power, 4e-16 * host.power);  // of other libraries
    EXPECT_NEAR(device.sine, host.sine, 4e-16);
    device.power = host.power;
    device.sine = host.sine;
    EXPECT_EQ(device, host) << "case " << k;
  }
}

TEST(PtxNumbers, ThrustSortsAndSums) {
  std::mt19937_64 random(4);
  for (const int n : {100, 60'000}) {
    std::vector<std::int64_t> keys(static_cast<std::size_t>(n));
    for (auto& key : keys) key = static_cast<std::int64_t>(random()) >> 20;
    auto expected = keys;
    std::sort(expected.begin(), expected.end());
    EXPECT_EQ(planted::sorted(keys), expected);
    std::vector<int> terms(static_cast<std::size_t>(n)), sums(terms.size());
    for (auto& term : terms) term = static_cast<int>(random() % 100) - 30;
    std::partial_sum(terms.begin(), terms.end(), sums.begin());
    EXPECT_EQ(planted::running_sums(terms), sums);
  }
}

}  // namespace
