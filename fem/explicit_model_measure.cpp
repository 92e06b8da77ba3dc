// What a model tells of its state: energies, probes, pictures.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/memory.hpp"
#include "fem/communication.hpp"
#include "fem/explicit_model.hpp"

namespace fem {

int ExplicitModel::body_index(const std::string& name) const {
  std::vector<std::string> names;
  for (const auto& body : setup_.bodies) names.push_back(body.name);
  const auto place = std::ranges::find(names, name);
  base::require_user(place != names.end(),
                     fmt::format("body \"{}\" does not exist; there are: {}", name, fmt::join(names, ", ")));
  return static_cast<int>(place - names.begin());
}

/// Work of gravity from the reference place to the present one: the force is constant, so the sum over steps is this.
double ExplicitModel::gravity_potential() const {
  double work = 0;
  for (std::size_t b = 0; b < setup_.bodies.size(); ++b) {
    if (!setup_.bodies[b].gravity) continue;
    for (int i = 3 * layout_.first_owned[b]; i < 3 * layout_.first_owned[b + 1]; ++i) {
      if (inverse_mass_[i] > 0) work += mass_.data()[i] * setup_.gravity[i % 3] * displacement_.data()[i];
    }
  }
  return work;
}

base::Energy ExplicitModel::energy() const {
  double kinetic = 0, strain = 0;
  for (int i = 0; i < displacement_.owned_size(); ++i)
    kinetic += 0.5 * mass_.data()[i] * velocity_.data()[i] * velocity_.data()[i];
  for (int b = 0; b < static_cast<int>(meshes_.size()); ++b) {
    if (!simple_energy_[b]) {
      strain += assembly_.stored(b, displacement_);
      continue;
    }
    for (int i = 3 * layout_.first_owned[b]; i < 3 * layout_.first_owned[b + 1]; ++i)
      strain += 0.5 * displacement_.data()[i] * inner_.data()[i];  // linear elasticity: u.K.u / 2
  }
  double values[] = {kinetic,
                     strain,
                     gravity_potential() - gravity_zero_,
                     ledger_.work_loads,
                     ledger_.work_interface,
                     ledger_.loss_damping,
                     ledger_.loss_viscous,
                     ledger_.loss_plastic,
                     ledger_.interface_impulse.x,
                     ledger_.interface_impulse.y,
                     ledger_.interface_impulse.z,
                     ledger_.interface_angular_impulse.x,
                     ledger_.interface_angular_impulse.y,
                     ledger_.interface_angular_impulse.z};
  sum(layout_.comm, values, 14);
  base::Energy energy;
  energy.kinetic = values[0];
  energy.strain = values[1];
  energy.work_gravity = values[2];
  energy.work_loads = values[3];
  energy.work_interface = values[4];
  energy.loss_damping = values[5];
  energy.loss_viscous = values[6];
  energy.loss_plastic = values[7];
  energy.interface_impulse = {values[8], values[9], values[10]};
  energy.interface_angular_impulse = {values[11], values[12], values[13]};
  return energy;
}

void ExplicitModel::reset_energy() {
  ledger_ = {};
  gravity_zero_ = gravity_potential();
}

Vec3 ExplicitModel::value_at(int node, Quantity quantity) const {
  const NodalField& field = quantity == Quantity::displacement ? displacement_
                            : quantity == Quantity::velocity   ? velocity_
                                                               : acceleration_;
  const double* x = field.data() + 3 * static_cast<std::size_t>(node);
  return {x[0], x[1], x[2]};
}

Vec3 ExplicitModel::mean_over(int body, std::span<const int> nodes, Quantity quantity) const {
  Vec3 total;
  for (const int node : nodes) {
    const int local = layout_.owned_node(body, node);
    if (local < 0) continue;
    total += value_at(local, quantity);
    if (quantity != Quantity::displacement || zero_.empty()) continue;
    for (int c = 0; c < 3; ++c) total[c] -= zero_[3 * local + c];
  }
  sum(layout_.comm, &total.x, 3);
  return total * (1.0 / static_cast<double>(nodes.size()));
}

Vec3 ExplicitModel::probe_group(const std::string& body, const std::string& group, Quantity quantity) const {
  const int b = body_index(body);
  const auto& nodes = find_group(meshes_[b], setup_.bodies[b], setup_.bodies[b].origin, "probe.group", group).nodes;
  return mean_over(b, nodes, quantity);
}

int ExplicitModel::nearest_node(int b, const Vec3& point) const {
  const std::pair<int, std::array<double, 3>> key{b, {point.x, point.y, point.z}};
  auto known = std::ranges::find(nearest_, key, [](const auto& entry) { return entry.first; });
  if (known == nearest_.end()) {
    const auto& nodes = meshes_[b].nodes;
    const auto nearest =
        std::ranges::min_element(nodes, {}, [&](const Vec3& node) { return base::norm2(node - point); });
    known = nearest_.insert(nearest_.end(), {key, static_cast<int>(nearest - nodes.begin())});
  }
  return known->second;
}

Vec3 ExplicitModel::probe_point(const std::string& body, Vec3 point, Quantity quantity) const {
  const int b = body_index(body);
  const int node = nearest_node(b, point);
  return mean_over(b, std::span(&node, 1), quantity);
}

void ExplicitModel::check_point(const std::string& body, const Vec3& point, const Origin& origin) const {
  const int b = body_index(body);
  const Mesh& mesh = meshes_[b];
  Vec3 node = mesh.nodes[nearest_node(b, point)];
  for (int c = 0; c < 3; ++c) node[c] = std::round(node[c] * 1e9) / 1e9 + 0.0;  // as people write it
  on_first_rank(layout_.comm, [&] {                                             // it has all elements
    for (int e = 0; e < mesh.element_count(); ++e) {
      Vec3 lower = mesh.nodes[mesh.element(e)[0]], upper = lower, outside;
      for (int a = 1; a < mesh.element_nodes; ++a) {
        const Vec3& x = mesh.nodes[mesh.element(e)[a]];
        for (int c = 0; c < 3; ++c) {
          lower[c] = std::min(lower[c], x[c]);
          upper[c] = std::max(upper[c], x[c]);
        }
      }
      for (int c = 0; c < 3; ++c) outside[c] = std::max({lower[c] - point[c], point[c] - upper[c], 0.0});
      if (base::norm(outside) <= base::norm(upper - lower)) return;
    }
    throw base::UserError(fmt::format(
        "{}point = ({:.6g}, {:.6g}, {:.6g}) m lies {:.3g} m from the nearest node, at ({:.6g}, {:.6g}, {:.6g}) m, "
        "farther "
        "than the elements there are large; move it to the body",
        message_head(origin, body), point.x, point.y, point.z, base::norm(point - node), node.x, node.y, node.z));
  });
}

std::vector<double> ExplicitModel::reactions() const {
  std::vector<double> result(inverse_mass_.size(), 0.0);
  for (std::size_t b = 0; b < meshes_.size(); ++b) {
    const Vec3 gravity = setup_.bodies[b].gravity ? setup_.gravity : Vec3{};
    for (int i = 3 * layout_.first_owned[b]; i < 3 * layout_.first_owned[b + 1]; ++i) {
      if (inverse_mass_[i] == 0) result[i] = inner_.data()[i] - external_[i] - mass_.data()[i] * gravity[i % 3];
    }
  }
  for (const auto& driven : driven_) {  // they have inertia too
    const double gravity = setup_.bodies[driven.body].gravity ? setup_.gravity[driven.index % 3] : 0;
    result[driven.index] = driven.reaction - mass_.data()[driven.index] * gravity;
  }
  return result;
}

Vec3 ExplicitModel::reaction(const std::string& body, const std::string& group) const {
  const int b = body_index(body);
  const auto all = reactions();
  Vec3 total;
  const auto& nodes = find_group(meshes_[b], setup_.bodies[b], setup_.bodies[b].origin, "probe.group", group).nodes;
  for (const int local : layout_.owned_nodes(b, nodes)) {
    for (int c = 0; c < 3; ++c) total[c] += all[3 * static_cast<std::size_t>(local) + c];
  }
  sum(layout_.comm, &total.x, 3);
  return total;
}

std::vector<std::array<double, 6>> ExplicitModel::element_stresses(const std::string& body) const {
  const int b = body_index(body);
  const bool moves = assembly_.viscous();
  displacement_.begin_to_ghosts();
  displacement_.end_to_ghosts();
  if (moves) velocity_.begin_to_ghosts();
  if (moves) velocity_.end_to_ghosts();
  return of_all_elements(b, assembly_.stresses(b, displacement_, moves ? &velocity_ : nullptr));
}

/// In the order of the mesh, on every rank.
template <class Value>
std::vector<Value> ExplicitModel::of_all_elements(int b, const std::vector<Value>& own) const {
  const auto elements = assembly_.elements_of(b);
  std::vector<Value> all(meshes_[b].regions.size());
  for (std::size_t i = 0; i < own.size(); ++i) all[elements[i]] = own[i];
  sum(layout_.comm, reinterpret_cast<double*>(all.data()),
      static_cast<int>(all.size() * sizeof(Value) / sizeof(double)));
  return all;
}

const Recovery& ExplicitModel::recovery_at(int b, const Spot& spot) const {
  const int node = spot.point ? nearest_node(b, *spot.point) : -1;
  const auto [place, fresh] = recoveries_.try_emplace({b, node, spot.group});
  Recovery& recovery = place->second;
  if (!fresh) return recovery;
  const auto& body = setup_.bodies[b];
  const Group* group = spot.point ? nullptr : &find_group(meshes_[b], body, body.origin, "probe.group", spot.group);
  if (group && group->facets.empty()) {
    recoveries_.erase(place);
    throw base::UserError(
        fmt::format("{}probe.group = \"{}\" is not a surface; a mean over an area needs a physical surface",
                    message_head(body.origin, body.name), spot.group));
  }
  // the first rank has all elements
  if (layout_.rank == 0)
    recovery = group ? recovery_over(meshes_[b], group->facets) : fem::recovery_at(meshes_[b], node);
  broadcast(layout_.comm, recovery.elements);
  broadcast(layout_.comm, recovery.weights);
  return recovery;
}

std::array<double, 6> ExplicitModel::stress_at(const std::string& body, const Spot& spot) const {
  const Recovery& recovery = recovery_at(body_index(body), spot);
  const auto stresses = element_stresses(body);
  std::array<double, 6> result{};
  for (std::size_t i = 0; i < recovery.elements.size(); ++i) {
    for (int c = 0; c < 6; ++c) result[c] += recovery.weights[i] * stresses[recovery.elements[i]][c];
  }
  return result;
}

double ExplicitModel::plastic_strain_at(const std::string& body, const Spot& spot) const {
  const int b = body_index(body);
  const Recovery& recovery = recovery_at(b, spot);
  const auto strains = of_all_elements(b, assembly_.plastic_strains(b));
  double result = 0;
  for (std::size_t i = 0; i < recovery.elements.size(); ++i)
    result += recovery.weights[i] * strains[recovery.elements[i]];
  return std::max(result, 0.0);
}

double ExplicitModel::load_value(const std::string& name) const {
  for (const auto& load : loads_) {
    if (load.load.name == name) return load.load.history->value(time_);
  }
  for (const auto& motion : motions_) {
    if (motion.name == name) return motion.history->value(time_);
  }
  throw base::UserError("load \"" + name + "\" does not exist");
}

void ExplicitModel::set_displacement_zero() {
  zero_.assign(displacement_.data(), displacement_.data() + displacement_.owned_size());
}

void ExplicitModel::write(const std::string& directory, double time) {
  const auto file = picture(directory, time);
  on_first_rank(layout_.comm, [&] { file(); });
}

std::function<void()> ExplicitModel::picture(const std::string& directory, double time) {
  std::vector<double> shown(displacement_.data(), displacement_.data() + displacement_.owned_size());
  for (std::size_t i = 0; i < zero_.size(); ++i) shown[i] -= zero_[i];
  displacement_.begin_to_ghosts();
  displacement_.end_to_ghosts();
  velocity_.begin_to_ghosts();
  velocity_.end_to_ghosts();
  const auto supported = reactions();
  auto file = output_->picture(directory, {time, shown, displacement_, velocity_, &acceleration_, &supported});
  if (!file) return {};
  return [file = std::move(file)]() mutable {
    std::exchange(file, {})();
    base::release_memory();  // what the picture took is half of what the model needs
  };
}

std::vector<BodyModes> ExplicitModel::find_modes(int count) {
  const Matrix stiffness = tangent_->make();
  tangent_->assemble(stiffness);
  const ModesInput input{setup_, meshes_, layout_, stiffness, {mass_.data(), inverse_mass_.size()}, inverse_mass_};
  std::vector<BodyModes> result;
  for (int b = 0; b < static_cast<int>(meshes_.size()); ++b) {
    modes_.push_back(fem::find_modes(input, b, count, mechanisms_[b]));
    result.push_back({setup_.bodies[b].name, static_cast<int>(mechanisms_[b].free.size()), modes_.back().modes});
  }
  return result;
}

void ExplicitModel::write_modes(const std::string& directory) {
  std::size_t most = 0;
  for (const auto& found : modes_) most = std::max(most, found.shapes.size());
  NodalField shape(layout_), at_rest(layout_);
  std::fill_n(at_rest.data(), at_rest.local_size(), 0.0);
  for (std::size_t k = 0; k < most; ++k) {
    std::fill_n(shape.data(), shape.owned_size(), 0.0);
    for (std::size_t b = 0; b < modes_.size(); ++b) {
      if (k >= modes_[b].shapes.size()) continue;
      const auto& values = modes_[b].shapes[k];
      double largest = 0;
      for (const double value : values) largest = std::max(largest, std::abs(value));
      MPI_Allreduce(MPI_IN_PLACE, &largest, 1, MPI_DOUBLE, MPI_MAX, layout_.comm);
      double* const to = shape.data() + 3 * layout_.first_owned[b];
      for (std::size_t i = 0; i < values.size(); ++i) to[i] = values[i] / largest;
    }
    shape.begin_to_ghosts();
    shape.end_to_ghosts();
    output_->write(
        directory,
        {static_cast<double>(k + 1), {shape.data(), static_cast<std::size_t>(shape.owned_size())}, shape, at_rest});
  }
}

}  // namespace fem
