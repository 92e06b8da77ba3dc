#pragma once
// The simulation on one Thrust system: what dem.hpp promises, put together from grains, pairs and walls.
#include <optional>
#include <string>

#include "dem/contact_step.hpp"
#include "dem/core/bodies.hpp"
#include "dem/core/bonds.hpp"
#include "dem/core/control.hpp"
#include "dem/core/ghosts.hpp"
#include "dem/core/host_rows.hpp"
#include "dem/core/leapfrog.hpp"
#include "dem/core/ledger.hpp"
#include "dem/core/pairs.hpp"
#include "dem/core/snapshot.hpp"
#if !defined(TRACKBED_DEM_CUDA)
#include "dem/core/plane_list.hpp"
#include "dem/core/sweep_lists.hpp"
#endif
#include "dem/dem.hpp"
#include "dem/sweep.hpp"

namespace dem::TRACKBED_DEM_SYSTEM {

struct TravellingBody;

class System final : public Simulation {
 public:
  System(const Setup&, Backend);
  System(const System& like, const base::Columns& saved_part);

  int add_shape(const Clump&) override;
  void add_grains(std::span<const Grain>) override;
  void remove_grains(std::span<const std::int64_t> ids) override;
  std::vector<Grain> grains() const override;
  std::vector<GrainSphere> spheres() const override;
  void set_grains(std::span<const Grain>) override;
  void scale_grains(std::span<const std::int64_t> ids, double factor) override;
  void set_material(int material, const Material&) override;
  void set_interaction(int a, int b, const Interaction&) override;
  void set_gravity(Vec3) override;
  void set_grain_damping(double alpha) override;

  void add_bonds(std::span<const Bond>) override;
  std::vector<BondNow> bonds() const override;
  std::int64_t broken_bonds() const override { return bonds_.broken(); }

  int add_plane(const Plane&, int material) override;
  int add_mesh(const base::Skin&, int material, bool two_sided) override;
  void remove_wall(int wall) override;
  void set_wall_velocity(int wall, Vec3) override;
  void set_wall_body(int wall, const WallBody&) override;
  void set_wall_load(int wall, Vec3 force, Vec3 torque) override;
  WallBodyState wall_body(int wall) const override;
  Vec3 wall_displacement(int wall) const override;
  Vec3 wall_velocity(int wall) const override;
  void set_mesh_target(int wall, std::span<const Vec3> positions, std::span<const Vec3> velocities,
                       MeshWay way) override;
  void know_mesh_nodes(int wall, std::span<const int> nodes, std::span<const int> fresh,
                       std::span<const Vec3> positions, std::span<const Vec3> velocities) override;
  void keep_within(double low, double high) override { limits_ = {low, high}; }
  Reach reach() const override;
  void nodal_impulse(int wall, std::span<Vec3> impulse) const override;
  Vec3 wall_impulse_on_grains(int wall) const override;

  void advance(int n, double dt) override;
  double time() const override { return time_; }
  StableStep stable_step() const override;
  StableStep contact_stable_step() const override;
  std::vector<NodeSpring> node_springs(int wall) const override;

  base::Columns save() const override;
  void restore(const base::Columns&) override;
  void restore_parts(std::span<const base::Columns>) override;

  base::Energy energy() const override;
  void reset_energy() override;
  std::vector<GrainContact> grain_contacts() const override;
  std::vector<WallContact> wall_contacts() const override;
  std::function<Picture()> picture() const override;
  std::function<base::Columns()> saved() const override;
  Counts counts() const override;
  Backend backend() const override { return backend_; }

