#pragma once
// The order in which a device may do what is queued: as late as possible. Work is done when somebody waits for it, and
// then only what that needs: what lies before it in its stream, what events make it wait for, and between the default
// stream and the others what the default stream's rule says.
#include <deque>
#include <functional>
#include <optional>
#include <vector>

namespace ptx {

struct Work {
  std::function<void()> run;
  const void* form = nullptr;  // what a graph of the same form has in the same place
};
/// Everything in a stream up to there.
struct Position {
  int stream = 0;
  long number = 0;
};

class Streams {
 public:
  /// Stream 0 waits for all others and all others for it, where this is so; a capture has no such stream.
  explicit Streams(bool with_default) : with_default_(with_default), streams_(1) {}
  int make() {
    streams_.emplace_back();
    return static_cast<int>(streams_.size()) - 1;
  }
  Position add(int stream, Work work) {
    streams_[static_cast<std::size_t>(stream)].push_back({++number_, std::move(work), {}});
    return {stream, number_};
  }
  void wait(int stream, Position position) {
    streams_[static_cast<std::size_t>(stream)].push_back({++number_, {}, position});
  }
  Position end(int stream) const { return {stream, number_}; }
  void clear() {
    for (auto& stream : streams_) stream.clear();
  }
  /// Does what `to` needs, with `run`, which may clear().
  template <class Run>
  void run_to(Position to, const Run& run) {
    auto* stream = &streams_[static_cast<std::size_t>(to.stream)];
    while (!stream->empty() && stream->front().number <= to.number) {
      const Position here{to.stream, stream->front().number};
      const auto waits = stream->front().waits;
      if (with_default_ && to.stream != 0) run_to({0, here.number}, run);
      if (with_default_ && to.stream == 0)
        for (int other = 1; other < static_cast<int>(streams_.size()); ++other) run_to({other, here.number}, run);
      if (waits) run_to(*waits, run);
      if (stream->empty()) return;
      const Work work = std::move(stream->front().work);
      stream->pop_front();
      if (work.run) run(work);
    }
  }
  template <class Run>
  void run_all(const Run& run) {
    for (int stream = 0; stream < static_cast<int>(streams_.size()); ++stream) run_to(end(stream), run);
  }

 private:
  struct Item {
    long number;
    Work work;
    std::optional<Position> waits;
  };
  bool with_default_;
  std::deque<std::deque<Item>> streams_;  // one may be made while another runs
  long number_ = 0;
};

}  // namespace ptx
