#pragma once
// The order in which the kernels of a step run. On CUDA they go into a stream of the simulation's own, without waiting
// for anything; many steps of the same kernels are captured once as a graph and started again and again, and so is a
// short window as long as it queues the same. On processors everything is done at once by the same calls, and what is
// repeated are the same noted calls again, so that what a graph may rely on (addresses, numbers of rows) is tested
// there.
//
// The stream is of the kind that waits for the default stream and for which the default stream waits: list builds,
// which Thrust does there, need no events.
#include <algorithm>
#include <functional>

#include "dem/core/backend.hpp"
#include "dem/core/launch_notes.hpp"

namespace dem::TRACKBED_DEM_SYSTEM {

/// Largest of non-negative numbers, whatever their order: their bits rise as they do.
using NumberBits = unsigned long long;
TRACKBED_HD inline NumberBits bits_of(double number) {
  NumberBits bits;
  memcpy(&bits, &number, sizeof bits);
  return bits;
}
TRACKBED_HD inline double number_of(NumberBits bits) {
  double number;
  memcpy(&number, &bits, sizeof number);
  return number;
}

/// Steps up to this number are not worth a graph of their own.
constexpr int steps_without_graph = 4;
/// Threads that share one sum, each with every so many-th term.
constexpr int sum_threads = 256;
/// Indices that follow each other and note their sums down together: a warp.
constexpr int group_size = 32;
constexpr int groups_of(int n) { return (n + group_size - 1) / group_size; }

#if defined(TRACKBED_DEM_CUDA)

template <class Functor>
__global__ void __launch_bounds__(kernel_threads)
    largest_kernel(int n, const __grid_constant__ Functor functor, NumberBits* largest) {
  const int index = static_cast<int>(blockIdx.x * kernel_threads + threadIdx.x);
  NumberBits bits = index < n ? bits_of(functor(index)) : 0;
  for (int lane = 16; lane > 0; lane /= 2) {
    const NumberBits other = __shfl_xor_sync(0xffffffffu, bits, lane);
    bits = bits > other ? bits : other;
  }
  // Most warps find that a larger number is there already.
  if (threadIdx.x % 32 == 0 && bits > *static_cast<volatile NumberBits*>(largest)) atomicMax(largest, bits);
}

template <int N, class Functor>
__global__ void __launch_bounds__(sum_threads) sum_kernel(int n, const __grid_constant__ Functor functor) {
  __shared__ double partial[sum_threads][N];
  const int result = static_cast<int>(blockIdx.x), thread = static_cast<int>(threadIdx.x);
  if (functor.skip(result)) return;
  Sums<N> sums;
  for (int index = thread; index < n; index += sum_threads) functor(result, index, sums);
  for (int k = 0; k < N; ++k) partial[thread][k] = sums.value[k];
  for (int half = sum_threads / 2; half > 0; half /= 2) {
    __syncthreads();
    if (thread < half)
      for (int k = 0; k < N; ++k) partial[thread][k] += partial[thread + half][k];
  }
  for (int k = 0; k < N && thread == 0; ++k) sums.value[k] = partial[0][k];
  if (thread == 0) functor.finish(result, sums);
}

template <int N, class Functor>
__global__ void __launch_bounds__(kernel_threads) group_kernel(int n, const __grid_constant__ Functor functor) {
  if (functor.idle()) return;  // all threads or none
  const int index = static_cast<int>(blockIdx.x * kernel_threads + threadIdx.x);
  Sums<N> sums;
  if (index < n) functor(index, sums);
  for (int half = group_size / 2; half > 0; half /= 2)
    for (int k = 0; k < N; ++k) sums.value[k] += __shfl_down_sync(0xffffffffu, sums.value[k], half);
  if (threadIdx.x % group_size == 0 && index < n) functor.book(index / group_size, sums);
}

/// Memory of the host that the device reads and writes without a detour.
template <class T>
class HostRows {
 public:
  HostRows() = default;
  ~HostRows() { cudaFreeHost(rows_); }
  HostRows(const HostRows&) = delete;
  HostRows& operator=(const HostRows&) = delete;
  /// What was there may be lost.
  T* make(std::size_t size) {
    if (size > room_) {
      cudaFreeHost(rows_);
      rows_ = nullptr;
      room_ = 0;
      require_device(cudaMallocHost(&rows_, size * sizeof(T)), "memory of the host");
      room_ = size;
    }
    return rows_;
  }
  T* data() const { return rows_; }
  std::size_t size() const { return room_; }

