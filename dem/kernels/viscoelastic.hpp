#pragma once
// Hertz contact of viscoelastic spheres.
//
//   F_el = 2/3 k_n overlap,  k_n = d F_el / d overlap = 2 E* sqrt(R* overlap)
//   F_n = max(0, F_el - A k_n v_n)                                                                (5)
// Source: Schwager, Pöschel 2002 (rigid-body dynamics of railway ballast), eqs. 4, 5; Li, Yan, Shao, Ji 2021
// (doi:10.32604/cmes.2021.013674), eq. 1 (F_n = K x^1.5 + 3/2 A K x^0.5 dx/dt, the same); after Brilliantov et al. 1996
// and Ramirez et al. 1999 (doi:10.1103/PhysRevE.60.4465). Where we differ: the total is clamped at zero. Li2021 calls A
// dimensionless; eq. 1 makes it a time. The tangential force is Mindlin's on the Coulomb cone (shear.hpp) without a
// dashpot, as in Li2021.
//
// Restitution falls with the speed: e = 1 - C1 b + 3/5 C1^2 b^2 -+ ...,  C1 = 1.15344,
// b = 3/2 A (rho / m*)^(2/5) v^(1/5),  rho = 4/3 E* sqrt(R*): quasi-static, so A must be well below the contact time.
#include "dem/kernels/pair_parameters.hpp"
#include "dem/kernels/shear.hpp"

namespace dem::kernels {

struct Viscoelastic {
  static constexpr int history = 4;  // as HertzMindlin

  template <bool Ledger, class Real>
  TRACKBED_HD TRACKBED_LANES static Reaction<Real> press(const PairParameters& pair, const Touch<Real>& touch,
                                                         const Interval& time, Real* history) {
    const auto touching = touch.overlap > Real{};
    const Real overlap = choose(touching, touch.overlap, Real{});
    const Real patch_radius = square_root(touch.effective_radius * overlap);
    const Real k_n = all<Real>(2 * pair.effective_young_modulus) * patch_radius;
    const Real elastic = all<Real>(2.0 / 3.0) * k_n * overlap;
    NormalForce<Real> normal;
    normal.separation = dot(touch.velocity, touch.normal);
    normal.damping = all<Real>(pair.dissipative_coefficient) * k_n;
    normal.force = larger(elastic - normal.damping * normal.separation, Real{});
    normal.shear_stiffness = all<Real>(8 * pair.effective_shear_modulus) * patch_radius;
    normal.stored = all<Real>(0.4) * elastic * overlap;
    normal.lost_power = (elastic - normal.force) * normal.separation;
    return sheared<Ledger>(normal, all<Real>(pair.friction), 0, touch, time, history);
  }
};

}  // namespace dem::kernels
