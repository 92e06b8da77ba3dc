#pragma once
// Friction that falls where a contact is stressed beyond a limit: takes back the friction that overlapping spheres of a
// clump add by their shape when a packing is confined.
//
//   F_nc = 2/3 pi R* overlap sigma_cmax            (the peak Hertz stress 3 F_n / (2 pi R* overlap) is sigma_cmax)
//   (6.4) mu = mu_0 (F_n / F_nc)^gamma  where F_n > F_nc,  mu_0 elsewhere (6.6)
// Source: Irazabal Gonzalez 2017 (PhD thesis, UPC Barcelona), section 6.3.4, after Harkness et al. 2016.
// Same there and here: F_n is the total with the dashpot, sigma_cmax and gamma <= 0 belong to the pair of materials
// (dem/law_parameters.hpp: 6.7-6.9). Meant for clump against clump; walls keep the classical law. sigma_cmax = 0 has
// every contact beyond the limit and is refused there.
#include "dem/kernels/hertz.hpp"
#include "dem/kernels/shear.hpp"

namespace dem::kernels {

/// mu of every lane.
template <class Real>
TRACKBED_HD TRACKBED_LANES Real stress_dependent_friction(const PairParameters& pair, Real normal_force,
                                                          const Touch<Real>& touch) {
  const double pi = 3.14159265358979323846;
  const Real critical = all<Real>(2.0 / 3.0 * pi * pair.critical_stress) * touch.effective_radius * touch.overlap;
  const auto beyond = both(normal_force > critical, critical > Real{});
  const Real mu = all<Real>(pair.friction);
  if (!any(beyond)) return mu;
  const Real one = all<Real>(1);
  const Real ratio = choose(beyond, normal_force, one) / choose(beyond, critical, one);
  return mu * power(ratio, all<Real>(pair.friction_exponent));
}

/// Hertz-Mindlin with it.
struct StressFriction {
  static constexpr int history = 4;  // as HertzMindlin

  template <bool Ledger, class Real>
  TRACKBED_HD TRACKBED_LANES static Reaction<Real> press(const PairParameters& pair, const Touch<Real>& touch,
                                                         const Interval& time, Real* history) {
    const NormalForce<Real> normal = hertz(pair, touch);
    const Real friction = stress_dependent_friction(pair, normal.force, touch);
    return sheared<Ledger>(normal, friction, pair.shear_damping, touch, time, history);
  }
};

}  // namespace dem::kernels
