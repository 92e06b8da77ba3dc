#pragma once
// The explicit model behind the façade: central difference in velocity form, mass-proportional damping taken at the end
// of the step.
//   v_half = v + dt/2 a;   u += dt v_half;   a = (F - alpha m v_half) / (m (1 + alpha dt/2));   v = v_half + dt/2 a
// which is m a + alpha m v = F with v at the end of the step. Viscous stress takes v_half: its damping lags by half a
// step, and shortens the stable one (stable_step.hpp). Absorbing boundaries are taken at the end of the step as damping
// is, (m + dt/2 C) a = F - C v_half, and leave it as it is.
// A prescribed displacement h: a = (h(t + dt) - 2 h(t) + h(t - dt)) / dt^2 leads from one instant to the next exactly.
// Its work is that of the reaction m a + alpha m v + f_inner - f_outer. Source: Hughes (2000), 9.1; Belytschko (2000),
// box 6.1. Work of a force over a step: half of (F_old + F_new) . (u_new - u_old). With it kinetic + strain - works +
// losses changes by dt^2/8 (sum m a^2) only: it stays within that, and does not drift.
#include <array>
#include <map>
#include <memory>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "fem/assembly.hpp"
#include "fem/fem.hpp"
#include "fem/modes.hpp"
#include "fem/newton.hpp"
#include "fem/output.hpp"
#include "fem/recovery.hpp"

namespace fem {

/// Per node of a body: which components its supports hold.
std::vector<std::array<bool, 3>> held_components(const Mesh&, const Body&);

class ExplicitModel : public Model {
 public:
  ExplicitModel(MPI_Comm, const Setup&);

  std::vector<BodyCounts> counts() const override { return counts_; }
  std::vector<std::string> warnings() const override { return warnings_; }
  StableStep stable_step() const override { return stable_step_; }
  void predict(double dt) override;
  void inner_forces() override;
  void correct(double dt) override;
  double time() const override { return time_; }
  void set_damping(const std::string& body, double alpha) override;
  void hold(const std::string& body, bool held) override;
  const std::vector<base::Skin>& skins() const override { return skins_; }
  std::span<const int> owned_skin_nodes(int skin) const override { return contacts_.at(skin).skin_nodes; }
  void skin_state(int skin, std::span<Vec3> positions, std::span<Vec3> velocities) const override;
  void set_skin_forces(int skin, std::span<const Vec3> forces) override;
  std::vector<double> skin_mobility(int skin) const override;
  base::Energy energy() const override;
  void reset_energy() override;
  Vec3 probe_group(const std::string& body, const std::string& group, Quantity) const override;
  Vec3 probe_point(const std::string& body, Vec3 point, Quantity) const override;
  void check_point(const std::string& body, const Vec3& point, const Origin& origin) const override;
  Vec3 reaction(const std::string& body, const std::string& group) const override;
  std::vector<std::array<double, 6>> element_stresses(const std::string& body) const override;
  std::array<double, 6> stress_at(const std::string& body, const Spot&) const override;
  double plastic_strain_at(const std::string& body, const Spot&) const override;
  double load_value(const std::string& name) const override;
  void set_displacement_zero() override;
  void write(const std::string& directory, double time) override;
  std::function<void()> picture(const std::string& directory, double time) override;
  base::Columns save() const override;
  void restore(const base::Columns&) override;
  std::vector<BodyModes> find_modes(int count) override;
  void write_modes(const std::string& directory) override;

 protected:  // implicit models step on the same state
  struct NodalLoad {
    Load load;
    std::vector<std::pair<int, Vec3>> share;  // owned node, its force [N] when the history is 1
    double value = 0;                         // of the history, as last used
  };
  struct Contact {                       // the owned part of a skin
    std::vector<int> skin_nodes, nodes;  // number in the skin; local number
    std::vector<Vec3> places;            // [m] reference
    std::vector<Vec3> given, used;       // [N] set by the caller; as last used
  };
  struct Driven {  // one component that a prescribed motion leads
    int index;     // 3 node + component
    int motion, body;
    double reaction = 0;  // [N] that moves it, as of the last forces
  };
  struct BodyState {
    double damping = 0;  // [1/s]
    bool held = false;
  };

