#pragma once
// The energy balance of the whole scene, closed from both sides' ledgers. Every term is integrated by the side that
// owns it; the residual is what is left over, and is never booked anywhere.
//   residual = [stored - stored at the start] - (work of gravity, loads, moving walls) + losses
// The interface does no work on the whole: what one side gives the other takes, so any mismatch of the two views shows
// in the residual.
#include "base/energy.hpp"

namespace coupling {

struct Sides {
  base::Energy grains, bodies;
};

class Ledger {
 public:
  /// Zero of the balance: call right after the sides' own reset.
  void start(const Sides&);
  void add(const Sides&);

  double residual() const { return residual_; }            // [J] at the last add()
  double external_work() const { return work_; }           // [J] largest |loads| + |gravity| + |walls| so far
  double interface_mismatch() const { return mismatch_; }  // [J] sum of both sides' views at the last add()
  double stored_at_start() const { return start_.grains.stored() + start_.bodies.stored(); }  // [J]
  /// Largest |residual| so far over the largest external work so far; over the energy at the start where less than
  /// a millionth of it was done as work.
  double relative_error() const;
  const Sides& last() const { return last_; }

 private:
  Sides start_, last_;
  double residual_ = 0, largest_residual_ = 0, work_ = 0, mismatch_ = 0;
};

}  // namespace coupling
