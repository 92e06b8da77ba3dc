#pragma once
// Façade of the finite element library: deformable bodies meshed by gmsh, moved by explicit central difference on PETSc
// vectors, partitioned over the ranks of one communicator. Knows nothing of scene files or grains. SI; tension
// positive. Every member is collective over the communicator unless it says otherwise; on an error every rank throws.
#include <mpi.h>

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/columns.hpp"
#include "base/energy.hpp"
#include "base/history.hpp"
#include "base/skin.hpp"
#include "base/vec3.hpp"

namespace fem {

using base::Vec3;

/// PETSc lives exactly as long as this object. Only ranks with finite elements make one.
class Library {
 public:
  explicit Library(MPI_Comm);
  ~Library();
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;
};

/// Where errors about a body or a region come from, put in front of every message about it ("scene.toml:12").
using Origin = std::string;

struct MaterialRegion {
  std::string group;  // physical volume of the mesh; empty: the whole body
  std::string law = "linear_elastic";
  double young_modulus = 0, poisson_ratio = 0, density = 0;  // [Pa] [-] [kg/m3]
  Origin origin;
  double shear_viscosity = 0, bulk_viscosity = 0;               // [Pa s]; not of linear_elastic
  double cohesion = 0, friction_angle = 0, dilation_angle = 0;  // [Pa] [rad] [rad]; drucker_prager
  std::string fit = "outer";                                    // outer, inner, plane_strain; drucker_prager
};

struct Support {
  std::string group;  // physical surface (or curve, point)
  std::array<bool, 3> fixed{false, false, false};
  Origin origin;
};

enum class LoadKind {
  nodal_total,  // total force [N] shared equally by the nodes of the group
  face_total,   // total force [N] spread evenly over the area of the group (consistent nodal forces)
  traction,     // [Pa] on the area of the group
  pressure,     // [Pa] against the outward normal of the undeformed surface; > 0 presses; `direction` is not read
};
struct Load {
  std::string name;  // for history.csv
  std::string group;
  LoadKind kind = LoadKind::face_total;
  Vec3 direction;            // multiplied by the history: force [N] or traction [Pa]
  base::HistoryPtr history;  // value(t)
  Origin origin;
};

/// Nodes that are driven. Between steps of equal length a displacement is followed exactly; a velocity in the middle of
/// every step.
struct PrescribedMotion {
  enum class Kind { displacement, velocity };
  std::string name;   // for history.csv
  std::string group;  // physical group of any dimension
  Kind kind = Kind::displacement;
  std::array<bool, 3> along{false, false, false};  // the components that follow the history; the others are free
  base::HistoryPtr history;                        // value(t): [m] or [m/s]
  Origin origin;
};

/// A surface that lets waves out (Lysmer & Kuhlemeyer 1969): dashpots rho c_p along its normal, rho c_s across.
struct AbsorbingBoundary {
  std::string group;  // physical surface
  Origin origin;
};

/// Two surfaces that are one: what leaves the body at the first comes in at the second (periodic.hpp).
struct PeriodicFaces {
  std::string first, second;  // physical surfaces, alike but for a shift
  Origin origin;
};

struct Body {
  std::string name;
  std::string mesh_file;                          // .geo (meshed through gmsh's API) or .msh
  std::map<std::string, double> mesh_parameters;  // numbers set in the .geo (its DefineConstant / SetNumber names)
  std::string element = "hex8";                   // see element_names()
  Vec3 translation;                               // [m] added to every node
  bool gravity = true;                            // false: starts in geostatic balance, its own weight is left out
  double damping = 0;                             // [1/s] mass-proportional: force -damping * m * v
  std::vector<MaterialRegion> materials;
  std::vector<Support> supports;
  std::vector<Load> loads;
  std::vector<PrescribedMotion> motions;
  std::vector<AbsorbingBoundary> absorbing;
  std::vector<PeriodicFaces> periodic;
  double stiffness_damping = 0;   // [s] beta: viscosity beta mu (shear), beta K (bulk) beside the law's own
  std::vector<std::string> skin;  // physical surfaces that grains can touch; empty: none
  Origin origin;
};

enum class Solver {
  explicit_steps,  // central difference
  newmark,         // implicit steps
  statics,         // every step ends in equilibrium; no mass, no damping
  modal,           // free vibrations; no steps
};
/// Where the explicit step's limit comes from: the largest eigenvalue of the mesh, or the cheaper bound that no element
/// alone has a larger one (a shorter step).
enum class StepBound { mesh, elements };
enum class LinearSolver { automatic, direct, iterative };  // automatic: by the number of unknowns
struct SolverSettings {
  Solver kind = Solver::explicit_steps;
  double beta = 0.25, gamma = 0.5;  // [-] of Newmark's method
  LinearSolver linear_solver = LinearSolver::automatic;
  StepBound step_bound = StepBound::mesh;
  bool start_in_equilibrium = false;  // with the loads of time 0; explicit and Newmark
  bool only_looked_at = false;        // no step will be taken: that start is not solved for
  Origin origin;
};

struct Setup {
  std::vector<Body> bodies;
  Vec3 gravity;
  SolverSettings solver = {};
};

struct Mode {
  double frequency = 0;  // [Hz]
  Vec3 effective_mass;   // [kg] that moves along x, y, z with it
};
struct BodyModes {
  std::string body;
  int rigid_motions = 0;    // that supports leave free: at 0 Hz, not among the modes
  std::vector<Mode> modes;  // elastic, lowest first
};

struct StableStep {
  double limit = 0;     // [s] explicit: 2/omega_max of the assembled mesh, lumped mass, never above the true one
  std::string limiter;  // body, element, size, material, in words
};

struct BodyCounts {
  std::string name;
  std::int64_t nodes = 0, elements = 0;
  Vec3 lower, upper;  // [m] bounding box
  double mass = 0;    // [kg]
};

enum class Quantity { displacement, velocity, acceleration };

/// Where a field of the elements is asked for: at the node nearest to a point, or, without one, its mean over the area
/// of a surface group.
struct Spot {
  std::optional<Vec3> point;
  std::string group;
};

class Model {
 public:
  static std::unique_ptr<Model> create(MPI_Comm, const Setup&);
  virtual ~Model() = default;

