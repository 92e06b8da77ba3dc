#pragma once
// Drucker-Prager, elastic and perfectly plastic, small strain, tension positive.
//   f = sqrt(J2) + alpha I1 - k <= 0,   flow along g = sqrt(J2) + beta I1
// One backward-Euler step is exact for the cone, since the return runs along a straight line in (I1, sqrt J2):
//   gamma = f / (G + 9 K alpha beta),   sqrt(J2) -= G gamma,   I1 -= 9 K beta gamma;
// where that would turn sqrt(J2) negative the stress goes to the apex: s = 0, I1 = k / alpha.
// Constants from cohesion c and friction angle phi (psi, the angle of dilation, gives beta as phi gives alpha):
//   outer         alpha = 2 sin phi / (sqrt3 (3 - sin phi)), k = 3 c alpha / tan phi; through triaxial compression
//   inner         the same with 3 + sin phi; through triaxial extension
//   plane_strain  alpha = tan phi / r, k = 3 c / r, r = sqrt(9 + 12 tan^2 phi); the limit load of plane strain with
//                 psi = phi
// Source: de Souza Neto, Peric, Owen, Computational Methods for Plasticity (2008), 6.4.3 and 8.3 (DOI
// 10.1002/9780470694626); Chen & Mizuno (1990). FrontISTR's friction angle is another convention.
// History per point: plastic strain with engineering shear [-], accumulated plastic strain sum sqrt(2/3 de_p : de_p).
// A viscous part (shear_viscosity, bulk_viscosity) may stand beside the elastic-plastic one, as in kelvin_voigt.hpp.
// No hardening and no cap: compression of any amount from all sides stays elastic.
#include <cmath>

#include "fem/laws/deformation.hpp"
#include "fem/laws/elastic_constants.hpp"
#include "fem/pack.hpp"

namespace fem {

struct DruckerPragerConstants {
  double alpha = 0, beta = 0;  // [-] of the yield surface, of the flow
  double k = 0;                // [Pa]
};

inline DruckerPragerConstants drucker_prager_constants(const MaterialRegion& m) {
  const auto slope = [&](double angle) {  // divided by sin: with cos it makes k, so that phi = 0 is allowed
    const double sine = std::sin(angle);
    if (m.fit == "plane_strain") {
      const double cosine = std::cos(angle);  // tan / sqrt(9 + 12 tan^2) = sin / sqrt(9 cos^2 + 12 sin^2)
      return 1 / std::sqrt(9 * cosine * cosine + 12 * sine * sine);
    }
    return 2 / (std::sqrt(3.0) * (m.fit == "inner" ? 3 + sine : 3 - sine));
  };
  return {slope(m.friction_angle) * std::sin(m.friction_angle), slope(m.dilation_angle) * std::sin(m.dilation_angle),
          3 * m.cohesion * slope(m.friction_angle) * std::cos(m.friction_angle)};
}

template <bool with_viscosity>
class DruckerPrager {
 public:
  static constexpr const char* name = "drucker_prager";
  static constexpr bool viscous = with_viscosity, hooke = false, finite = false;
  static constexpr int history = 7;

  static bool serves(const MaterialRegion& m) { return m.law == name && is_viscous(m) == with_viscosity; }

  static void check(const MaterialRegion& m, const std::string& head) {
    constexpr double right_angle = 1.57079632679489661923;
    check_elastic(m, head);
    check_viscous(m, head);
    base::require_user(m.cohesion >= 0, fmt::format("{}cohesion = {}; must be >= 0 Pa", head, m.cohesion));
    base::require_user(m.friction_angle >= 0 && m.friction_angle < right_angle,
                       fmt::format("{}friction_angle = {} rad; must be in [0, pi/2)", head, m.friction_angle));
    base::require_user(m.cohesion > 0 || m.friction_angle > 0,
                       fmt::format("{}cohesion and friction_angle are both 0; nothing would carry a shear stress; give "
                                   "one of them",
                                   head));
    base::require_user(
        m.dilation_angle >= 0 && m.dilation_angle <= m.friction_angle,
        fmt::format("{}dilation_angle = {} rad; must be in [0, friction_angle = {} rad]: a material that "
                    "dilates more than it rubs would give energy away",
                    head, m.dilation_angle, m.friction_angle));
    base::require_user(m.fit == "outer" || m.fit == "inner" || m.fit == "plane_strain",
                       fmt::format("{}fit = \"{}\"; must be one of: outer, inner, plane_strain", head, m.fit));
  }