  void apply_supports();
  void make_loads();
  void make_motions();
  void make_absorbers();
  void make_skins();
  void lead(double dt);
  void follow(double dt);
  double absorb(const Dashpot&, int body, double dt);
  void count_bodies();
  void start_accelerations();
  void prepare_solver();
  void refuse_mechanisms() const;
  void look_for_hinges();
  void start_in_equilibrium();
  std::vector<double> weights() const;  // [N] gravity on the owned components, zero where a support holds them
  void gather_external_forces(double time);
  double update_accelerations(double dt);
  void book_interface_impulse(double dt);
  void agree_on_finite(double measure);
  int body_index(const std::string& name) const;
  double gravity_potential() const;
  std::vector<double> reactions() const;  // [N] of supports, on the owned components that they hold
  Vec3 value_at(int owned_node, Quantity) const;
  int nearest_node(int body, const Vec3& point) const;
  const Recovery& recovery_at(int body, const Spot&) const;
  template <class Value>
  std::vector<Value> of_all_elements(int body, const std::vector<Value>& own) const;
  // explicit_model_state.cpp
  std::vector<double> by_global_number(std::span<const double> owned) const;
  void take_owned(const base::Columns&, const std::string& name, std::span<double> owned) const;
  std::vector<double> of_all_ranks(std::span<const double> mine) const;
  std::vector<double> share_of_rank(const base::Columns&, const std::string& name, std::size_t numbers) const;
  std::vector<double> on_skins(std::vector<Vec3> Contact::*) const;
  std::vector<std::size_t> first_numbers_of_skins() const;
  void save_histories(base::Columns&) const;
  void restore_histories(const base::Columns&);
  void require_same_meshes(const base::Columns&) const;
  Vec3 mean_over(int body, std::span<const int> nodes, Quantity) const;

  Setup setup_;
  std::vector<Mesh> meshes_;  // elements are dropped after the start where no output needs them
  Layout layout_;
  Assembly assembly_;
  mutable NodalField displacement_, velocity_;  // their ghosts are brought up to date where they are read
  NodalField acceleration_, inner_, mass_;
  std::vector<double> external_;      // [N] loads and skin forces of this instant, owned components
  std::vector<double> inverse_mass_;  // [1/kg] zero where a support holds the component
  std::vector<double> zero_;          // [m] displacement taken as zero in output and probes; empty: none
  std::vector<BodyState> states_;
  std::vector<char> simple_energy_;  // per body, on all ranks: see Assembly::has_simple_energy
  std::vector<NodalLoad> loads_;
  std::vector<PrescribedMotion> motions_;
  std::vector<Driven> driven_;
  std::vector<Dashpot> dashpots_;  // of absorbing boundaries
  std::vector<int> dashpot_of_;    // per owned node, -1: none; empty: no boundary absorbs
  std::vector<base::Skin> skins_;
  std::vector<Contact> contacts_;
  std::vector<BodyCounts> counts_;
  std::vector<std::string> warnings_;  // of the first rank
  StableStep stable_step_;
  base::Energy ledger_;      // works and losses of this rank
  double gravity_zero_ = 0;  // [J] of this rank, at the last reset
  double time_ = 0;
  double half_step_ = 0;      // [s] dt/2 between predict and correct, else 0
  double viscous_power_ = 0;  // [W] of the last inner forces, this rank's
  long steps_ = 0;
  mutable std::vector<std::pair<std::pair<int, std::array<double, 3>>, int>> nearest_;  // body, point: node
  mutable std::map<std::tuple<int, int, std::string>, Recovery> recoveries_;  // by body and node or group, as asked for
  std::unique_ptr<Output> output_;
  std::unique_ptr<Tangent> tangent_;    // where the solver needs it
  std::vector<Mechanisms> mechanisms_;  // per body, where the solver needs them
  std::vector<FoundModes> modes_;       // per body, once found
};

}  // namespace fem