  virtual std::vector<BodyCounts> counts() const = 0;
  /// What is most likely a mistake but can be computed, one sentence each; on the first rank, elsewhere empty (not
  /// collective).
  virtual std::vector<std::string> warnings() const = 0;
  virtual StableStep stable_step() const = 0;

  // ---- one step in parts, so that contact forces and inner forces can overlap in time; implicit models do all of it
  // in correct()
  /// v += dt/2 a; u += dt v (v is now the half-step velocity).
  virtual void predict(double dt) = 0;
  /// Inner forces and loads at the present displacement and the end-of-step time.
  virtual void inner_forces() = 0;
  /// a from inner, load, gravity, damping and skin forces; v += dt/2 a. Time advances by dt.
  /// Throws base::UnstableError on every rank when the state is not finite.
  virtual void correct(double dt) = 0;
  virtual double time() const = 0;
  virtual void set_damping(const std::string& body, double alpha) = 0;
  /// Fixes all components of the body's nodes at their present place (velocity zero), or lets it go again.
  virtual void hold(const std::string& body, bool held) = 0;

  // ---- skins: one per body that has any skin group; node order as in skins()[s].nodes on every rank
  virtual const std::vector<base::Skin>& skins() const = 0;
  /// Which nodes of skin s this rank owns (not collective).
  virtual std::span<const int> owned_skin_nodes(int skin) const = 0;
  /// Present positions and velocities of the owned skin nodes, in that order (not collective). After predict() the
  /// velocity is extrapolated to the end of the step (v + dt/2 a), so both belong to the same instant.
  virtual void skin_state(int skin, std::span<Vec3> positions, std::span<Vec3> velocities) const = 0;
  /// 1 / mass [1/kg] of the owned skin nodes, in the direction in which they are lightest; 0: held everywhere (not
  /// collective).
  virtual std::vector<double> skin_mobility(int skin) const = 0;
  /// Forces [N] on the owned skin nodes, held until set again (not collective).
  virtual void set_skin_forces(int skin, std::span<const Vec3> forces) = 0;

  // ---- measurement
  virtual base::Energy energy() const = 0;
  virtual void reset_energy() = 0;
  /// Mean of the quantity over the nodes of a group of a body (the whole group; equal weights), or at the node nearest
  /// to a point.
  virtual Vec3 probe_group(const std::string& body, const std::string& group, Quantity) const = 0;
  virtual Vec3 probe_point(const std::string& body, Vec3 point, Quantity) const = 0;
  /// Throws base::UserError, opened by `origin`, where the point lies farther from the body than the elements there are
  /// large: its nearest node would stand for nothing.
  virtual void check_point(const std::string& body, const Vec3& point, const Origin& origin) const = 0;
  /// Force [N] of supports and prescribed motions on the nodes of a group of a body.
  virtual Vec3 reaction(const std::string& body, const std::string& group) const = 0;
  /// Mean stress [Pa] (xx, yy, zz, xy, yz, xz) of every element of a body in the order of its mesh, on every rank.
  virtual std::vector<std::array<double, 6>> element_stresses(const std::string& body) const = 0;
  /// Stress [Pa] and plastic strain [-] recovered at a spot (recovery.hpp); plastic strain is not below zero. Throws
  /// base::UserError for a group that is no surface.
  virtual std::array<double, 6> stress_at(const std::string& body, const Spot&) const = 0;
  virtual double plastic_strain_at(const std::string& body, const Spot&) const = 0;
  /// Present value of a load's or a motion's history (not collective).
  virtual double load_value(const std::string& name) const = 0;
  /// Displacement zero for output and probes from here on (the state itself is untouched).
  virtual void set_displacement_zero() = 0;
  /// Appends one time level to DIR/<body>.pvd and writes DIR/<body>/<body>_NNNN.vtu for every body (output.hpp). Throws
  /// base::MachineError when the disk fails.
  virtual void write(const std::string& directory, double time) = 0;
  /// The same in two parts: the values of this instant are gathered, and on the first rank the function that is
  /// returned writes them, once, in any thread; the model may go on and be written again, but must live until then. On
  /// the other ranks there is none. Collective.
  virtual std::function<void()> picture(const std::string& directory, double time) = 0;

  // ---- checkpoint
  /// All that the steps to come depend on, between two steps, by global numbers of nodes and elements: whole on the
  /// first rank, empty on the others.
  virtual base::Columns save() const = 0;
  /// Goes on from there: on as many ranks bit for bit, on another number the same to rounding. Every rank brings all
  /// columns. The model must be new and of the same Setup. Throws base::UserError when the columns do not fit.
  virtual void restore(const base::Columns&) = 0;

  // ---- modal models
  /// The `count` lowest elastic modes of every body, undamped, about the unloaded state.
  virtual std::vector<BodyModes> find_modes(int count) = 0;
  /// As write(), one level per mode found: its shape, largest component 1 m, its number as time.
  virtual void write_modes(const std::string& directory) = 0;
};

std::vector<std::string> element_names();

double von_mises(const std::array<double, 6>& stress);  // [Pa]
/// Principal stresses [Pa], the largest first.
std::array<double, 3> principal(const std::array<double, 6>& stress);

}  // namespace fem
