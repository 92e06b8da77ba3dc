#pragma once
// The one place that knows which Thrust system runs the loops. Everything in dem/core is compiled once per system (by
// backend_omp.cpp and backend_cuda.cu), each time in the system's own namespace, so that the two halves of the program
// share no symbol. The namespace name is a macro for that reason alone.
#if defined(TRACKBED_DEM_CUDA)
#include <thrust/mr/allocator.h>
#include <thrust/system/cuda/execution_policy.h>
#include <thrust/system/cuda/vector.h>
#define TRACKBED_DEM_SYSTEM cuda_system
#else
#include <omp.h>
#include <thrust/system/omp/execution_policy.h>

#include <new>
#define TRACKBED_DEM_SYSTEM omp_system
#endif

#include <thrust/binary_search.h>
#include <thrust/copy.h>
#include <thrust/for_each.h>
#include <thrust/functional.h>
#include <thrust/iterator/counting_iterator.h>
#include <thrust/scan.h>
#include <thrust/sequence.h>
#include <thrust/sort.h>
#include <thrust/transform_reduce.h>

#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "base/vec3.hpp"

/// Inlines everything a functor calls: g++ would leave the contact law a call, at the price of a third of its speed.
#if defined(__CUDACC__)
#define TRACKBED_FLATTEN
#else
#define TRACKBED_FLATTEN __attribute__((flatten))
#endif

namespace dem::TRACKBED_DEM_SYSTEM {

using base::Vec3;
using base::Vector3;

#if defined(TRACKBED_DEM_CUDA)
inline void require_device(cudaError_t error, const char* what) {
  if (error == cudaSuccess) return;
  cudaGetLastError();  // an error that has been told must not be found by a later call
  throw base::MachineError(std::string("the GPU failed (") + what + "): " + cudaGetErrorString(error));
}

/// Device memory from the driver's pool: what lists give back when they are made anew is at hand for the next ones.
class PooledMemory final : public thrust::mr::memory_resource<thrust::cuda::pointer<void>> {
 public:
  pointer do_allocate(std::size_t bytes, std::size_t) override {
    void* memory = nullptr;
    require_device(pools() ? cudaMallocAsync(&memory, bytes, nullptr) : cudaMalloc(&memory, bytes), "memory");
    return pointer(memory);
  }
  void do_deallocate(pointer memory, std::size_t, std::size_t) noexcept override {
    pools() ? cudaFreeAsync(memory.get(), nullptr) : cudaFree(memory.get());
  }

 private:
  /// Devices without pools are rare (some virtual ones).
  static bool pools() {
    static const bool has = [] {
      int device = 0, supported = 0;
      cudaMemPool_t pool = nullptr;
      std::uint64_t kept = UINT64_MAX;
      return cudaGetDevice(&device) == cudaSuccess &&
             cudaDeviceGetAttribute(&supported, cudaDevAttrMemoryPoolsSupported, device) == cudaSuccess && supported &&
             cudaDeviceGetDefaultMemPool(&pool, device) == cudaSuccess &&
             cudaMemPoolSetAttribute(pool, cudaMemPoolAttrReleaseThreshold, &kept) == cudaSuccess;
    }();
    return has;
  }
};
template <class T>
using Pooled = thrust::mr::stateless_resource_allocator<T, PooledMemory>;
template <class T>
using Vector = thrust::cuda::vector<T, Pooled<T>>;
inline auto policy() {
  static Pooled<char> temporaries;
  return thrust::cuda::par_nosync(temporaries);
}
struct ThreadsFor {
  explicit ThreadsFor(int) {}
};
#else
/// Rows start on cache lines: malloc would put every second one across two.
template <class T>
struct OnCacheLines {
  using value_type = T;
  OnCacheLines() = default;
  template <class U>
  OnCacheLines(const OnCacheLines<U>&) {}
  T* allocate(std::size_t n) { return static_cast<T*>(::operator new (n * sizeof(T), std::align_val_t{64})); }
  void deallocate(T* memory, std::size_t) { ::operator delete (memory, std::align_val_t{64}); }
  bool operator==(const OnCacheLines&) const = default;
};
template <class T>
using Vector = std::vector<T, OnCacheLines<T>>;
inline auto policy() { return thrust::omp::par; }
/// While it lives: one thread where a second would cost more than it brings (waking it takes longer than the loop).
class ThreadsFor {
 public:
  explicit ThreadsFor(int grains) : threads_(omp_get_max_threads()) {
    if (grains < 500) omp_set_num_threads(1);
  }
  ~ThreadsFor() { omp_set_num_threads(threads_); }
  ThreadsFor(const ThreadsFor&) = delete;
  ThreadsFor& operator=(const ThreadsFor&) = delete;

