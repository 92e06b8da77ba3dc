#pragma once
// Hertz normal force (hertz.hpp) with Mindlin's incremental tangential force in Thornton's no-slip form (shear.hpp) and
// Coulomb friction: the standard law for ballast. Source: Irazabal Gonzalez 2017, section 3.2.3.
#include "dem/kernels/hertz.hpp"
#include "dem/kernels/shear.hpp"

namespace dem::kernels {

struct HertzMindlin {
  static constexpr int history = 4;  // shear force, half a step ahead [N], shear stiffness [N/m]

  template <bool Ledger, class Real>
  TRACKBED_HD TRACKBED_LANES static Reaction<Real> press(const PairParameters& pair, const Touch<Real>& touch,
                                                         const Interval& time, Real* history) {
    return sheared<Ledger>(hertz(pair, touch), all<Real>(pair.friction), pair.shear_damping, touch, time, history);
  }
};

/// The same without friction: no tangential force, nothing kept.
struct HertzSmooth {
  static constexpr int history = 0;

  template <bool Ledger, class Real>
  TRACKBED_HD TRACKBED_LANES static Reaction<Real> press(const PairParameters& pair, const Touch<Real>& touch,
                                                         const Interval& time, [[maybe_unused]] Real* history) {
    const auto touching = touch.overlap > all<Real>(0);
    const NormalForce<Real> normal = hertz(pair, touch);
    Reaction<Real> result;
    result.normal_force = choose(touching, normal.force, Real{});
    result.force = result.normal_force * touch.normal;
    if constexpr (Ledger) {
      result.elastic_normal = choose(touching, normal.stored, Real{});
      result.loss_damping = choose(touching, all<Real>(time.before + time.ahead) * normal.lost_power, Real{});
      history[0] = Real{};
    }
    return result;
  }
};

}  // namespace dem::kernels
