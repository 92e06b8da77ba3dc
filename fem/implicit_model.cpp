#include "fem/implicit_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "fem/communication.hpp"

namespace fem {

ImplicitModel::ImplicitModel(MPI_Comm comm, const Setup& setup)
    : ExplicitModel(comm, setup),
      newton_(setup_.solver, layout_, assembly_, *tangent_, inverse_mass_),
      weight_(weights()),
      balanced_(external_.size(), 0.0),
      weight_balanced_(external_.size(), 0.0) {
  if (is_static()) {
    std::fill_n(acceleration_.data(), acceleration_.owned_size(), 0.0);
  } else {
    make_damping();
  }
}

void ImplicitModel::make_damping() {
  std::vector<double> factors;
  for (const auto& body : setup_.bodies) factors.push_back(body.stiffness_damping);
  if (std::ranges::all_of(factors, [](double factor) { return factor == 0; })) return;
  damping_ = tangent_->make();
  tangent_->assemble(damping_, displacement_, factors);
}

StableStep ImplicitModel::stable_step() const {
  const double beta = setup_.solver.beta, gamma = setup_.solver.gamma;
  if (setup_.solver.kind == Solver::statics) return {INFINITY, "equilibria: no limit"};
  if (2 * beta >= gamma) return {INFINITY, "Newmark, unconditionally stable: no limit"};
  return {stable_step_.limit / (2 * std::sqrt(0.5 * gamma - beta)), stable_step_.limiter};
}

void ImplicitModel::hold(const std::string& body, bool held) {
  base::require_user(!held, fmt::format("body \"{}\" is held; only the explicit solver holds bodies in place", body));
}

void ImplicitModel::set_damping(const std::string& body, double alpha) {
  const double before = states_[body_index(body)].damping;
  ExplicitModel::set_damping(body, alpha);
  if (alpha != before) newton_.forget();
}

std::vector<double> ImplicitModel::damping_forces() const {
  std::vector<double> forces(external_.size(), 0.0);
  const double *v = velocity_.data(), *m = mass_.data();
  if (damping_) {
    Vector velocity, product;
    check_petsc(MatCreateVecs(damping_, velocity.place(), product.place()));
    double* values = nullptr;
    check_petsc(VecGetArray(velocity, &values));
    std::copy_n(v, forces.size(), values);
    check_petsc(VecRestoreArray(velocity, &values));
    check_petsc(MatMult(damping_, velocity, product));
    check_petsc(VecGetArray(product, &values));
    std::copy_n(values, forces.size(), forces.begin());
    check_petsc(VecRestoreArray(product, &values));
  }
  for (std::size_t b = 0; b < states_.size(); ++b) {
    for (int i = 3 * layout_.first_owned[b]; i < 3 * layout_.first_owned[b + 1]; ++i)
      forces[i] += states_[b].damping * m[i] * v[i];
  }
  return forces;
}

/// Displacements, velocities go to what they would be if the acceleration did not change.
void ImplicitModel::guess(double dt) {
  double *u = displacement_.data(), *v = velocity_.data();
  const double* a = acceleration_.data();
  for (std::size_t i = 0; i < external_.size(); ++i) {
    u[i] += dt * (v[i] + 0.5 * dt * a[i]);
    v[i] += dt * a[i];
  }
}

void ImplicitModel::correct(double dt) {
  const bool moves = !is_static();
  const double beta = setup_.solver.beta, gamma = setup_.solver.gamma;
  const std::size_t size = external_.size();
  if (moves && dt != step_) newton_.forget();
  step_ = dt;
  time_ += dt;
  ++steps_;
  const Step before{{displacement_.data(), displacement_.data() + size},
                    moves ? external_ : balanced_,
                    moves ? weight_ : weight_balanced_,
                    moves ? damping_forces() : std::vector<double>(size, 0.0)};
  gather_external_forces(time_);
  std::vector<double> given(external_), diagonal;
  for (std::size_t i = 0; i < size; ++i) given[i] += weight_[i];
  if (moves) {
    guess(dt);
    const auto damping = damping_forces();
    diagonal.resize(size);
    for (std::size_t b = 0; b < states_.size(); ++b) {
      const double factor = (1 / dt + gamma * states_[b].damping) / (beta * dt);
      for (int i = 3 * layout_.first_owned[b]; i < 3 * layout_.first_owned[b + 1]; ++i) {
        diagonal[i] = factor * mass_.data()[i];
        given[i] -= mass_.data()[i] * acceleration_.data()[i] + damping[i];
      }
    }
  }
  const std::vector<double> guessed(displacement_.data(), displacement_.data() + size);
  newton_.solve(displacement_, inner_, {diagonal, given, damping_, gamma / (beta * dt)},
                fmt::format("t = {:.6g} s (step {}): ", time_, steps_));
  if (moves) {
    for (std::size_t i = 0; i < size; ++i) {
      const double w = displacement_.data()[i] - guessed[i];
      velocity_.data()[i] += gamma / (beta * dt) * w;
      acceleration_.data()[i] += w / (beta * dt * dt);
    }
  }
  balanced_ = external_;
  weight_balanced_ = weight_;
  book_work(before);
}

/// Work of a force over a step: the mean of its two ends times the way.
void ImplicitModel::book_work(const Step& before) {
  const auto damping = is_static() ? before.damping : damping_forces();
  for (std::size_t i = 0; i < external_.size(); ++i) {
    const double half_way = 0.5 * (displacement_.data()[i] - before.displacements[i]);
    ledger_.work_loads += half_way * (before.loads[i] + external_[i]);
    ledger_.loss_damping += half_way * (before.damping[i] + damping[i]);
    work_gravity_ += half_way * (before.weight[i] + weight_[i]);
  }
}

base::Energy ImplicitModel::energy() const {
  base::Energy energy = ExplicitModel::energy();
  energy.work_gravity = work_gravity_;
  sum(layout_.comm, &energy.work_gravity, 1);
  return energy;
}

void ImplicitModel::reset_energy() {
  ExplicitModel::reset_energy();
  work_gravity_ = 0;
}

base::Columns ImplicitModel::save() const {
  base::Columns columns = ExplicitModel::save();
  base::Saver saver(columns);
  saver.numbers("step", step_);
  saver.rows("nodes/balanced", by_global_number(balanced_));
  saver.rows("nodes/weight_balanced", by_global_number(weight_balanced_));
  saver.rows("nodes/diagonal", by_global_number(newton_.diagonal()));
  saver.rows("ranks/work_gravity", of_all_ranks(std::span(&work_gravity_, 1)));
  if (layout_.rank != 0) columns.clear();
  return columns;
}

void ImplicitModel::restore(const base::Columns& columns) {
  ExplicitModel::restore(columns);
  base::Loader(columns).numbers("step", step_);
  take_owned(columns, "nodes/balanced", balanced_);
  take_owned(columns, "nodes/weight_balanced", weight_balanced_);
  std::vector<double> diagonal(balanced_.size());
  take_owned(columns, "nodes/diagonal", diagonal);
  newton_.set_diagonal(diagonal);
  newton_.forget();
  work_gravity_ = share_of_rank(columns, "ranks/work_gravity", 1)[0];
}

}  // namespace fem
