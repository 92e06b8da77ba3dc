#pragma once
// The coupling window: the common multiple of both sides' steps. The finer side runs at its own stable step d or f, the
// coarser one at the largest multiple that it can take, so neither ever exceeds its limit.
#include <cmath>
#include <optional>

namespace coupling {

struct Window {
  int n_dem = 0, n_fem = 0;       // steps per window; 0: that side does not exist
  double dt_dem = 0, dt_fem = 0;  // [s]
  double length() const { return n_fem > 0 ? n_fem * dt_fem : n_dem * dt_dem; }
};

/// d, f: longest steps [s] the DEM and FEM side may take (limit × fraction, or set by hand); absent: no such side.
inline Window choose_window(std::optional<double> d, std::optional<double> f) {
  if (!d && !f) return {};
  if (!d) return {0, 1, 0, *f};
  if (!f) return {1, 0, *d, 0};
  // A ratio a rounding error below a whole number counts as that number.
  const auto whole = [](double ratio) { return static_cast<int>(std::floor(ratio * (1 + 1e-12))); };
  if (*d <= *f) {
    const int n = whole(*f / *d);
    return {n, 1, *d, n * *d};
  }
  const int n = whole(*d / *f);
  return {1, n, n * *f, *f};
}

}  // namespace coupling
