#pragma once
// Load on one sleeper as axles roll over a rail on an elastic foundation (Zimmermann/Winkler).
//   Q_S(t) = s Q (k_eq / K) sum over axles of e^(-xi) (cos xi + sin xi),   xi = |x - v t| / L
// Irazabal2017 eq. 7.13 (from 7.8 and 7.12), summed over axles because the rail is linear.
//   Q axle load [N], k_eq bearing stiffness [N/m], K track stiffness [N/m], L elastic length [m], v speed [m/s],
//   x distance of an axle from the sleeper at t = 0 [m], positive while it still has to come, s share of this load
//   (0.5: one of two rail seats).
// Differs from the source: a factor r^2 (3 - 2 r), r = t / ramp in [0, 1], brings the load in from exactly zero with
// zero slope, because the tail of 7.13 is not zero at t = 0. ramp = 0: no such factor.
// With Q = 168 732 N, k_eq = 33.58 kN/mm, K = 75 kN/mm a lone axle above the sleeper gives 75.55 kN. The 73 882 N
// printed in eq. 7.16 does not follow from its own inputs (168 732 * 33.58 / 75 = 75 547). Valid for a quasi-static
// rail: no inertia of rail or wheel, no sleeper passing, no irregularity. Negative (uplift) beyond xi = 3 pi / 4, at
// most 4.3 % of the peak.
#include <algorithm>
#include <cmath>
#include <vector>

#include "base/history.hpp"
#include "base/parameter.hpp"

namespace base::histories {

class Axles final : public History {
 public:
  static Table declaration(const std::string&) {
    return {
        "axles",
        "load on one sleeper under rolling axles, Irazabal2017 eq. 7.13",
        {real("axle_load", "N", "Q, load of every axle").at_least(0),
         real("share", "", "share of the sleeper's load that this load carries").at_least(0).at_most(1).otherwise(1.0),
         real("speed", "m/s", "v, speed of the train").above(0),
         reals("positions", "m", "x, distance of each axle from the sleeper at time zero, > 0: still to come"),
         real("track_stiffness", "N/m", "K, axle load over rail deflection").above(0),
         real("bearing_stiffness", "N/m", "k_eq, sleeper load over rail deflection").above(0),
         real("elastic_length", "m", "L").above(0),
         real("ramp", "s", "time over which the load is brought in from zero").at_least(0).otherwise(0.0)}};
  }
  explicit Axles(const Value& checked)
      : peak_(checked.at("share").real() * checked.at("axle_load").real() * checked.at("bearing_stiffness").real() /
              checked.at("track_stiffness").real()),
        speed_(checked.at("speed").real()),
        elastic_length_(checked.at("elastic_length").real()),
        ramp_(checked.at("ramp").real()),
        positions_(checked.at("positions").reals()) {}

  double value(double time) const override {
    double sum = 0;
    for (const double x : positions_) {
      const double xi = std::abs(x - speed_ * time) / elastic_length_;
      sum += std::exp(-xi) * (std::cos(xi) + std::sin(xi));
    }
    const double r = ramp_ > 0 ? std::clamp(time / ramp_, 0.0, 1.0) : 1.0;
    return peak_ * sum * r * r * (3 - 2 * r);
  }

 private:
  double peak_;                    // [N] of one axle above the sleeper
  double speed_, elastic_length_;  // [m/s] [m]
  double ramp_;                    // [s]
  std::vector<double> positions_;  // [m]
};

}  // namespace base::histories
