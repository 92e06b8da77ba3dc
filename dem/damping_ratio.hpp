#pragma once
// Damping ratio gamma that gives a Hertz contact the wanted normal restitution e, when contacts cannot pull
// (kernels/hertz.hpp: c_n = 2 gamma sqrt(m k_n), k_n = 2 E* a, F_n >= 0).
//
// m x'' + c_n x' + 4/3 E* sqrt(R*) x^1.5 = 0 becomes linear in w = x^(5/4) with the clock d tau = x^(1/4) dt (units
// with 4/3 E* sqrt(R*) / m = 1): dw/dtau = 5/4 v, dv/dtau = -(w + 2 gamma sqrt(3/2) v): an oscillator with the damping
// ratio zeta = gamma sqrt(6/5). The force is used up where w + 2 gamma sqrt(3/2) v = 0, that is where v is least, and
// from there on the grain flies with
//     e = exp(-2 zeta acos(zeta) / sqrt(1 - zeta^2)),     zeta > 1: acosh(zeta) / sqrt(zeta^2 - 1).
// This is eq. 3.17 of Irazabal Gonzalez 2017 (PhD thesis, UPC Barcelona; after Thornton et al. 2013,
// doi:10.1016/j.powtec.2012.08.012) with zeta for gamma; the first branch of 3.17 is printed with 2 gamma^2 - 1 where
// 1 - 2 gamma^2 is meant. The fit 3.18 is not needed.
// Validity: any material, size and speed; gravity during the contact neglected.

namespace dem {

/// Restitution in (0, 1] that the damping ratio gives. damping_ratio >= 0.
double restitution_of(double damping_ratio);

/// Damping ratio for a restitution in (0, 1]; throws base::UserError outside. restitution_of(damping_ratio(e)) == e to
/// rounding.
double damping_ratio(double restitution);

}  // namespace dem
