#pragma once
// Stand-ins for both sides of the exchange: a long skin that moves by a formula, and grains that are no more than an
// interval along x. The grains look at every window whether the skin they have been given is the one of the formula
// wherever they might touch it.
#include <fmt/format.h>

#include <cmath>
#include <new>

#include "base/error.hpp"
#include "dem/company.hpp"
#include "dem/dem.hpp"
#include "fem/fem.hpp"

namespace stand_ins {

using base::Vec3;

constexpr double cell = 0.05, window_length = 2e-3;  // [m] [s]
constexpr int cells = 400, nodes_across = 3;
constexpr double bed_start = 5, bed_length = 2;     // [m]
constexpr double radius = 0.02, spare = 0.03;       // [m]
constexpr double bed_speed = 10, skin_speed = 1.5;  // [m/s] along x
constexpr double margin(double window) { return 2 * radius + 4 * bed_speed * window; }
constexpr int skin_nodes() { return nodes_across * (cells + 1); }
// Lengths of steps that make a part fail, with a sign (see advance()).
constexpr double first_part_fails = -1e-4, last_part_fails = -2e-4, last_part_fails_in_company = -3e-4;

inline base::Skin skin() {
  base::Skin made;
  made.body = "sleeper";
  for (int k = 0; k <= cells; ++k)
    for (int j = 0; j < nodes_across; ++j) made.nodes.push_back({cell * k, cell * j, 0});
  for (int k = 0; k < cells; ++k)
    for (int j = 0; j + 1 < nodes_across; ++j) {
      const int first = nodes_across * k + j;
      made.facets.push_back({first, first + nodes_across, first + nodes_across + 1, first + 1});
    }
  return made;
}

inline Vec3 place(const Vec3& node, double time) {
  return {node.x + skin_speed * time, node.y, 0.01 * std::sin(3 * node.x - 200 * time)};
}
inline Vec3 velocity(const Vec3& node, double time) { return {skin_speed, 0, -2 * std::cos(3 * node.x - 200 * time)}; }

/// One FEM rank: a piece of the skin, from end to end.
class Model final : public fem::Model {
 public:
  Model(int rank, int ranks) : skins_{skin()} {
    for (int k = rank * skin_nodes() / ranks; k < (rank + 1) * skin_nodes() / ranks; ++k) owned_.push_back(k);
  }
  void step() { time_ += window_length; }

  const std::vector<base::Skin>& skins() const override { return skins_; }
  std::span<const int> owned_skin_nodes(int) const override { return owned_; }
  void skin_state(int, std::span<Vec3> positions, std::span<Vec3> velocities) const override {
    for (std::size_t k = 0; k < owned_.size(); ++k) {
      const Vec3& node = skins_[0].nodes[static_cast<std::size_t>(owned_[k])];
      positions[k] = place(node, time_);
      velocities[k] = velocity(node, time_);
    }
  }
  std::vector<double> skin_mobility(int) const override { return std::vector<double>(owned_.size(), 1.0); }
  void set_skin_forces(int, std::span<const Vec3>) override {}

  std::vector<fem::BodyCounts> counts() const override { return {}; }
  std::vector<std::string> warnings() const override { return {}; }
  fem::StableStep stable_step() const override { return {}; }
  void predict(double) override {}
  void inner_forces() override {}
  void correct(double) override {}
  double time() const override { return time_; }
  void set_damping(const std::string&, double) override {}
  void hold(const std::string&, bool) override {}
  base::Energy energy() const override { return {}; }
  void reset_energy() override {}
  Vec3 probe_group(const std::string&, const std::string&, fem::Quantity) const override { return {}; }
  Vec3 probe_point(const std::string&, Vec3, fem::Quantity) const override { return {}; }
  void check_point(const std::string&, const Vec3&, const fem::Origin&) const override {}
  Vec3 reaction(const std::string&, const std::string&) const override { return {}; }
  std::vector<std::array<double, 6>> element_stresses(const std::string&) const override { return {}; }
  std::array<double, 6> stress_at(const std::string&, const fem::Spot&) const override { return {}; }
  double plastic_strain_at(const std::string&, const fem::Spot&) const override { return 0; }
  double load_value(const std::string&) const override { return 0; }
  void set_displacement_zero() override {}
  void write(const std::string&, double) override {}
  std::function<void()> picture(const std::string&, double) override { return {}; }
  base::Columns save() const override { return {}; }
  void restore(const base::Columns&) override {}
  std::vector<fem::BodyModes> find_modes(int) override { return {}; }
  void write_modes(const std::string&) override {}

 private:
  std::vector<base::Skin> skins_;
  std::vector<int> owned_;
  double time_ = 0;
};

/// One DEM part: its share of the bed, which moves along.
class Grains final : public dem::Simulation {
 public:
  explicit Grains(const dem::Setup& setup)
      : company_(setup.company),
        part_(company_ ? company_->part() : 0),
        parts_(company_ ? company_->parts() : 1),
        known_(skin_.nodes.size(), 1),
        now_(skin_.nodes),
        target_(skin_.nodes) {}

