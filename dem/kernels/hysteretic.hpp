#pragma once
// Hertz contact whose damping goes with the elastic force and the approach speed (Hunt-Crossley form).
//
//   F_h = 2/3 k_n overlap,  k_n = 2 E* a,  a = sqrt(R* overlap)                                   (8)
//   F_n = max(0, F_h (1 - D v_n / v_impact))                                                      (14, 15)
//   k_s = 8 G* a,  |F_s| <= mu F_n                                                                (10-13)
//   D = (1 - e^2) / e  |  3/4 (1 - e^2)  |  3/4 (1 - e^2) exp(2 (1 - e))         mode 0, 1, 2      (16)
// Source: Talebiahooie, Thiery, Meng, Mattsson, Nordlund, Rantatalo 2021 (Sustainability 13, 12247), eqs. 8-16, after
// Gonthier 2007, Lankarani and Nikravesh 1990, Zhiying and Qishao 2006. Eqs. 8 and 11 with their effective radius 2 R*
// are the forms written here.
//
// What e the law returns: m v dv = -F_h (1 - D v / v_impact) d(overlap) gives D (1 + e') = ln((1 + D) / (1 - D e')),
// whatever the speed, mass and material. e' is not the e of eq. 16: modes 0, 1, 2 return 0.488, 0.725, 0.483 for 0.5.
// dem/law_parameters.hpp: hysteretic_restitution().
//
// Where we differ from the source:
// - v_impact is the largest approach speed that the contact has seen, not the first. In a free impact they are one. In
//   a packing a contact may form slowly and be struck later: with the first speed the damping has no bound;
// - eq. 12 limits friction by F_h; here by F_n;
// - the shear spring gives way when the patch shrinks (shear.hpp), so that no cycle gains energy;
// - the normal force is clamped at zero (never reached in a free impact).
// Shear onset as eq. 3: "the same procedure as the linear shear force".
#include "dem/kernels/onset.hpp"
#include "dem/kernels/pair_parameters.hpp"
#include "dem/kernels/shear.hpp"

namespace dem::kernels {

struct Hysteretic {
  static constexpr int history = 5;  // largest approach speed [m/s], then as HertzMindlin

  template <bool Ledger, class Real>
  TRACKBED_HD TRACKBED_LANES static Reaction<Real> press(const PairParameters& pair, const Touch<Real>& touch,
                                                         const Interval& time, Real* history) {
    const auto touching = touch.overlap > Real{};
    const Real overlap = choose(touching, touch.overlap, Real{});
    const Real patch_radius = square_root(touch.effective_radius * overlap);
    const Real elastic = all<Real>(4.0 / 3.0 * pair.effective_young_modulus) * patch_radius * overlap;
    NormalForce<Real> normal;
    normal.separation = dot(touch.velocity, touch.normal);
    const Real impact = choose(touching, larger(history[0], -normal.separation), Real{});
    history[0] = impact;
    const auto struck = impact > Real{};
    const Real speed_share = choose(struck, normal.separation, Real{}) / choose(struck, impact, all<Real>(1));
    normal.force = larger(elastic - all<Real>(pair.hysteretic_damping) * elastic * speed_share, Real{});
    normal.shear_stiffness = all<Real>(8 * pair.effective_shear_modulus) * patch_radius;
    normal.damping = Real{};
    normal.stored = all<Real>(0.4) * elastic * overlap;
    normal.lost_power = (elastic - normal.force) * normal.separation;
    shear_onset(normal, touch, onset(touch, normal.separation, time), time, history + 1);
    return sheared<Ledger>(normal, all<Real>(pair.friction), 0, touch, time, history + 1);
  }
};

}  // namespace dem::kernels
