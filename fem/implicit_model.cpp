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
      elastic_(layout_),
      weight_(weights()),
      balanced_(external_.size(), 0.0),
      weight_balanced_(external_.size(), 0.0) {
  if (is_static()) std::fill_n(acceleration_.data(), acceleration_.owned_size(), 0.0);
  if (creeps()) viscous_.assign(external_.size(), 0.0);
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
  if (is_static()) return forces;
  const double *v = velocity_.data(), *m = mass_.data();
  for (std::size_t b = 0; b < states_.size(); ++b) {
    for (int i = 3 * layout_.first_owned[b]; i < 3 * layout_.first_owned[b + 1]; ++i)
      forces[i] = states_[b].damping * m[i] * v[i];
  }
  for (const auto& dashpot : dashpots_) {
    const int first = 3 * dashpot.node;
    for (int c = 0; c < 3; ++c) {
      for (int d = 0; d < 3; ++d) forces[first + c] += dashpot.drag[c][d] * v[first + d];
    }
  }
  return forces;
}

ImplicitModel::Step ImplicitModel::begin() const {
  Step step{{displacement_.data(), displacement_.data() + external_.size()},
            is_static() ? balanced_ : external_,
            is_static() ? weight_balanced_ : weight_,
            damping_forces(),
            viscous_,
            {},
            {}};
  for (const auto& driven : driven_) step.reactions.push_back(driven.reaction);
  for (const auto& contact : contacts_) step.contacts.push_back(contact.used);
  return step;
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

/// Driven components go where their history says.
void ImplicitModel::drive(double dt, const Step& before) {
  for (const auto& driven : driven_) {
    const auto& motion = motions_[driven.motion];
    const bool place = motion.kind == PrescribedMotion::Kind::displacement;
    displacement_.data()[driven.index] =
        place ? motion.history->value(time_)
              : before.displacements[driven.index] + dt * motion.history->value(time_ - 0.5 * dt);
    if (is_static()) continue;
    const double ahead = motion.history->value(time_ + (place ? dt : 0.5 * dt)), now = motion.history->value(time_),
                 behind = motion.history->value(time_ - (place ? dt : 0.5 * dt));
    velocity_.data()[driven.index] = place ? (ahead - behind) / (2 * dt) : 0.5 * (ahead + behind);
    acceleration_.data()[driven.index] = place ? (ahead - 2 * now + behind) / (dt * dt) : (ahead - behind) / dt;
  }
}

/// The forces that drive the driven components.
void ImplicitModel::react(std::span<const double> damping) {
  for (auto& driven : driven_) {
    const int i = driven.index;
    driven.reaction = inner_.data()[i] - external_[i] + damping[i];
    if (!is_static()) driven.reaction += mass_.data()[i] * acceleration_.data()[i];
  }
}

void ImplicitModel::correct(double dt) {
  const bool moves = !is_static();
  const double beta = setup_.solver.beta, gamma = setup_.solver.gamma, rate = moves ? gamma / (beta * dt) : 0;
  const std::size_t size = external_.size();
  if (moves && dt != step_) newton_.forget();
  step_ = dt;
  time_ += dt;
  ++steps_;
  const Step before = begin();
  gather_external_forces(time_);
  std::vector<double> given(external_), diagonal;
  for (std::size_t i = 0; i < size; ++i) given[i] += weight_[i];
  if (moves) guess(dt);
  drive(dt, before);
  if (moves) {
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
  newton_.solve(displacement_, inner_, {diagonal, given, dashpots_, moves ? &velocity_ : nullptr, rate},
                fmt::format("t = {:.6g} s (step {}): ", time_, steps_));
  if (moves) {
    for (std::size_t i = 0; i < size; ++i)
      acceleration_.data()[i] += (displacement_.data()[i] - guessed[i]) / (beta * dt * dt);
  }
  if (!moves) refuse_absurd_displacements();
  remember();
  const auto damping = damping_forces();
  react(damping);
  balanced_ = external_;
  weight_balanced_ = weight_;
  book_work(before, damping);
  book_interface_impulse(dt);
}

/// A hinge, or a material without stiffness, lets a static body go anywhere.
void ImplicitModel::refuse_absurd_displacements() const {
  constexpr double absurd = 10;  // sizes of the body; small strains end far below
  for (std::size_t b = 0; b < meshes_.size(); ++b) {
    double largest = 0;
    for (int i = 3 * layout_.first_owned[b]; i < 3 * layout_.first_owned[b + 1]; ++i)
      largest = std::max(largest, std::abs(displacement_.data()[i]));
    MPI_Allreduce(MPI_IN_PLACE, &largest, 1, MPI_DOUBLE, MPI_MAX, layout_.comm);
    const double size = base::norm(counts_[b].upper - counts_[b].lower);
    base::require_user(
        largest <= absurd * size,
        fmt::format("{}moves by {:.3g} m in equilibrium, {:.3g} times its size: a part of it can turn about "
                    "an edge or a node that joins it to the rest, or its material is far too soft; join "
                    "cells by their sides, or look at young_modulus and the loads",
                    message_head(setup_.bodies[b].origin, setup_.bodies[b].name), largest, largest / size));
  }
}

/// What laws remember, and the viscous part of the forces, of the state that a step has come to.
void ImplicitModel::remember() {
  if (assembly_.keeps_history()) {
    displacement_.begin_to_ghosts();
    if (assembly_.viscous()) velocity_.begin_to_ghosts();
    ledger_.loss_plastic += assembly_.advance(displacement_, velocity_, inner_).plastic_work;
  }
  if (!creeps()) return;
  displacement_.begin_to_ghosts();
  assembly_.inner_forces(displacement_, nullptr, elastic_);
  for (std::size_t i = 0; i < viscous_.size(); ++i) viscous_[i] = inner_.data()[i] - elastic_.data()[i];
}

/// Work of a force over a step: the mean of its two ends times the way.
void ImplicitModel::book_work(const Step& before, std::span<const double> damping) {
  for (std::size_t i = 0; i < external_.size(); ++i) {
    const double half_way = 0.5 * (displacement_.data()[i] - before.displacements[i]);
    ledger_.work_loads += half_way * (before.loads[i] + external_[i]);
    ledger_.loss_damping += half_way * (before.damping[i] + damping[i]);
    if (creeps()) ledger_.loss_viscous += half_way * (before.viscous[i] + viscous_[i]);
    work_gravity_ += half_way * (before.weight[i] + weight_[i]);
  }
  for (std::size_t k = 0; k < driven_.size(); ++k) {
    const int i = driven_[k].index;
    const double half_way = 0.5 * (displacement_.data()[i] - before.displacements[i]);
    ledger_.work_loads += half_way * (before.reactions[k] + driven_[k].reaction);
  }
  // Contact forces are among the loads above, but their work is the interface's.
  for (std::size_t s = 0; s < contacts_.size(); ++s) {
    for (std::size_t k = 0; k < contacts_[s].nodes.size(); ++k) {
      const Vec3 both = before.contacts[s][k] + contacts_[s].used[k];
      for (int c = 0; c < 3; ++c) {
        const int i = 3 * contacts_[s].nodes[k] + c;
        const double work = 0.5 * (displacement_.data()[i] - before.displacements[i]) * both[c];
        ledger_.work_interface += work;
        ledger_.work_loads -= work;
      }
    }
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
  if (creeps()) saver.rows("nodes/viscous", by_global_number(viscous_));
  saver.rows("ranks/work_gravity", of_all_ranks(std::span(&work_gravity_, 1)));
  if (layout_.rank != 0) columns.clear();
  return columns;
}

void ImplicitModel::restore(const base::Columns& columns) {
  ExplicitModel::restore(columns);
  base::Loader(columns).numbers("step", step_);
  take_owned(columns, "nodes/balanced", balanced_);
  take_owned(columns, "nodes/weight_balanced", weight_balanced_);
  if (creeps()) take_owned(columns, "nodes/viscous", viscous_);
  std::vector<double> diagonal(balanced_.size());
  take_owned(columns, "nodes/diagonal", diagonal);
  newton_.set_diagonal(diagonal);
  newton_.forget();
  work_gravity_ = share_of_rank(columns, "ranks/work_gravity", 1)[0];
}

}  // namespace fem
