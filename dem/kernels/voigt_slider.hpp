#pragma once
// Voigt elements (spring beside dashpot) in both directions, the tangential one behind a frictional slider.
//
//   F_n = max(0, k_n overlap - c_n v_n)
//   F_t = - k_t (tangential displacement) - c_t v_t,  |F_t| <= mu F_n
// Source: Nishiura, Sakaguchi, Aikawa 2017 (Materials 10, 615), section 4 and Table 1: there c_n = c_t = 0, because the
// grains themselves are viscous, and k_t = k_n / 2 (1 + nu).
// Where we differ: the total normal force is clamped at zero; when the slider slips, the spring is held on the cone
// first and the dashpot gets what is left (shear.hpp). The paper has no equation for either.
// Against linear.hpp: dashpots in N s/m instead of shares of critical damping, and no rule for the onset of the shear
// spring.
#include "dem/kernels/linear.hpp"

namespace dem::kernels {

struct VoigtSlider {
  static constexpr int history = 4;  // as HertzMindlin

  template <bool Ledger, class Real>
  TRACKBED_HD TRACKBED_LANES static Reaction<Real> press(const PairParameters& pair, const Touch<Real>& touch,
                                                         const Interval& time, Real* history) {
    const Real weight = onset(touch, dot(touch.velocity, touch.normal), time).weight;
    NormalForce<Real> normal = linear_springs(pair, all<Real>(pair.normal_viscosity) * weight, touch);
    normal.damping = all<Real>(pair.shear_viscosity) * weight;
    return sheared<Ledger>(normal, all<Real>(pair.friction), 1, touch, time, history);
  }
};

}  // namespace dem::kernels
