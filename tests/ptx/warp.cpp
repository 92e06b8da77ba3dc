#include "tests/ptx/warp.hpp"

#include <algorithm>
#include <bit>
#include <climits>
#include <cstdio>
#include <cstdlib>
#include <set>
#include <span>

namespace ptx {
namespace {

std::set<const Instruction*> told;
std::uint32_t launch = 0;  // the one that runs

std::string place_of(const Block& block, const Instruction& i) {
  return "\n  in " + block.kernel->name + "\n  at " + std::string(block.program->line(i.line));
}

/// Who wrote and read each word of global memory in the launch that runs.
class Races {
 public:
  /// Whether another thread is about it too.
  bool note(std::uint64_t address, int bytes, memory::Access access, std::uint32_t me) {
    if (address - memory::device_place.begin >= memory::room) return false;
    bool raced = false;
    const std::uint64_t first = address - memory::device_place.begin;
    const int unit = bytes < 4 ? 1 : 4;  // flags of one byte lie side by side
    Word* words = bytes < 4 ? bytes_ : words_;
    for (std::uint64_t k = first / unit; k <= (first + bytes - 1) / unit; ++k) {
      Word& word = words[k];
      const bool written = word.written_in == launch, read = word.read_in == launch;
      raced |= written && word.writer != me;
      if (access == memory::Access::write) {
        raced |= read && word.reader != me;
        word.written_in = launch;
        word.writer = me;
      } else {
        word.reader = read && word.reader != me ? several : me;
        word.read_in = launch;
      }
    }
    return raced;
  }

