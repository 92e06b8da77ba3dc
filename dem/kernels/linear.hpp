#pragma once
// Linear springs with a viscous dashpot and Coulomb friction; a damping ratio of 0 leaves the dashpot out.
//
//   F_n = max(0, k_n overlap - c_n v_n),  c_n = 2 beta sqrt(m* k_n)                               (1, 6, 7)
//   F_s = F_s(last) - k_s (tangential displacement), |F_s| <= mu F_n                               (2-5)
// Source: Talebiahooie, Thiery, Meng, Mattsson, Nordlund, Rantatalo 2021 (Sustainability 13, 12247), eqs. 1-7.
// Where we differ from the source:
// - the dashpot never pulls: the total normal force is clamped at zero (dry stones do not attract). The restitution is
//   then e = exp(-2 beta acos(beta) / sqrt(1 - beta^2)), which is Irazabal2017 3.17 (dem/law_parameters.hpp);
// - eq. 4 limits friction by the spring's force alone; here by the total. Without a dashpot, as there, it is the same;
// - the dashpot of a contact that forms within a step acts for its part of the step (onset.hpp), as eq. 3 has it for
//   the shear spring;
// - a tangential dashpot, which eqs. 1-7 leave out, comes with shear_damping > 0.
// Limits: stiffnesses belong to the pair of materials, whatever the radii.
#include "dem/kernels/onset.hpp"
#include "dem/kernels/pair_parameters.hpp"
#include "dem/kernels/shear.hpp"

namespace dem::kernels {

/// Springs k_n, k_s and a dashpot c_n [N s/m] that cannot pull.
template <class Real>
TRACKBED_HD TRACKBED_LANES NormalForce<Real> linear_springs(const PairParameters& pair, Real c_n,
                                                            const Touch<Real>& touch) {
  const auto touching = touch.overlap > Real{};
  const Real overlap = choose(touching, touch.overlap, Real{});
  NormalForce<Real> normal;
  normal.separation = dot(touch.velocity, touch.normal);
  const Real elastic = all<Real>(pair.normal_stiffness) * overlap;
  normal.force = choose(touching, larger(elastic - c_n * normal.separation, Real{}), Real{});
  normal.shear_stiffness = choose(touching, all<Real>(pair.shear_stiffness), Real{});
  normal.damping = c_n;
  normal.stored = all<Real>(0.5) * elastic * overlap;
  normal.lost_power = (elastic - normal.force) * normal.separation;
  return normal;
}

struct Linear {
  static constexpr int history = 4;  // as HertzMindlin

  template <bool Ledger, class Real>
  TRACKBED_HD TRACKBED_LANES static Reaction<Real> press(const PairParameters& pair, const Touch<Real>& touch,
                                                         const Interval& time, Real* history) {
    const Real c_n =
        all<Real>(2 * pair.damping_ratio) * square_root(all<Real>(pair.normal_stiffness) * touch.effective_mass);
    const Onset<Real> begins = onset(touch, dot(touch.velocity, touch.normal), time);
    const NormalForce<Real> normal = linear_springs(pair, c_n * begins.weight, touch);
    shear_onset(normal, touch, begins, time, history);
    return sheared<Ledger>(normal, all<Real>(pair.friction), pair.shear_damping, touch, time, history);
  }
};

}  // namespace dem::kernels
