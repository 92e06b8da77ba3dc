#pragma once
// Rolling resistance of one contact: a moment against the turning of i relative to j in the contact plane. j gets the
// opposite, so angular momentum is kept. (The fourth model, BROF, brakes each grain as a whole: rolling.hpp.)
//
//   none      M = 0
//   type A    M = -eta_r R* F_n omega / |omega|                        constant, against the turning             (5.1)
//   type C    M = M_k + M_d,  dM_k = -k_r d(angle),  M_d = -c_r omega,  |M| <= eta_r R* F_n      elastic-plastic
//             k_r = 2.25 k_n eta_r^2 R*^2,  c_r = 2 delta_r sqrt(I_r k_r),
//             1/I_r = 1/(I_i + m_i R_i^2) + 1/(I_j + m_j R_j^2)
// Source: Ai, Chen, Rotter, Ooi 2011 (doi:10.1016/j.powtec.2010.09.030), models A and C; Irazabal2017 5.1-5.3, 5.6a.
// Where we differ from the source:
// - omega is the part of the relative angular velocity in the contact plane: twist about the normal is no rolling (the
//   source works in two dimensions);
// - C is the friction law of shear.hpp with angles for displacements. So the sum of spring and dashpot stays below the
//   limit (Ai et al. switch the dashpot off at the limit, and below it let the sum exceed it), and the spring gives way
//   when k_r falls with the patch, so that no cycle gains energy.
// Limits: A trembles at rest (its direction is undefined at omega = 0; there it answers zero); C swings to rest.
#include "dem/kernels/pair_parameters.hpp"
#include "dem/kernels/shear.hpp"
#include "dem/kernels/turning.hpp"

namespace dem::kernels {

template <class Real>
struct RollingContact {
  Vector3<Real> angular_velocity;  // [rad/s] of i relative to j
  Real normal_force;               // [N] of this contact now, Reaction::normal_force
  Real shear_stiffness;            // [N/m] k_t now: the last number of the law's history, Law::history - 1; only C
  Real inertia;                    // [kg m2] I_r; only C. Spheres: 1.4 m R^2 for I + m R^2, walls: infinitely much
};

/// I_r of two spheres; a wall: mass_j = 0 stands for infinitely much.
template <class Real>
TRACKBED_HD TRACKBED_LANES Real rolling_inertia(Real mass_i, Real radius_i, Real mass_j, Real radius_j) {
  const Real i = all<Real>(1.4) * mass_i * radius_i * radius_i, j = all<Real>(1.4) * mass_j * radius_j * radius_j;
  const auto free = mass_j > Real{};
  return choose(free, i * j, i) / choose(free, i + j, all<Real>(1));
}

struct NoRolling {
  static constexpr int history = 0;

  template <bool Ledger, class Real>
  TRACKBED_HD TRACKBED_LANES static Moment<Real> resist(const PairParameters&, const Touch<Real>&,
                                                        const RollingContact<Real>&, const Interval&, Real*) {
    return {};
  }
};

/// BROF: nothing per contact; each grain is braked as a whole (rolling.hpp).
struct BoundedRolling : NoRolling {};

struct RollingA {
  static constexpr int history = 0;

  template <bool Ledger, class Real>
  TRACKBED_HD TRACKBED_LANES static Moment<Real> resist(const PairParameters& pair, const Touch<Real>& touch,
                                                        const RollingContact<Real>& contact, const Interval& time,
                                                        Real*) {
    const Vector3<Real> turning = contact.angular_velocity - dot(contact.angular_velocity, touch.normal) * touch.normal;
    const Real squared = norm2(turning);
    const auto rolls = both(squared > Real{}, touch.overlap > Real{});
    const Real speed = square_root(choose(rolls, squared, all<Real>(1)));
    const Real limit =
        choose(rolls, all<Real>(pair.rolling_friction) * touch.effective_radius * contact.normal_force, Real{});
    Moment<Real> result;
    result.moment = (-limit / speed) * turning;
    if constexpr (Ledger) result.loss = limit * speed * all<Real>(time.before + time.ahead);
    return result;
  }
};

struct RollingC {
  static constexpr int history = 4;  // spring moment, half a step ahead [N m], rolling stiffness [N m]

  template <bool Ledger, class Real>
  TRACKBED_HD TRACKBED_LANES static Moment<Real> resist(const PairParameters& pair, const Touch<Real>& touch,
                                                        const RollingContact<Real>& contact, const Interval& time,
                                                        Real* history) {
    Touch<Real> turning = touch;
    turning.velocity = contact.angular_velocity;
    NormalForce<Real> spring;
    spring.force = all<Real>(pair.rolling_friction) * touch.effective_radius * contact.normal_force;
    spring.shear_stiffness =
        all<Real>(pair.rolling_stiffness) * contact.shear_stiffness * touch.effective_radius * touch.effective_radius;
    spring.damping = all<Real>(2 * pair.rolling_damping) * square_root(contact.inertia * spring.shear_stiffness);
    spring.separation = dot(contact.angular_velocity, touch.normal);
    spring.stored = spring.lost_power = Real{};
    const Reaction<Real> rolled = sheared<Ledger>(spring, all<Real>(1), 1, turning, time, history);
    return {rolled.force - rolled.normal_force * touch.normal, rolled.elastic_shear,
            rolled.loss_friction + rolled.loss_damping};
  }
};

}  // namespace dem::kernels
