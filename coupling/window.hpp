#pragma once
// The coupling window: the common multiple of both sides' steps, and what passes between them in it.
//
// Chosen: the finer side runs at its own stable step d or f, the coarser one at the largest multiple that it can take,
// so neither ever exceeds its limit. Set by the scene: n_dem and n_fem, and the longest window that both steps allow.
//
// What a scheme costs in accuracy is how late the contact force acts on the bodies. Contacts are evaluated at the end
// of each DEM step; the mean over the window, held over it, acts in a body's step of dt_fem around its end:
//   tau = (W / 2) (1 / n_fem - 1 / n_dem)      sequential
//   tau = (W / 2) (1 / n_fem - 1 / n_dem) + W  concurrent
// A contact of stiffness k whose force is late by tau works on the body as a dashpot -k tau beside it: over a contact
// the energy of the interface is wrong by tau times the integral of (dF/dt) v, v the velocity of the skin along F.
// First order in W, but for n_dem = n_fem in the sequential scheme, where tau = 0; at 1 : 1 both sides then use forces
// of one instant. tau < 0 (bodies finer): a dashpot + k |tau|.
#include <cmath>
#include <optional>

namespace coupling {

/// sequential: the bodies take the impulse of the window in which it arose; concurrent: that of the window before, so
/// that neither side waits for the other within a window.
enum class Scheme { sequential, concurrent };
/// Of the skin within a window. linear: straight from end to end; quadratic: leaves with the velocity that the skin has
/// at the window's start, so that the velocity which contacts see goes on from one window to the next but for W / 2
/// times the change of the skin's acceleration.
enum class SkinMotion { linear, quadratic };

struct CouplingSettings {
  Scheme scheme = Scheme::sequential;
  SkinMotion skin_motion = SkinMotion::linear;
  int n_dem = 0, n_fem = 0;  // steps per window; 0: chosen
};

struct Window {
  int n_dem = 0, n_fem = 0;       // steps per window; 0: that side does not exist
  double dt_dem = 0, dt_fem = 0;  // [s]
  double length() const { return n_fem > 0 ? n_fem * dt_fem : n_dem * dt_dem; }
};

/// How late contact forces act on the bodies [s]; negative: early.
inline double lag(const Window& window, const CouplingSettings& settings) {
  const double held = 0.5 * (1.0 / window.n_fem - 1.0 / window.n_dem);
  return window.length() * (held + (settings.scheme == Scheme::concurrent ? 1 : 0));
}

/// d, f: longest steps [s] the DEM and FEM side may take (limit × fraction, or set by hand); absent: no such side.
inline Window choose_window(std::optional<double> d, std::optional<double> f, const CouplingSettings& settings = {}) {
  if (!d && !f) return {};
  if (!d) return {0, 1, 0, *f};
  if (!f) return {1, 0, *d, 0};
  // A ratio a rounding error away from a whole number counts as that number.
  const auto below = [](double ratio) { return static_cast<int>(std::floor(ratio * (1 + 1e-12))); };
  const auto above = [](double ratio) { return static_cast<int>(std::ceil(ratio * (1 - 1e-12))); };
  int n_dem = settings.n_dem, n_fem = settings.n_fem;
  if (n_dem > 0 || n_fem > 0) {
    if (n_dem == 0) n_dem = above(n_fem * *f / *d);
    if (n_fem == 0) n_fem = above(n_dem * *d / *f);
    const double length = std::fmin(n_dem * *d, n_fem * *f);
    return {n_dem, n_fem, length / n_dem, length / n_fem};
  }
  if (*d <= *f) {
    const int n = below(*f / *d);
    return {n, 1, *d, n * *d};
  }
  const int n = below(*d / *f);
  return {1, n, n * *f, *f};
}

}  // namespace coupling
