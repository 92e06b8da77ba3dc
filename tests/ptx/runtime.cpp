// The CUDA runtime's functions that the program uses, on the pretended device: a program linked with these instead of
// cudart takes it for a GPU. As lazy as a device may be: nothing queued is done before somebody waits for it, so that
// a host that does not wait is found out. Captures refuse what a driver refuses.
#include "tests/ptx/runtime.hpp"

#include <cuda_runtime_api.h>
#include <unistd.h>
#include <zstd.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <functional>
#include <mutex>
#include <new>
#include <thread>
#include <unordered_map>
#include <utility>

#include "tests/ptx/memory.hpp"
#include "tests/ptx/streams.hpp"
#include "tests/ptx/warp.hpp"

namespace {

using ptx::Position, ptx::Streams, ptx::Work;

struct Module {
  const void* data = nullptr;
  std::unique_ptr<ptx::Program> program;
};
struct Function {
  Module* module = nullptr;
  std::string name;
  const ptx::Kernel* kernel = nullptr;
  long launches = 0;
  double threads = 0;  // of all launches
  ptx::Counts counts;
};

std::recursive_mutex everything;
Streams device(true);
/// Kernels register themselves before this file's variables are made.
std::deque<Module>& modules() {
  static std::deque<Module> all;
  return all;
}
std::unordered_map<const void*, Function>& functions() {
  static std::unordered_map<const void*, Function> all;
  return all;
}
cudaError_t failed = cudaSuccess;
thread_local cudaError_t last = cudaSuccess;
struct Launch {
  dim3 grid, block;
  std::size_t shared;
  cudaStream_t stream;
};
thread_local std::vector<Launch> launches;
constexpr char copies = 0, sets = 0;  // their addresses stand for what is done

}  // namespace

bool ptx::make_whole() {
  const bool was_broken = failed != cudaSuccess;
  failed = last = cudaSuccess;
  device.clear();
  findings = {};
  return was_broken;
}

struct CUstream_st {
  int number = 0;       // of the device's streams
  int captured_as = 0;  // a capture's stream; 0: it takes part in none
};
struct CUevent_st {
  bool captured = false;
  Position position;
  std::shared_ptr<std::chrono::steady_clock::time_point> time =
      std::make_shared<std::chrono::steady_clock::time_point>();
};
struct CUgraph_st {
  std::vector<Work> work;
};
struct CUgraphExec_st {
  std::vector<Work> work;
};

