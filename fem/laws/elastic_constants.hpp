#pragma once
// What every law of solids has: an isotropic elastic part, a density, and possibly a viscous part beside it.
//   lambda = E nu / ((1 + nu)(1 - 2 nu)),  mu = E / (2 (1 + nu))
//   mu_D: shear viscosity, lambda_D + 2/3 mu_D: bulk viscosity
#include <fmt/format.h>

#include <string>

#include "base/error.hpp"
#include "fem/elements/elastic.hpp"
#include "fem/fem.hpp"
#include "fem/laws/deformation.hpp"

namespace fem {

inline void check_elastic(const MaterialRegion& m, const std::string& head) {
  base::require_user(m.young_modulus > 0, fmt::format("{}young_modulus = {}; must be > 0 Pa", head, m.young_modulus));
  base::require_user(
      m.poisson_ratio > -1 && m.poisson_ratio < 0.5,
      fmt::format("{}poisson_ratio = {}; must be in (-1, 0.5): at 0.5 the material cannot change its volume; "
                  "use 0.49 with element = \"hex8_bbar\"",
                  head, m.poisson_ratio));
  base::require_user(m.density > 0, fmt::format("{}density = {}; must be > 0 kg/m3", head, m.density));
}

inline void check_viscous(const MaterialRegion& m, const std::string& head) {
  base::require_user(m.shear_viscosity >= 0,
                     fmt::format("{}shear_viscosity = {}; must be >= 0 Pa s", head, m.shear_viscosity));
  base::require_user(m.bulk_viscosity >= 0,
                     fmt::format("{}bulk_viscosity = {}; must be >= 0 Pa s", head, m.bulk_viscosity));
}

inline bool is_viscous(const MaterialRegion& m) { return m.shear_viscosity > 0 || m.bulk_viscosity > 0; }

inline Elastic elastic_constants(const MaterialRegion& m) {
  const double e = m.young_modulus, nu = m.poisson_ratio;
  return {e * nu / ((1 + nu) * (1 - 2 * nu)), e / (2 * (1 + nu))};
}

/// Elastic energy [J/m3] of Hooke's law at a displacement gradient.
template <class T>
T hooke_energy(const Elastic& elastic, const T (*gradient)[3]) {
  T strain[6], stress[6];
  symmetric_part(gradient, strain);
  isotropic(elastic.lambda, elastic.mu, strain, stress);
  return 0.5 * contraction(stress, strain);
}

/// [Pa s] lambda_D and mu_D.
inline Elastic viscous_constants(const MaterialRegion& m) {
  return {m.bulk_viscosity - 2.0 / 3.0 * m.shear_viscosity, m.shear_viscosity};
}

}  // namespace fem
