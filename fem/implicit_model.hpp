#pragma once
// Implicit steps on the state, supports and loads of the explicit model: Newmark's method, or a row of equilibria.
//   u' = u_g + w,  v' = v_g + gamma / (beta dt) w,  a' = a + w / (beta dt^2)
//   guess: u_g = u + dt v + dt^2/2 a,  v_g = v + dt a
//   f(u', v') + M a' + (alpha M + D) v' = F(t + dt),  D dashpots of absorbing boundaries
// Source: Newmark 1959; Hughes, The Finite Element Method (2000), 9.1 (beta, gamma, stability), 9.4.
// beta 1/4, gamma 1/2 (average acceleration) keeps the energy of a linear body at any step; gamma > 1/2 damps the high
// modes and is of first order. 2 beta < gamma is stable up to omega_max dt = 1 / sqrt(gamma/2 - beta) only.
// A static model leaves mass and damping out: every step ends in the equilibrium of its end, reached in one path from
// the equilibrium before; its works are those of forces that grow in proportion from one to the next.
// Laws that remember take a step as one, and keep what it ends with (backward Euler). Driven nodes follow their history
// as in the explicit model.
#include <span>

#include "fem/explicit_model.hpp"
#include "fem/newton.hpp"

namespace fem {

class ImplicitModel final : public ExplicitModel {
 public:
  ImplicitModel(MPI_Comm, const Setup&);

  StableStep stable_step() const override;
  /// Implicit steps are whole: the first two parts do nothing, correct() does all.
  void predict(double) override {}
  void inner_forces() override {}
  void correct(double dt) override;
  void hold(const std::string& body, bool held) override;
  void set_damping(const std::string& body, double alpha) override;
  base::Energy energy() const override;
  void reset_energy() override;
  base::Columns save() const override;
  void restore(const base::Columns&) override;

 private:
  struct Step {                                                          // as a step begins, owned components
    std::vector<double> displacements, loads, weight, damping, viscous;  // [m] [N] [N] [N] [N]
    std::vector<double> reactions;                                       // [N] of driven components
    std::vector<std::vector<Vec3>> contacts;                             // [N] of grains, by skin
  };
  bool is_static() const { return setup_.solver.kind == Solver::statics; }
  bool creeps() const { return assembly_.viscous() && !is_static(); }
  Step begin() const;
  void guess(double dt);
  void drive(double dt, const Step& before);
  void react(std::span<const double> damping);
  void refuse_absurd_displacements() const;
  void remember();
  void book_work(const Step& before, std::span<const double> damping);
  std::vector<double> damping_forces() const;  // [N] (alpha M + D) v of the owned components

  Newton newton_;
  NodalField elastic_;                              // [N] inner forces without their viscous part, where it creeps()
  std::vector<double> weight_;                      // [N] gravity on the owned components that are free
  std::vector<double> balanced_, weight_balanced_;  // [N] static: loads and weight of the last equilibrium
  std::vector<double> viscous_;                     // [N] viscous part of the inner forces, where it creeps()
  double step_ = 0;                                 // [s] that the matrix was made for
  double work_gravity_ = 0;                         // [J] of this rank
};

}  // namespace fem
