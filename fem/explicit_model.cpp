#include "fem/explicit_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "fem/communication.hpp"
#include "fem/implicit_model.hpp"

namespace fem {

std::unique_ptr<Model> Model::create(MPI_Comm comm, const Setup& setup) {
  const Solver kind = setup.solver.kind;
  if (kind == Solver::newmark || kind == Solver::statics) return std::make_unique<ImplicitModel>(comm, setup);
  return std::make_unique<ExplicitModel>(comm, setup);
}

void ExplicitModel::predict(double dt) {
  double *u = displacement_.data(), *v = velocity_.data();
  const double* a = acceleration_.data();
  for (std::size_t b = 0; b < states_.size(); ++b) {
    if (states_[b].held) continue;
    const int last = 3 * layout_.first_owned[b + 1];
    for (int i = 3 * layout_.first_owned[b]; i < last; ++i) {
      v[i] += 0.5 * dt * a[i];
      u[i] += dt * v[i];
    }
  }
  lead(dt);
  half_step_ = 0.5 * dt;
  displacement_.begin_to_ghosts();
  if (assembly_.viscous()) velocity_.begin_to_ghosts();
  // half of each force's work over this step, with the force as it was at its beginning
  for (const auto& load : loads_) {
    double power = 0;
    for (const auto& [node, force] : load.share) power += base::dot(force, value_at(node, Quantity::velocity));
    ledger_.work_loads += 0.5 * dt * load.value * power;
  }
  for (const auto& contact : contacts_) {
    for (std::size_t i = 0; i < contact.nodes.size(); ++i) {
      ledger_.work_interface += 0.5 * dt * base::dot(contact.used[i], value_at(contact.nodes[i], Quantity::velocity));
    }
  }
}

void ExplicitModel::inner_forces() {
  const Losses losses = assembly_.advance(displacement_, velocity_, inner_);
  // Viscous forces are those of the half step before; half of each force's work over a step is a sum of C v v' with the
  // velocities of two half steps, which is this to the square of the step.
  ledger_.loss_viscous += 2 * half_step_ * (0.75 * losses.viscous_power + 0.25 * viscous_power_);
  ledger_.loss_plastic += losses.plastic_work;
  viscous_power_ = losses.viscous_power;
}

void ExplicitModel::gather_external_forces(double time) {
  for (const auto& load : loads_) {
    for (const auto& [node, force] : load.share) std::fill_n(external_.begin() + 3 * node, 3, 0.0);
  }
  for (const auto& contact : contacts_) {
    for (const int node : contact.nodes) std::fill_n(external_.begin() + 3 * node, 3, 0.0);
  }
  for (auto& load : loads_) {
    load.value = load.load.history->value(time);
    for (const auto& [node, force] : load.share) {
      for (int c = 0; c < 3; ++c) external_[3 * node + c] += load.value * force[c];
    }
  }
  for (auto& contact : contacts_) {
    contact.used = contact.given;
    for (std::size_t i = 0; i < contact.nodes.size(); ++i) {
      for (int c = 0; c < 3; ++c) external_[3 * contact.nodes[i] + c] += contact.used[i][c];
    }
  }
}

/// New accelerations and end-of-step velocities from the half-step ones; returns the sum of squared velocities.
double ExplicitModel::update_accelerations(double dt) {
  double *v = velocity_.data(), *a = acceleration_.data();
  const double *f = inner_.data(), *m = mass_.data();
  double measure = 0;
  for (std::size_t b = 0; b < states_.size(); ++b) {
    if (states_[b].held) continue;
    const double alpha = states_[b].damping, divisor = 1 / (1 + 0.5 * alpha * dt);
    const Vec3 gravity = setup_.bodies[b].gravity ? setup_.gravity : Vec3{};
    double loss = 0;
    for (int node = layout_.first_owned[b]; node < layout_.first_owned[b + 1]; ++node) {
      if (!dashpot_of_.empty() && dashpot_of_[node] >= 0) {
        measure += absorb(dashpots_[dashpot_of_[node]], static_cast<int>(b), dt);
        continue;
      }
      for (int c = 0; c < 3; ++c) {
        const int i = 3 * node + c;
        const double free = inverse_mass_[i] > 0 ? 1.0 : 0.0;
        const double before = v[i] - 0.5 * dt * a[i];
        a[i] = (inverse_mass_[i] * (external_[i] - f[i]) + free * (gravity[c] - alpha * v[i])) * divisor;
        const double after = v[i] + 0.5 * dt * a[i];
        loss += 0.5 * m[i] * v[i] * (before + after);
        v[i] = after;
        measure += after * after;
      }
    }
    ledger_.loss_damping += alpha * dt * loss;
  }
  follow(dt);
  return measure;
}

void ExplicitModel::correct(double dt) {
  time_ += dt;
  half_step_ = 0;
  ++steps_;
  gather_external_forces(time_);
  for (const auto& load : loads_) {  // velocities are still the half-step ones: dt times them is the way of the step
    double power = 0;
    for (const auto& [node, force] : load.share) power += base::dot(force, value_at(node, Quantity::velocity));
    ledger_.work_loads += 0.5 * dt * load.value * power;
  }
  for (const auto& contact : contacts_) {
    for (std::size_t i = 0; i < contact.nodes.size(); ++i) {
      ledger_.work_interface += 0.5 * dt * base::dot(contact.used[i], value_at(contact.nodes[i], Quantity::velocity));
    }
  }
  book_interface_impulse(dt);
  agree_on_finite(update_accelerations(dt));
}

/// What the skins' nodes receive over a step that ends now.
void ExplicitModel::book_interface_impulse(double dt) {
  for (const auto& contact : contacts_) {
    for (std::size_t i = 0; i < contact.nodes.size(); ++i) {
      if (contact.used[i].x == 0 && contact.used[i].y == 0 && contact.used[i].z == 0) continue;
      const double* u = displacement_.data() + 3 * contact.nodes[i];
      const Vec3 impulse = dt * contact.used[i];
      ledger_.interface_impulse += impulse;
      ledger_.interface_angular_impulse += base::cross(contact.places[i] + Vec3{u[0], u[1], u[2]}, impulse);
    }
  }
}

/// All ranks look together every few steps, one rank alone at every step.
void ExplicitModel::agree_on_finite(double measure) {
  constexpr long steps_between_looks = 16;
  if (layout_.ranks > 1 && steps_ % steps_between_looks != 0) return;
  std::string message;
  Outcome outcome = Outcome::good;
  if (!std::isfinite(measure)) {
    outcome = Outcome::unstable;
    int node = 0;
    while (node + 1 < layout_.owned && std::isfinite(base::norm2(value_at(node, Quantity::velocity)))) ++node;
    const auto past = std::ranges::upper_bound(layout_.first_node, layout_.global_of_local[node]);
    const auto body = past - layout_.first_node.begin() - 1;
    const int own = layout_.global_of_local[node] - layout_.first_node[body];
    const Vec3& x = meshes_[body].nodes[own];
    message = fmt::format(
        "body \"{}\" became unstable: the velocity of node {} at ({:.4g}, {:.4g}, {:.4g}) m is no longer a "
        "finite number at t = {:.6g} s (FEM step {}); stable step {:.4g} s",
        setup_.bodies[body].name, own + 1, x.x, x.y, x.z, time_, steps_, stable_step_.limit);
  }
  agree(layout_.comm, outcome, message);
}

void ExplicitModel::start_accelerations() {
  displacement_.begin_to_ghosts();
  if (assembly_.viscous()) velocity_.begin_to_ghosts();
  inner_forces();
  gather_external_forces(time_);
  update_accelerations(0);
}

void ExplicitModel::set_damping(const std::string& body, double alpha) { states_[body_index(body)].damping = alpha; }

void ExplicitModel::hold(const std::string& body, bool held) {
  const int b = body_index(body);
  if (states_[b].held == held) return;
  states_[b].held = held;
  if (held) {
    double *v = velocity_.data(), *a = acceleration_.data();
    for (int i = 3 * layout_.first_owned[b]; i < 3 * layout_.first_owned[b + 1]; ++i) {
      ledger_.loss_damping += 0.5 * mass_.data()[i] * v[i] * v[i];  // what the hold takes out
      v[i] = a[i] = 0;
    }
  } else {
    start_accelerations();
  }
}

void ExplicitModel::skin_state(int skin, std::span<Vec3> positions, std::span<Vec3> velocities) const {
  const auto& contact = contacts_.at(skin);
  for (std::size_t i = 0; i < contact.nodes.size(); ++i) {
    const int node = contact.nodes[i];
    for (int c = 0; c < 3; ++c) {
      positions[i][c] = contact.places[i][c] + displacement_.data()[3 * node + c];
      velocities[i][c] = velocity_.data()[3 * node + c] + half_step_ * acceleration_.data()[3 * node + c];
    }
  }
}

std::vector<double> ExplicitModel::skin_mobility(int skin) const {
  std::vector<double> mobility;
  for (const int node : contacts_.at(skin).nodes) {
    const double* inverse = inverse_mass_.data() + 3 * node;
    mobility.push_back(std::max({inverse[0], inverse[1], inverse[2]}));
  }
  return mobility;
}

void ExplicitModel::set_skin_forces(int skin, std::span<const Vec3> forces) {
  std::ranges::copy(forces, contacts_.at(skin).given.begin());
}

}  // namespace fem