 private:
  T* rows_ = nullptr;
  std::size_t room_ = 0;
};

/// When what was queued up to some point is done, for any thread.
class Arrival {
 public:
  Arrival() = default;
  ~Arrival() {
    if (event_) cudaEventDestroy(event_);
  }
  Arrival(const Arrival&) = delete;
  Arrival& operator=(const Arrival&) = delete;
  void note(cudaStream_t stream) {
    if (!event_) {
      require_device(cudaGetDevice(&device_), "the device");
      require_device(cudaEventCreateWithFlags(&event_, cudaEventDisableTiming | cudaEventBlockingSync), "an event");
    }
    require_device(cudaEventRecord(event_, stream), "an event");
  }
  void wait() {
    if (!event_) return;
    require_device(cudaSetDevice(device_), "the device");  // another thread knows of none
    require_device(cudaEventSynchronize(event_), "a copy");
  }

 private:
  cudaEvent_t event_ = nullptr;
  int device_ = 0;
};

class Queue {
 public:
  Queue() {
    require_device(cudaStreamCreate(&stream_), "a stream");
    require_device(cudaStreamCreate(&side_), "a stream");
    for (cudaEvent_t* event : {&forked_, &joined_})
      require_device(cudaEventCreateWithFlags(event, cudaEventDisableTiming), "an event");
  }
  ~Queue() {
    cudaStreamSynchronize(stream_);
    for (const cudaGraphExec_t graph : {steps_, window_})
      if (graph) cudaGraphExecDestroy(graph);
    cudaEventDestroy(forked_);
    cudaEventDestroy(joined_);
    cudaStreamDestroy(side_);
    cudaStreamDestroy(stream_);
  }
  Queue(const Queue&) = delete;
  Queue& operator=(const Queue&) = delete;

  /// functor(index) for 0 … n-1.
  template <class Functor>
  void launch(int n, const Functor& functor) {
    if (n > 0 && !notes_.takes(&mark_of<Functor>, n, functor)) launch_on(on_side_ ? side_ : stream_, n, functor);
  }
  /// *largest = the larger of itself and all functor(index), which are not negative.
  template <class Functor>
  void launch_largest(int n, const Functor& functor, NumberBits* largest) {
    if (n <= 0 || notes_.takes(&mark_of<Functor>, n, functor, largest)) return;
    largest_kernel<<<blocks_of(n), kernel_threads, 0, stream_>>>(n, functor, largest);
    require_device(cudaGetLastError(), "a kernel");
  }
  /// For every result: functor(result, index, sums) over all indices, in an order that depends on n alone, then
  /// functor.finish(result, sums); nothing where functor.skip(result).
  template <int N, class Functor>
  void launch_sums(int results, int n, const Functor& functor) {
    if (results <= 0 || notes_.takes(&mark_of<Functor>, results, n, functor)) return;
    sum_kernel<N><<<static_cast<unsigned>(results), sum_threads, 0, stream_>>>(n, functor);
    require_device(cudaGetLastError(), "a kernel");
  }
  /// functor(index, sums) for 0 … n-1, then functor.book(group, sums of the group), in an order that depends on n
  /// alone; nothing where functor.idle().
  template <int N, class Functor>
  void launch_groups(int n, const Functor& functor) {
    if (n <= 0 || notes_.takes(&mark_of<Functor>, n, functor)) return;
    group_kernel<N><<<blocks_of(n), kernel_threads, 0, on_side_ ? side_ : stream_>>>(n, functor);
    require_device(cudaGetLastError(), "a kernel");
  }
  /// What the two launch may run at the same time.
  template <class First, class Second>
  void side_by_side(const First& first, const Second& second) {
    if (notes_.takes(&mark_of<Queue>)) {
      second();
      return first();
    }
    require_device(cudaEventRecord(forked_, stream_), "an event");
    require_device(cudaStreamWaitEvent(side_, forked_), "an event");
    on_side_ = true;
    second();
    on_side_ = false;
    first();
    require_device(cudaEventRecord(joined_, side_), "an event");
    require_device(cudaStreamWaitEvent(stream_, joined_), "an event");
  }

