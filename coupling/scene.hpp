#pragma once
// A scene as the run loop sees it: everything parsed, in SI, defaults filled in, names resolved to what they mean,
// files found. Made by read_scene() only; every check that needs no mesh is done there.
#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/history.hpp"
#include "base/vec3.hpp"
#include "coupling/bonding.hpp"
#include "coupling/grain_probe.hpp"
#include "coupling/shapes.hpp"
#include "coupling/window.hpp"
#include "dem/dem.hpp"
#include "fem/fem.hpp"

namespace coupling {

using base::Vec3;

struct Box {
  Vec3 lower, upper;  // [m]
};

/// A step set by hand; above the limit: exit 2 unless force_step.
struct ChosenStep {
  double seconds = 0;
  std::string origin;  // file:line
};

struct TimeSettings {
  double dem_fraction = 0.25;  // of the DEM stable-step limit (Rayleigh)
  double fem_fraction = 0.9;   // of the FEM stable-step limit (2/omega_max)
  std::optional<ChosenStep> dem_step, fem_step;
  bool force_step = false;  // run with a step above its limit (it will become unstable)
  dem::TimeScheme integrator = dem::TimeScheme::velocity_verlet;  // of the grains, but not while packing
};

/// The step set by hand, or `fraction` of the limit.
inline double step_of(const std::optional<ChosenStep>& chosen, double fraction, double limit) {
  return chosen ? chosen->seconds : fraction * limit;
}

/// A stretch of simulated time with its own helps (damping, held bodies, stiffness ramp). Run in file order.
struct Stage {
  std::string name;
  double duration = 0;                         // [s]
  double grain_damping = 0;                    // [1/s] artificial -alpha m v on grains
  std::map<std::string, double> body_damping;  // [1/s] per body, instead of the body's own
  std::vector<std::string> hold;               // bodies fixed in place
  bool ramp_stiffness = false;    // grains' modulus goes from packing to loading value, geometrically, over the stage
  bool packing_friction = false;  // grains keep the friction and rolling friction of their packing
  bool measure = false;           // the stage whose start is the zero of displacement, energy and results
  std::string origin;             // file:line
};

struct WallLoad {
  Vec3 direction;  // [N] or [m2] per unit of the history
  base::HistoryPtr history;
};

/// The wall moves as a rigid body.
struct WallBodyScene {
  dem::WallBody is;            // its centre is filled in when the mesh is there
  std::optional<Vec3> centre;  // [m] absent: mean of the mesh's nodes
  std::vector<WallLoad> loads;
};

struct WallMotion {
  int stage = 0;  // from its start on
  Vec3 velocity;  // [m/s]
};

struct WallScene {
  std::string name;
  std::optional<dem::Plane> plane;  // either a plane …
  std::filesystem::path mesh;       // … or a surface mesh (.stl, .msh, .geo)
  std::map<std::string, double> mesh_parameters;
  Vec3 translation;  // [m] of the mesh
  int material = 0;
  Vec3 velocity;                    // [m/s] rigid translation
  std::vector<WallMotion> motions;  // other velocities, by stages
  std::optional<WallBodyScene> body;
  int removed_at = -1;  // stage at whose start it is taken away
  bool two_sided = false;
  bool packing_only = false;  // taken away when the packing is done
  bool run_only = false;      // comes when the packing is done
  std::string origin;
};

/// Grains put small into a closed box and grown (packing_growth.cpp).
struct Growth {
  double start = 0.625;        // share of their size at which grains are put in
  double overlap = 0.02;       // of the smaller radius: added by one stage at most, and left at most
  double damping = 100;        // [1/s] while they grow
  double gravity_factor = 30;  // of the gravity that presses the bed once the lid is gone
  double lowering = 0.1;       // [s] in which that gravity becomes the scene's own
};

/// The whole container shaken, amplitude sin(2 pi frequency t) along the direction (packing_vibration.cpp).
struct Vibration {
  double amplitude = 0;  // [m]
  double frequency = 0;  // [1/s]
  double time = 0;       // [s]
  Vec3 direction{0, 0, 1};
  std::string origin;
};

/// A part of the bed that is less dense than the rest (packing_regions.cpp).
struct LooseRegion {
  Box box;                         // [m]
  std::optional<double> friction;  // between its grains while packing
  double share = 0;                // of its grains, taken out of the finished bed
  std::string origin;
};

/// A box out of which grains are taken until none comes any more (packing_regions.cpp).
struct ErodedRegion {
  Box box;                          // [m]
  std::optional<dem::Plane> above;  // only what lies on the side that the normal points to
  double settle = 1;                // [s] at most
  std::string origin;
};

/// One lift of ballast: grains poured over `box` or grown in it, settled, struck off at the box's top, levelled by a
/// plate.
struct PackingLayer {
  Box box;                          // [m] what the lift is to fill
  double overfill = 0.1;            // more solid volume than needed by this share
  bool plate = true;                // press a level plate down to the box's top afterwards
  std::vector<std::string> bodies;  // bodies and mesh walls already in place (as rigid surfaces), e.g. the sleeper
  double settle = 0.5;              // [s] time for the grains to come down and calm
  std::optional<Growth> growth;     // instead of being poured
  std::optional<Vibration> vibration;
  std::string origin;
};

struct GradingRow {
  double size = 0;     // [m] sieve
  double passing = 0;  // mass fraction in [0, 1]
};

struct Packing {
  std::vector<GradingRow> grading;  // rising sizes
  std::uint64_t seed = 1;
  double young_modulus = 0;  // [Pa] of the grains while packing
  double friction = 0;       // grain–grain and grain–wall while packing
  double rolling_friction = 0;
  double target_porosity = 0.4;     // decides how many grains are poured
  std::optional<double> tolerance;  // a bed that is farther from the target is refused
  int tries = 1;                    // beds packed, with other frictions, until one is within the tolerance
  double grain_damping = 0;         // [1/s]
  double plate_speed = 0.2;         // [m/s]
  std::vector<PackingLayer> layers;
  std::vector<dem::Plane>
      cuts;  // after packing, grains reaching above a cut plane (normal points away from the ballast) are taken out
  std::vector<LooseRegion> loosened;
  std::vector<ErodedRegion> eroded;
  std::vector<int> shapes;           // of GrainsScene::shapes; empty: spheres
  std::vector<double> shape_shares;  // of the number of grains, one per shape, sum 1
  bool use_cache = true;
  std::string origin;
};

/// The axis of a periodic direction that the plane cuts.
inline std::optional<int> cuts_period(const dem::Plane& plane, const std::array<dem::Period, 3>& periods) {
  for (int axis = 0; axis < 3; ++axis)
    if (periods[static_cast<std::size_t>(axis)].length > 0 && std::abs(plane.normal[axis]) > 1e-9 * norm(plane.normal))
      return axis;
  return std::nullopt;
}

struct GrainsScene {
  std::vector<dem::Material> materials;        // [0] is the grains' own
  std::vector<dem::Interaction> interactions;  // materials × materials
  std::vector<GrainShape> shapes;              // Grain::shape counts in it
  std::vector<dem::Grain> list;                // grains given one by one ([[grain]])
  std::optional<Packing> packing;
  std::vector<WallScene> walls;
  std::array<dem::Period, 3> periods{};  // along x, y, z
  double neighbour_skin = 0;             // [m] 0: automatic
  double maximum_overlap = 0.3;          // overlap / smaller radius above which a run is declared unstable
  bool rotations = true;                 // grains may turn
  dem::kernels::RotationScheme rotation_scheme = dem::kernels::RotationScheme::quaternion;  // of clumps
  Bonding bonding;
  dem::Precision precision = dem::Precision::full;
  std::map<std::string, int> body_material;  // contact material of each deformable body's skin
};

enum class ProbeKind {
  displacement,
  velocity,
  acceleration,    // of a body: group mean or point; component x|y|z
  load,            // value of a named load [N or Pa]
  contact_force,   // sum of grain forces on a body's skin (or a wall) inside a box, component
  contact_stress,  // the same over `area`
  porosity,
  coordination,
  rattlers,
  mechanical_coordination,
  contact_force_mean,
  contact_force_quantile,
  strong_contacts,
  stress,              // of the grains in a region
  heap_angle,          // of a heap of grains
  passing,             // of the grains, through a sieve
  grain_displacement,  // of one grain, component
  kinetic_energy,      // of all grains
  broken_bonds,        // number of them since the start
  grain_position,
  grain_velocity,
  grain_angular_velocity,  // of one grain (id), component
  wall_displacement,
  wall_velocity,  // of a rigid wall, component
  sum,
  quotient,
  angle,  // of other probes that stand before it
  reaction,
  mode_frequency,
  body_stress,
  body_plastic_strain,  // of a body, at a point or over a group
  time
};
struct Probe {
  std::string name;
  ProbeKind kind{};
  std::string unit;  // filled in from the kind
  std::string body, group, load, wall;
  std::optional<Vec3> point;
  std::optional<Box> box;
  GrainProbe look;  // of kinds that measures_grains() (grain_probes.hpp) knows
  double area = 0;  // [m2]
  double scale = 1;
  int component = 2;
  std::int64_t grain = 0;
  int mode = 1;                 // 1: the lowest
  std::vector<std::size_t> of;  // indices of other probes
  std::vector<double> factors;  // of a sum
  double offset = 0;            // of a sum
  std::string origin;
};

struct Result {
  std::string name;
  std::string probe;
  /// first | last | min | max | first_peak | rise | max_abs | mean | range | frequency | decay | ratio | at
  std::string take = "last";
  std::string over;     // for ratio: max|probe| / max|over|; for at: what reaches `level`
  double level = 0;     // of `over`, SI
  double smoothed = 0;  // [s] width of a moving mean taken first; 0: none
  double scale = 1;
  std::string unit;                                     // shown; the values here are SI
  std::optional<double> expected;                       // one value …
  std::optional<std::array<double, 2>> expected_range;  // … or a range
  std::string source;
  std::string origin;
};

/// A column of spectra.csv.
struct SpectrumScene {
  std::string name, probe, over;  // over: empty, or what divides
  std::string unit;
  double bandwidth = 0;  // [Hz] of Parzen's window; 0: none
};

struct Output {
  double interval = 0;              // [s] between pictures of the state; 0: only the last
  double probe_interval = 0;        // [s] between rows of history.csv; 0: every window
  double checkpoint_interval = 0;   // [s] simulated, between checkpoints; 0: none
  double checkpoint_wall_time = 0;  // [s] on the clock, likewise
  bool contacts = false;            // write contacts.pvd (force chains) and contact_forces.csv
  std::vector<double> sieves;       // [m] of sieve_curve.csv; empty: those of the packing's grading
};

struct Scene {
  std::filesystem::path file;
  std::string title;
  Vec3 gravity{0, 0, -9.81};
  TimeSettings time;
  CouplingSettings coupling;
  std::vector<Stage> stages;
  std::optional<GrainsScene> grains;  // absent: no DEM at all
  std::vector<fem::Body> bodies;      // empty: no FEM at all
  fem::SolverSettings solver;         // of the bodies
  int modes = 6;                      // of every body, where the solver is modal
  std::vector<Probe> probes;
  std::vector<Result> results;
  std::vector<SpectrumScene> spectra;
  Output output;
  std::string resolved_toml;  // scene.resolved.toml: every default and derived value; can be run again
  std::string packing_hash;   // of everything that decides the packing; empty without one

  bool has_grains() const { return grains.has_value(); }
  bool has_bodies() const { return !bodies.empty(); }
  bool is_modal() const { return solver.kind == fem::Solver::modal; }
  bool is_explicit() const { return solver.kind == fem::Solver::explicit_steps; }
};

struct Override {
  std::string key, value;  // --set key=value, applied before checking
};

/// Reads, checks and resolves a scene file. Throws base::UserError with file:line, key, value found, rule and remedy.
Scene read_scene(const std::filesystem::path& file, const std::vector<Override>& overrides = {});

/// The scene's word for a solver.
const char* solver_name(fem::Solver);

/// Text of `trackbed list FAMILY`: name, type, unit, range, default, meaning. Throws base::UserError on an unknown
/// family.
std::string list_family(const std::string& family);
std::vector<std::string> families();

}  // namespace coupling
