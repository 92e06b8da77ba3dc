#pragma once
// How long a coupling window may be for the contacts that press on the bodies' skins now.
//
// At 1 : 1 the window is one step of velocity Verlet of the whole, stable up to
//   W = 2 / omega (sqrt(1 + xi^2) - xi),  xi = d / k lambda_node / (2 omega)
//   omega^4 - (lambda_grain + lambda_node + omega_body^2) omega^2 + lambda_grain omega_body^2 = 0, the larger root,
// which is omega^2 = lambda_grain + lambda_node on a soft body and never more than that + omega_body^2.
// lambda_grain: bound of the grains' contacts with walls held still (dem/contact_step.hpp), k_c / m for one contact;
// lambda_node: the largest sum of k_c N / M over a node's contacts, N their shape functions, M the node's mass (row
// sums of M^-1 K; k_c sum N^2 / M for one contact of a facet of equal masses); d their dashpot, whose velocities lag by
// half a step. The bound: k (x - u)^2 <= (1 + s) k x^2 + (1 + 1/s) k u^2 for any s > 0, so omega^2 is at most the
// larger of (1 + s) lambda_grain and omega_body^2 + (1 + 1/s) lambda_node, and least where both are equal.
//
// With more steps on a side, or data of another window, the force acts late (window.hpp) and is sampled and held. The
// smallest case: the node alone (mass M) against a grain that stays, n DEM steps to one FEM step over W:
//   u'' = 2 u' - u - q ((1 - c) u + c u'),  q = k W^2 / M,  c = (n + 1) / (2 n)
//   z^2 - (2 - c q) z + 1 + (1 - c) q = 0
// The product of the roots is 1 + (1 - c) q: |z| = 1 at n = 1 up to q = 4, and above 1 for every W at n > 1. That is
// the lag tau = (1 - 1/n) W / 2 at work as a dashpot - k tau: |z| grows by k tau / (2 M) per second, until the
// contact's own dashpot, d >= k tau, eats it. So the window is judged by the growth of the whole map of one window
// (grain, node, its body's spring, force and skin under way), which is found by making that window with each unit
// state:
//   zeta = - ln(growth) / (omega W),  omega^2 = lambda_grain + lambda_node
// is the damping ratio that contacts have; short windows have zeta = - tau omega / 2 lambda_node / (lambda_grain +
// lambda_node), as the force is late on the node's side only. Windows with zeta < - 0.1, from which a contact leaves
// with nearly twice its energy, are too long, and those above 2 / sqrt(lambda_node); below that a lag is an error of
// accuracy, which zeta and the ledger's interface tell. The longest such window is that of the node against a grain
// that stays, whose steps have a limit of their own: a grain that moves takes less of the lag. Body frequencies from 0
// to omega_body are tried. Source: Hughes, The Finite Element Method (2000), 9.1 and 9.2 (amplification matrices).
// Validity: contacts as they are now, linearised; a window between contacts that come and go gains less.
#include "coupling/window.hpp"

namespace coupling {

/// What presses on the skins now, worst node and worst grain together.
struct SkinContacts {
  double grain = 0, node = 0, body = 0;  // [1/s2] lambda_grain, lambda_node, omega_body^2
  double dashpot = 0;                    // [s] d / k of the node's contacts
  bool implicit_body = false;            // Newmark's average acceleration
};

/// Both sides take one step with forces of one instant.
bool is_one_step_of_the_whole(const Window&, const CouplingSettings&, const SkinContacts&);
/// Largest factor by which a state grows over one window: the spectral radius of its map.
double growth(const Window&, const CouplingSettings&, const SkinContacts&);
/// Damping ratio of the contacts over such a window; negative: they gain energy.
double damping_ratio(const Window&, const CouplingSettings&, const SkinContacts&);
/// Longest stable window [s] with the numbers of steps of this one; infinity where nothing presses on a skin.
double longest_window(const Window&, const CouplingSettings&, const SkinContacts&);

}  // namespace coupling
