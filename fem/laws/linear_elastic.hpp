#pragma once
// Linear elasticity, isotropic, small strain.
//   sigma = lambda tr(eps) I + 2 mu eps,  lambda = E nu / ((1 + nu)(1 - 2 nu)),  mu = E / (2 (1 + nu))
// Source: any text, e.g. Hughes, The Finite Element Method (2000), 2.7. Stress and strain are positive in tension.
// Valid for small strains and small rotations; -1 < nu < 0.5 (at 0.5 lambda is infinite).
#include <fmt/format.h>

#include <string>

#include "base/error.hpp"
#include "fem/fem.hpp"

namespace fem {

class LinearElastic {
 public:
  static constexpr const char* name = "linear_elastic";

  static void check(const MaterialRegion& m, const std::string& head) {
    base::require_user(m.young_modulus > 0, fmt::format("{}young_modulus = {}; must be > 0 Pa", head, m.young_modulus));
    base::require_user(
        m.poisson_ratio > -1 && m.poisson_ratio < 0.5,
        fmt::format("{}poisson_ratio = {}; must be in (-1, 0.5): at 0.5 the material cannot change its volume; "
                    "use 0.49 with element = \"hex8_bbar\"",
                    head, m.poisson_ratio));
    base::require_user(m.density > 0, fmt::format("{}density = {}; must be > 0 kg/m3", head, m.density));
  }

  explicit LinearElastic(const MaterialRegion& m)
      : lambda_(m.young_modulus * m.poisson_ratio / ((1 + m.poisson_ratio) * (1 - 2 * m.poisson_ratio))),
        mu_(m.young_modulus / (2 * (1 + m.poisson_ratio))) {}

  /// Components xx, yy, zz, xy, yz, xz; strain [-] with engineering shear (2 eps_xy), stress [Pa].
  template <class T>
  inline __attribute__((always_inline)) void stress(const T* strain, T* stress) const {
    const T pressure = lambda_ * (strain[0] + strain[1] + strain[2]);
    for (int i = 0; i < 3; ++i) stress[i] = pressure + (2 * mu_) * strain[i];
    for (int i = 3; i < 6; ++i) stress[i] = mu_ * strain[i];
  }

 private:
  double lambda_, mu_;  // [Pa] Lame's constants
};

}  // namespace fem
