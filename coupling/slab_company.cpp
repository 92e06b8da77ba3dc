#include "coupling/slab_company.hpp"

#include <algorithm>
#include <cstdint>

namespace coupling {

namespace {

constexpr std::size_t longest_message = 1 << 30;  // [bytes] that MPI can count

constexpr int opposite(int side) { return 1 - side; }

/// Messages that go up and those that go down are told apart even where both neighbours are one.
constexpr int tag(int side_it_goes_to) { return 51 + side_it_goes_to; }

class Messages {
 public:
  explicit Messages(MPI_Comm ranks) : ranks_(ranks) {}
  ~Messages() { MPI_Waitall(static_cast<int>(requests_.size()), requests_.data(), MPI_STATUSES_IGNORE); }
  Messages(const Messages&) = delete;
  Messages& operator=(const Messages&) = delete;

  void receive(void* to, std::size_t bytes, int from, int tag) {
    pieces(bytes, [&](std::size_t first, int length) {
      MPI_Irecv(static_cast<std::byte*>(to) + first, length, MPI_BYTE, from, tag, ranks_, &requests_.emplace_back());
    });
  }
  void send(const void* what, std::size_t bytes, int to, int tag) {
    pieces(bytes, [&](std::size_t first, int length) {
      MPI_Isend(static_cast<const std::byte*>(what) + first, length, MPI_BYTE, to, tag, ranks_,
                &requests_.emplace_back());
    });
  }

 private:
  template <class Transfer>
  static void pieces(std::size_t bytes, const Transfer& transfer) {
    for (std::size_t first = 0; first < bytes; first += longest_message)
      transfer(first, static_cast<int>(std::min(longest_message, bytes - first)));
  }
  MPI_Comm ranks_;
  std::vector<MPI_Request> requests_;
};

}  // namespace

SlabCompany::SlabCompany(MPI_Comm ranks, bool ring) : ranks_(ranks), ring_(ring) {
  MPI_Comm_rank(ranks, &part_);
  MPI_Comm_size(ranks, &parts_);
}

int SlabCompany::neighbour(Side side) const { return (part_ + (side == above ? 1 : parts_ - 1)) % parts_; }

void SlabCompany::largest(std::span<double> values) {
  MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_DOUBLE, MPI_MAX, ranks_);
}

/// In one place and then handed out: an Allreduce may add in another order on every rank.
void SlabCompany::sum(std::span<double> values) {
  const int count = static_cast<int>(values.size());
  if (part_ == 0)
    MPI_Reduce(MPI_IN_PLACE, values.data(), count, MPI_DOUBLE, MPI_SUM, 0, ranks_);
  else
    MPI_Reduce(values.data(), nullptr, count, MPI_DOUBLE, MPI_SUM, 0, ranks_);
  MPI_Bcast(values.data(), count, MPI_DOUBLE, 0, ranks_);
}

void SlabCompany::swap(const std::array<Letter, 2>& out, std::array<Letter, 2>& in) {
  std::array<std::uint64_t, 2> leaving{out[below].size(), out[above].size()}, coming{};
  {
    Messages messages(ranks_);
    for (const Side side : {below, above}) {
      if (!has(side)) continue;
      messages.receive(&coming[side], sizeof coming[side], neighbour(side), tag(opposite(side)));
      messages.send(&leaving[side], sizeof leaving[side], neighbour(side), tag(side));
    }
  }
  for (const Side side : {below, above}) in[side].resize(coming[side]);
  swap_known(out, in);
}

void SlabCompany::swap_known(const std::array<Letter, 2>& out, std::array<Letter, 2>& in) {
  Messages messages(ranks_);
  for (const Side side : {below, above})
    if (has(side)) messages.receive(in[side].data(), in[side].size(), neighbour(side), tag(opposite(side)));
  for (const Side side : {below, above})
    if (has(side)) messages.send(out[side].data(), out[side].size(), neighbour(side), tag(side));
}

}  // namespace coupling