namespace {

struct Capture {
  Streams streams{false};
  std::vector<Work> work;  // as it came
  std::vector<cudaStream_t> taking_part;
  std::thread::id thread;
};
std::unique_ptr<Capture> capture;
bool this_thread_captures() { return capture && capture->thread == std::this_thread::get_id(); }

struct Locked {
  std::lock_guard<std::recursive_mutex> lock{everything};
};

cudaError_t done(cudaError_t error) {
  if (error != cudaSuccess) last = error;
  return error;
}

/// Blocks from the last to the first, and of what may run at the same time the other first.
bool backwards() {
  static const bool set = ptx::switched_on("PTX_BACKWARDS");
  return set;
}

/// At the end: what a user would not see otherwise.
struct Account {
  ~Account() {
    if (ptx::counts) {
      std::fprintf(stderr,
                   "ptx: launches, threads of one; of a warp: instructions, of them in double; of a thread: bytes "
                   "asked for, read, written\n");
      for (const auto& [host, f] : functions())
        if (f.launches) {
          const double warps = f.threads / ptx::warp_size;
          std::fprintf(stderr, "ptx: %8ld %9.0f  %7.0f %6.0f  %7.1f %7.1f %7.1f  %s\n", f.launches,
                       f.threads / static_cast<double>(f.launches), f.counts.issued / warps,
                       f.counts.issued_double / warps, 32 * f.counts.asked / f.threads, 32 * f.counts.read / f.threads,
                       32 * f.counts.written / f.threads, f.name.c_str());
        }
    }
    const ptx::Findings& found = ptx::findings;
    if (failed == cudaSuccess && found.unwritten == 0 && found.races == 0) return;
    std::fprintf(stderr, "ptx: %ld reads of what was never written, %ld races%s\n", found.unwritten, found.races,
                 failed == cudaSuccess ? "" : ", and the device failed");
    std::fflush(nullptr);
    _exit(99);
  }
};

bool is_default(cudaStream_t stream) { return !stream || stream == cudaStreamLegacy || stream == cudaStreamPerThread; }
bool captures(cudaStream_t stream) { return !is_default(stream) && stream->captured_as != 0; }
int number_of(cudaStream_t stream) { return is_default(stream) ? 0 : stream->number; }

void do_work(const Work& work) {
  if (failed != cudaSuccess) return;
  try {
    work.run();
  } catch (const std::exception& e) {
    std::fprintf(stderr, "ptx: %s\n", e.what());
    failed = cudaErrorIllegalAddress;
  }
}
cudaError_t finish() {
  device.run_all(do_work);
  return done(failed);
}
cudaError_t finish(Position position) {
  device.run_to(position, do_work);
  return done(failed);
}

cudaError_t add(cudaStream_t stream, Work work) {
  if (failed != cudaSuccess) return done(failed);
  if (captures(stream)) {
    capture->work.push_back(work);
    capture->streams.add(stream->captured_as, std::move(work));
  } else if (capture && is_default(stream)) {
    return done(cudaErrorStreamCaptureImplicit);
  } else {
    device.add(number_of(stream), std::move(work));
  }
  return cudaSuccess;
}
cudaError_t wait_for_all() { return this_thread_captures() ? done(cudaErrorStreamCaptureUnsupported) : finish(); }

void read_module(Module& module) {
  static Account account;  // made after all that it looks at
  const auto* file = static_cast<const std::byte*>(module.data);
  const auto get = [&]<class T>(T, std::size_t at) {
    T value;
    std::memcpy(&value, file + at, sizeof value);
    return value;
  };
  if (get(std::uint32_t{}, 0) != 0xba55ed50u) throw ptx::Hazard("not a binary of nvcc");
  std::size_t at = get(std::uint16_t{}, 6);
  const std::size_t end = at + get(std::uint64_t{}, 8);
  while (at < end) {
    const auto kind = get(std::uint16_t{}, at);
    const std::size_t head = get(std::uint32_t{}, at + 4), size = get(std::uint64_t{}, at + 8),
                      packed = get(std::uint32_t{}, at + 16), plain = get(std::uint64_t{}, at + 56);
    if (kind == 1) {
      std::string text;
      if (packed) {
        text.resize(plain);
        const std::size_t got = ZSTD_decompress(text.data(), plain, file + at + head, packed);
        if (ZSTD_isError(got)) throw ptx::Hazard(std::string("PTX: ") + ZSTD_getErrorName(got));
        text.resize(got);
      } else {
        text.assign(reinterpret_cast<const char*>(file + at + head), size);
      }
      module.program = ptx::read_program(std::move(text));
      return;
    }
    at += head + size;
  }
  throw ptx::Hazard("no PTX in the binary: build it for sm_80, which takes PTX along");
}
Function& function_of(const void* host) {
  Function& f = functions().at(host);
  if (!f.module->program) read_module(*f.module);
  if (!f.kernel) f.kernel = &f.module->program->kernels.at(f.name);
  return f;
}

cudaError_t launch(const void* host, dim3 grid, dim3 block, void** args, std::size_t shared, cudaStream_t stream) {
  Locked locked;
  try {
    Function& f = function_of(host);
    std::vector<std::byte> params(static_cast<std::size_t>(f.kernel->param_bytes));
    for (std::size_t k = 0; k < f.kernel->params.size(); ++k)
      std::memcpy(params.data() + f.kernel->params[k].to, args[k], static_cast<std::size_t>(f.kernel->params[k].count));
    if (grid.x == 0 || block.x == 0 || block.x * block.y * block.z > 1024) return done(cudaErrorInvalidConfiguration);
    // Kernels of ours must not care for the order of their blocks.
    const bool ours = !ptx::of_thrust(f.name);
    return add(stream, {[&f, params = std::move(params), grid, block, shared, ours] {
                          ptx::counted = {};
                          ptx::run_kernel(*f.module->program, *f.kernel, {grid.x, grid.y, grid.z},
                                          {block.x, block.y, block.z}, shared, params.data(), backwards() && ours);
                          f.counts += ptx::counted;
                          f.threads += static_cast<double>(grid.x) * block.x;
                          ++f.launches;
                        },
                        f.kernel});
  } catch (const std::exception& e) {
    std::fprintf(stderr, "ptx: %s\n", e.what());
    return done(failed = cudaErrorInvalidPtx);
  }
}

void copy_now(void* to, const void* from, std::size_t bytes) {
  const auto place = [&](const void* address, ptx::memory::Access access) -> std::byte* {
    const auto number = reinterpret_cast<std::uint64_t>(address);
    if (!ptx::memory::is_device(number) && !ptx::memory::is_pinned(number))
      return static_cast<std::byte*>(const_cast<void*>(address));
    ptx::memory::Fault fault;
    std::byte* found = ptx::memory::at(number, bytes, access, fault);
    if (!found) throw ptx::Hazard("a copy outside of what is allocated");
    return found;
  };
  std::memcpy(place(to, ptx::memory::Access::write), place(from, ptx::memory::Access::read), bytes);
  ptx::memory::copy_state(reinterpret_cast<std::uint64_t>(to), reinterpret_cast<std::uint64_t>(from), bytes);
}

}  // namespace