 private:
  // system.hpp: what changes between steps
  void upload_parameters();
  void set_masses();
  void mark_grains_changed();
  void require_wall(int wall) const;
  // system_bodies.hpp
  void make_bodies();
  void add_bodies(std::span<const Grain>);
  void set_body_masses();
  void set_bodies(std::span<const Grain>);
  void carry_spheres();
  template <class Forces, class Visit>
  void with_body_leap(const Integrator&, const Forces&, const Visit&);
  // system_queue.hpp
  bool queues() const;
  void advance_queued(int n, double dt);
  void set_start(Control&);
  void send_start();
  void queue_look();
  void look(Control&);
  void send_free_control(double dt, int step);
  void queue_step(double dt);
  void queue_motion(double dt, int nodes);
  void queue_rest_of_step(double dt);
  void queue_forces(const kernels::Interval&, double ended);
  void queue_end(double dt, double ended);
  template <class Launch>
  void press_bonds(const Launch&, double ended);
  void send_nodes(NodeRows, std::span<const Vec3>, Vec3* to, int first);
  void fetch_impulses();
  void fetch_node_impulse() const;
  // system_advance.hpp
  void advance_by_steps(int n, double dt);
  void prepare(double dt);
  int met_trouble();
  bool keeps_grain_ledger() const { return setup_.track_energy && (alpha_ > 0 || brakes_); }
  void rebuild(double share);
  void list_planes();
  void keep_touching_pairs();
  void adapt_skin();
  void relist(double moved, double wall_shift, double share);
  void note_reach(const Box& own);
  void evaluate(const kernels::Interval&, double ended);
  template <class Visit>
  void with_scene_law(const Visit&) const;
  template <class Law, class Real, bool Ledger, bool Couples>
  ContactPass<Law, Real, Ledger, Couples> contact_pass(const kernels::Interval&);
  template <class Law, bool Ledger, bool Couples>
  WallPass<Law, Ledger, Couples> wall_pass(const kernels::Interval&, double ended);
  template <class Real>
  GatheredForces<Real> gathered_forces();
  template <class Forces, class Visit>
  void with_leap(double dt, const Forces&, const Visit&);
  double leap(const Phase&, double dt);
  double leap_rows(const Phase&, double dt);
  Integrator integrator(double dt);
  void book_removed_walls();
  void feel_walls();
  void finish_walls(double dt);
  void return_grains();
  void make_images(int spare_rows);
  void move_images();
  void sort(const CellGrid&, Vector<int>& bucket);
  PairSearch search(const CellGrid&, Vector<int>& bucket, Vector<int>& bucket_start);
  bool sweeps() const;
  kernels::Interval interval(double dt) const;
  HistoryLayout history_of(const kernels::PairParameters&) const;
  int history_stride() const { return history_of({}).total; }
#if !defined(TRACKBED_DEM_CUDA)
  SweepLayout sweep_layout() const;
  template <class Walls>
  bool press_walls(const Walls&, int share, int shares);
  template <class Walls>
  void sweep_pairs(const kernels::Interval&, const Walls&);
#endif
  [[noreturn]] void stop_unstable(int trouble, double dt) const;
  // system_slabs.hpp
  bool in_company() const;
  bool is_first_part() const { return !in_company() || setup_.company->part() == 0; }
  void join_company();
  double over_parts(double value) const;
  int part_of(double x) const;
  void cut_slabs(std::span<const Grain> all);
  [[noreturn]] void refuse_slabs(double along, double least, double reach) const;
  std::vector<Grain> own_grains(std::span<const Grain> all);
  void drop_ghosts();
  void migrate();
  void balance();
  std::vector<double> new_cuts();
  void list_keys();
  double pass_on();
  void write_leaving(const std::vector<int>& side, std::array<Company::Letter, 2>& out);
  void write_memories(const std::vector<int>& side_of_old, std::array<Company::Letter, 2>& out) const;
  double read_arriving(const Company::Letter&);
  void append_bodies(const std::vector<TravellingBody>&, const std::vector<Vec3>& offsets,
                     const std::vector<int>& starts, const std::vector<int>& owners);
  std::vector<double> extents();
  void take_ghosts();
  void move_ghosts();
  void enter_ghosts(const CellGrid&, Vector<int>& bucket, Vector<int>& entry);
  void recall();
  void recall_pairs(const RowOfKey&);
  void recall_walls(const RowOfKey&);
  void count_work();
  bool is_elsewhere(int i, int j, const std::vector<std::int64_t>& ids) const;
  std::vector<std::int64_t> row_ids() const;
  // system_measure.hpp
  void reference_gravity(bool referenced);
  template <class Visit>
  void each_pair(Visit&& visit) const;
  template <class Take>
  GrainRows grain_rows(Take&&) const;
  template <class Take>
  PairRows pair_rows(Take&&, bool listed) const;
  template <class Take>
  NearWallRows near_wall_rows(Take&&) const;
  void flush_losses();
  void flush_impulses();
  void settle_gravity();
  double gravity_potential() const;
  Sums<5> pair_energies() const;
  base::Energy pending() const;
  template <class Visit>
  void each_contact(Visit&&) const;
  double stiffest_spring(int material) const;
  std::vector<GrainInertia> inertias() const;
  // system_state.hpp
  template <class Self, class Walk>
  static void walk(Self&, Walk&);
  void load(const base::Columns&);
  Company::Letter everything();
  // system_bonds.hpp
  std::vector<GrainSpring> bond_springs() const;
  StableStep with_bonds(const StableStep& without) const;

