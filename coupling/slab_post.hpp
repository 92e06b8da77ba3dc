#pragma once
// Orders from the first DEM rank to the others and their answers, as bytes. Who waits for an order burns no core. Short
// ones need one message.
#include <mpi.h>

#include <vector>

#include "coupling/bytes.hpp"

namespace coupling {

class SlabPost {
 public:
  explicit SlabPost(MPI_Comm ranks);

  // ---- on the first rank
  void give(const Bytes& order);
  /// To this rank only, which asks for it with own_order().
  void give_to(int rank, const Bytes& order);
  /// The answers to the last order by rank, with this one's own.
  std::vector<Bytes> collect(Bytes own);

  // ---- on the others
  Bytes next_order();
  Bytes own_order();
  void answer(const Bytes&);

  int rank() const { return rank_; }
  int ranks() const { return size_; }

 private:
  MPI_Comm ranks_;
  int rank_ = 0, size_ = 1;
};

}  // namespace coupling