  explicit DruckerPrager(const MaterialRegion& m)
      : elastic_(elastic_constants(m)),
        viscosity_(viscous_constants(m)),
        constants_(drucker_prager_constants(m)),
        bulk_(elastic_.lambda + 2.0 / 3.0 * elastic_.mu),
        compliance_(1 / (elastic_.mu + 9 * bulk_ * constants_.alpha * constants_.beta)),
        apex_(constants_.alpha > 0 ? constants_.k / constants_.alpha : 0) {}

  const Elastic& elastic() const { return elastic_; }
  double relaxation() const { return viscosity_.mu / elastic_.mu; }

  template <class T>
  inline __attribute__((always_inline)) void stress(const Deformation<T>& d, T* history, T* stress,
                                                    Loss<T>& loss) const {
    T strain[6];
    symmetric_part(d.gradient, strain);
    for (int i = 0; i < 6; ++i) strain[i] -= history[i];
    isotropic(elastic_.lambda, elastic_.mu, strain, stress);
    const T trace = stress[0] + stress[1] + stress[2], mean = trace * (1.0 / 3.0);
    T deviator[6];
    for (int i = 0; i < 6; ++i) deviator[i] = i < 3 ? stress[i] - mean : stress[i];
    const T root =
        square_root(0.5 * (deviator[0] * deviator[0] + deviator[1] * deviator[1] + deviator[2] * deviator[2]) +
                    deviator[3] * deviator[3] + deviator[4] * deviator[4] + deviator[5] * deviator[5]);
    const T excess = root + constants_.alpha * trace - constants_.k;
    if (any_above_zero(excess)) give_way(trace, root, excess, deviator, history, stress, loss);
    if constexpr (viscous) {
      T rate[6], drag[6];
      symmetric_part(d.rate, rate);
      isotropic(viscosity_.lambda, viscosity_.mu, rate, drag);
      for (int i = 0; i < 6; ++i) stress[i] += drag[i];
      loss.viscous += contraction(drag, rate);
    }
  }

  template <class T>
  T stored(const Deformation<T>& d, const T* history) const {
    T strain[6], stress[6];
    symmetric_part(d.gradient, strain);
    for (int i = 0; i < 6; ++i) strain[i] -= history[i];
    isotropic(elastic_.lambda, elastic_.mu, strain, stress);
    return 0.5 * contraction(stress, strain);
  }

 private:
  /// The plastic return, for the lanes whose excess is positive.
  template <class T>
  void give_way(T trace, T root, T excess, const T* deviator, T* history, T* stress, Loss<T>& loss) const {
    const T zero{};
    const T gamma = (excess > zero ? excess : zero) * compliance_;
    const T cone_root = root - elastic_.mu * gamma, cone_trace = trace - (9 * bulk_ * constants_.beta) * gamma;
    const T apex = zero + apex_;
    const T new_root = cone_root < zero ? zero : cone_root, new_trace = cone_root < zero ? apex : cone_trace;
    const T share = new_root / (root > zero ? root : zero + 1.0);  // of the deviator that is left
    const T lost = root > zero ? 1.0 - share : zero, swelling = (trace - new_trace) * (1 / (9 * bulk_));
    T sum{};
    for (int i = 0; i < 6; ++i) {
      const double shear = i < 3 ? 1 : 2;  // engineering shear
      const T step = (0.5 / elastic_.mu) * lost * deviator[i] + (i < 3 ? swelling : zero);
      stress[i] = (1.0 - lost) * deviator[i] + (i < 3 ? new_trace * (1.0 / 3.0) : zero);
      history[i] += shear * step;
      loss.plastic += shear * stress[i] * step;
      sum += shear * step * step;
    }
    history[6] += square_root((2.0 / 3.0) * sum);
  }

  Elastic elastic_, viscosity_;  // [Pa] [Pa s]
  DruckerPragerConstants constants_;
  double bulk_;        // [Pa]
  double compliance_;  // [1/Pa] flow per excess
  double apex_;        // [Pa] I1 there
};

}  // namespace fem
