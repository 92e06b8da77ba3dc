#pragma once
// Kelvin-Voigt solid for bodies that turn: Hooke's law in the left Green-Lagrange strain, a Newtonian dashpot beside
// it.
//   T = lambda tr(eps) I + 2 mu eps + lambda_D tr(D) I + 2 mu_D D,   eps = (F F^T - I) / 2,   D = sym(dF/dt F^-1)
// T is Cauchy's stress in the deformed body. Nodal forces are V sum T cof(F) grad_X N (virtual work in the deformed
// body). F F^T = V^2 forgets the rotation before it strains nothing: a rigidly carried body stays without stress.
// Source: Nishiura2017 eq. 2-4, 7-8 (DOI 10.3390/ma10060615). Differs: the paper sums forces over the faces between its
// particles (eq. 9-10); for the tetrahedron the two are the same.
// Valid for small strains and any rotation. No potential exists, so the stored energy 1/2 T_E : eps det F closes the
// ledger to the order of the strain.
#include "fem/laws/deformation.hpp"
#include "fem/laws/elastic_constants.hpp"

namespace fem {

class LeftCauchyGreen {
 public:
  static constexpr const char* name = "left_cauchy_green";
  static constexpr bool viscous = true, hooke = false, finite = true;
  static constexpr int history = 0;

  static bool serves(const MaterialRegion& m) { return m.law == name; }
  static void check(const MaterialRegion& m, const std::string& head) {
    check_elastic(m, head);
    check_viscous(m, head);
  }
  explicit LeftCauchyGreen(const MaterialRegion& m)
      : elastic_(elastic_constants(m)), viscosity_(viscous_constants(m)) {}

  const Elastic& elastic() const { return elastic_; }
  double relaxation() const { return viscosity_.mu / elastic_.mu; }

  template <class T>
  inline __attribute__((always_inline)) void stress(const Deformation<T>& d, T*, T* stress, Loss<T>& loss) const {
    T strain[6], rate[6], drag[6], cofactor[3][3], spatial[3][3];
    left_strain(d, strain);
    isotropic(elastic_.lambda, elastic_.mu, strain, stress);
    const T volume = cofactors(d.gradient, cofactor);
    for (int c = 0; c < 3; ++c) {  // dF/dt F^-1
      for (int e = 0; e < 3; ++e) {
        spatial[c][e] =
            (d.rate[c][0] * cofactor[e][0] + d.rate[c][1] * cofactor[e][1] + d.rate[c][2] * cofactor[e][2]) / volume;
      }
    }
    symmetric_part(spatial, rate);
    isotropic(viscosity_.lambda, viscosity_.mu, rate, drag);
    for (int i = 0; i < 6; ++i) stress[i] += drag[i];
    loss.viscous += volume * contraction(drag, rate);
  }

  template <class T>
  T stored(const Deformation<T>& d, const T*) const {
    T strain[6], stress[6], cofactor[3][3];
    left_strain(d, strain);
    isotropic(elastic_.lambda, elastic_.mu, strain, stress);
    return 0.5 * cofactors(d.gradient, cofactor) * contraction(stress, strain);
  }

 private:
  /// (F F^T - I) / 2 = (h + h^T + h h^T) / 2, without the difference of two numbers near one.
  template <class T>
  static inline __attribute__((always_inline)) void left_strain(const Deformation<T>& d, T* strain) {
    T sum[3][3];
    for (int c = 0; c < 3; ++c) {
      for (int e = 0; e < 3; ++e) {
        const T product = d.gradient[c][0] * d.gradient[e][0] + d.gradient[c][1] * d.gradient[e][1] +
                          d.gradient[c][2] * d.gradient[e][2];
        sum[c][e] = d.gradient[c][e] + 0.5 * product;  // its symmetric part is the strain
      }
    }
    symmetric_part(sum, strain);
  }

  Elastic elastic_, viscosity_;  // [Pa] [Pa s]
};

}  // namespace fem