extern "C" {

void** __cudaRegisterFatBinary(void* wrapper) {
  const void* data;
  std::memcpy(&data, static_cast<const std::byte*>(wrapper) + 8, sizeof data);
  modules().emplace_back().data = data;
  return reinterpret_cast<void**>(&modules().back());
}
void __cudaRegisterFatBinaryEnd(void**) {}
void __cudaUnregisterFatBinary(void**) {}
void __cudaRegisterVar(void**, char*, char*, const char*, int, std::size_t, int, int) {}
void __cudaRegisterFunction(void** module, const char* host, char*, const char* name, int, uint3*, uint3*, dim3*, dim3*,
                            int*) {
  functions()[host] = {reinterpret_cast<Module*>(module), name, nullptr, 0, 0, {}};
}
unsigned __cudaPushCallConfiguration(dim3 grid, dim3 block, std::size_t shared, CUstream_st* stream) {
  launches.push_back({grid, block, shared, stream});
  return 0;
}
cudaError_t __cudaPopCallConfiguration(dim3* grid, dim3* block, std::size_t* shared, void* stream) {
  const Launch& is = launches.back();
  *grid = is.grid;
  *block = is.block;
  *shared = is.shared;
  *static_cast<cudaStream_t*>(stream) = is.stream;
  launches.pop_back();
  return cudaSuccess;
}
cudaError_t __cudaGetKernel(cudaKernel_t* kernel, const void* host) {
  *kernel = reinterpret_cast<cudaKernel_t>(const_cast<void*>(host));
  return cudaSuccess;
}
cudaError_t __cudaLaunchKernel(cudaKernel_t kernel, dim3 grid, dim3 block, void** args, std::size_t shared,
                               cudaStream_t stream) {
  return launch(kernel, grid, block, args, shared, stream);
}
cudaError_t cudaLaunchKernelExC(const cudaLaunchConfig_t* config, const void* host, void** args) {
  return launch(host, config->gridDim, config->blockDim, args, config->dynamicSmemBytes, config->stream);
}

cudaError_t cudaGetDeviceCount(int* count) { return *count = 1, cudaSuccess; }
cudaError_t cudaGetDevice(int* device) { return *device = 0, cudaSuccess; }
cudaError_t cudaSetDevice(int device) { return done(device == 0 ? cudaSuccess : cudaErrorInvalidDevice); }
cudaError_t cudaDriverGetVersion(int* version) { return *version = CUDART_VERSION, cudaSuccess; }
cudaError_t cudaRuntimeGetVersion(int* version) { return *version = CUDART_VERSION, cudaSuccess; }
cudaError_t cudaGetDeviceProperties(cudaDeviceProp* is, int) {
  *is = {};
  std::snprintf(is->name, sizeof is->name, "PTX run on the processor");
  is->totalGlobalMem = 16ull << 30;
  is->major = 8;
  is->multiProcessorCount = 4;
  return cudaSuccess;
}
cudaError_t cudaDeviceGetAttribute(int* value, cudaDeviceAttr attribute, int) {
  switch (attribute) {
    case cudaDevAttrComputeCapabilityMajor:
      *value = 8;
      break;
    case cudaDevAttrComputeCapabilityMinor:
      *value = 0;
      break;
    case cudaDevAttrComputeMode:
      *value = cudaComputeModeDefault;
      break;
    case cudaDevAttrMemoryPoolsSupported:
      *value = 1;
      break;
    case cudaDevAttrMultiProcessorCount:
      *value = 4;
      break;
    case cudaDevAttrMaxSharedMemoryPerBlock:
      *value = 48 << 10;
      break;
    case cudaDevAttrMaxSharedMemoryPerBlockOptin:
      *value = 163 << 10;
      break;
    case cudaDevAttrMaxSharedMemoryPerMultiprocessor:
      *value = 164 << 10;
      break;
    case cudaDevAttrMaxThreadsPerBlock:
      *value = 1024;
      break;
    case cudaDevAttrMaxThreadsPerMultiProcessor:
      *value = 2048;
      break;
    case cudaDevAttrMaxGridDimX:
      *value = 2147483647;
      break;
    case cudaDevAttrWarpSize:
      *value = 32;
      break;
    default:
      std::fprintf(stderr, "ptx: device attribute %d is not known\n", static_cast<int>(attribute));
      return done(cudaErrorInvalidValue);
  }
  return cudaSuccess;
}
cudaError_t cudaFuncGetAttributes(cudaFuncAttributes* is, const void* host) {
  Locked locked;
  *is = {};
  is->ptxVersion = is->binaryVersion = 80;
  is->maxThreadsPerBlock = 1024;
  try {
    is->sharedSizeBytes = static_cast<std::size_t>(function_of(host).kernel->shared_bytes);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "ptx: %s\n", e.what());
    return done(failed = cudaErrorInvalidPtx);
  }
  return cudaSuccess;
}
cudaError_t cudaOccupancyMaxActiveBlocksPerMultiprocessorWithFlags(int* blocks, const void*, int, std::size_t,
                                                                   unsigned) {
  return *blocks = 2, cudaSuccess;
}

