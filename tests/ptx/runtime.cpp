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
#include <unordered_map>
#include <utility>

#include "tests/ptx/memory.hpp"
#include "tests/ptx/warp.hpp"

namespace {

struct Work {
  std::function<void()> run;
  const void* form;  // what a graph of the same form has in the same place
};
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
std::deque<Work> queue;
/// Kernels register themselves before this file's variables are made.
std::deque<Module>& modules() {
  static std::deque<Module> all;
  return all;
}
std::unordered_map<const void*, Function>& functions() {
  static std::unordered_map<const void*, Function> all;
  return all;
}
cudaError_t failed = cudaSuccess, last = cudaSuccess;
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
  queue.clear();
  findings = {};
  return was_broken;
}

struct CUstream_st {
  bool captures = false;
};
struct CUevent_st {
  bool captured = false;
  std::chrono::steady_clock::time_point time;
};
struct CUgraph_st {
  std::vector<Work> work;
};
struct CUgraphExec_st {
  std::vector<Work> work;
};

namespace {

CUgraph_st* capture = nullptr;
std::vector<cudaStream_t> capturing;

struct Locked {
  std::lock_guard<std::recursive_mutex> lock{everything};
};

cudaError_t done(cudaError_t error) {
  if (error != cudaSuccess) last = error;
  return error;
}
bool switched_on(const char* name) {
  const char* value = std::getenv(name);
  return value && *value && *value != '0';
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

cudaError_t finish() {
  while (!queue.empty() && failed == cudaSuccess) {
    const Work work = std::move(queue.front());
    queue.pop_front();
    try {
      work.run();
    } catch (const std::exception& e) {
      std::fprintf(stderr, "ptx: %s\n", e.what());
      failed = cudaErrorIllegalAddress;
    }
  }
  return done(failed);
}

bool captures(cudaStream_t stream) {
  return stream && stream != cudaStreamLegacy && stream != cudaStreamPerThread && stream->captures;
}

cudaError_t add(cudaStream_t stream, Work work) {
  if (failed != cudaSuccess) return done(failed);
  if (captures(stream))
    capture->work.push_back(std::move(work));
  else if (capture && (!stream || stream == cudaStreamLegacy))
    return done(cudaErrorStreamCaptureImplicit);
  else
    queue.push_back(std::move(work));
  return cudaSuccess;
}
cudaError_t wait_for_all() { return capture ? done(cudaErrorStreamCaptureUnsupported) : finish(); }

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
    static const bool backwards = switched_on("PTX_BACKWARDS");
    const bool ours = !ptx::of_thrust(f.name);
    return add(stream, {[&f, params = std::move(params), grid, block, shared, ours] {
                          ptx::counted = {};
                          ptx::run_kernel(*f.module->program, *f.kernel, {grid.x, grid.y, grid.z},
                                          {block.x, block.y, block.z}, shared, params.data(), backwards && ours);
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
  if (capture) return done(cudaErrorStreamCaptureUnsupported);
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
  ptx::memory::free(reinterpret_cast<std::uint64_t>(memory));
  return error;
}
cudaError_t cudaMallocAsync(void** memory, std::size_t bytes, cudaStream_t) { return cudaMalloc(memory, bytes); }
cudaError_t cudaFreeAsync(void* memory, cudaStream_t stream) {
  Locked locked;
  if (!memory) return cudaSuccess;
  return add(stream, {[memory] { ptx::memory::free(reinterpret_cast<std::uint64_t>(memory)); }, nullptr});
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

cudaError_t cudaMemcpyAsync(void* to, const void* from, std::size_t bytes, cudaMemcpyKind, cudaStream_t stream) {
  Locked locked;
  if (!bytes) return cudaSuccess;
  const auto pageable = [](const void* address) {
    const auto number = reinterpret_cast<std::uint64_t>(address);
    return !ptx::memory::is_device(number) && !ptx::memory::is_pinned(number);
  };
  const bool later = captures(stream);
  if (pageable(from) && !later) {
    const auto* bytes_from = static_cast<const std::byte*>(from);
    return add(stream, {[to, kept = std::vector<std::byte>(bytes_from, bytes_from + bytes)] {
                          copy_now(to, kept.data(), kept.size());
                        },
                        nullptr});
  }
  const cudaError_t error = add(stream, {[to, from, bytes] { copy_now(to, from, bytes); }, &copies});
  return error == cudaSuccess && pageable(to) && !later ? wait_for_all() : error;
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
cudaError_t cudaStreamCreate(cudaStream_t* stream) { return *stream = new CUstream_st, cudaSuccess; }
cudaError_t cudaStreamDestroy(cudaStream_t stream) {
  Locked locked;
  delete stream;
  return cudaSuccess;
}
cudaError_t cudaStreamSynchronize(cudaStream_t) {
  Locked locked;
  return wait_for_all();
}
cudaError_t cudaEventCreateWithFlags(cudaEvent_t* event, unsigned) { return *event = new CUevent_st, cudaSuccess; }
cudaError_t cudaEventCreate(cudaEvent_t* event) { return cudaEventCreateWithFlags(event, 0); }
cudaError_t cudaEventDestroy(cudaEvent_t event) {
  Locked locked;
  const cudaError_t error = capture ? cudaSuccess : finish();
  delete event;
  return error;
}
cudaError_t cudaEventRecord(cudaEvent_t event, cudaStream_t stream) {
  Locked locked;
  event->captured = captures(stream);
  if (event->captured) return cudaSuccess;
  return add(stream, {[event] { event->time = std::chrono::steady_clock::now(); }, nullptr});
}
cudaError_t cudaStreamWaitEvent(cudaStream_t stream, cudaEvent_t event, unsigned) {
  Locked locked;
  if (event->captured && capture && !captures(stream)) {  // the stream takes part in the capture from here on
    stream->captures = true;
    capturing.push_back(stream);
  }
  return cudaSuccess;
}
cudaError_t cudaEventSynchronize(cudaEvent_t event) {
  Locked locked;
  return event->captured ? done(cudaErrorCapturedEvent) : wait_for_all();
}
cudaError_t cudaEventElapsedTime(float* milliseconds, cudaEvent_t begin, cudaEvent_t end) {
  Locked locked;
  *milliseconds = std::chrono::duration<float, std::milli>(end->time - begin->time).count();
  return cudaSuccess;
}

cudaError_t cudaStreamBeginCapture(cudaStream_t stream, cudaStreamCaptureMode) {
  Locked locked;
  if (!stream || capture) return done(cudaErrorStreamCaptureUnsupported);
  capture = new CUgraph_st;
  stream->captures = true;
  capturing.assign(1, stream);
  return cudaSuccess;
}
cudaError_t cudaStreamEndCapture(cudaStream_t stream, cudaGraph_t* graph) {
  Locked locked;
  if (!capture || capturing.front() != stream) return done(cudaErrorIllegalState);
  for (const cudaStream_t one : capturing) one->captures = false;
  *graph = std::exchange(capture, nullptr);
  return cudaSuccess;
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
  finish();  // what is queued keeps the graph that it was started with
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
