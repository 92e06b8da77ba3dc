#pragma once
// Façade of the discrete element library: grains (spheres and clumps of spheres), their contacts with each other and
// with walls.
// Knows nothing of scene files, MPI or finite elements. All values SI. Host API; the state lives in the backend
// (Thrust OMP or Thrust CUDA, one kernel source). Errors: base::UserError, base::UnstableError.
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/columns.hpp"
#include "base/energy.hpp"
#include "base/skin.hpp"
#include "base/vec3.hpp"
#include "dem/bond.hpp"
#include "dem/clump.hpp"
#include "dem/company.hpp"

namespace dem {

using base::Vec3;

enum class Backend { omp, cuda };
/// True when the CUDA backend is built in and a usable device is present; `why_not` says why not.
bool cuda_available(std::string* why_not = nullptr);
/// True when the CUDA backend was compiled into this binary.
bool cuda_built();
/// Simulations made from now on take this one of the machine's GPUs, counted round where there are fewer. Several
/// processes may share one. Asks nothing of the GPU yet.
void use_device(int number);
/// The GPU that simulations take: name, number, memory; empty without one.
std::string device_text();

/// Elastic constants of what touches. A wall material has no density.
struct Material {
  std::string name;
  double young_modulus = 0;  // [Pa]
  double poisson_ratio = 0;  // [-]
  double density = 0;        // [kg/m3], grains only
};

/// What a pair of materials does when they touch. Symmetric in the pair.
struct Interaction {
  double friction = 0;                // Coulomb coefficient mu [-]
  double restitution = 1;             // normal restitution e_n in (0, 1] [-]
  double rolling_friction = 0;        // eta_r [-] (Irazabal2017 5.3); 0: no rolling resistance
  std::string law = "hertz_mindlin";  // contact law and rolling model: rows of laws.hpp
  std::string rolling = "brof";
  // What only some laws read; laws.hpp says which.
  double normal_stiffness = 0, shear_stiffness = 0;  // [N/m]
  double normal_viscosity = 0, shear_viscosity = 0;  // [N s/m]
  double dissipative_coefficient = 0;                // [s] A
  int damping_mode = 0;                              // of the hysteretic law
  double critical_stress = 0;                        // [Pa]
  double friction_exponent = 0;                      // [-]
  double rolling_damping = 0;                        // [-] share of critical, rolling model type_c

