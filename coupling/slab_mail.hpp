#pragma once
// Messages between the parts of a simulation, over channels: from one rank to another, of one kind, in order.
//
// A part that fails alone (out of memory, say) must not leave the others waiting for it. One that gives up puts an
// empty message, its last, on all its channels; whoever waits there finds it in place of what he waits for, and gives
// up likewise. When all know that one has failed, clear() empties the channels up to that last message, and they are
// as new.
#include <mpi.h>

#include <cstddef>
#include <vector>

namespace coupling {

class SlabMail {
 public:
  enum Kind : int { to_below = 51, to_above = 52, passed_round = 53, gathered = 54, handed_out = 55 };

  /// `ranks` must outlive this and carry no other messages.
  explicit SlabMail(MPI_Comm ranks);
  ~SlabMail();
  SlabMail(const SlabMail&) = delete;
  SlabMail& operator=(const SlabMail&) = delete;

  int rank() const { return rank_; }
  int ranks() const { return size_; }
  /// The rank so many places above this one, round a ring.
  int beside(int places) const { return (rank_ + size_ + places) % size_; }

  /// What goes out is copied first. Nothing is sent or received where there are no bytes. Send before you receive:
  /// what may fail comes first, so that nothing comes into memory that has been left.
  void send(const void* what, std::size_t bytes, int to, Kind);
  void receive(void* to, std::size_t bytes, int from, Kind);
  /// Until all of that is done. Throws base::UnstableError where somebody has given up whose message is waited for.
  void await();

  /// This part has failed, or another one: nobody waits for it any more. Does not wait itself.
  void give_up();
  /// After any part has failed, on all of them.
  void clear();

 private:
  struct Channel {
    int rank = 0, kind = 0;  // to or from
    bool closed = false;     // its last message has come
  };
  struct Sent {
    MPI_Request request = MPI_REQUEST_NULL;
    std::vector<std::byte> bytes;
  };
  struct Awaited {
    MPI_Request request = MPI_REQUEST_NULL;
    int from = 0, kind = 0;
  };
  void send_piece(const void* what, int bytes, int to, int kind);
  bool has_come(Awaited&);
  void settle_sends();

  MPI_Comm ranks_;
  int rank_ = 0, size_ = 1;
  bool given_up_ = false;
  std::vector<Channel> in_, out_;
  std::vector<Awaited> awaited_;
  std::vector<Sent> sent_;
  std::size_t sends_ = 0;  // of sent_ on their way
};

}  // namespace coupling
