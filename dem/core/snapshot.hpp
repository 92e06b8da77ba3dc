#pragma once
// Rows on the host for something that is done beside the steps to come. On CUDA they come through pinned memory: the
// copies are queued behind what has been queued, steps that follow are queued behind the copies, and the host waits for
// neither. The device keeps no second copy of anything.
#include <atomic>
#include <deque>
#include <memory>
#include <span>

#include "dem/core/queue.hpp"

namespace dem::TRACKBED_DEM_SYSTEM {

/// Rows at once, by waiting for each. They live as long as this does.
class Downloads {
 public:
  template <class T>
  std::span<const T> operator()(const Vector<T>& rows) {
    const auto host = std::make_shared<const std::vector<T>>(download(rows));
    kept_.push_back(host);
    return *host;
  }

 private:
  std::vector<std::shared_ptr<const void>> kept_;
};

/// Rows that are there after wait(), which any one thread may call. The memory is kept for the next snapshot.
class Snapshot {
 public:
  /// The rows of the snapshot before are no longer needed.
  void begin() {
    arrival_.wait();
    taken_.clear();
  }
  /// The same rows once, however often they are asked for.
  template <class T>
  std::span<const T> take(Queue& queue, const Vector<T>& rows) {
    static_assert(std::is_trivially_copyable_v<T> && alignof(T) <= sizeof(Line));
    const auto* const source = reinterpret_cast<const std::byte*>(pointer(rows));
    std::size_t k = 0;
    while (k < taken_.size() && taken_[k] != source) ++k;
    if (k == rooms_.size()) rooms_.emplace_back();
    if (k == taken_.size()) {
      const std::size_t bytes = rows.size() * sizeof(T);
      Line* const room = rooms_[k].make((bytes + sizeof(Line) - 1) / sizeof(Line));
      queue.fetch(source, reinterpret_cast<std::byte*>(room), bytes);
      taken_.push_back(source);
    }
    return {reinterpret_cast<const T*>(rooms_[k].data()), rows.size()};
  }
  /// All has been taken.
  void end(Queue& queue) { queue.note(arrival_); }
  void wait() { arrival_.wait(); }

 private:
  struct alignas(64) Line {
    std::byte bytes[64];
  };
  std::deque<HostRows<Line>> rooms_;
  std::vector<const std::byte*> taken_;  // the rows that lie in the first rooms
  Arrival arrival_;
};

/// The one that is kept, or a new one while somebody still reads that.
inline std::shared_ptr<Snapshot> begin_snapshot(std::shared_ptr<Snapshot>& kept) {
  if (!kept || kept.use_count() > 1) kept = std::make_shared<Snapshot>();
  std::atomic_thread_fence(std::memory_order_acquire);  // who has read it has let go of it
  kept->begin();
  return kept;
}

}  // namespace dem::TRACKBED_DEM_SYSTEM
