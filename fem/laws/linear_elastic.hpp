#pragma once
// Linear elasticity, isotropic, small strain.
//   sigma = lambda tr(eps) I + 2 mu eps,  lambda = E nu / ((1 + nu)(1 - 2 nu)),  mu = E / (2 (1 + nu))
// Source: any text, e.g. Hughes, The Finite Element Method (2000), 2.7. Stress and strain are positive in tension.
// Valid for small strains and small rotations; -1 < nu < 0.5 (at 0.5 lambda is infinite).
#include "fem/laws/deformation.hpp"
#include "fem/laws/elastic_constants.hpp"

namespace fem {

class LinearElastic {
 public:
  static constexpr const char* name = "linear_elastic";
  static constexpr bool viscous = false;  // reads rates
  static constexpr bool hooke = true;     // stress is Hooke's and nothing else
  static constexpr bool finite = false;   // Cauchy's stress in the deformed body; else one with the reference body
  static constexpr int history = 0;       // numbers kept per point

  static bool serves(const MaterialRegion& m) { return m.law == name; }
  static void check(const MaterialRegion& m, const std::string& head) { check_elastic(m, head); }
  explicit LinearElastic(const MaterialRegion& m) : elastic_(elastic_constants(m)) {}

  const Elastic& elastic() const { return elastic_; }
  double relaxation() const { return 0; }

  /// Stress [Pa].
  template <class T>
  inline __attribute__((always_inline)) void stress(const Deformation<T>& d, T*, T* stress, Loss<T>&) const {
    T strain[6];
    symmetric_part(d.gradient, strain);
    isotropic(elastic_.lambda, elastic_.mu, strain, stress);
  }

  /// Elastic energy [J/m3].
  template <class T>
  T stored(const Deformation<T>& d, const T*) const {
    return hooke_energy(elastic_, d.gradient);
  }

 private:
  Elastic elastic_;
};

}  // namespace fem
