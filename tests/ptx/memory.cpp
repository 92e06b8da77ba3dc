#include "tests/ptx/memory.hpp"

#include <sys/mman.h>

#include <algorithm>
#include <map>
#include <mutex>
#include <new>

namespace ptx::memory {
namespace {

std::byte* reserve_with(std::size_t bytes, int access) {
  void* memory = mmap(nullptr, bytes, access, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (memory == MAP_FAILED) throw std::bad_alloc();
  return static_cast<std::byte*>(memory);
}

class Region {
 public:
  explicit Region(bool device)
      : bytes_(reserve_with(room, PROT_READ | PROT_WRITE)),
        state_(reinterpret_cast<std::uint8_t*>(reserve_with(room, PROT_READ | PROT_WRITE))),
        begin_(reinterpret_cast<std::uint64_t>(device ? reserve_with(room, PROT_NONE) : bytes_)) {
    if (device) device_place = {begin_, bytes_, state_};
  }
  bool has(std::uint64_t address) const { return address - begin_ < room; }
  std::uint64_t allocate(std::size_t bytes, std::size_t align, State state) {
    next_ = (next_ + align - 1) / align * align;
    if (bytes > room - next_ || in_use_ + bytes > device_bytes) throw std::bad_alloc();
    const std::uint64_t address = begin_ + next_;
    std::memset(bytes_ + next_, 0xff, bytes);
    std::memset(state_ + next_, state, bytes);
    sizes_[address] = bytes;
    next_ += bytes + 512;
    in_use_ += bytes;
    return address;
  }
  bool free(std::uint64_t address) {
    const auto found = sizes_.find(address);
    if (found == sizes_.end()) return false;
    const std::size_t first = address - begin_, bytes = found->second;
    std::memset(state_ + first, nobodys, bytes);
    constexpr std::size_t page = 4096;
    const std::size_t from = (first + page - 1) / page * page, to = (first + bytes) / page * page;
    if (from < to) {
      madvise(bytes_ + from, to - from, MADV_DONTNEED);
      madvise(state_ + from, to - from, MADV_DONTNEED);
    }
    in_use_ -= bytes;
    sizes_.erase(found);
    return true;
  }
  std::byte* at(std::uint64_t address, std::size_t bytes, Access access, Fault& fault) {
    const std::size_t first = address - begin_;
    std::uint8_t* state = state_ + first;
    for (std::size_t k = 0; k < bytes; ++k)
      if (state[k] == nobodys) {
        fault = Fault::outside;
        return nullptr;
      }
    if (access == Access::write)
      std::memset(state, written, bytes);
    else
      for (std::size_t k = 0; k < bytes; ++k)
        if (state[k] != written) fault = Fault::unwritten;
    return bytes_ + first;
  }
  std::size_t in_use() const { return in_use_; }

 private:
  static constexpr std::size_t device_bytes = 16ull << 30;
  std::byte* bytes_;
  std::uint8_t* state_;
  std::uint64_t begin_;
  std::size_t next_ = 4096, in_use_ = 0;
  std::map<std::uint64_t, std::size_t> sizes_;
};

Region& device() {
  static Region region(true);
  return region;
}
Region& pinned() {
  static Region region(false);
  return region;
}

}  // namespace

Place device_place{~0ull, nullptr, nullptr};

std::byte* reserve(std::size_t bytes) { return reserve_with(bytes, PROT_READ | PROT_WRITE); }

std::uint64_t allocate(std::size_t bytes, std::size_t align) { return device().allocate(bytes, align, given); }
bool free(std::uint64_t address) { return device().free(address); }
void copy_state(std::uint64_t to, std::uint64_t from, std::size_t bytes) {
  if (!is_device(to) || !is_device(from)) return;
  std::memcpy(device_place.state + (to - device_place.begin), device_place.state + (from - device_place.begin), bytes);
}
void* allocate_host(std::size_t bytes) {
  return reinterpret_cast<void*>(pinned().allocate(bytes, 512, written));  // NOLINT: what the host writes is not seen
}
void free_host(void* address) { pinned().free(reinterpret_cast<std::uint64_t>(address)); }
bool is_device(std::uint64_t address) { return device().has(address); }
bool is_pinned(std::uint64_t address) { return pinned().has(address); }
std::size_t bytes_in_use() { return device().in_use(); }

std::byte* at(std::uint64_t address, std::size_t bytes, Access access, Fault& fault) {
  fault = Fault::none;
  if (device().has(address)) return device().at(address, bytes, access, fault);
  if (pinned().has(address)) return pinned().at(address, bytes, access, fault);
  fault = Fault::outside;
  return nullptr;
}

}  // namespace ptx::memory