cudaError_t cudaGetLastError() { return std::exchange(last, cudaSuccess); }
cudaError_t cudaPeekAtLastError() { return last; }
const char* cudaGetErrorName(cudaError_t error) { return error == cudaSuccess ? "cudaSuccess" : "cudaError"; }
const char* cudaGetErrorString(cudaError_t error) {
  switch (error) {
    case cudaSuccess:
      return "no error";
    case cudaErrorMemoryAllocation:
      return "out of memory";
    case cudaErrorIllegalAddress:
      return "an illegal memory access was encountered";
    case cudaErrorStreamCaptureUnsupported:
      return "operation not permitted when stream is capturing";
    case cudaErrorStreamCaptureImplicit:
      return "operation would make the legacy stream depend on a capturing blocking stream";
    default:
      return "an error of the pretended device";
  }
}

cudaError_t cudaMalloc(void** memory, std::size_t bytes) {
  Locked locked;
  if (this_thread_captures()) return done(cudaErrorStreamCaptureUnsupported);
  try {
    *memory = bytes ? reinterpret_cast<void*>(ptx::memory::allocate(bytes)) : nullptr;  // NOLINT
    return cudaSuccess;
  } catch (const std::bad_alloc&) {
    return done(cudaErrorMemoryAllocation);
  }
}
cudaError_t cudaFree(void* memory) {
  Locked locked;
  if (!memory) return cudaSuccess;
  const cudaError_t error = wait_for_all();
  if (error != cudaSuccess) return error;
  return done(ptx::memory::free(reinterpret_cast<std::uint64_t>(memory)) ? cudaSuccess : cudaErrorInvalidValue);
}
cudaError_t cudaMallocAsync(void** memory, std::size_t bytes, cudaStream_t) { return cudaMalloc(memory, bytes); }
cudaError_t cudaFreeAsync(void* memory, cudaStream_t stream) {
  Locked locked;
  if (!memory) return cudaSuccess;
  return add(stream, {[memory] {
                        if (!ptx::memory::free(reinterpret_cast<std::uint64_t>(memory)))
                          throw ptx::Hazard("memory is freed that was not allocated");
                      },
                      nullptr});
}
cudaError_t cudaHostAlloc(void** memory, std::size_t bytes, unsigned) {
  Locked locked;
  try {
    *memory = ptx::memory::allocate_host(bytes);
    return cudaSuccess;
  } catch (const std::bad_alloc&) {
    return done(cudaErrorMemoryAllocation);
  }
}
cudaError_t cudaMallocHost(void** memory, std::size_t bytes) { return cudaHostAlloc(memory, bytes, 0); }
cudaError_t cudaFreeHost(void* memory) {
  Locked locked;
  if (!memory) return cudaSuccess;
  const cudaError_t error = wait_for_all();
  ptx::memory::free_host(memory);
  return error;
}
cudaError_t cudaMemGetInfo(std::size_t* free, std::size_t* total) {
  Locked locked;
  *total = 16ull << 30;
  *free = *total - ptx::memory::bytes_in_use();
  return cudaSuccess;
}
cudaError_t cudaDeviceGetDefaultMemPool(cudaMemPool_t* pool, int) { return *pool = nullptr, cudaSuccess; }
cudaError_t cudaMemPoolSetAttribute(cudaMemPool_t, cudaMemPoolAttr, void*) { return cudaSuccess; }
cudaError_t cudaMemPoolTrimTo(cudaMemPool_t, std::size_t) { return cudaSuccess; }