 private:
  static constexpr std::uint32_t several = 0xffffffffu;
  struct Word {
    std::uint32_t written_in, writer, read_in, reader;
  };
  Word* words_ = reinterpret_cast<Word*>(memory::reserve(memory::room * sizeof(Word) / 4));
  Word* bytes_ = reinterpret_cast<Word*>(memory::reserve(memory::room * sizeof(Word)));
};
Races& races() {
  static Races all;
  return all;
}

}  // namespace

bool switched_on(const char* variable) {
  const char* value = std::getenv(variable);
  return value && *value == '1';
}

Counts counted;
bool counts = switched_on("PTX_STATISTICS");
Counts& Counts::operator+=(const Counts& more) {
  issued += more.issued, issued_double += more.issued_double, asked += more.asked;
  read += more.read, written += more.written;
  return *this;
}
void count_access(Warp& w, const Instruction& i, Lanes lanes, int bytes, memory::Access access) {
  constexpr int sector = 32;
  // The launches in which each sector was read and written.
  struct Seen {
    std::uint32_t read, written;
  };
  static Seen* const seen = reinterpret_cast<Seen*>(memory::reserve(memory::room / sector * sizeof(Seen)));
  const std::uint64_t* address = w.value(i.from[0]);
  std::vector<std::uint64_t> sectors;
  for (; lanes; lanes &= lanes - 1) {
    const std::uint64_t first = address[std::countr_zero(lanes)] + i.offset - memory::device_place.begin;
    if (i.space > Space::global || first >= memory::room) continue;
    for (std::uint64_t k = first / sector; k <= (first + bytes - 1) / sector; ++k) sectors.push_back(k);
  }
  std::sort(sectors.begin(), sectors.end());
  sectors.erase(std::unique(sectors.begin(), sectors.end()), sectors.end());
  counted.asked += static_cast<double>(sectors.size());
  for (const std::uint64_t k : sectors) {
    std::uint32_t& in = access == memory::Access::read ? seen[k].read : seen[k].written;
    if (in == launch) continue;
    in = launch;
    (access == memory::Access::read ? counted.read : counted.written) += 1;
  }
}

Findings findings;
std::string Warp::where() const { return place_of(*block, *now); }
bool of_thrust(const std::string& kernel) { return kernel.starts_with("_ZN3cub") || kernel.starts_with("_ZN6thrust"); }
bool watches_races = switched_on("PTX_RACES");

std::byte* Warp::find(Space space, std::uint64_t address, int bytes, int lane, memory::Access access, bool atomic) {
  if (space == Space::generic) {
    const std::uint64_t window = address & (3ull << 60);
    space = window == shared_window  ? Space::shared
            : window == local_window ? Space::local
            : window == param_window ? Space::param
                                     : Space::global;
    address &= ~(3ull << 60);
  }
  const auto tell = [&](const char* what) {
    if (told.insert(now).second) std::fprintf(stderr, "ptx: %s%s\n", what, where().c_str());
  };
  const auto inside = [&](std::size_t size) {
    if (address + bytes > size || address > size) throw Hazard("address outside of its space" + where());
  };
  if (address % bytes != 0 && space != Space::lane_param)  // vectors included
    throw Hazard("address " + std::to_string(address) + " of " + std::to_string(bytes) + " bytes is not aligned" +
                 where());
  switch (space) {
    case Space::shared: {
      inside(block->shared.size());
      if (watches_races && !atomic)
        for (std::uint64_t word = address / 4; word <= (address + bytes - 1) / 4; ++word) {
          Block::Touch& touch = block->touches[word];
          const auto me = static_cast<short>(number + 1);
          const bool written_by_other = touch.written_at == block->phase && touch.writer != me,
                     read_by_other = touch.read_at == block->phase && touch.reader != me;
          if (written_by_other || (access == memory::Access::write && read_by_other && bytes >= 4)) {
            ++findings.races;
            tell("warps of a block race for shared memory");
          }
          if (access == memory::Access::write) {
            touch.written_at = block->phase;
            touch.writer = me;
          } else {
            touch.reader = touch.read_at == block->phase && touch.reader != me ? short{-1} : me;
            touch.read_at = block->phase;
          }
        }
      return block->shared.data() + address;
    }
    case Space::local:
      inside(local_bytes);
      return local.data() + static_cast<std::ptrdiff_t>(lane) * local_bytes + address;
    case Space::param:
      inside(block->kernel->param_bytes);
      if (access == memory::Access::write) throw Hazard("writes to its parameters" + where());
      return const_cast<std::byte*>(block->params) + address;
    case Space::lane_param:
      inside(lane_param_bytes);
      return lane_params.data() + static_cast<std::ptrdiff_t>(lane) * lane_param_bytes + address;
    default: {
      memory::Fault fault;
      if (watches_races && !atomic && !now->ordered && !of_thrust(block->kernel->name)) {
        const auto me = static_cast<std::uint32_t>(block->number * 1024 + number * warp_size + lane);
        if (races().note(address, bytes, access, me)) {
          ++findings.races;
          tell("threads race for memory");
        }
      }
      std::byte* found = memory::at(address, bytes, access, fault);
      if (fault == memory::Fault::outside)
        throw Hazard((access == memory::Access::write ? "writes to" : "reads from") +
                     std::string(" memory that is not allocated") + where());
      if (fault == memory::Fault::unwritten) {
        ++findings.unwritten;
        tell("reads memory that nothing was written to");
      }
      return found;
    }
  }
}

void Warp::run() {
  const std::vector<Instruction>& code = block->program->code;
  std::vector<int> waits_at;  // instructions where lanes wait for others of their warp
  for (;;) {
    const Lanes ready = alive & ~at_barrier;
    if (!ready) return;
    // The lowest instruction, those who stand there, and where the next ones wait.
    int pc = INT_MAX, limit = INT_MAX;
    for (Lanes rest = ready; rest; rest &= rest - 1) {
      const int here = at[std::countr_zero(rest)];
      if (std::find(waits_at.begin(), waits_at.end(), here) != waits_at.end()) continue;
      if (here < pc)
        limit = pc, pc = here;
      else if (here > pc && here < limit)
        limit = here;
    }
    if (pc == INT_MAX)
      throw Hazard("lanes of a warp wait for each other for ever" + place_of(*block, code[waits_at[0]]));
    for (const int place : waits_at)
      if (place > pc) limit = std::min(limit, place);
    Lanes lanes = 0;
    for (Lanes rest = ready; rest; rest &= rest - 1)
      if (at[std::countr_zero(rest)] == pc) lanes |= 1u << std::countr_zero(rest);
    const auto put = [&](Lanes these, int place) {
      for (; these; these &= these - 1) at[std::countr_zero(these)] = place;
    };
    bool moved = false, chosen = true, waits = false;
    while (chosen) {
      const Instruction& i = code[pc];
      now = &i;
      Lanes doing = lanes;
      if (i.guarded) {
        const std::uint64_t* guard = value(i.guard);
        Lanes yes = 0;
        for (int lane = 0; lane < warp_size; ++lane) yes |= static_cast<Lanes>(guard[lane] & 1) << lane;
        doing &= i.unless ? ~yes : yes;
      }
      if (counts) {
        counted.issued += 1;
        counted.issued_double += i.in_double && doing ? 1 : 0;
      }
      switch (i.kind) {
        case Kind::plain:
          if (doing) i.run(*this, i, doing);
          ++pc;
          break;
        case Kind::branch:
          if (doing == lanes) {
            // Back to where others may wait: a new choice.
            const bool may_meet = i.target <= pc && !waits_at.empty();
            pc = i.target;
            if (may_meet) {
              put(lanes, pc);
              chosen = false;
            }
          } else if (!doing) {
            ++pc;
          } else {
            put(doing, i.target);
            put(lanes & ~doing, pc + 1);
            chosen = false;
          }
          break;
        case Kind::together: {
          const std::uint64_t* masks = value(i.from[4]);
          const Lanes all = static_cast<Lanes>(masks[std::countr_zero(lanes)]);
          for (Lanes rest = lanes; rest; rest &= rest - 1)
            if (static_cast<Lanes>(masks[std::countr_zero(rest)]) != all)
              throw Hazard("lanes that do not wait for the same ones" + place_of(*block, i));
          if (all & ~alive) throw Hazard("waits for lanes that have ended" + place_of(*block, i));
          if ((all & lanes) != all) {
            put(lanes, pc);
            if (moved) waits_at.clear();
            waits_at.push_back(pc);
            chosen = false;
            waits = true;
            break;
          }
          i.run(*this, i, lanes);
          ++pc;
          break;
        }
        case Kind::barrier:
          put(lanes, pc);
          at_barrier |= lanes;
          chosen = false;
          break;
        case Kind::call: {
          const Call& call = block->program->calls[i.target];
          if (doing != lanes) throw Hazard("a guarded call is not known here" + place_of(*block, i));
          for (Lanes rest = lanes; rest; rest &= rest - 1) {
            const int lane = std::countr_zero(rest);
            std::byte* params = lane_params.data() + static_cast<std::ptrdiff_t>(lane) * lane_param_bytes;
            for (const Bytes& argument : call.arguments)
              std::memcpy(params + argument.to, params + argument.from, argument.count);
            returns[lane].push_back({pc + 1, i.target});
          }
          pc = call.entry;
          put(lanes, pc);
          chosen = false;
          break;
        }
        case Kind::ret:
        case Kind::end:
          for (Lanes rest = doing; rest; rest &= rest - 1) {
            const int lane = std::countr_zero(rest);
            if (i.kind == Kind::end || returns[lane].empty()) {
              alive &= ~(1u << lane);
              continue;
            }
            const Return back = returns[lane].back();
            returns[lane].pop_back();
            std::byte* params = lane_params.data() + static_cast<std::ptrdiff_t>(lane) * lane_param_bytes;
            const Bytes& result = block->program->calls[back.call].result;
            std::memcpy(params + result.to, params + result.from, result.count);
            at[lane] = back.to;
          }
          put(lanes & ~doing, pc + 1);
          chosen = false;
          break;
      }
      if (!chosen) break;
      moved = true;
      if (pc >= limit) {
        put(lanes, pc);
        chosen = false;
      }
    }
    if (!waits) waits_at.clear();
  }
}

namespace {

/// One warp after the other to the next barrier, until all have ended.
void run_block(Block& block, std::span<Warp> warps) {
  for (;;) {
    bool alive = false;
    for (Warp& warp : warps) {
      warp.run();
      alive |= warp.alive != 0;
    }
    if (!alive) return;
    int barrier = -1;
    bool any = false;
    for (const Warp& warp : warps)
      for (Lanes rest = warp.alive; rest; rest &= rest - 1) {
        const int lane = std::countr_zero(rest);
        if (barrier < 0) barrier = warp.at[lane];
        if (warp.at[lane] != barrier)
          throw Hazard("threads of a block wait at different barriers" + place_of(block, block.program->code[barrier]));
        const Instruction& i = block.program->code[barrier];
        any |= i.from[0] != 0 && (warp.value(i.from[0])[lane] & 1);
      }
    const Instruction& i = block.program->code[barrier];
    for (Warp& warp : warps) {
      for (Lanes rest = warp.alive; rest; rest &= rest - 1) {
        const int lane = std::countr_zero(rest);
        if (i.to[0]) warp.row(i.to[0])[lane] = any;
        warp.at[lane] = barrier + 1;
      }
      warp.at_barrier = 0;
    }
    ++block.phase;
  }
}

}  // namespace

void run_kernel(const Program& program, const Kernel& kernel, Size grid, Size size, std::size_t more_shared,
                const std::byte* params, bool backwards) {
  static std::vector<Warp> warps;
  ++launch;
  const unsigned threads = size.all();
  if (threads == 0 || threads > static_cast<unsigned>(kernel.threads_at_most) || grid.all() == 0)
    throw Hazard("a launch with " + std::to_string(grid.all()) + " blocks of " + std::to_string(threads) + " threads");
  const std::size_t count = (threads + warp_size - 1) / warp_size;
  if (warps.size() < count) warps.resize(count);
  static Block block;
  block.program = &program;
  block.kernel = &kernel;
  block.params = params;
  block.shared.resize((kernel.shared_bytes + more_shared + 15) / 16 * 16);
  if (block.shared.size() > 227 * 1024) throw Hazard("more shared memory than a device has");
  if (watches_races) block.touches.assign(block.shared.size() / 4, {});
  for (std::size_t k = 0; k < count; ++k) {
    Warp& warp = warps[k];
    const std::size_t words = static_cast<std::size_t>(program.registers) * warp_size;
    if (warp.registers.size() < words) warp.registers.resize(words);
    if (warp.local.empty()) warp.local.resize(static_cast<std::size_t>(local_bytes) * warp_size);
    if (warp.lane_params.empty()) warp.lane_params.resize(static_cast<std::size_t>(lane_param_bytes) * warp_size);
    warp.block = &block;
    warp.number = static_cast<int>(k);
    warp.constants = program.constants.data();
    const auto set = [&](Special row, auto of) {
      for (unsigned lane = 0; lane < warp_size; ++lane) warp.row(row)[lane] = of(lane);
    };
    const auto thread = [&](unsigned lane) { return static_cast<unsigned>(k) * warp_size + lane; };
    set(tid_x, [&](unsigned lane) { return thread(lane) % size.x; });
    set(tid_y, [&](unsigned lane) { return thread(lane) / size.x % size.y; });
    set(tid_z, [&](unsigned lane) { return thread(lane) / size.x / size.y; });
    set(ntid_x, [&](unsigned) { return size.x; });
    set(ntid_y, [&](unsigned) { return size.y; });
    set(ntid_z, [&](unsigned) { return size.z; });
    set(nctaid_x, [&](unsigned) { return grid.x; });
    set(nctaid_y, [&](unsigned) { return grid.y; });
    set(nctaid_z, [&](unsigned) { return grid.z; });
    set(laneid, [](unsigned lane) { return lane; });
    set(warpid, [&](unsigned) { return k; });
    set(lanemask_eq, [](unsigned lane) { return 1u << lane; });
    set(lanemask_lt, [](unsigned lane) { return (1u << lane) - 1; });
    set(lanemask_le, [](unsigned lane) { return (2ull << lane) - 1; });
    set(lanemask_gt, [](unsigned lane) { return ~((2ull << lane) - 1) & 0xffffffffu; });
    set(lanemask_ge, [](unsigned lane) { return ~((1u << lane) - 1); });
  }
  const unsigned blocks = grid.all();
  for (unsigned turn = 0; turn < blocks; ++turn) {
    const unsigned b = backwards ? blocks - 1 - turn : turn;
    block.number = b;
    std::fill(block.shared.begin(), block.shared.end(), std::byte{0xff});
    ++block.phase;
    for (std::size_t k = 0; k < count; ++k) {
      Warp& warp = warps[k];
      const unsigned left = threads - static_cast<unsigned>(k) * warp_size;
      warp.alive = left >= warp_size ? all_lanes : (1u << left) - 1;
      warp.at_barrier = 0;
      warp.at.fill(kernel.entry);
      for (auto& stack : warp.returns) stack.clear();
      for (unsigned lane = 0; lane < warp_size; ++lane) {
        warp.row(ctaid_x)[lane] = b % grid.x;
        warp.row(ctaid_y)[lane] = b / grid.x % grid.y;
        warp.row(ctaid_z)[lane] = b / grid.x / grid.y;
      }
    }
    run_block(block, std::span(warps).first(count));
  }
}

}  // namespace ptx
