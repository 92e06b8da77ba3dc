#pragma once
// PTX, the virtual machine code that nvcc makes of kernels, read into a form that warp.cpp runs on a processor. What
// the CUDA half of the program consists of is run thus without a GPU: the same objects, the same kernels, every address
// and every read of memory that nothing was written to checked. It says nothing about speed. Source: PTX ISA 9.0
// (NVIDIA); of its instructions those that our kernels and Thrust's use. Others are
// an error, and so are roundings and saturation that they do not use.
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace ptx {

struct Warp;
struct Instruction;

/// Threads of a warp as bits.
using Lanes = std::uint32_t;
constexpr int warp_size = 32;
constexpr Lanes all_lanes = 0xffffffffu;

enum class Kind : std::uint8_t { plain, branch, call, ret, end, barrier, together };
enum class Space : std::uint8_t { generic, global, shared, local, param, lane_param };

/// Generic addresses of what is no global memory: window | address in its space.
constexpr std::uint64_t shared_window = 1ull << 60, local_window = 2ull << 60, param_window = 3ull << 60;

/// Operands are numbers of rows of 32 values, one a lane: registers from 0, constants from -1 down.
struct Instruction {
  void (*run)(Warp&, const Instruction&, Lanes) = nullptr;
  Kind kind = Kind::plain;
  bool guarded = false, unless = false;  // @p, @!p
  bool in_double = false;                // arithmetic in double precision
  bool ordered = false;                  // a volatile or relaxed access: others may be about it at the same time
  Space space = Space::generic;
  std::uint8_t count = 1;  // of a vector; of from[]
  int guard = 0;
  int to[4] = {}, from[5] = {};
  std::int64_t offset = 0;  // of an address
  int target = 0;           // of a branch: an instruction; of a call: its number in Program::calls
  int line = 0;             // of the text
};

struct Bytes {
  int from, to, count;
};
struct Call {
  std::string function;
  int entry = -1;
  std::vector<std::string> argument_names;
  std::vector<Bytes> arguments;
  std::string result_name;
  Bytes result{0, 0, 0};
};

struct Kernel {
  std::string name;
  int entry = 0, registers = 0, shared_bytes = 0, param_bytes = 0;
  std::vector<Bytes> params;  // to: where in the block of parameters
  int threads_at_most = 1024;
};

/// Special registers, rows 0 to special_rows - 1.
enum Special : int {
  tid_x,
  tid_y,
  tid_z,
  ntid_x,
  ntid_y,
  ntid_z,
  ctaid_x,
  ctaid_y,
  ctaid_z,
  nctaid_x,
  nctaid_y,
  nctaid_z,
  laneid,
  warpid,
  lanemask_eq,
  lanemask_lt,
  lanemask_le,
  lanemask_gt,
  lanemask_ge,
  special_rows
};

/// Local memory of a lane: a kernel's from 0, those of functions above; none calls itself, so each has a place of its
/// own. The same for parameters of calls.
constexpr int function_local_begin = 16 << 10, local_bytes = 48 << 10;
constexpr int function_param_begin = 2 << 10, lane_param_bytes = 8 << 10;

struct Variable {
  std::uint64_t address;
  std::size_t bytes;
};

struct Program {
  std::string text;  // lines of it are shown with errors
  std::vector<Instruction> code;
  std::vector<Call> calls;
  std::map<std::string, Kernel, std::less<>> kernels;
  std::map<std::string, Variable, std::less<>> variables;
  std::vector<std::uint64_t> constants;  // 32 copies each
  int registers = 0;                     // of any kernel, with the functions'
  std::string_view line(int number) const;
};

/// Throws std::runtime_error with the line of what it does not know.
std::unique_ptr<Program> read_program(std::string text);

}  // namespace ptx