  /// step() `times` times. What it launches, and with what, must be the same every time.
  template <class Step>
  void repeat(int times, const Step& step) {
    if (times <= steps_without_graph) {
      for (int k = 0; k < times; ++k) step();
      return;
    }
    capture(step, steps_);
    for (int k = 0; k < times; ++k) require_device(cudaGraphLaunch(steps_, stream_), "a graph");
  }
  /// queue_all(), which queues few steps with what goes before and after them. What it queues twice in a row becomes a
  /// graph, which is started as long as it would queue the same: same kernels, rows, numbers and copies. It is called
  /// up to twice, and does nothing else that matters.
  template <class All>
  void window(const All& queue_all) {
    if (!notes_.same_again(queue_all)) {
      window_is_graph_ = false;
      return queue_all();
    }
    if (!window_is_graph_) capture(queue_all, window_);
    window_is_graph_ = true;
    require_device(cudaGraphLaunch(window_, stream_), "a graph");
  }

  template <class T>
  void send(const T* host, T* device, std::size_t n) {
    copy(host, device, n, cudaMemcpyHostToDevice);
  }
  template <class T>
  void fetch(const T* device, T* host, std::size_t n) {
    copy(device, host, n, cudaMemcpyDeviceToHost);
  }
  void wait() { require_device(cudaStreamSynchronize(stream_), "a step"); }
  void note(Arrival& arrival) { arrival.note(stream_); }

 private:
  cudaStream_t stream_ = nullptr, side_ = nullptr;
  cudaEvent_t forked_ = nullptr, joined_ = nullptr;
  cudaGraphExec_t steps_ = nullptr, window_ = nullptr;
  bool on_side_ = false, window_is_graph_ = false;
  LaunchNotes notes_;

  template <class T>
  void copy(const T* from, T* to, std::size_t n, cudaMemcpyKind kind) {
    if (n == 0 || notes_.takes(&mark_of<T>, from, to, n)) return;
    require_device(cudaMemcpyAsync(to, from, n * sizeof(T), kind, stream_), "a copy");
  }
  /// A graph of the same form takes new addresses and numbers without being made anew.
  template <class Step>
  void capture(const Step& step, cudaGraphExec_t& graph_to_start) {
    require_device(cudaStreamBeginCapture(stream_, cudaStreamCaptureModeThreadLocal), "a capture");
    cudaGraph_t graph = nullptr;
    try {
      step();
    } catch (...) {
      cudaStreamEndCapture(stream_, &graph);
      if (graph) cudaGraphDestroy(graph);
      throw;
    }
    require_device(cudaStreamEndCapture(stream_, &graph), "a capture");
    cudaGraphExecUpdateResultInfo how{};
    if (graph_to_start && cudaGraphExecUpdate(graph_to_start, graph, &how) != cudaSuccess) {
      cudaGetLastError();  // the graph has another form
      cudaGraphExecDestroy(graph_to_start);
      graph_to_start = nullptr;
    }
    const cudaError_t made = graph_to_start ? cudaSuccess : cudaGraphInstantiate(&graph_to_start, graph, 0);
    cudaGraphDestroy(graph);
    require_device(made, "a graph");
  }
};

#else

template <int N, class Functor>
struct NoteGroup {
  Functor functor;
  int n;
  void operator()(int group) const {
    if (functor.idle()) return;
    Sums<N> sums[group_size];
    const int first = group * group_size, count = std::min(group_size, n - first);
    for (int k = 0; k < count; ++k) functor(first + k, sums[k]);
    for (int half = group_size / 2; half > 0; half /= 2)
      for (int thread = 0; thread < half; ++thread)
        for (int k = 0; k < N; ++k) sums[thread].value[k] += sums[thread + half].value[k];
    functor.book(group, sums[0]);
  }
};

template <class T>
class HostRows {
 public:
  T* make(std::size_t size) {
    if (size > rows_.size()) rows_.resize(size);
    return rows_.data();
  }
  T* data() { return rows_.data(); }
  const T* data() const { return rows_.data(); }
  std::size_t size() const { return rows_.size(); }

