#pragma once
// Normal force of two elastic spheres with a viscous dashpot that returns a given restitution.
//
//   a = sqrt(R* overlap)                         radius of the contact patch
//   k_n = 2 E* a,  k_t = 8 G* a                  tangent stiffnesses                          (3.25)
//   c_n = 2 gamma sqrt(m* k_n)                                                                (3.26)
//   F_n = max(0, 2/3 k_n overlap - c_n v_n)                                                   (3.12-3.14)
// Source: Irazabal Gonzalez 2017 (PhD thesis, UPC Barcelona), section 3.2.3; Thornton, Cummins, Cleary 2013
// (doi:10.1016/j.powtec.2012.08.012).
// Where we differ: 3.12 lets the dashpot pull grains together at the end of a contact. Dry stones do not attract: the
// total is clamped at zero, and damping_ratio.hpp gives the gamma that returns the wanted restitution under this rule.
// Validity: overlap well below the radius (to about 10 % of it).
#include "dem/kernels/normal_force.hpp"
#include "dem/kernels/pair_parameters.hpp"

namespace dem::kernels {

template <class Real>
TRACKBED_HD TRACKBED_LANES NormalForce<Real> hertz(const PairParameters& pair, const Touch<Real>& touch) {
  const auto touching = touch.overlap > all<Real>(0);
  const Real overlap = choose(touching, touch.overlap, Real{});
  const Real patch_radius = square_root(touch.effective_radius * overlap);
  const Real k_n = all<Real>(2 * pair.effective_young_modulus) * patch_radius;
  const Real c_n = all<Real>(2 * pair.damping_ratio) * square_root(touch.effective_mass * k_n);
  NormalForce<Real> normal;
  normal.separation = dot(touch.velocity, touch.normal);
  const Real elastic = all<Real>(2.0 / 3.0) * k_n * overlap;
  normal.force = larger(elastic - c_n * normal.separation, Real{});
  normal.shear_stiffness = all<Real>(8 * pair.effective_shear_modulus) * patch_radius;
  normal.damping = c_n;
  normal.stored = all<Real>(0.4) * elastic * overlap;
  normal.lost_power = (elastic - normal.force) * normal.separation;
  return normal;
}

}  // namespace dem::kernels
