#pragma once
// Largest stable step of the central difference scheme: dt = 2 / omega_max, omega_max^2 the largest eigenvalue of M^-1
// K with the supports, M lumped. Viscous stress takes the velocity of the half step before: M d2u + dt C d1u + dt^2 K u
// = 0 in differences has no growing solution while the largest eigenvalue of M^-1 (dt^2 K + 2 dt C) is at most 4. So
// the step is where dt = 2 / omega_max(K + (2 / dt) C); for one mode that is (2 / omega) (sqrt(1 + xi^2) - xi)
// (Belytschko 2000, 6.2.3). C is taken as laws have it at rest.
//
// Lanczos' method approaches the largest eigenvalue from below. After k products from a random start, with probability
// 1 - p over the start, theta >= (1 - eps) lambda_max where p = 1.648 sqrt(n) exp(-sqrt(eps) (2 k - 1)), n unknowns
// (Kuczynski & Wozniakowski 1992, theorem 4.2, DOI 10.1137/0613066; no gap between eigenvalues is asked for). So
// theta / (1 - eps) is above lambda_max; with eps = 0.04 the step is 2 % below the true limit at most. p = 1e-9 decides
// k (about 70 for a million unknowns). The largest eigenvalue of any single element is a bound too (Hughes 2000, 9.3):
// the smaller of the two is taken, or (StepBound::elements) this one alone. Mass-proportional damping, treated as the
// model does, leaves the limit as it is.
#include <span>

#include "fem/assembly.hpp"

namespace fem {

/// `inverse_mass`: [1/kg] of the owned components, zero where a support holds them. Collective.
StableStep find_stable_step(const Setup&, const std::vector<Mesh>&, const Layout&, const Assembly&,
                            std::span<const double> inverse_mass);

}  // namespace fem
