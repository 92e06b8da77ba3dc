#pragma once
// One element with one law: inner forces, mean stress and stored energy from nodal displacements and velocities,
// through the element's Field (gradients at its points), the law's stress there, and the element's Forces (the
// transpose).
//
// A law with Cauchy's stress T in the deformed body acts on the reference one by T cof(F). Elements with assumed
// strains or hourglass control know small strains only; with such a law they work in a frame that turns with their mean
// rotation R: R^T u goes in, forces are turned by R (Belytschko 2000, 4.6).
#include <cstddef>
#include <type_traits>

#include "fem/elements/rotation.hpp"
#include "fem/laws/deformation.hpp"

namespace fem {

/// Of one element.
template <class T>
struct Motion {
  const T (*displacements)[3];  // [m] per node
  const T (*velocities)[3];     // [m/s] per node; of viscous laws only
  T* history;                   // of the law, per point; updated
};

template <class Element, class Law, class T>
class Response {
 public:
  static constexpr int nodes = Element::nodes;

  /// Inner forces [N]; adds what was lost to `loss` ([W] and [J] of the element).
  static inline __attribute__((always_inline)) void forces(const T* g, const Law& law, const Motion<T>& motion,
                                                           T (*f)[3], Loss<T>& loss) {
    if constexpr (turns) {
      T r[3][3], u[nodes][3], v[nodes][3], turned[nodes][3];
      mean_rotation(g, law, motion, r);
      turn_back<nodes>(r, motion.displacements, u);
      if constexpr (Law::viscous) turn_back<nodes>(r, motion.velocities, v);
      in_frame(g, law, {u, v, motion.history}, r, turned, loss);
      for (int a = 0; a < nodes; ++a) {
        for (int c = 0; c < 3; ++c) f[a][c] = r[c][0] * turned[a][0] + r[c][1] * turned[a][1] + r[c][2] * turned[a][2];
      }
    } else {
      in_frame(g, law, motion, nullptr, f, loss);
    }
  }

  /// Mean of Cauchy's stress over the element [Pa]: xx, yy, zz, xy, yz, xz.
  static void mean_stress(const T* g, const Law& law, const Motion<T>& motion, T* mean) {
    T volume{};
    for (int i = 0; i < 6; ++i) mean[i] = T{};
    at_points(g, law, motion, [&](int p, const Deformation<T>& d, T* history, const T(*r)[3]) {
      T stress[6];
      Loss<T> loss;
      law.stress(d, history, stress, loss);
      if constexpr (turns) turn(r, stress);
      for (int i = 0; i < 6; ++i) mean[i] += Element::weight(g, p) * stress[i];
      volume += Element::weight(g, p);
    });
    for (int i = 0; i < 6; ++i) mean[i] /= volume;
  }

  /// Elastic energy [J].
  static T stored(const T* g, const Law& law, const Motion<T>& motion) {
    T energy{};
    at_points(g, law, motion, [&](int p, const Deformation<T>& d, const T* history, const T(*)[3]) {
      energy += Element::weight(g, p) * law.stored(d, history);
    });
    if constexpr (Element::stabilised) {
      T u[nodes][3], f[nodes][3] = {};
      for (int a = 0; a < nodes; ++a) {
        for (int c = 0; c < 3; ++c) u[a][c] = motion.displacements[a][c];
      }
      if constexpr (turns) {
        T r[3][3];
        mean_rotation(g, law, motion, r);
        turn_back<nodes>(r, motion.displacements, u);
      }
      Element::stabilise(g, u, f);
      for (int a = 0; a < nodes; ++a) {
        for (int c = 0; c < 3; ++c) energy += 0.5 * f[a][c] * u[a][c];
      }
    }
    return energy;
  }

 private:
  using Field = typename Element::template Field<T>;
  struct NoField {
    NoField(const T*, const Elastic&, const T (*)[3]) {}
  };
  using Rate = std::conditional_t<Law::viscous, Field, NoField>;
  static constexpr bool turns = Law::finite && (Element::assumed_strain || Element::stabilised);

  static inline __attribute__((always_inline)) void mean_rotation(const T* g, const Law& law, const Motion<T>& motion,
                                                                  T (*r)[3]) {
    const Field field(g, law.elastic(), motion.displacements);
    T mean[3][3] = {}, h[3][3], volume{};
    for (int p = 0; p < Element::points; ++p) {
      field.gradient(p, h);
      volume += Element::weight(g, p);
      for (int c = 0; c < 3; ++c) {
        for (int d = 0; d < 3; ++d) mean[c][d] += Element::weight(g, p) * h[c][d];
      }
    }
    for (auto& row : mean) {
      for (T& value : row) value /= volume;
    }
    rotation_of(mean, r);
  }

