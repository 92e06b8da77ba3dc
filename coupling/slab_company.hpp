#pragma once
// The parts of a simulation as the ranks of a communicator: what dem::Company asks for, by MPI.
#include <mpi.h>

#include "dem/company.hpp"

namespace coupling {

class SlabCompany : public dem::Company {
 public:
  /// Part r is rank r of `ranks`, which must outlive this and carry no other messages while parts work.
  SlabCompany(MPI_Comm ranks, bool ring);

  int part() const override { return part_; }
  int parts() const override { return parts_; }
  bool ring() const override { return ring_; }
  void largest(std::span<double>) override;
  void sum(std::span<double>) override;
  void swap(const std::array<Letter, 2>& out, std::array<Letter, 2>& in) override;
  void swap_known(const std::array<Letter, 2>& out, std::array<Letter, 2>& in) override;

 private:
  int neighbour(Side) const;

  MPI_Comm ranks_;
  int part_ = 0, parts_ = 1;
  bool ring_;
};

}  // namespace coupling