  bool operator==(const Interaction&) const = default;
};

struct Grain {
  Vec3 position{};                    // [m] centre of mass
  double radius = 0;                  // [m] of a clump: its reach, from the centre of mass to the farthest point
  Vec3 velocity{};                    // [m/s]
  Vec3 angular_velocity{};            // [rad/s]
  int material = 0;                   // index into Setup::materials
  std::int64_t id = 0;                // kept for the grain's whole life; unique
  int shape = -1;                     // as returned by add_shape(); -1: a sphere
  kernels::Quaternion orientation{};  // body frame of the shape to space; of a clump only
};

/// One sphere of a grain; a grain that is no clump is its only sphere.
struct GrainSphere {
  Vec3 position{};      // [m]
  double radius = 0;    // [m]
  std::int64_t id = 0;  // of the grain
};

/// Infinite plane; grains live on the side the normal points to.
struct Plane {
  Vec3 point, normal;
};

/// A wall that moves as one rigid body under the grains' forces, its weight and a load: a sleeper, or (guided, without
/// weight) a plate under a servo that holds a force.
struct WallBody {
  Vec3 centre{};                         // [m] centre of mass
  double mass = 0;                       // [kg]
  Vec3 inertia{};                        // [kg m2] principal moments, about axes along x, y, z at the start
  std::array<bool, 3> moves{}, turns{};  // free along and about x, y, z; held otherwise
  bool weighs = true;                    // feels gravity
  double damping = 0;                    // [1/s] force -damping m v, torque likewise
};
/// Where such a wall is, and what it feels.
struct WallBodyState {
  Vec3 centre, velocity, angular_velocity;  // [m], [m/s], [rad/s]
  kernels::Quaternion orientation;          // from the start
  Vec3 contact_force, contact_torque;       // [N], [N m] of the grains on the wall, about the centre
};

/// How the nodes of a mesh come to their targets. line: straight and evenly; the velocities that contacts see go
/// linearly from the last ones to the given ones. parabola: the given velocities are those at the start; the way is the
/// quadratic through start, start velocity and target, and contacts see its derivative.
enum class MeshWay { line, parabola };

/// How positions and velocities advance (Irazabal2017 3.3): velocity Verlet (3.44-3.53), second order; or symplectic
/// Euler (3.36-3.39), first order: v += dt a(x_n, v_n), x += dt v. Walls that are bodies keep velocity Verlet.
enum class TimeScheme { velocity_verlet, symplectic_euler };
enum class Precision { full, mixed };

/// A direction in which space repeats itself: what leaves at one face comes in at the other.
struct Period {
  double lower = 0, length = 0;  // [m] length 0: not periodic
};
/// The shortest of all differences that two places have [m].
inline Vec3 nearest_image(Vec3 difference, const std::array<Period, 3>& periods) {
  for (int axis = 0; axis < 3; ++axis)
    if (const double length = periods[static_cast<std::size_t>(axis)].length; length > 0)
      difference[axis] -= length * std::round(difference[axis] / length);
  return difference;
}

struct Setup {
  std::vector<Material> materials;
  std::vector<Interaction> interactions;  // row-major materials × materials, symmetric
  Vec3 gravity{};                         // [m/s2]
  double skin = 0;                        // [m] neighbour-list skin; 0: chosen (0.1 × smallest radius or better)
  double maximum_overlap = 0.3;           // overlap / smaller radius above which the run is declared unstable
  bool track_energy = true;               // false: no ledger, no memory and no work for it
  bool rotations = true;
  TimeScheme time_scheme = TimeScheme::velocity_verlet;
  kernels::RotationScheme rotation_scheme = kernels::RotationScheme::quaternion;  // of clumps
  int lanes = 0;  // OMP: pairs taken at once, 2 or 4; 1: one by one, as on a GPU; 0: what suits this machine
  Precision precision = Precision::full;
  /// Along x, y, z. Positions of grains lie between the faces whenever lists are made (a clump's: its centre), so they
  /// jump by a period. Walls do not repeat: a floor must reach beyond the faces by the largest grain, planes must not
  /// cut the direction. Each length at least 4 times the largest grain's radius (a clump's reach) plus the skin twice.
  std::array<Period, 3> periods{};
  /// Not null: this simulation is one part of company->parts(); it must outlive the simulation. All parts make the same
  /// calls in the same order. add_grains() is given all grains everywhere and takes its own; what is measured is of
  /// this part, a contact with a ghost of the part whose grain has the lower id. A period along x is at least 2 parts;
  /// bonds are refused.
  Company* company = nullptr;
};

struct StableStep {
  double limit = 0;     // [s] before any safety factor
  std::string limiter;  // which grain / contact sets it, in words
};

struct Counts {
  std::int64_t grains = 0, spheres = 0, contacts = 0, wall_contacts = 0, candidate_pairs = 0, wall_candidates = 0,
               rebuilds = 0, steps = 0;
  std::size_t bytes = 0;  // memory held by the backend
};

/// One grain–grain contact that carries force, for output and measurement.
struct GrainContact {
  std::int64_t id_i, id_j;
  Vec3 position_i, position_j;
  Vec3 force;          // [N] on i
  double overlap = 0;  // [m]
  Vec3 period{};       // [m] j is met where it lies plus this (position_j has it), across a periodic face
};
/// One grain–wall contact that carries force.
struct WallContact {
  std::int64_t id;
  int wall;  // as returned by add_plane / add_mesh
  Vec3 grain_position, point;
  Vec3 force;          // [N] on the grain
  double overlap = 0;  // [m]
};

/// Grains and contacts of one instant, as Simulation's members of these names tell them.
struct Picture {
  std::vector<Grain> grains;
  std::vector<GrainContact> grain_contacts;
  std::vector<WallContact> wall_contacts;
};

/// Contacts at a node of a mesh: tangent stiffness, the larger of normal and shear, and normal dashpot, as sums
/// |N_a| sum_b |N_b| of the shape functions N at the points of contact: row sums of the springs' matrix.
struct NodeSpring {
  double stiffness = 0, damping = 0;  // [N/m], [N s/m]
};

/// Where along x spheres may be until the lists are made anew, and right after that: those that are here, and (in
/// company, or where space repeats itself) those that may come over.
struct Reach {
  double low = 0, high = 0;  // [m] with half the largest grain and the skin to spare; low > high: no grains
  double grain = 0;          // [m] reach of the largest grain
  double speed = 0;          // [m/s] of the fastest sphere, when the lists were made
};

class Simulation {
 public:
  static std::unique_ptr<Simulation> create(const Setup&, Backend);
  virtual ~Simulation() = default;

