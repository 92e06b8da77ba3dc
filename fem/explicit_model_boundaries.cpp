// Prescribed motions and absorbing boundaries of the explicit model.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "fem/explicit_model.hpp"
#include "fem/faces.hpp"
#include "fem/families.hpp"

namespace fem {

void ExplicitModel::make_motions() {
  for (int b = 0; b < static_cast<int>(meshes_.size()); ++b) {
    const Body& body = setup_.bodies[b];
    auto led = held_components(meshes_[b], body);
    for (const auto& motion : body.motions) {
      base::require_internal(motion.history != nullptr, "a motion without a history");
      std::set<int> nodes;  // periodic faces may have two nodes on one unknown
      for (const int node : find_group(meshes_[b], body, motion.origin, "motion.group", motion.group).nodes)
        nodes.insert(meshes_[b].unknown_of(node));
      for (const int node : nodes) {
        const int local = layout_.owned_node(b, node);
        for (int c = 0; c < 3; ++c) {
          if (!motion.along[c]) continue;
          base::require_user(
              !led[node][c],
              fmt::format("{}motion.group = \"{}\" has nodes that a support or another motion leads along "
                          "{}; let every component be led once",
                          message_head(motion.origin, body.name), motion.group, "xyz"[c]));
          led[node][c] = true;
          if (local < 0) continue;
          driven_.push_back({3 * local + c, static_cast<int>(motions_.size()), b, 0});
          inverse_mass_[3 * local + c] = 0;
          if (motion.kind == PrescribedMotion::Kind::displacement)
            displacement_.data()[3 * local + c] = motion.history->value(0);
        }
      }
      motions_.push_back(motion);
    }
  }
}

void ExplicitModel::make_absorbers() {
  for (int b = 0; b < static_cast<int>(meshes_.size()); ++b) {
    const Body& body = setup_.bodies[b];
    std::map<int, Dashpot> dashpots;
    for (const auto& boundary : body.absorbing) {
      const Group& group = find_group(meshes_[b], body, boundary.origin, "absorbing.group", boundary.group);
      base::require_user(
          !group.facets.empty() && group.outside,
          fmt::format("{}absorbing.group = \"{}\" is not an outer surface of the body; waves can leave it "
                      "only there",
                      message_head(boundary.origin, body.name), boundary.group));
      for (std::size_t i = 0; i < group.facets.size(); ++i) {
        const MaterialRegion& material = body.materials[group.facet_regions[i]];
        const Elastic elastic = elastic_constants(material);
        const double along = std::sqrt(material.density * (elastic.lambda + 2 * elastic.mu));  // rho c_p [Pa s/m]
        const double across = std::sqrt(material.density * elastic.mu);                        // rho c_s
        const auto nodes = integrate(meshes_[b], group.facets[i]);
        Vec3 normal;
        for (const auto& node : nodes) normal += node.normal;
        normal *= 1 / base::norm(normal);
        for (const auto& node : nodes) {
          const int local = layout_.owned_node(b, node.node);
          if (local < 0) continue;
          Dashpot& dashpot = dashpots.try_emplace(local, Dashpot{local, {}}).first->second;
          for (int c = 0; c < 3; ++c) {
            for (int d = 0; d < 3; ++d)
              dashpot.drag[c][d] += node.lumped * ((c == d ? across : 0) + (along - across) * normal[c] * normal[d]);
          }
        }
      }
    }
    if (!dashpots.empty()) dashpot_of_.resize(layout_.owned, -1);
    for (const auto& [node, dashpot] : dashpots) {
      dashpot_of_[node] = static_cast<int>(dashpots_.size());
      dashpots_.push_back(dashpot);
    }
  }
}

/// Driven nodes go where their history says, after the step has been predicted.
void ExplicitModel::lead(double dt) {
  for (auto& driven : driven_) {
    if (states_[driven.body].held) continue;
    const auto& motion = motions_[driven.motion];
    double &u = displacement_.data()[driven.index], &v = velocity_.data()[driven.index];
    const double start = u - dt * v;
    if (motion.kind == PrescribedMotion::Kind::displacement) {
      u = motion.history->value(time_ + dt);
      v = dt > 0 ? (u - start) / dt : 0;
    } else {
      v = motion.history->value(time_ + 0.5 * dt);
      u = start + dt * v;
    }
    ledger_.work_loads += 0.5 * driven.reaction * (u - start);
  }
}

/// Velocity, acceleration and reaction of driven nodes at the end of the step.
void ExplicitModel::follow(double dt) {
  double *v = velocity_.data(), *a = acceleration_.data();
  for (auto& driven : driven_) {
    const int i = driven.index;
    if (states_[driven.body].held) {
      driven.reaction = 0;
      continue;
    }
    const auto& h = *motions_[driven.motion].history;
    const double half = v[i], alpha = states_[driven.body].damping, m = mass_.data()[i];
    if (motions_[driven.motion].kind == PrescribedMotion::Kind::displacement) {
      const double before = h.value(time_ - dt), now = h.value(time_), after = h.value(time_ + dt);
      v[i] = dt > 0 ? (after - before) / (2 * dt) : 0;
      a[i] = dt > 0 ? (after - 2 * now + before) / (dt * dt) : 0;
    } else {
      const double before = h.value(time_ - 0.5 * dt), after = h.value(time_ + 0.5 * dt);
      v[i] = 0.5 * (before + after);
      a[i] = dt > 0 ? (after - before) / dt : 0;
    }
    ledger_.loss_damping += 0.5 * dt * alpha * m * half * (v[i] - half);  // was counted with `half` at both ends
    driven.reaction = m * (a[i] + alpha * v[i]) + inner_.data()[i] - external_[i];
    if (!dashpot_of_.empty() && dashpot_of_[i / 3] >= 0) {
      for (int d = 0; d < 3; ++d) driven.reaction += dashpots_[dashpot_of_[i / 3]].drag[i % 3][d] * v[i - i % 3 + d];
    }
    ledger_.work_loads += 0.5 * driven.reaction * dt * half;
  }
}

/// A node on an absorbing boundary: (m + dt/2 (alpha m + C)) a = F - (alpha m + C) v_half. Returns its squared
/// velocity.
double ExplicitModel::absorb(const Dashpot& dashpot, int body, double dt) {
  const double alpha = states_[body].damping;
  const Vec3 gravity = setup_.bodies[body].gravity ? setup_.gravity : Vec3{};
  const int first = 3 * dashpot.node;
  double *v = velocity_.data() + first, *a = acceleration_.data() + first;
  double drag[3][3], matrix[3][4], before[3], half[3], measure = 0;
  for (int c = 0; c < 3; ++c) {
    before[c] = v[c] - 0.5 * dt * a[c];
    half[c] = v[c];
    for (int d = 0; d < 3; ++d) drag[c][d] = dashpot.drag[c][d] + (c == d ? alpha * mass_.data()[first] : 0);
  }
  for (int c = 0; c < 3; ++c) {
    const bool free = inverse_mass_[first + c] > 0;  // neither held nor driven
    for (int d = 0; d < 3; ++d) matrix[c][d] = (c == d ? mass_.data()[first] : 0) + (free ? 0.5 * dt * drag[c][d] : 0);
    matrix[c][3] = 0;
    if (!free) continue;
    matrix[c][3] = external_[first + c] - inner_.data()[first + c] + mass_.data()[first] * gravity[c];
    for (int d = 0; d < 3; ++d) matrix[c][3] -= drag[c][d] * half[d];
  }
  for (int p = 0; p < 3; ++p) {  // Gauss-Jordan; the matrix is positive definite
    for (int r = 0; r < 3; ++r) {
      if (r == p) continue;
      const double factor = matrix[r][p] / matrix[p][p];
      for (int c = p; c < 4; ++c) matrix[r][c] -= factor * matrix[p][c];
    }
  }
  for (int c = 0; c < 3; ++c) {
    a[c] = matrix[c][3] / matrix[c][c];
    v[c] = half[c] + 0.5 * dt * a[c];
    measure += v[c] * v[c];
  }
  for (int c = 0; c < 3; ++c) {
    for (int d = 0; d < 3; ++d) ledger_.loss_damping += 0.5 * dt * half[c] * drag[c][d] * (before[d] + v[d]);
  }
  return measure;
}

}  // namespace fem