cudaError_t cudaMemcpyAsync(void* to, const void* from, std::size_t bytes, cudaMemcpyKind kind, cudaStream_t stream) {
  Locked locked;
  if (!bytes) return cudaSuccess;
  const auto on_device = [](const void* address) {
    return ptx::memory::is_device(reinterpret_cast<std::uint64_t>(address));
  };
  const auto pageable = [&](const void* address) {
    return !on_device(address) && !ptx::memory::is_pinned(reinterpret_cast<std::uint64_t>(address));
  };
  const bool from_device = kind == cudaMemcpyDeviceToHost || kind == cudaMemcpyDeviceToDevice,
             to_device = kind == cudaMemcpyHostToDevice || kind == cudaMemcpyDeviceToDevice;
  if (kind != cudaMemcpyDefault && (from_device != on_device(from) || to_device != on_device(to)))
    return done(cudaErrorInvalidValue);
  const bool later = captures(stream);
  if (pageable(from) && !later) {
    const auto* bytes_from = static_cast<const std::byte*>(from);
    return add(stream, {[to, kept = std::vector<std::byte>(bytes_from, bytes_from + bytes)] {
                          copy_now(to, kept.data(), kept.size());
                        },
                        nullptr});
  }
  const cudaError_t error = add(stream, {[to, from, bytes] { copy_now(to, from, bytes); }, &copies});
  return error == cudaSuccess && pageable(to) && !later ? finish(device.end(number_of(stream))) : error;
}
cudaError_t cudaMemsetAsync(void* to, int value, std::size_t bytes, cudaStream_t stream) {
  Locked locked;
  return add(stream, {[to, value, bytes] {
                        ptx::memory::Fault fault;
                        std::byte* found = ptx::memory::at(reinterpret_cast<std::uint64_t>(to), bytes,
                                                           ptx::memory::Access::write, fault);
                        if (!found) throw ptx::Hazard("a memset outside of what is allocated");
                        std::memset(found, value, bytes);
                      },
                      &sets});
}
cudaError_t cudaMemset(void* to, int value, std::size_t bytes) { return cudaMemsetAsync(to, value, bytes, nullptr); }