 private:
  int threads_;
};
#endif

template <class T>
T* pointer(Vector<T>& v) {
  return v.empty() ? nullptr : thrust::raw_pointer_cast(v.data());
}
template <class T>
const T* pointer(const Vector<T>& v) {
  return v.empty() ? nullptr : thrust::raw_pointer_cast(v.data());
}

template <class T>
std::vector<T> download(const Vector<T>& v) {
  std::vector<T> host(v.size());
  if (!host.empty()) thrust::copy(v.begin(), v.end(), host.begin());
  return host;
}
template <class T>
void upload(std::span<const T> host, Vector<T>& v) {
  v.resize(host.size());
  if (!host.empty()) thrust::copy(host.begin(), host.end(), v.begin());
}
template <class T>
void upload(const std::vector<T>& host, Vector<T>& v) {
  upload(std::span<const T>(host), v);
}
template <class T>
void release(Vector<T>& v) {
  Vector<T>().swap(v);
}
template <class T>
std::size_t bytes_of(const Vector<T>& v) {
  return v.capacity() * sizeof(T);
}

/// Loops up to this length run on the calling thread: starting a parallel loop takes longer than they do.
constexpr int serial_length = 256;

#if defined(TRACKBED_DEM_CUDA)
constexpr int kernel_threads = 128;  // of a block
inline unsigned blocks_of(int n) { return (static_cast<unsigned>(n) + kernel_threads - 1) / kernel_threads; }

/// (__grid_constant__: where a function is not inlined, it would otherwise be handed a copy of the functor that every
/// thread makes for itself.)
template <class Functor>
__global__ void __launch_bounds__(kernel_threads) each_kernel(int n, const __grid_constant__ Functor functor) {
  const int index = static_cast<int>(blockIdx.x * kernel_threads + threadIdx.x);
  if (index < n) functor(index);
}
template <class Functor>
void launch_on(cudaStream_t stream, int n, const Functor& functor) {
  each_kernel<<<blocks_of(n), kernel_threads, 0, stream>>>(n, functor);
  require_device(cudaGetLastError(), "a kernel");
}
#endif

/// Calls functor(index) for 0 … n-1, in any order. On CUDA in the default stream, and without waiting.
template <class Functor>
void launch(int n, Functor functor) {
#if defined(TRACKBED_DEM_CUDA)
  if (n > 0) launch_on(nullptr, n, functor);
#else
  if (n <= serial_length) {
    for (int index = 0; index < n; ++index) functor(index);
    return;
  }
  thrust::for_each_n(policy(), thrust::counting_iterator<int>(0), n, functor);
#endif
}

/// One of several shares of a reduction.
template <class T, class Functor, class Operation>
struct ReduceShare {
  Functor functor;
  Operation operation;
  T start;
  T* partial;
  int n, shares;
  TRACKBED_HD void operator()(int share) const {
    T result = start;
    for (int index = share; index < n; index += shares) result = operation(result, functor(index));
    partial[share] = result;
  }
};

/// Reduction of functor(index) with an operation that does not depend on the order (maximum, logical or, integer sum).
/// On a GPU not by Thrust, whose kernels would take in twenty copies of the functor each, nor within a step.
template <class T, class Functor, class Operation>
T reduce(int n, Functor functor, T start, Operation operation) {
  if (n <= 0) return start;
#if defined(TRACKBED_DEM_CUDA)
  const int shares = n < 4096 ? n : 4096;
  Vector<T> partial(shares);
  launch(shares, ReduceShare<T, Functor, Operation>{functor, operation, start, pointer(partial), n, shares});
  for (const T& share : download(partial)) start = operation(start, share);
  return start;
#else
  if (n <= serial_length) {
    for (int index = 0; index < n; ++index) start = operation(start, functor(index));
    return start;
  }
  const thrust::counting_iterator<int> first(0);
  return thrust::transform_reduce(policy(), first, first + n, functor, start, operation);
#endif
}

template <class T>
struct SetTo {
  T* to;
  T value;
  TRACKBED_HD void operator()(int index) const { to[index] = value; }
};
template <class T>
void clear(Vector<T>& v) {
  launch(static_cast<int>(v.size()), SetTo<T>{pointer(v), T{}});
}

template <int N>
struct Sums {
  double value[N] = {};
};

constexpr int sum_block = 256;

template <int N, class Functor>
struct SumBlock {
  Functor functor;  // void operator()(int index, Sums<N>&): adds its terms
  Sums<N>* partial;
  int n;
  TRACKBED_HD void operator()(int block) const {
    Sums<N> sums;
    const int last = (block + 1) * sum_block < n ? (block + 1) * sum_block : n;
    for (int index = block * sum_block; index < last; ++index) functor(index, sums);
    partial[block] = sums;
  }
};

/// Sums in an order that depends on n alone, so that they are the same to the last bit for any number of threads.
template <int N, class Functor>
Sums<N> ordered_sum(int n, Functor functor) {
  Sums<N> total;
  if (n <= 0) return total;
  const int blocks = (n + sum_block - 1) / sum_block;
  Vector<Sums<N>> partial(blocks);
  launch(blocks, SumBlock<N, Functor>{functor, pointer(partial), n});
  for (const auto& block : download(partial))
    for (int k = 0; k < N; ++k) total.value[k] += block.value[k];
  return total;
}

}  // namespace dem::TRACKBED_DEM_SYSTEM
