#include "dem/damping_ratio.hpp"

#include <cmath>

#include "base/error.hpp"

namespace dem {

namespace {

/// ln e of the oscillator with this damping ratio.
double log_restitution(double zeta) {
  const double s = 1 - zeta * zeta;
  if (std::abs(s) < 1e-8) return -2 + 4.0 / 3.0 * (1 - zeta);  // both branches meet here
  if (s > 0) return -2 * zeta * std::acos(zeta) / std::sqrt(s);
  return -2 * zeta * std::acosh(zeta) / std::sqrt(-s);
}

}  // namespace

double restitution_of(double damping_ratio) { return std::exp(log_restitution(damping_ratio * std::sqrt(1.2))); }

double damping_ratio(double restitution) {
  base::require_user(restitution > 0 && restitution <= 1, "restitution must be in (0, 1]");
  if (restitution == 1) return 0;
  double low = 0, high = 1 / std::sqrt(restitution);  // e(zeta) < 1 / (4 zeta^2) (1 + small): high is beyond the root
  const double target = std::log(restitution);
  for (int i = 0; i < 200 && high - low > 1e-16 * high; ++i) {
    const double middle = 0.5 * (low + high);
    (log_restitution(middle) > target ? low : high) = middle;
  }
  return 0.5 * (low + high) / std::sqrt(1.2);
}

}  // namespace dem
