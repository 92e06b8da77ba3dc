#include "coupling/slab_mail.hpp"

#include <algorithm>
#include <utility>

#include "base/error.hpp"

namespace coupling {

namespace {

constexpr std::size_t longest_message = 1 << 30;  // [bytes] that MPI can count

}  // namespace

SlabMail::SlabMail(MPI_Comm ranks) : ranks_(ranks) {
  MPI_Comm_rank(ranks, &rank_);
  MPI_Comm_size(ranks, &size_);
  awaited_.reserve(16);
  if (size_ == 1) return;
  out_ = {{beside(-1), to_below}, {beside(1), to_above}};
  in_ = {{beside(1), to_below}, {beside(-1), to_above}};
  for (int distance = 1; distance < size_; distance *= 2) {
    out_.push_back({beside(distance), passed_round});
    in_.push_back({beside(-distance), passed_round});
  }
  for (int other = 1; other < size_; ++other) {
    if (rank_ > 0 && rank_ != other) continue;
    const int partner = rank_ == 0 ? other : 0;
    (rank_ == 0 ? in_ : out_).push_back({partner, gathered});
    (rank_ == 0 ? out_ : in_).push_back({partner, handed_out});
  }
}

SlabMail::~SlabMail() { settle_sends(); }

/// From a copy: the sender may leave before it has gone, where the other one has failed.
void SlabMail::send_piece(const void* what, int bytes, int to, int kind) {
  if (sends_ == sent_.size()) sent_.emplace_back();
  Sent& sent = sent_[sends_];
  const auto* first = static_cast<const std::byte*>(what);
  sent.bytes.assign(first, first + bytes);
  MPI_Isend(sent.bytes.data(), bytes, MPI_BYTE, to, kind, ranks_, &sent.request);
  ++sends_;
}

void SlabMail::send(const void* what, std::size_t bytes, int to, Kind kind) {
  for (std::size_t first = 0; first < bytes; first += longest_message)
    send_piece(static_cast<const std::byte*>(what) + first, static_cast<int>(std::min(longest_message, bytes - first)),
               to, kind);
}

void SlabMail::receive(void* to, std::size_t bytes, int from, Kind kind) {
  for (std::size_t first = 0; first < bytes; first += longest_message) {
    Awaited& message = awaited_.emplace_back(Awaited{.from = from, .kind = kind});
    MPI_Irecv(static_cast<std::byte*>(to) + first, static_cast<int>(std::min(longest_message, bytes - first)), MPI_BYTE,
              from, kind, ranks_, &message.request);
  }
}

/// False: what has come is the channel's last message.
bool SlabMail::has_come(Awaited& message) {
  MPI_Status status;
  int bytes = 0, cancelled = 0;
  MPI_Wait(&message.request, &status);
  MPI_Test_cancelled(&status, &cancelled);
  if (cancelled) return true;
  MPI_Get_count(&status, MPI_BYTE, &bytes);
  if (bytes > 0) return true;
  for (Channel& channel : in_)
    if (channel.rank == message.from && channel.kind == message.kind) channel.closed = true;
  return false;
}

void SlabMail::await() {
  const auto last = std::ranges::find_if(awaited_, [&](Awaited& message) { return !has_come(message); });
  const bool all = last == awaited_.end();
  if (!all)  // nothing may come into memory that is about to be left
    for (auto other = last + 1; other != awaited_.end(); ++other) {
      MPI_Cancel(&other->request);
      has_come(*other);
    }
  awaited_.clear();
  if (!all) throw base::UnstableError("stopped with another part of the grains");
  settle_sends();
}

void SlabMail::settle_sends() {
  for (std::size_t k = 0; k < sends_; ++k) MPI_Wait(&sent_[k].request, MPI_STATUS_IGNORE);
  sends_ = 0;
}

void SlabMail::give_up() {
  if (std::exchange(given_up_, true)) return;
  for (Awaited& message : awaited_) {
    MPI_Cancel(&message.request);
    has_come(message);
  }
  awaited_.clear();
  for (const Channel& channel : out_) send_piece(nullptr, 0, channel.rank, channel.kind);
}

void SlabMail::clear() {
  give_up();
  for (Channel& channel : in_) {
    while (!channel.closed) {
      MPI_Status status;
      int bytes = 0;
      MPI_Probe(channel.rank, channel.kind, ranks_, &status);
      MPI_Get_count(&status, MPI_BYTE, &bytes);
      std::vector<std::byte> dropped(static_cast<std::size_t>(bytes));
      MPI_Recv(dropped.data(), bytes, MPI_BYTE, channel.rank, channel.kind, ranks_, MPI_STATUS_IGNORE);
      channel.closed = bytes == 0;
    }
    channel.closed = false;
  }
  settle_sends();
  given_up_ = false;
}

}  // namespace coupling
