#pragma once
// Kernels that do one thing wrong each, and some that do it right (planted.cu).
#include <cstdint>
#include <vector>

namespace planted {

/// Each starts one kernel on the default stream, and does not wait.
void write_past_the_end(int* row, int n);
void read(const int* from, int* to, int n);
void read_across_words(const int* row, int* to);
void shuffle_with_half_a_warp(int* to);
void exchange_without_barrier(int* to, int n);
void exchange_with_barrier(int* to, int n);
void all_write_one(int* to, int blocks);
void write(int* to, int value);

struct Numbers {
  std::int64_t a, b;
  std::uint32_t u, v;
  double x, y;
  float f;
};
struct Results {
  std::int64_t high, quotient, remainder, shifted, from_double;
  std::uint64_t unsigned_high, unsigned_quotient;
  std::uint32_t leading, ones, reversed;
  std::int32_t from_float, down, nearest;
  double fused, root, ratio, least, power, sine;
  float narrow;
  bool operator==(const Results&) const = default;
};
/// The same source for the device and the host.
std::vector<Results> on_device(const std::vector<Numbers>& numbers);
Results on_host(const Numbers& numbers);

/// Thrust on the device.
std::vector<std::int64_t> sorted(const std::vector<std::int64_t>& keys);
std::vector<int> running_sums(const std::vector<int>& terms);

}  // namespace planted