  /// Gradients in a frame that is turned by r: R^T (I + grad u) - I, where u is turned back already.
  static inline __attribute__((always_inline)) void deform(const Field& field, const T (*r)[3], int p, T (*h)[3]) {
    field.gradient(p, h);
    if constexpr (turns) {
      for (int c = 0; c < 3; ++c) {
        for (int d = 0; d < 3; ++d) h[c][d] += r[d][c] - (c == d ? 1.0 : 0.0);
      }
    }
  }

  static inline __attribute__((always_inline)) void in_frame(const T* g, const Law& law, const Motion<T>& motion,
                                                             const T (*r)[3], T (*f)[3], Loss<T>& loss) {
    const Elastic& elastic = law.elastic();
    const Field field(g, elastic, motion.displacements);
    const Rate rate(g, elastic, motion.velocities);
    typename Element::template Forces<T, Law::hooke> forces(g, elastic);
    for (int p = 0; p < Element::points; ++p) {
      Deformation<T> d;
      deform(field, r, p, d.gradient);
      if constexpr (Law::viscous) rate.gradient(p, d.rate);
      T symmetric[6], stress[3][3];
      Loss<T> density;
      law.stress(d, motion.history + static_cast<std::ptrdiff_t>(p) * Law::history, symmetric, density);
      const T weight = Element::weight(g, p);
      for (T& value : symmetric) value *= weight;
      to_matrix(symmetric, stress);
      if constexpr (Law::finite) to_reference_body(d.gradient, stress);
      if constexpr (Law::viscous) loss.viscous += weight * density.viscous;
      if constexpr (Law::history > 0) loss.plastic += weight * density.plastic;
      forces.add(p, stress);
    }
    forces.finish(f);
    if constexpr (Element::stabilised) {
      Element::stabilise(g, motion.displacements, f);
      if constexpr (Law::viscous) loss.viscous += Element::drag(g, law.relaxation(), motion.velocities, f);
    }
  }

  /// stress cof(F)
  static inline __attribute__((always_inline)) void to_reference_body(const T (*gradient)[3], T (*stress)[3]) {
    T cofactor[3][3], cauchy[3][3];
    cofactors(gradient, cofactor);
    for (int c = 0; c < 3; ++c) {
      for (int d = 0; d < 3; ++d) cauchy[c][d] = stress[c][d];
    }
    for (int c = 0; c < 3; ++c) {
      for (int d = 0; d < 3; ++d) {
        stress[c][d] = cauchy[c][0] * cofactor[0][d] + cauchy[c][1] * cofactor[1][d] + cauchy[c][2] * cofactor[2][d];
      }
    }
  }

  /// R stress R^T
  static void turn(const T (*r)[3], T* stress) {
    T m[3][3], half[3][3], turned[3][3];
    to_matrix(stress, m);
    for (int c = 0; c < 3; ++c) {
      for (int d = 0; d < 3; ++d) half[c][d] = r[c][0] * m[0][d] + r[c][1] * m[1][d] + r[c][2] * m[2][d];
    }
    for (int c = 0; c < 3; ++c) {
      for (int d = 0; d < 3; ++d) turned[c][d] = half[c][0] * r[d][0] + half[c][1] * r[d][1] + half[c][2] * r[d][2];
    }
    for (int i = 0; i < 3; ++i) stress[i] = turned[i][i];
    stress[3] = turned[0][1], stress[4] = turned[1][2], stress[5] = turned[0][2];
  }

  template <class Visit>
  static void at_points(const T* g, const Law& law, const Motion<T>& motion, Visit&& visit) {
    T r[3][3] = {}, u[nodes][3], v[nodes][3];
    Motion<T> seen = motion;
    if constexpr (turns) {
      mean_rotation(g, law, motion, r);
      turn_back<nodes>(r, motion.displacements, u);
      if constexpr (Law::viscous) turn_back<nodes>(r, motion.velocities, v);
      seen = {u, v, motion.history};
    }
    const Field field(g, law.elastic(), seen.displacements);
    const Rate rate(g, law.elastic(), seen.velocities);
    for (int p = 0; p < Element::points; ++p) {
      Deformation<T> d;
      deform(field, r, p, d.gradient);
      if constexpr (Law::viscous) rate.gradient(p, d.rate);
      visit(p, d, motion.history + static_cast<std::ptrdiff_t>(p) * Law::history, r);
    }
  }
};

}  // namespace fem
