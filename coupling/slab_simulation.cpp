#include "coupling/slab_simulation.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.hpp"
#include "coupling/agree.hpp"
#include "coupling/checkpoint.hpp"

namespace coupling {

namespace {

dem::StableStep shortest(const std::vector<dem::StableStep>& steps) {
  return *std::ranges::min_element(steps, {}, &dem::StableStep::limit);
}

std::string group(int part) { return fmt::format("part_{}/", part); }

}  // namespace

std::vector<base::Columns> saved_parts(const base::Columns& columns) {
  const auto& number = base::column<std::vector<int>>(columns, "parts");
  if (number.size() != 1) return {columns};
  std::vector<base::Columns> parts;
  for (int part = 0; part < number[0]; ++part) parts.push_back(group_of(columns, group(part)));
  return parts;
}

SlabSimulation::SlabSimulation(SlabCrew& crew, int number) : crew_(crew), number_(number) {}

SlabSimulation::~SlabSimulation() {
  static_cast<void>(caught([&] { crew_.order(ByteWriter(destroy_slab, number_).bytes()); }));
}

/// What the parts answer, by rank; nothing where the call gives nothing.
template <auto call, class... A>
auto SlabSimulation::all(const A&... arguments) const {
  auto answers = crew_.order(ByteWriter(order_of<call>(), number_, arguments...).bytes());
  if constexpr (!std::is_void_v<ResultOf<call>>) {
    std::vector<ResultOf<call>> results;
    for (ByteReader& answer : answers) results.push_back(answer.get<ResultOf<call>>());
    return results;
  }
}

/// With the next order that is answered.
template <auto call, class... A>
void SlabSimulation::later(const A&... arguments) {
  static_assert(std::is_void_v<ResultOf<call>>);
  crew_.order_later(ByteWriter(order_of<call>(), number_, arguments...).take());
}

const dem::Simulation& SlabSimulation::own() const {
  if (crew_.has_later()) all<&Sim::time>();
  return crew_.own_part(number_);
}

/// Lists of the parts, one after the other.
template <auto call, class... A>
auto SlabSimulation::joined(const A&... arguments) const {
  auto lists = all<call>(arguments...);
  for (std::size_t part = 1; part < lists.size(); ++part)
    lists[0].insert(lists[0].end(), lists[part].begin(), lists[part].end());
  return std::move(lists[0]);
}

int SlabSimulation::add_shape(const dem::Clump& shape) { return all<&Sim::add_shape>(shape)[0]; }
void SlabSimulation::add_grains(std::span<const dem::Grain> grains) { all<&Sim::add_grains>(grains); }
void SlabSimulation::remove_grains(std::span<const std::int64_t> ids) { all<&Sim::remove_grains>(ids); }
void SlabSimulation::set_grains(std::span<const dem::Grain> grains) { all<&Sim::set_grains>(grains); }
void SlabSimulation::scale_grains(std::span<const std::int64_t> ids, double factor) {
  all<&Sim::scale_grains>(ids, factor);
}
void SlabSimulation::set_material(int number, const dem::Material& material) {
  later<&Sim::set_material>(number, material);
}
void SlabSimulation::set_interaction(int a, int b, const dem::Interaction& interaction) {
  later<&Sim::set_interaction>(a, b, interaction);
}
void SlabSimulation::set_gravity(dem::Vec3 gravity) { later<&Sim::set_gravity>(gravity); }
void SlabSimulation::set_grain_damping(double alpha) { later<&Sim::set_grain_damping>(alpha); }

std::vector<dem::Grain> SlabSimulation::grains() const {
  auto list = joined<&Sim::grains>();
  std::ranges::sort(list, {}, &dem::Grain::id);
  return list;
}

std::vector<dem::GrainSphere> SlabSimulation::spheres() const {
  auto list = joined<&Sim::spheres>();
  std::ranges::stable_sort(list, {}, &dem::GrainSphere::id);  // those of one grain come from one part
  return list;
}

void SlabSimulation::add_bonds(std::span<const dem::Bond> bonds) {
  base::require_user(bonds.empty(), "bonds need one DEM rank; start with --dem-ranks 1");
}

int SlabSimulation::add_plane(const dem::Plane& plane, int material) {
  return all<&Sim::add_plane>(plane, material)[0];
}
int SlabSimulation::add_mesh(const base::Skin& skin, int material, bool two_sided) {
  return all<&Sim::add_mesh>(skin, material, two_sided)[0];
}
void SlabSimulation::remove_wall(int wall) { all<&Sim::remove_wall>(wall); }
void SlabSimulation::set_wall_velocity(int wall, dem::Vec3 velocity) { later<&Sim::set_wall_velocity>(wall, velocity); }
void SlabSimulation::set_wall_body(int wall, const dem::WallBody& body) { all<&Sim::set_wall_body>(wall, body); }
void SlabSimulation::set_wall_load(int wall, dem::Vec3 force, dem::Vec3 torque) {
  later<&Sim::set_wall_load>(wall, force, torque);
}
void SlabSimulation::set_mesh_target(int wall, std::span<const dem::Vec3> positions,
                                     std::span<const dem::Vec3> velocities, dem::MeshWay way) {
  later<&Sim::set_mesh_target>(wall, positions, velocities, way);
}

void SlabSimulation::know_mesh_nodes(int wall, std::span<const int> nodes, std::span<const int> fresh,
                                     std::span<const dem::Vec3> positions, std::span<const dem::Vec3> velocities) {
  later<&Sim::know_mesh_nodes>(wall, nodes, fresh, positions, velocities);
}
void SlabSimulation::keep_within(double low, double high) { later<&Sim::keep_within>(low, high); }

dem::Reach SlabSimulation::reach() const {
  const auto parts = all<&Sim::reach>();
  dem::Reach whole = parts[0];
  for (const dem::Reach& part : parts) {
    whole.low = std::min(whole.low, part.low);
    whole.high = std::max(whole.high, part.high);
    whole.grain = std::max(whole.grain, part.grain);
    whole.speed = std::max(whole.speed, part.speed);
  }
  return whole;
}

void SlabSimulation::nodal_impulse(int wall, std::span<dem::Vec3> impulse) const {
  std::ranges::fill(impulse, dem::Vec3{});
  for (const auto& part : all<&nodal_impulses>(wall, static_cast<int>(impulse.size())))
    for (std::size_t node = 0; node < impulse.size(); ++node) impulse[node] += part[node];
}

std::vector<dem::NodeSpring> SlabSimulation::node_springs(int wall) const {
  const auto parts = all<&Sim::node_springs>(wall);
  std::vector<dem::NodeSpring> springs(parts[0].size());
  for (const auto& part : parts) {
    for (std::size_t node = 0; node < springs.size(); ++node) {
      springs[node].stiffness += part[node].stiffness;
      springs[node].damping += part[node].damping;
    }
  }
  return springs;
}

dem::Vec3 SlabSimulation::wall_impulse_on_grains(int wall) const {
  dem::Vec3 sum;
  for (const dem::Vec3& part : all<&Sim::wall_impulse_on_grains>(wall)) sum += part;
  return sum;
}

void SlabSimulation::advance(int n, double dt) { all<&Sim::advance>(n, dt); }
dem::StableStep SlabSimulation::stable_step() const { return shortest(all<&Sim::stable_step>()); }

dem::StableStep SlabSimulation::contact_stable_step() const { return shortest(all<&Sim::contact_stable_step>()); }

base::Columns SlabSimulation::save() const {
  base::Columns columns;
  auto parts = all<&Sim::save>();
  columns["parts"] = std::vector{crew_.ranks()};
  for (int part = 0; part < crew_.ranks(); ++part)
    add_group(columns, group(part), std::move(parts[static_cast<std::size_t>(part)]));
  return columns;
}

void SlabSimulation::restore(const base::Columns& columns) {
  const auto parts = saved_parts(columns);
  if (static_cast<int>(parts.size()) != crew_.ranks()) return restore_parts(parts);
  std::vector<Bytes> orders;
  for (const base::Columns& part : parts) orders.push_back(ByteWriter(order_of<&Sim::restore>(), number_, part).take());
  crew_.order_each(orders);
}

void SlabSimulation::restore_parts(std::span<const base::Columns> parts) { all<&Sim::restore_parts>(parts); }

base::Energy SlabSimulation::energy() const {
  base::Energy sum;
  for (const base::Energy& part : all<&Sim::energy>()) sum += part;
  return sum;
}

void SlabSimulation::reset_energy() { all<&Sim::reset_energy>(); }
std::vector<dem::GrainContact> SlabSimulation::grain_contacts() const { return joined<&Sim::grain_contacts>(); }
std::vector<dem::WallContact> SlabSimulation::wall_contacts() const { return joined<&Sim::wall_contacts>(); }

dem::Counts SlabSimulation::counts() const {
  const auto parts = all<&Sim::counts>();
  dem::Counts sum = parts[0];  // all parts take the same steps and make lists together
  for (std::size_t part = 1; part < parts.size(); ++part) {
    const dem::Counts& more = parts[part];
    sum.grains += more.grains;
    sum.spheres += more.spheres;
    sum.contacts += more.contacts;
    sum.wall_contacts += more.wall_contacts;
    sum.candidate_pairs += more.candidate_pairs;
    sum.wall_candidates += more.wall_candidates;
    sum.bytes += more.bytes;
  }
  return sum;
}

template <class R, class... A>
std::vector<R> SlabSimulation::from_ends(SlabOrder what, const A&... arguments) const {
  std::vector<R> results;
  for (ByteReader& answer : crew_.order(ByteWriter(what, number_, arguments...).bytes()))
    results.push_back(answer.get<R>());
  return results;
}

void SlabSimulation::join_bodies(const Interface& is, const std::vector<int>& walls) {
  crew_.order(ByteWriter(coupling::join_bodies, number_, is, walls).bytes());
}
std::vector<WindowReport> SlabSimulation::window(const WindowOrder& order) {
  return from_ends<WindowReport>(exchange_window, order);
}
std::vector<PairTraffic> SlabSimulation::traffic() const { return from_ends<PairTraffic>(exchange_traffic); }
std::vector<std::vector<double>> SlabSimulation::save_ends() const { return from_ends<std::vector<double>>(save_end); }
void SlabSimulation::restore_ends(const std::vector<std::vector<double>>& ends) {
  std::vector<Bytes> orders;
  for (const auto& end : ends) orders.push_back(ByteWriter(restore_end, number_, end).take());
  crew_.order_each(orders);
}

}  // namespace coupling
