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
#include "coupling/shapes.hpp"
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
  bool ramp_stiffness = false;  // grains' modulus goes from packing to loading value, geometrically, over the stage
  bool measure = false;         // the stage whose start is the zero of displacement, energy and results
  std::string origin;           // file:line
};

struct WallScene {
  std::string name;
  std::optional<dem::Plane> plane;  // either a plane …
  std::filesystem::path mesh;       // … or a surface mesh (.stl, .msh, .geo)
  std::map<std::string, double> mesh_parameters;
  int material = 0;
  Vec3 velocity;  // [m/s] rigid translation
  bool two_sided = false;
  bool packing_only = false;  // taken away when the packing is done
  std::string origin;
};

/// One lift of ballast: grains poured over `box`, settled, struck off at the box's top, levelled by a plate.
struct PackingLayer {
  Box box;                          // [m] what the lift is to fill
  double overfill = 0.1;            // more solid volume than needed by this share
  bool plate = true;                // press a level plate down to the box's top afterwards
  std::vector<std::string> bodies;  // deformable bodies already in place (as rigid surfaces), e.g. the sleeper
  double settle = 0.5;              // [s] time for the grains to come down and calm
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
  double target_porosity = 0.4;  // decides how many grains are poured
  double grain_damping = 0;      // [1/s]
  double plate_speed = 0.2;      // [m/s]
  std::vector<PackingLayer> layers;
  std::vector<dem::Plane>
      cuts;  // after packing, grains reaching above a cut plane (normal points away from the ballast) are taken out
  std::vector<int> shapes;           // of GrainsScene::shapes; empty: spheres
  std::vector<double> shape_shares;  // of the number of grains, one per shape, sum 1
  bool use_cache = true;
  std::string origin;
};

struct GrainsScene {
  std::vector<dem::Material> materials;        // [0] is the grains' own
  std::vector<dem::Interaction> interactions;  // materials × materials
  std::vector<GrainShape> shapes;              // Grain::shape counts in it
  std::vector<dem::Grain> list;                // grains given one by one ([[grain]])
  std::optional<Packing> packing;
  std::vector<WallScene> walls;
  double neighbour_skin = 0;     // [m] 0: automatic
  double maximum_overlap = 0.3;  // overlap / smaller radius above which a run is declared unstable
  bool rotations = true;         // grains may turn
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
  coordination,    // of the grains in a box
  kinetic_energy,  // of all grains
  grain_position,
  grain_velocity,
  grain_angular_velocity  // of one grain (id), component
};
struct Probe {
  std::string name;
  ProbeKind kind{};
  std::string unit;  // filled in from the kind
  std::string body, group, load, wall;
  std::optional<Vec3> point;
  std::optional<Box> box;
  double area = 0;  // [m2]
  double scale = 1;
  int component = 2;
  std::int64_t grain = 0;
  std::string origin;
};

struct Result {
  std::string name;
  std::string probe;
  std::string take =
      "last";        // first | last | min | max | first_peak | rise | max_abs | mean | range | frequency | ratio
  std::string over;  // for ratio: max|probe| / max|over|
  double scale = 1;
  std::string unit;                                     // shown; the values here are SI
  std::optional<double> expected;                       // one value …
  std::optional<std::array<double, 2>> expected_range;  // … or a range
  std::string source;
  std::string origin;
};

struct Output {
  double interval = 0;        // [s] between pictures of the state; 0: only the last
  double probe_interval = 0;  // [s] between rows of history.csv; 0: every window
  bool contacts = false;      // write contacts.pvd (force chains)
};

struct Scene {
  std::filesystem::path file;
  std::string title;
  Vec3 gravity{0, 0, -9.81};
  TimeSettings time;
  std::vector<Stage> stages;
  std::optional<GrainsScene> grains;  // absent: no DEM at all
  std::vector<fem::Body> bodies;      // empty: no FEM at all
  std::vector<Probe> probes;
  std::vector<Result> results;
  Output output;
  std::string resolved_toml;  // scene.resolved.toml: every default and derived value; can be run again
  std::string packing_hash;   // of everything that decides the packing; empty without one

  bool has_grains() const { return grains.has_value(); }
  bool has_bodies() const { return !bodies.empty(); }
};

struct Override {
  std::string key, value;  // --set key=value, applied before checking
};

/// Reads, checks and resolves a scene file. Throws base::UserError with file:line, key, value found, rule and remedy.
Scene read_scene(const std::filesystem::path& file, const std::vector<Override>& overrides = {});

/// Text of `trackbed list FAMILY`: name, type, unit, range, default, meaning. Throws base::UserError on an unknown
/// family.
std::string list_family(const std::string& family);
std::vector<std::string> families();

}  // namespace coupling
