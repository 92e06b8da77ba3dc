// The pretended device computes what the host computes, and finds what is wrong with a kernel or with its host.
#include "tests/ptx/planted.hpp"

#include <cuda_runtime_api.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <thread>

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

/// Two streams, an event of each kind.
class Streams : public Planted {
 protected:
  void SetUp() override {
    Planted::SetUp();
    ASSERT_EQ(cudaStreamCreate(&one), cudaSuccess);
    ASSERT_EQ(cudaStreamCreate(&other_one), cudaSuccess);
    for (cudaEvent_t* event : {&forked, &joined}) ASSERT_EQ(cudaEventCreateWithFlags(event, 0), cudaSuccess);
    host[0] = 1;
    host[1] = 2;
  }
  void TearDown() override {
    for (const cudaEvent_t event : {forked, joined}) cudaEventDestroy(event);
    for (const cudaStream_t stream : {one, other_one}) cudaStreamDestroy(stream);
    Planted::TearDown();
  }
  void send(cudaStream_t stream) const {
    ASSERT_EQ(cudaMemcpyAsync(row, host, sizeof(int), cudaMemcpyHostToDevice, stream), cudaSuccess);
  }
  void fetch(cudaStream_t stream) const {
    ASSERT_EQ(cudaMemcpyAsync(host + 1, row, sizeof(int), cudaMemcpyDeviceToHost, stream), cudaSuccess);
  }
  cudaStream_t one = nullptr, other_one = nullptr;
  cudaEvent_t forked = nullptr, joined = nullptr;
};

TEST_F(Streams, WaitingForAnotherStreamIsNotEnough) {
  send(one);
  fetch(one);
  EXPECT_EQ(cudaStreamSynchronize(other_one), cudaSuccess);
  EXPECT_EQ(host[1], 2);
  EXPECT_EQ(cudaStreamSynchronize(one), cudaSuccess);
  EXPECT_EQ(host[1], 1);
}

TEST_F(Streams, AnEventHasWhatWasQueuedBeforeIt) {
  send(one);
  EXPECT_EQ(cudaEventRecord(forked, one), cudaSuccess);
  fetch(one);
  EXPECT_EQ(cudaEventRecord(joined, one), cudaSuccess);
  EXPECT_EQ(cudaEventSynchronize(forked), cudaSuccess);
  EXPECT_EQ(host[1], 2);
  EXPECT_EQ(cudaEventSynchronize(joined), cudaSuccess);
  EXPECT_EQ(host[1], 1);
}

TEST_F(Streams, OneWaitsForTheOtherWhereItIsTold) {
  send(one);
  EXPECT_EQ(cudaEventRecord(forked, one), cudaSuccess);
  EXPECT_EQ(cudaStreamWaitEvent(other_one, forked, 0), cudaSuccess);
  fetch(other_one);
  EXPECT_EQ(cudaStreamSynchronize(other_one), cudaSuccess);
  EXPECT_EQ(host[1], 1);
}

TEST_F(Streams, TheDefaultStreamWaitsForAll) {
  send(one);
  planted::write(other, 4);
  planted::read(row, other, 1);
  ASSERT_EQ(cudaMemcpyAsync(host + 1, other, sizeof(int), cudaMemcpyDeviceToHost, other_one), cudaSuccess);
  EXPECT_EQ(cudaStreamSynchronize(other_one), cudaSuccess);
  EXPECT_EQ(host[1], 1);
}

TEST_F(Streams, ACaptureHasItsSideStreamJoined) {
  cudaGraph_t graph = nullptr;
  for (const bool joins : {false, true}) {
    ASSERT_EQ(cudaStreamBeginCapture(one, cudaStreamCaptureModeThreadLocal), cudaSuccess);
    ASSERT_EQ(cudaEventRecord(forked, one), cudaSuccess);
    ASSERT_EQ(cudaStreamWaitEvent(other_one, forked, 0), cudaSuccess);
    send(other_one);
    ASSERT_EQ(cudaEventRecord(joined, other_one), cudaSuccess);
    if (joins) {
      ASSERT_EQ(cudaStreamWaitEvent(one, joined, 0), cudaSuccess);
    }
    EXPECT_EQ(cudaStreamEndCapture(one, &graph), joins ? cudaSuccess : cudaErrorStreamCaptureUnjoined);
    cudaGraphDestroy(graph);
  }
}

TEST_F(Streams, AnotherThreadMayWaitDuringACapture) {
  fetch(nullptr);
  ASSERT_EQ(cudaEventRecord(joined, nullptr), cudaSuccess);
  ASSERT_EQ(cudaStreamBeginCapture(one, cudaStreamCaptureModeThreadLocal), cudaSuccess);
  cudaError_t there = cudaErrorUnknown;
  std::thread([&] { there = cudaEventSynchronize(joined); }).join();
  EXPECT_EQ(there, cudaSuccess);
  EXPECT_EQ(cudaGetLastError(), cudaSuccess);
  cudaGraph_t graph = nullptr;
  EXPECT_EQ(cudaStreamEndCapture(one, &graph), cudaSuccess);
  cudaGraphDestroy(graph);
}

TEST_F(Planted, CopiesGoWhereTheySay) {
  EXPECT_EQ(cudaMemcpyAsync(host, row, sizeof(int), cudaMemcpyDeviceToDevice, nullptr), cudaErrorInvalidValue);
  EXPECT_EQ(cudaMemcpyAsync(host, row, sizeof(int), cudaMemcpyHostToDevice, nullptr), cudaErrorInvalidValue);
  EXPECT_EQ(cudaFree(row + 1), cudaErrorInvalidValue);
}

TEST_F(Planted, CopiesOfWhatWasNeverWrittenAreNotWritten) {
  EXPECT_EQ(cudaMemcpyAsync(other, row, 8 * sizeof(int), cudaMemcpyDeviceToDevice, nullptr), cudaSuccess);
  planted::read(other, row, 1);
  EXPECT_EQ(cudaDeviceSynchronize(), cudaSuccess);
  EXPECT_EQ(ptx::findings.unwritten, 1);
}

/// PTX ISA 9.0, cvt: out of range to the nearest number of the type; no number to 0 of 32 bits from a float, else to
/// the least of a signed type.
TEST(PtxNumbers, OutOfRange) {
  const double inf = HUGE_VAL, nan = std::nan("");
  std::vector<planted::Numbers> numbers{
      {1, 1, 1, 1, nan, 1.0, std::nanf("")}, {1, 1, 1, 1, inf, 1.0, HUGE_VALF}, {1, 1, 1, 1, -inf, 1.0, -HUGE_VALF}};
  const auto results = planted::on_device(numbers);
  EXPECT_EQ(results[0].nearest, INT32_MIN);  // from a double
  EXPECT_EQ(results[0].from_float, 0);
  EXPECT_EQ(results[0].from_double, INT64_MIN);
  EXPECT_EQ(results[0].least, 1.0);
  EXPECT_EQ(results[1].nearest, INT32_MAX);
  EXPECT_EQ(results[1].from_float, INT32_MAX);
  EXPECT_EQ(results[1].from_double, INT64_MAX);
  EXPECT_EQ(results[2].down, INT32_MIN);
  EXPECT_EQ(results[2].from_double, INT64_MIN);
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
