#include "coupling/ledger.hpp"

#include <algorithm>
#include <cmath>

namespace coupling {

void Ledger::start(const Sides& sides) {
  *this = Ledger{};
  start_ = last_ = sides;
}

void Ledger::add(const Sides& sides) {
  last_ = sides;
  const auto external = [](const base::Energy& e) { return e.work_gravity + e.work_loads + e.work_walls; };
  const auto magnitude = [](const base::Energy& e) {
    return std::abs(e.work_gravity) + std::abs(e.work_loads) + std::abs(e.work_walls);
  };
  const auto balance = [&](const base::Energy& now, const base::Energy& then) {
    return now.stored() - then.stored() - external(now) + external(then) + now.losses() - then.losses();
  };
  residual_ = balance(sides.grains, start_.grains) + balance(sides.bodies, start_.bodies);
  mismatch_ = sides.grains.work_interface + sides.bodies.work_interface - start_.grains.work_interface -
              start_.bodies.work_interface;
  largest_residual_ = std::max(largest_residual_, std::abs(residual_));
  work_ = std::max(work_, magnitude(sides.grains) + magnitude(sides.bodies));
}

double Ledger::relative_error() const {
  constexpr double to_speak_of =
      1e-6;  // a body let go keeps its energy; the last of its load's work is next to nothing
  const double stored = stored_at_start(), scale = work_ > to_speak_of * stored ? work_ : stored;
  return scale > 0 ? largest_residual_ / scale : 0;
}

}  // namespace coupling
