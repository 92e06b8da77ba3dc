#pragma once
// The parts of a simulation as the ranks of a communicator: what dem::Company asks for, by MPI.
#include "coupling/slab_mail.hpp"
#include "dem/company.hpp"

namespace coupling {

class SlabCompany : public dem::Company {
 public:
  /// Part r is rank r of the mail's communicator.
  SlabCompany(SlabMail& mail, bool ring) : mail_(mail), ring_(ring) {}

  int part() const override { return mail_.rank(); }
  int parts() const override { return mail_.ranks(); }
  bool ring() const override { return ring_; }
  void largest(std::span<double>) override;
  void sum(std::span<double>) override;
  void swap(const std::array<Letter, 2>& out, std::array<Letter, 2>& in) override;
  void swap_known(const std::array<Letter, 2>& out, std::array<Letter, 2>& in) override;

 private:
  int neighbour(Side side) const { return mail_.beside(side == above ? 1 : -1); }

  SlabMail& mail_;
  bool ring_;
  std::vector<double> theirs_;
};

}  // namespace coupling
