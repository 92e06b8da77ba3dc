#include "coupling/slab_post.hpp"

#include <algorithm>

#include "coupling/agree.hpp"

namespace coupling {

namespace {

constexpr int rest_tag = 61, own_tag = 62;

/// The first part of every message; what does not go into it follows.
struct Head {
  std::uint64_t size = 0;
  std::array<std::byte, 1016> first{};

  Head() = default;
  explicit Head(const Bytes& bytes) : size(bytes.size()) { std::copy_n(bytes.data(), here(), first.data()); }
  std::size_t here() const { return std::min<std::size_t>(size, first.size()); }
  Bytes begun() const {
    Bytes bytes(size);
    std::copy_n(first.data(), here(), bytes.data());
    return bytes;
  }
};

/// In pieces that MPI can count.
template <class Some, class Transfer>
void rest_of(const Head& head, Some& bytes, const Transfer& transfer) {
  constexpr std::size_t largest = 1 << 30;
  for (std::size_t first = head.here(); first < bytes.size(); first += largest)
    transfer(bytes.data() + first, static_cast<int>(std::min(largest, bytes.size() - first)));
}

void broadcast(Head& head, MPI_Comm ranks) {
  MPI_Request request;
  MPI_Ibcast(&head, sizeof head, MPI_BYTE, 0, ranks, &request);
  wait_politely(request);
}

}  // namespace

SlabPost::SlabPost(MPI_Comm ranks) : ranks_(ranks) {
  MPI_Comm_rank(ranks, &rank_);
  MPI_Comm_size(ranks, &size_);
}

void SlabPost::give(const Bytes& order) {
  Head head(order);
  broadcast(head, ranks_);
  rest_of(head, order, [&](const std::byte* from, int count) {
    MPI_Bcast(const_cast<std::byte*>(from), count, MPI_BYTE, 0, ranks_);  // which only reads it here
  });
}

Bytes SlabPost::next_order() {
  Head head;
  broadcast(head, ranks_);
  Bytes order = head.begun();
  rest_of(head, order, [&](std::byte* to, int count) { MPI_Bcast(to, count, MPI_BYTE, 0, ranks_); });
  return order;
}

void SlabPost::give_to(int rank, const Bytes& order) {
  const Head head(order);
  MPI_Send(&head, sizeof head, MPI_BYTE, rank, own_tag, ranks_);
  rest_of(head, order,
          [&](const std::byte* from, int count) { MPI_Send(from, count, MPI_BYTE, rank, own_tag, ranks_); });
}

Bytes SlabPost::own_order() {
  Head head;
  MPI_Recv(&head, sizeof head, MPI_BYTE, 0, own_tag, ranks_, MPI_STATUS_IGNORE);
  Bytes order = head.begun();
  rest_of(head, order,
          [&](std::byte* to, int count) { MPI_Recv(to, count, MPI_BYTE, 0, own_tag, ranks_, MPI_STATUS_IGNORE); });
  return order;
}

std::vector<Bytes> SlabPost::collect(Bytes own) {
  const Head mine;
  std::vector<Head> heads(static_cast<std::size_t>(size_));
  MPI_Request request;
  MPI_Igather(&mine, sizeof mine, MPI_BYTE, heads.data(), sizeof mine, MPI_BYTE, 0, ranks_, &request);
  wait_politely(request);
  std::vector<Bytes> answers{std::move(own)};
  for (int r = 1; r < size_; ++r) {
    const Head& head = heads[static_cast<std::size_t>(r)];
    rest_of(head, answers.emplace_back(head.begun()),
            [&](std::byte* to, int count) { MPI_Recv(to, count, MPI_BYTE, r, rest_tag, ranks_, MPI_STATUS_IGNORE); });
  }
  return answers;
}

void SlabPost::answer(const Bytes& bytes) {
  const Head head(bytes);
  MPI_Request request;
  MPI_Igather(&head, sizeof head, MPI_BYTE, nullptr, 0, MPI_BYTE, 0, ranks_, &request);
  wait_politely(request);
  rest_of(head, bytes, [&](const std::byte* from, int count) { MPI_Send(from, count, MPI_BYTE, 0, rest_tag, ranks_); });
}

}  // namespace coupling