  int add_mesh(const base::Skin&, int, bool) override { return 0; }
  void set_mesh_target(int, std::span<const Vec3> positions, std::span<const Vec3> velocities, dem::MeshWay) override {
    target_.assign(positions.begin(), positions.end());
    require(velocities.size() == target_.size(), "velocities", 0);
  }
  void know_mesh_nodes(int, std::span<const int> nodes, std::span<const int> fresh, std::span<const Vec3> positions,
                       std::span<const Vec3>) override {
    std::vector<int> before = std::exchange(known_, std::vector<int>(known_.size(), 0));
    for (const int node : nodes) known_[at(node)] = 1;
    if (windows_ == 0) before.assign(before.size(), 0);
    for (std::size_t k = 0; k < fresh.size(); ++k) {
      require(!before[at(fresh[k])] && known_[at(fresh[k])], "a fresh node that was known", fresh[k]);
      now_[at(fresh[k])] = positions[k];
      before[at(fresh[k])] = 1;
    }
    for (const int node : nodes) require(before[at(node)], "a new node that is not fresh", node);
  }
  void keep_within(double low, double high) override {
    const auto is = reach();
    require(is.low >= low && is.high <= high, "limits that hold already", 0);
  }
  dem::Reach reach() const override { return {low() - spare, high() + spare, radius, bed_speed}; }
  void nodal_impulse(int, std::span<Vec3> impulse) const override {
    for (std::size_t n = 0; n < impulse.size(); ++n)
      impulse[n] = near(static_cast<int>(n)) ? Vec3{1.0 * part_, 0.1 * static_cast<double>(n % 7), 1} : Vec3{};
  }
  Vec3 wall_impulse_on_grains(int) const override {
    std::vector<Vec3> all(skin_.nodes.size());
    nodal_impulse(0, all);
    Vec3 sum;
    for (const Vec3& one : all) sum -= one;
    return sum;
  }
  void advance(int n, double dt) override {
    if (dt == -first_part_fails || dt == -last_part_fails || dt == -last_part_fails_in_company) fail(dt);
    const double start = windows_ * window_length, end = (windows_ + 1) * window_length;
    check(now_, windows_ == 0 ? skin_.nodes : places(start), "at the start");
    x_ += n * dt * bed_speed;
    check(target_, places(end), "at the end");
    for (std::size_t node = 0; node < now_.size(); ++node)
      if (known_[node]) now_[node] = target_[node];
    ++windows_;
  }

  int add_shape(const dem::Clump&) override { return 0; }
  void add_grains(std::span<const dem::Grain>) override {}
  void remove_grains(std::span<const std::int64_t>) override {}
  std::vector<dem::Grain> grains() const override { return {}; }
  std::vector<dem::GrainSphere> spheres() const override { return {}; }
  void set_grains(std::span<const dem::Grain>) override {}
  void scale_grains(std::span<const std::int64_t>, double) override {}
  void set_material(int, const dem::Material&) override {}
  void set_interaction(int, int, const dem::Interaction&) override {}
  void set_gravity(Vec3) override {}
  void set_grain_damping(double) override {}
  void add_bonds(std::span<const dem::Bond>) override {}
  std::vector<dem::BondNow> bonds() const override { return {}; }
  std::int64_t broken_bonds() const override { return 0; }
  int add_plane(const dem::Plane&, int) override { return 0; }
  void remove_wall(int) override {}
  void set_wall_velocity(int, Vec3) override {}
  void set_wall_body(int, const dem::WallBody&) override {}
  void set_wall_load(int, Vec3, Vec3) override {}
  dem::WallBodyState wall_body(int) const override { return {}; }
  Vec3 wall_displacement(int) const override { return {}; }
  Vec3 wall_velocity(int) const override { return {}; }
  std::vector<dem::NodeSpring> node_springs(int) const override { return {}; }
  double time() const override { return 0; }
  dem::StableStep stable_step() const override { return {}; }
  dem::StableStep contact_stable_step() const override { return {}; }
  base::Columns save() const override { return {}; }
  void restore(const base::Columns&) override {}
  void restore_parts(std::span<const base::Columns>) override {}
  base::Energy energy() const override { return {}; }
  void reset_energy() override {}
  std::vector<dem::GrainContact> grain_contacts() const override { return {}; }
  std::vector<dem::WallContact> wall_contacts() const override { return {}; }
  dem::Counts counts() const override { return {}; }
  dem::Backend backend() const override { return dem::Backend::omp; }

 private:
  static std::size_t at(int node) { return static_cast<std::size_t>(node); }
  static void require(bool holds, const char* what, int node) {
    if (!holds) throw base::InternalError(fmt::format("{}, node {}", what, node));
  }
  double low() const { return bed_start + x_ + bed_length * part_ / parts_; }
  double high() const { return low() + bed_length / parts_; }
  std::vector<Vec3> places(double time) const {
    std::vector<Vec3> all;
    for (const Vec3& node : skin_.nodes) all.push_back(place(node, time));
    return all;
  }
  /// A cell around the node reaches under the grains.
  bool near(int node) const {
    const double x = skin_.nodes[at(node)].x + skin_speed * windows_ * window_length;
    return x + cell >= low() - spare && x - cell <= high() + spare;
  }
  void check(const std::vector<Vec3>& have, const std::vector<Vec3>& truth, const char* when) const {
    for (std::size_t node = 0; node < have.size(); ++node) {
      if (!near(static_cast<int>(node))) continue;
      require(known_[node], "a node near grains is not known", static_cast<int>(node));
      if (base::norm(have[node] - truth[node]) <= 1e-12) continue;
      throw base::InternalError(fmt::format("window {}: node {} is at x = {}, z = {} {}, must be at {}, {}", windows_,
                                            node, have[node].x, have[node].z, when, truth[node].x, truth[node].z));
    }
  }
  void fail(double dt) const {
    if (part_ == (dt == -first_part_fails ? 0 : parts_ - 1)) throw std::bad_alloc();
    std::vector<double> values{1};
    std::array<dem::Company::Letter, 2> out, in;
    if (dt == -last_part_fails_in_company) company_->swap(out, in);
    company_->largest(values);
  }

  dem::Company* company_;
  int part_, parts_;
  base::Skin skin_ = skin();
  std::vector<int> known_;
  std::vector<Vec3> now_, target_;
  double x_ = 0;  // [m] that the bed has gone
  int windows_ = 0;
};

}  // namespace stand_ins