  // ---- grains
  /// A shape that clumps may have, in any size; returns its number.
  virtual int add_shape(const Clump&) = 0;
  virtual void add_grains(std::span<const Grain>) = 0;
  /// Removes the grains with these ids (unknown ids are ignored).
  virtual void remove_grains(std::span<const std::int64_t> ids) = 0;
  /// Host copy, sorted by id; velocities at the same instant as positions.
  virtual std::vector<Grain> grains() const = 0;
  /// Host copy, sorted by id.
  virtual std::vector<GrainSphere> spheres() const = 0;
  /// Overwrites position, velocities and orientation of the grains with these ids (histories of their contacts are
  /// kept).
  virtual void set_grains(std::span<const Grain>) = 0;
  /// Makes these grains `factor` times as large about their centres (unknown ids are ignored); masses and inertias
  /// follow, velocities stay. The ledger does not count what that stores in contacts and adds in kinetic energy.
  virtual void scale_grains(std::span<const std::int64_t> ids, double factor) = 0;
  virtual void set_material(int material, const Material&) = 0;
  virtual void set_interaction(int a, int b, const Interaction&) = 0;
  virtual void set_gravity(Vec3) = 0;
  /// Artificial damping force -alpha m v and torque -alpha I omega on every grain, for relaxation. 0: off.
  virtual void set_grain_damping(double alpha) = 0;

  // ---- bonds
  /// Bonds grains as they lie now. A bond goes with its grains. Throws base::UserError: a grain that does not exist or
  /// is a clump, a pair that is bonded already, a constant out of range.
  virtual void add_bonds(std::span<const Bond>) = 0;
  /// Host copy in the order of adding; broken ones too, but not those whose grains are gone.
  virtual std::vector<BondNow> bonds() const = 0;
  virtual std::int64_t broken_bonds() const = 0;

