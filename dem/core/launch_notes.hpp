#pragma once
// What a window of steps launches and copies, as bytes: two windows with the same notes do the same, and one graph
// serves both. Nothing has to know what may change in between: what does is in a functor, an address or a number of
// rows.
#include <cstddef>
#include <type_traits>
#include <vector>

namespace dem {

/// Everything that is queued, to the byte.
class LaunchNotes {
 public:
  /// Whether queue_all() would queue what it did the last time; it is called, but has its calls noted only.
  template <class All>
  bool same_again(const All& queue_all) {
    begin();
    only_notes_ = true;
    queue_all();
    only_notes_ = false;
    return same_again();
  }
  /// Whether a call is to be noted in place of being queued; then it is.
  template <class... T>
  bool takes(const T&... what) {
    if (only_notes_) add(what...);
    return only_notes_;
  }

  template <class... T>
  void add(const T&... values) {
    (add_bytes(values), ...);
  }
  void begin() { now_.clear(); }
  /// Whether it is what was noted before; from now on this is.
  bool same_again() {
    const bool same = now_ == before_ && !now_.empty();
    before_.swap(now_);
    return same;
  }

 private:
  std::vector<std::byte> now_, before_;
  bool only_notes_ = false;

  template <class T>
  void add_bytes(T value) {
    static_assert(std::is_trivially_copyable_v<T>);
#if __has_builtin(__builtin_clear_padding)
    __builtin_clear_padding(&value);
#endif
    const auto* bytes = reinterpret_cast<const std::byte*>(&value);
    now_.insert(now_.end(), bytes, bytes + sizeof value);
  }
};
/// Its address stands for the type.
template <class T>
inline constexpr char mark_of = 0;

}  // namespace dem
