#pragma once
// Kelvin-Voigt solid: Hooke's spring and a Newtonian dashpot side by side, small strain.
//   T = lambda tr(eps) I + 2 mu eps + lambda_D tr(D) I + 2 mu_D D,   D = sym(grad v)
// mu_D is the shear viscosity, lambda_D + 2/3 mu_D the bulk viscosity [Pa s].
// Source: Nishiura2017 eq. 7-8 (DOI 10.3390/ma10060615). Differs: eq. 2 there takes the left Green-Lagrange strain;
// that form is left_cauchy_green.hpp. Stiffness-proportional (Rayleigh) damping beta K is this law with mu_D = beta mu
// and lambda_D = beta lambda. A mode of frequency omega is damped by xi = beta omega / 2. Valid for small strains and
// rotations (a turning body is strained falsely). Viscosity shortens the stable step.
#include "fem/laws/deformation.hpp"
#include "fem/laws/elastic_constants.hpp"

namespace fem {

class KelvinVoigt {
 public:
  static constexpr const char* name = "kelvin_voigt";
  static constexpr bool viscous = true, hooke = false, finite = false;
  static constexpr int history = 0;

  static bool serves(const MaterialRegion& m) { return m.law == name; }
  static void check(const MaterialRegion& m, const std::string& head) {
    check_elastic(m, head);
    check_viscous(m, head);
  }
  explicit KelvinVoigt(const MaterialRegion& m) : elastic_(elastic_constants(m)), viscosity_(viscous_constants(m)) {}

  const Elastic& elastic() const { return elastic_; }
  double relaxation() const { return viscosity_.mu / elastic_.mu; }

  template <class T>
  inline __attribute__((always_inline)) void stress(const Deformation<T>& d, T*, T* stress, Loss<T>& loss) const {
    T strain[6], rate[6], drag[6];
    symmetric_part(d.gradient, strain);
    symmetric_part(d.rate, rate);
    isotropic(elastic_.lambda, elastic_.mu, strain, stress);
    isotropic(viscosity_.lambda, viscosity_.mu, rate, drag);
    for (int i = 0; i < 6; ++i) stress[i] += drag[i];
    loss.viscous += contraction(drag, rate);
  }

  template <class T>
  T stored(const Deformation<T>& d, const T*) const {
    return hooke_energy(elastic_, d.gradient);
  }

 private:
  Elastic elastic_, viscosity_;  // [Pa] [Pa s]
};

}  // namespace fem