 private:
  std::vector<T> rows_;
};

struct Arrival {
  void wait() {}
};

class Queue {
 public:
  Queue() = default;
  Queue(const Queue&) = delete;
  Queue& operator=(const Queue&) = delete;

  template <class Functor>
  void launch(int n, const Functor& functor) {
    if (n <= 0 || notes_.takes(&mark_of<Functor>, n, functor)) return;
    now_or_later([n, functor] { dem::TRACKBED_DEM_SYSTEM::launch(n, functor); });
  }
  template <class Functor>
  void launch_largest(int n, const Functor& functor, NumberBits* largest) {
    if (n <= 0 || notes_.takes(&mark_of<Functor>, n, functor, largest)) return;
    now_or_later([n, functor, largest] {
      const double found = reduce(n, functor, 0.0, thrust::maximum<double>());
      if (bits_of(found) > *largest) *largest = bits_of(found);
    });
  }
  template <int N, class Functor>
  void launch_sums(int results, int n, const Functor& functor) {
    if (results <= 0 || notes_.takes(&mark_of<Functor>, results, n, functor)) return;
    now_or_later([results, n, functor] {
      for (int result = 0; result < results; ++result) {
        if (functor.skip(result)) continue;
        Sums<N> partial[sum_threads];
        for (int index = 0; index < n; ++index) functor(result, index, partial[index % sum_threads]);
        for (int half = sum_threads / 2; half > 0; half /= 2)
          for (int thread = 0; thread < half; ++thread)
            for (int k = 0; k < N; ++k) partial[thread].value[k] += partial[thread + half].value[k];
        functor.finish(result, partial[0]);
      }
    });
  }
  template <int N, class Functor>
  void launch_groups(int n, const Functor& functor) {
    launch(groups_of(n), NoteGroup<N, Functor>{functor, n});
  }
  template <class First, class Second>
  void side_by_side(const First& first, const Second& second) {
    first();
    second();
  }

  template <class Step>
  void repeat(int times, const Step& step) {
    if (times <= steps_without_graph) {
      for (int k = 0; k < times; ++k) step();
      return;
    }
    keep_calls(step, step_calls_);
    for (int k = 0; k < times; ++k)
      for (const auto& call : step_calls_) call();
  }
  template <class All>
  void window(const All& queue_all) {
    if (!notes_.same_again(queue_all)) {
      window_calls_.clear();
      return queue_all();
    }
    if (window_calls_.empty()) keep_calls(queue_all, window_calls_);
    for (const auto& call : window_calls_) call();
  }

  template <class T>
  void send(const T* host, T* device, std::size_t n) {
    if (n == 0 || notes_.takes(&mark_of<T>, host, device, n)) return;
    now_or_later([=] { std::copy_n(host, n, device); });
  }
  template <class T>
  void fetch(const T* device, T* host, std::size_t n) {
    send(device, host, n);
  }
  void wait() {}
  void note(Arrival&) {}

 private:
  using Calls = std::vector<std::function<void()>>;
  Calls step_calls_, window_calls_;
  Calls* kept_ = nullptr;  // calls go there instead of being done
  LaunchNotes notes_;

  template <class Step>
  void keep_calls(const Step& step, Calls& calls) {
    calls.clear();
    kept_ = &calls;
    step();
    kept_ = nullptr;
  }
  template <class Call>
  void now_or_later(const Call& call) {
    if (kept_)
      kept_->push_back(call);
    else
      call();
  }
};

#endif

}  // namespace dem::TRACKBED_DEM_SYSTEM