cudaError_t cudaDeviceSynchronize() {
  Locked locked;
  return wait_for_all();
}
cudaError_t cudaStreamCreate(cudaStream_t* stream) {
  Locked locked;
  *stream = new CUstream_st{device.make()};
  return cudaSuccess;
}
cudaError_t cudaStreamDestroy(cudaStream_t stream) {
  Locked locked;
  delete stream;
  return cudaSuccess;
}
cudaError_t cudaStreamSynchronize(cudaStream_t stream) {
  Locked locked;
  if (captures(stream) || this_thread_captures()) return done(cudaErrorStreamCaptureUnsupported);
  return is_default(stream) ? finish() : finish(device.end(stream->number));
}
cudaError_t cudaEventCreateWithFlags(cudaEvent_t* event, unsigned) { return *event = new CUevent_st, cudaSuccess; }
cudaError_t cudaEventCreate(cudaEvent_t* event) { return cudaEventCreateWithFlags(event, 0); }
cudaError_t cudaEventDestroy(cudaEvent_t event) {
  Locked locked;
  delete event;
  return cudaSuccess;
}
cudaError_t cudaEventRecord(cudaEvent_t event, cudaStream_t stream) {
  Locked locked;
  event->captured = captures(stream);
  if (event->captured) {
    event->position = capture->streams.end(stream->captured_as);
    return cudaSuccess;
  }
  const cudaError_t error = add(stream, {[time = event->time] { *time = std::chrono::steady_clock::now(); }, nullptr});
  event->position = device.end(number_of(stream));
  return error;
}
cudaError_t cudaStreamWaitEvent(cudaStream_t stream, cudaEvent_t event, unsigned) {
  Locked locked;
  if (!event->captured) {
    if (captures(stream)) return done(cudaErrorStreamCaptureIsolation);
    device.wait(number_of(stream), event->position);
    return cudaSuccess;
  }
  if (!capture || is_default(stream)) return done(cudaErrorStreamCaptureIsolation);
  if (!captures(stream)) {  // the stream takes part in the capture from here on
    stream->captured_as = capture->streams.make();
    capture->taking_part.push_back(stream);
  }
  capture->streams.wait(stream->captured_as, event->position);
  return cudaSuccess;
}
cudaError_t cudaEventSynchronize(cudaEvent_t event) {
  Locked locked;
  if (event->captured) return done(cudaErrorCapturedEvent);
  return this_thread_captures() ? done(cudaErrorStreamCaptureUnsupported) : finish(event->position);
}
cudaError_t cudaEventElapsedTime(float* milliseconds, cudaEvent_t begin, cudaEvent_t end) {
  Locked locked;
  *milliseconds = std::chrono::duration<float, std::milli>(*end->time - *begin->time).count();
  return cudaSuccess;
}

cudaError_t cudaStreamBeginCapture(cudaStream_t stream, cudaStreamCaptureMode) {
  Locked locked;
  if (is_default(stream) || capture) return done(cudaErrorStreamCaptureUnsupported);
  capture = std::make_unique<Capture>();
  capture->thread = std::this_thread::get_id();
  stream->captured_as = capture->streams.make();
  capture->taking_part.push_back(stream);
  return cudaSuccess;
}
cudaError_t cudaStreamEndCapture(cudaStream_t stream, cudaGraph_t* graph) {
  Locked locked;
  *graph = nullptr;
  if (!capture || capture->taking_part.front() != stream) return done(cudaErrorIllegalState);
  // What the first stream needs in the end must be everything: as late as possible, side streams last.
  std::vector<Work> late;
  capture->streams.run_to(capture->streams.end(stream->captured_as), [&](const Work& work) { late.push_back(work); });
  const bool joined = late.size() == capture->work.size();
  for (const cudaStream_t one : capture->taking_part) one->captured_as = 0;
  if (joined) *graph = new CUgraph_st{backwards() ? late : capture->work};
  capture = nullptr;
  return joined ? cudaSuccess : done(cudaErrorStreamCaptureUnjoined);
}
cudaError_t cudaGraphInstantiate(cudaGraphExec_t* exec, cudaGraph_t graph, unsigned long long) {
  Locked locked;
  *exec = new CUgraphExec_st{graph->work};
  return cudaSuccess;
}
cudaError_t cudaGraphExecUpdate(cudaGraphExec_t exec, cudaGraph_t graph, cudaGraphExecUpdateResultInfo*) {
  Locked locked;
  bool same = exec->work.size() == graph->work.size();
  for (std::size_t k = 0; same && k < graph->work.size(); ++k) same = exec->work[k].form == graph->work[k].form;
  if (!same) return done(cudaErrorGraphExecUpdateFailure);
  exec->work = graph->work;
  return cudaSuccess;
}
cudaError_t cudaGraphLaunch(cudaGraphExec_t exec, cudaStream_t stream) {
  Locked locked;
  for (const Work& work : exec->work)
    if (const cudaError_t error = add(stream, work); error != cudaSuccess) return error;
  return cudaSuccess;
}
cudaError_t cudaGraphExecDestroy(cudaGraphExec_t exec) {
  Locked locked;
  delete exec;
  return cudaSuccess;
}
cudaError_t cudaGraphDestroy(cudaGraph_t graph) {
  Locked locked;
  delete graph;
  return cudaSuccess;
}

}  // extern "C"
