#pragma once
// Blocks of threads, a warp at a time. The lanes of a warp that stand at the lowest instruction go on together until
// they meet those that wait above: branches join again without being told where.
#include <array>
#include <cstring>
#include <functional>
#include <stdexcept>

#include "tests/ptx/memory.hpp"
#include "tests/ptx/program.hpp"

namespace ptx {

struct Size {
  unsigned x = 1, y = 1, z = 1;
  unsigned all() const { return x * y * z; }
};

/// Something that a device would not survive, or that has no defined result.
struct Hazard : std::runtime_error {
  using runtime_error::runtime_error;
};

/// Whether an environment variable is 1.
bool switched_on(const char* variable);

/// What is wrong but does not stop a device; said once for each instruction on standard error.
struct Findings {
  long unwritten = 0;  // reads of what was never written
  long races = 0;      // threads of a launch at the same memory, one of them writing; looked for where watches_races
};
extern Findings findings;
/// From PTX_RACES=1; costs time and memory.
extern bool watches_races;

/// What launches did since they were last set to zero; counted where `counts`, from PTX_STATISTICS=1. Of global memory:
/// sectors of 32 bytes.
struct Counts {
  double issued = 0;             // instructions of warps, of which
  double issued_double = 0;      // arithmetic in double
  double asked = 0;              // sectors that instructions of warps ask for
  double read = 0, written = 0;  // different ones of a launch: what it must move, however large the caches
  Counts& operator+=(const Counts& more);
};
extern Counts counted;
extern bool counts;
/// An instruction's part of it.
void count_access(Warp& w, const Instruction& i, Lanes lanes, int bytes, memory::Access access);

struct Block {
  const Program* program = nullptr;
  const Kernel* kernel = nullptr;
  const std::byte* params = nullptr;
  std::vector<std::byte> shared;
  /// Who touched a word of shared memory since the last barrier: warp + 1, or -1 of several.
  struct Touch {
    int written_at = 0, read_at = 0;
    short writer = 0, reader = 0;
  };
  std::vector<Touch> touches;
  int phase = 1;
  unsigned number = 0;
};

struct Warp {
  std::vector<std::uint64_t> registers;  // rows of 32
  std::vector<std::byte> local, lane_params;
  std::array<int, warp_size> at{};  // instruction
  struct Return {
    int to, call;
  };
  std::array<std::vector<Return>, warp_size> returns;
  Lanes alive = 0, at_barrier = 0;
  int number = 0;
  Block* block = nullptr;
  const std::uint64_t* constants = nullptr;
  const Instruction* now = nullptr;

  std::uint64_t* row(int number) { return registers.data() + static_cast<std::ptrdiff_t>(number) * warp_size; }
  const std::uint64_t* value(int number) const {
    return number >= 0 ? registers.data() + static_cast<std::ptrdiff_t>(number) * warp_size
                       : constants + static_cast<std::ptrdiff_t>(-1 - number) * warp_size;
  }
  /// Where an address is found; `what` must be the whole of what is read or written.
  std::byte* find(Space space, std::uint64_t address, int bytes, int lane, memory::Access access, bool atomic = false);
  /// For a message: the kernel and the line.
  std::string where() const;
  /// Until all lanes wait at a barrier or have ended.
  void run();
};

/// Its blocks wait for those before them, and look at what those write.
bool of_thrust(const std::string& kernel);

/// Runs all blocks of a launch, the last one first where `backwards`. Throws Hazard.
void run_kernel(const Program& program, const Kernel& kernel, Size grid, Size block, std::size_t more_shared,
                const std::byte* params, bool backwards);

}  // namespace ptx