  Setup setup_;
  Backend backend_;
  double alpha_ = 0;                         // [1/s] artificial damping
  bool smooth_ = true, mixed_laws_ = false;  // no friction at all; laws other than hertz_mindlin
  bool brakes_ = false, couples_ = false;    // rolling models: BROF; those that act in a contact
  Grains grains_;                            // spheres
  Bodies bodies_;                            // of clumps; empty without them
  std::vector<Clump> shapes_;
  Bonds bonds_;
  Periods periods_;
  Images images_;      // empty without periods
  Periods ring_;       // along x, where parts of the grains lie in a ring; then not in periods_
  Ghosts ghosts_;      // empty where all grains are here
  Vector<int> entry_;  // spheres and ghosts by bucket
  PairColumns pairs_;
  Walls walls_;
  WallColumns near_walls_;
#if !defined(TRACKBED_DEM_CUDA)
  PlaneList planes_;
#endif
  Vector<double> density_;
  Vector<kernels::PairParameters> grain_parameters_, wall_parameters_;
  std::vector<kernels::PairParameters> grain_parameters_host_, wall_parameters_host_;
  mutable Queue queue_;
  Vector<Control> control_;    // one
  Vector<DrivenWall> driven_;  // in a window of queued steps, where walls move
  Vector<int> wall_bodies_;    // the ones of these that are bodies
  std::vector<int> wall_bodies_host_;
  HostRows<Control> control_host_;  // two: as it is now; as it was before the last leap
  HostRows<DrivenWall> driven_host_;
  HostRows<Vec3> sent_nodes_;
#if !defined(TRACKBED_DEM_CUDA)
  SweepLists sweep_lists_;
#endif
  SweepSums sweep_sums_;  // of the last step; its losses are booked. One by one: stored where the lists are new

  bool list_is_stale_ = true, forces_are_stale_ = true;
  bool rows_moved_ = false;                // grains came or went: the lists name others
  double skin_ = 0, skin_share_ = 0.1;     // [m]; of the smallest radius
  double tight_ = 0, tight_share_ = 0.01;  // of the list that the step runs over; without a sweep the same as the skin
  double travelled_ = 0;  // [m] bound of what any grain has moved from the skin list's build to the tight list's
  Radii radii_;
  static constexpr Reach nowhere{.low = HUGE_VAL, .high = -HUGE_VAL};
  Reach reach_ = nowhere;                              // of the spheres here when the lists were made
  std::array<double, 2> limits_{-HUGE_VAL, HUGE_VAL};  // [m] keep_within()
  double time_ = 0, last_dt_ = 0;
  double last_ahead_ = 0;  // [s] that the histories are ahead of this instant
  std::int64_t steps_ = 0, rebuilds_ = 0, last_rebuild_ = 0, last_tight_ = 0;

  base::Energy totals_;               // works and losses flushed so far
  double gravity_reference_ = 0;      // [J]
  std::optional<double> taken_away_;  // [J] elastic energy before walls were removed, until the next forces
  bool gravity_referenced_ = false;
  mutable Vector<Vec3> node_impulse_;  // [N s] of the last advance()
  mutable HostRows<Vec3> node_impulse_host_;
  mutable bool node_impulse_is_here_ = false;
  Vector<Vec3> wall_impulse_;  // [N s] on grains, without the flushed part
  HostRows<Vec3> wall_impulse_host_;
  bool wall_impulse_is_here_ = false;
  mutable std::shared_ptr<Snapshot> pictured_, saved_;  // memory of the last picture() and saved()
};

}  // namespace dem::TRACKBED_DEM_SYSTEM
