#pragma once
// A simulation whose grains are shared out over the DEM ranks, as the first of them uses it: every call goes to all
// parts, and what they measure is put together. Sums are taken in the order of the ranks.
// Where it differs from one that holds all grains: bonds are refused. In a coupled window one order goes out and one
// answer comes back; what passes between grains and bodies goes straight from each part to each of the bodies' ranks.
#include <string>

#include "coupling/slab_server.hpp"

namespace coupling {

/// What a simulation's save() gave, part by part.
std::vector<base::Columns> saved_parts(const base::Columns&);

class SlabSimulation : public dem::Simulation {
 public:
  /// `number`: under which all parts hold it already.
  SlabSimulation(SlabCrew&, int number);
  ~SlabSimulation() override;
  SlabSimulation(const SlabSimulation&) = delete;
  SlabSimulation& operator=(const SlabSimulation&) = delete;

  int add_shape(const dem::Clump&) override;
  void add_grains(std::span<const dem::Grain>) override;
  void remove_grains(std::span<const std::int64_t> ids) override;
  std::vector<dem::Grain> grains() const override;
  std::vector<dem::GrainSphere> spheres() const override;
  void set_grains(std::span<const dem::Grain>) override;
  void scale_grains(std::span<const std::int64_t> ids, double factor) override;
  void set_material(int material, const dem::Material&) override;
  void set_interaction(int a, int b, const dem::Interaction&) override;
  void set_gravity(dem::Vec3) override;
  void set_grain_damping(double alpha) override;

  void add_bonds(std::span<const dem::Bond>) override;
  std::vector<dem::BondNow> bonds() const override { return {}; }
  std::int64_t broken_bonds() const override { return 0; }

  int add_plane(const dem::Plane&, int material) override;
  int add_mesh(const base::Skin&, int material, bool two_sided) override;
  void remove_wall(int wall) override;
  void set_wall_velocity(int wall, dem::Vec3) override;
  void set_wall_body(int wall, const dem::WallBody&) override;
  void set_wall_load(int wall, dem::Vec3 force, dem::Vec3 torque) override;
  dem::WallBodyState wall_body(int wall) const override { return own().wall_body(wall); }
  dem::Vec3 wall_displacement(int wall) const override { return own().wall_displacement(wall); }
  dem::Vec3 wall_velocity(int wall) const override { return own().wall_velocity(wall); }
  void set_mesh_target(int wall, std::span<const dem::Vec3> positions, std::span<const dem::Vec3> velocities,
                       dem::MeshWay) override;
  void know_mesh_nodes(int wall, std::span<const int> nodes, std::span<const int> fresh,
                       std::span<const dem::Vec3> positions, std::span<const dem::Vec3> velocities) override;
  void keep_within(double low, double high) override;
  dem::Reach reach() const override;
  void nodal_impulse(int wall, std::span<dem::Vec3> impulse) const override;
  std::vector<dem::NodeSpring> node_springs(int wall) const override;
  dem::Vec3 wall_impulse_on_grains(int wall) const override;

  void advance(int n, double dt) override;
  double time() const override { return own().time(); }
  dem::StableStep stable_step() const override;
  dem::StableStep contact_stable_step() const override;

  base::Columns save() const override;
  void restore(const base::Columns&) override;
  void restore_parts(std::span<const base::Columns>) override;

  base::Energy energy() const override;
  void reset_energy() override;
  std::vector<dem::GrainContact> grain_contacts() const override;
  std::vector<dem::WallContact> wall_contacts() const override;
  dem::Counts counts() const override;
  dem::Backend backend() const override { return own().backend(); }

  // ---- the exchange with bodies, by parts (coupling/grain_end.hpp)
  void join_bodies(const Interface&, const std::vector<int>& walls);
  std::vector<WindowReport> window(const WindowOrder&);
  std::vector<PairTraffic> traffic() const;
  std::vector<std::vector<double>> save_ends() const;
  void restore_ends(const std::vector<std::vector<double>>&);

 private:
  template <auto call, class... A>
  auto all(const A&... arguments) const;
  template <auto call, class... A>
  void later(const A&... arguments);
  template <auto call, class... A>
  auto joined(const A&... arguments) const;
  template <class R, class... A>
  std::vector<R> from_ends(SlabOrder, const A&... arguments) const;
  const dem::Simulation& own() const;

  SlabCrew& crew_;
  int number_;
};

}  // namespace coupling
