#pragma once
// Memory of the pretended device. Its addresses are no addresses of the host, so that a host that reads them falls
// over; every byte of the device knows whether it is allocated and whether something was written to it, of page-locked
// memory whether it is allocated. Nothing is given out twice, so that a use after freeing is found.
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace ptx::memory {

enum class Access { read, write };

/// Where the device's bytes and what is known of each lie on the host.
struct Place {
  std::uint64_t begin;
  std::byte* bytes;
  std::uint8_t* state;
};
constexpr std::size_t room = 48ull << 30;  // of addresses; memory is taken as it is touched
enum State : std::uint8_t { nobodys, given, written };
extern Place device_place;  // from the first allocation on

/// What is written already may be read and written again without more ado: its place, else null.
inline std::byte* written_at(std::uint64_t address, int bytes) {
  const std::uint64_t first = address - device_place.begin;
  if (first >= room) return nullptr;
  const std::uint8_t* state = device_place.state + first;
  constexpr std::uint64_t all = 0x0202020202020202u;
  std::uint64_t found = all;
  switch (bytes) {
    case 16:
      std::memcpy(&found, state + 8, 8);
      if (found != all) return nullptr;
      [[fallthrough]];
    case 8:
      std::memcpy(&found, state, 8);
      break;
    case 4:
      std::memcpy(&found, state, 4);
      break;
    case 2:
      std::memcpy(&found, state, 2);
      break;
    case 1:
      std::memcpy(&found, state, 1);
      break;
    default:
      return nullptr;
  }
  return found == all ? device_place.bytes + first : nullptr;
}

/// Zeros that take memory as they are touched. Throws std::bad_alloc, as the next do.
std::byte* reserve(std::size_t bytes);
std::uint64_t allocate(std::size_t bytes, std::size_t align = 512);
/// False where nothing was allocated.
bool free(std::uint64_t address);
/// Page-locked: the host's addresses are the device's.
void* allocate_host(std::size_t bytes);
void free_host(void* address);
bool is_device(std::uint64_t address), is_pinned(std::uint64_t address);
std::size_t bytes_in_use();
/// After a copy within the device: what was not written there is not written here.
void copy_state(std::uint64_t to, std::uint64_t from, std::size_t bytes);

enum class Fault { none, outside, unwritten };
/// Where the host finds it. `outside`: not allocated (the pointer is null); `unwritten`: read before anything was
/// written.
std::byte* at(std::uint64_t address, std::size_t bytes, Access access, Fault& fault);

}  // namespace ptx::memory