  // ---- walls; every call returns the wall's number
  virtual int add_plane(const Plane&, int material) = 0;
  /// Rigid or deforming surface. two_sided: grains may touch it from either side (the normal is set towards the grain).
  virtual int add_mesh(const base::Skin&, int material, bool two_sided) = 0;
  virtual void remove_wall(int wall) = 0;
  /// Rigid translation with this velocity from now on (planes and meshes); of a wall that is a body: in the directions
  /// in which it is not free.
  virtual void set_wall_velocity(int wall, Vec3) = 0;
  /// From now on the wall is a rigid body at rest, without load. Throws base::UserError: no mass, or a free turn
  /// without moment of inertia.
  virtual void set_wall_body(int wall, const WallBody&) = 0;
  /// Load on such a wall from now on, at its centre.
  virtual void set_wall_load(int wall, Vec3 force, Vec3 torque) = 0;
  virtual WallBodyState wall_body(int wall) const = 0;
  /// Of a rigid wall: how far it has come [m] (a body: its centre) and how fast it moves [m/s].
  virtual Vec3 wall_displacement(int wall) const = 0;
  virtual Vec3 wall_velocity(int wall) const = 0;
  /// Nodes of a mesh move, over the next advance(), from where they are to these positions (MeshWay).
  virtual void set_mesh_target(int wall, std::span<const Vec3> positions, std::span<const Vec3> velocities,
                               MeshWay = MeshWay::line) = 0;
  /// From now on targets are true for these nodes of a mesh only; at the start all are. The others rest, and no grain
  /// finds the facets and faces that have one of them: keep grains away with keep_within(). fresh: those of `nodes`
  /// that were not known before, with where they are now and how fast. Not of a wall that has been removed.
  virtual void know_mesh_nodes(int wall, std::span<const int> nodes, std::span<const int> fresh,
                               std::span<const Vec3> positions, std::span<const Vec3> velocities) = 0;
  /// No sphere may come beyond [low, high] along x [m] in the advances to come: one that could before lists are made
  /// anew ends them (base::UnstableError). Of this part.
  virtual void keep_within(double low, double high) = 0;
  /// As of the last advance(); of this part.
  virtual Reach reach() const = 0;
  /// Nodal impulse [N s] that the grains passed to the mesh during the last advance(): sum over its steps of
  /// (nodal force at the step's end) × dt, the contact force carried to the nodes by the shape functions of the
  /// facet, or of the face of the second order that it is a part of.
  virtual void nodal_impulse(int wall, std::span<Vec3> impulse) const = 0;
  /// Springs of the live contacts on the nodes of a mesh, each contact's shared out by the facet's shape functions.
  virtual std::vector<NodeSpring> node_springs(int wall) const = 0;
  /// Sum of the impulses that the grains received from that mesh in the last advance(), counted on the grains' side.
  virtual Vec3 wall_impulse_on_grains(int wall) const = 0;

  // ---- time
  /// n steps of dt. Throws base::UnstableError (cause, grain id, place, step) when a state is not
  /// finite or an overlap exceeds Setup::maximum_overlap.
  virtual void advance(int n, double dt) = 0;
  virtual double time() const = 0;
  /// Over the present grains and materials: the Rayleigh limit; where a material meets linear springs 2 / omega with
  /// omega^2 = 8 k / m (four contacts in one direction, partners moving against them). Bonds add their own omega^2.
  virtual StableStep stable_step() const = 0;
  /// 2/omega_max bound from the live contacts (normal and shear stiffness, damping, grain and wall-node free side).
  virtual StableStep contact_stable_step() const = 0;

  // ---- checkpoint
  /// All that the steps to come depend on, between two calls of advance(). The lists of neighbours are part of it, so
  /// that saving leaves no trace in the simulation that goes on, at whatever moment it is done.
  virtual base::Columns save() const = 0;
  /// Goes on from there, on the same number of threads bit for bit. The simulation must be new: of the same Setup and
  /// backend, with the same shapes and walls added (and bodies made of them) in the same order, without grains. Throws
  /// base::UserError when the columns do not fit.
  virtual void restore(const base::Columns&) = 0;
  /// Goes on from what another number of parts has saved, given to all parts of this one: the same to rounding. Before
  /// the next step only.
  virtual void restore_parts(std::span<const base::Columns>) = 0;

  // ---- measurement (host copies; not for every step)
  virtual base::Energy energy() const = 0;
  /// Works and losses start again at zero from here.
  virtual void reset_energy() = 0;
  /// Contacts as of the last advance(); none after grains have been added or removed, until the next.
  virtual std::vector<GrainContact> grain_contacts() const = 0;
  virtual std::vector<WallContact> wall_contacts() const = 0;
  /// What grains(), grain_contacts() and wall_contacts() would tell now, and what save() would, for files that are
  /// written while the simulation goes on: the function that is returned gives it, once, to any thread. On a GPU nobody
  /// waits for the copies before that.
  virtual std::function<Picture()> picture() const;
  virtual std::function<base::Columns()> saved() const;
  virtual Counts counts() const = 0;
  virtual Backend backend() const = 0;
};

/// A row of laws.hpp, for programs that list and check what a user chooses.
struct LawText {
  std::string_view name, text, source;
  std::vector<std::string_view> parameters;  // of the materials and of the pair, by their names in a scene
};
std::vector<LawText> contact_law_texts();
std::vector<LawText> rolling_model_texts();

/// Number of OMP threads the OMP backend uses from now on.
void set_threads(int);

}  // namespace dem
