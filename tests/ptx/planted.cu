#include <thrust/device_vector.h>
#include <thrust/scan.h>
#include <thrust/sort.h>

#include <cmath>

#include "tests/ptx/planted.hpp"

namespace planted {
namespace {

__global__ void past_the_end(int* row, int n) {
  if (static_cast<int>(threadIdx.x) <= n) row[threadIdx.x] = 1;
}
__global__ void copy(const int* from, int* to, int n) {
  if (static_cast<int>(threadIdx.x) < n) to[threadIdx.x] = from[threadIdx.x];
}
__global__ void across_words(const int* row, int* to) {
  *to = *reinterpret_cast<const int*>(reinterpret_cast<const char*>(row) + 2);
}
__global__ void half_a_warp(int* to) {
  if (threadIdx.x < 16) to[threadIdx.x] = __shfl_down_sync(0xffffffffu, static_cast<int>(threadIdx.x), 1);
}
template <bool waits>
__global__ void exchange(int* to, int n) {
  __shared__ int row[256];
  const int me = static_cast<int>(threadIdx.x);
  row[me] = 2 * me;
  if (waits) __syncthreads();
  to[me] = row[n - 1 - me];
}
__global__ void one_word(int* to) { *to = static_cast<int>(blockIdx.x); }
__global__ void set(int* to, int value) { *to = value; }

// What the host's compiler has other names for.
__host__ __device__ int leading_zeros(std::uint32_t a) {
#if defined(__CUDA_ARCH__)
  return __clz(static_cast<int>(a));
#else
  return a ? __builtin_clz(a) : 32;
#endif
}
__host__ __device__ int ones_of(std::uint32_t a) {
#if defined(__CUDA_ARCH__)
  return __popc(a);
#else
  return __builtin_popcount(a);
#endif
}
__host__ __device__ std::uint32_t reversed(std::uint32_t a) {
#if defined(__CUDA_ARCH__)
  return __brev(a);
#else
  std::uint32_t turned = 0;
  for (int k = 0; k < 32; ++k) turned |= (a >> k & 1) << (31 - k);
  return turned;
#endif
}
__host__ __device__ std::uint64_t high_half(std::uint64_t a, std::uint64_t b) {
#if defined(__CUDA_ARCH__)
  return __umul64hi(a, b);
#else
  return static_cast<std::uint64_t>(static_cast<unsigned __int128>(a) * b >> 64);
#endif
}
__host__ __device__ std::int64_t high_half(std::int64_t a, std::int64_t b) {
#if defined(__CUDA_ARCH__)
  return __mul64hi(a, b);
#else
  return static_cast<std::int64_t>(static_cast<__int128>(a) * b >> 64);
#endif
}

__host__ __device__ Results compute(const Numbers& n) {
  Results r{};
  const auto a = static_cast<std::uint64_t>(n.a), b = static_cast<std::uint64_t>(n.b);
  r.high = high_half(n.a, n.b);
  r.quotient = n.a / n.b;
  r.remainder = n.a % n.b;
  r.shifted = n.a >> (n.u & 63);
  r.from_double = static_cast<std::int64_t>(n.x);
  r.unsigned_high = high_half(a, b);
  r.unsigned_quotient = a / b;
  r.leading = static_cast<std::uint32_t>(leading_zeros(n.u >> (n.v & 31)));
  r.ones = static_cast<std::uint32_t>(ones_of(n.u));
  r.reversed = reversed(n.u);
  r.from_float = static_cast<std::int32_t>(n.f);
  r.down = static_cast<std::int32_t>(std::floor(n.f));
  r.nearest = static_cast<std::int32_t>(std::rint(n.x));
  r.fused = std::fma(n.x, n.y, 1.0);
  r.root = std::sqrt(n.x * n.x);
  r.ratio = n.x / n.y;
  r.least = std::fmin(n.x, n.y);
  r.narrow = static_cast<float>(n.x);
  return r;
}
__global__ void compute_all(const Numbers* numbers, Results* results, int n) {
  const int k = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
  if (k >= n) return;
  results[k] = compute(numbers[k]);
  results[k].power = std::pow(std::fabs(numbers[k].x), 0.3);
  results[k].sine = std::sin(numbers[k].x);
}

}  // namespace

void write_past_the_end(int* row, int n) { past_the_end<<<1, 64>>>(row, n); }
void read(const int* from, int* to, int n) { copy<<<1, 64>>>(from, to, n); }
void read_across_words(const int* row, int* to) { across_words<<<1, 1>>>(row, to); }
void shuffle_with_half_a_warp(int* to) { half_a_warp<<<1, 32>>>(to); }
void exchange_without_barrier(int* to, int n) { exchange<false><<<1, n>>>(to, n); }
void exchange_with_barrier(int* to, int n) { exchange<true><<<1, n>>>(to, n); }
void all_write_one(int* to, int blocks) { one_word<<<blocks, 1>>>(to); }
void write(int* to, int value) { set<<<1, 1>>>(to, value); }

std::vector<Results> on_device(const std::vector<Numbers>& numbers) {
  const thrust::device_vector<Numbers> from(numbers.begin(), numbers.end());
  thrust::device_vector<Results> to(numbers.size());
  const int n = static_cast<int>(numbers.size());
  compute_all<<<(n + 95) / 96, 96>>>(thrust::raw_pointer_cast(from.data()), thrust::raw_pointer_cast(to.data()), n);
  std::vector<Results> results(numbers.size());
  thrust::copy(to.begin(), to.end(), results.begin());
  return results;
}
Results on_host(const Numbers& numbers) {
  Results r = compute(numbers);
  r.power = std::pow(std::fabs(numbers.x), 0.3);
  r.sine = std::sin(numbers.x);
  return r;
}

std::vector<std::int64_t> sorted(const std::vector<std::int64_t>& keys) {
  thrust::device_vector<std::int64_t> row(keys.begin(), keys.end());
  thrust::device_vector<int> places(keys.size());
  thrust::sequence(places.begin(), places.end());
  thrust::stable_sort_by_key(row.begin(), row.end(), places.begin());
  std::vector<std::int64_t> result(keys.size());
  thrust::copy(row.begin(), row.end(), result.begin());
  return result;
}
std::vector<int> running_sums(const std::vector<int>& terms) {
  thrust::device_vector<int> row(terms.begin(), terms.end());
  thrust::inclusive_scan(row.begin(), row.end(), row.begin());
  std::vector<int> result(terms.size());
  thrust::copy(row.begin(), row.end(), result.begin());
  return result;
}

}  // namespace planted
