#include "coupling/scene_tables.hpp"

#include "base/histories.hpp"
#include "coupling/contact_tables.hpp"
#include "coupling/grain_probes.hpp"
#include "coupling/wall_tables.hpp"
#include "dem/grading.hpp"
#include "fem/fem.hpp"

namespace coupling {

using base::Family;
using base::Table;
using base::Vec3;

const Table& box_table() {
  static const Table table{"box",
                           "an upright box, between two corners",
                           {base::vector("lower", "m", "corner with the smallest coordinates"),
                            base::vector("upper", "m", "corner with the largest coordinates")}};
  return table;
}

const Table& plane_table() {
  static const Table table{"plane",
                           "an infinite plane",
                           {base::vector("point", "m", "a point of the plane"),
                            base::vector("normal", "", "normal, of any length; grains live on the side it points to")}};
  return table;
}

namespace {
const Table& cut_table() {
  static const Table table{
      "packing.cuts",
      "a plane that trims the finished packing",
      {base::vector("point", "m", "a point of the plane"),
       base::vector("normal", "", "normal, of any length; grains that reach beyond on this side are taken out")}};
  return table;
}

/// The parameters of a table, one list after the other.
std::vector<base::Parameter> joined(std::vector<base::Parameter> first, const std::vector<base::Parameter>& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}
constexpr const char* own = "the grains' own";

std::vector<std::string> grading_names() {
  std::vector<std::string> names;
  for (const auto& grading : dem::named_gradings()) names.emplace_back(grading.name);
  return names;
}
}  // namespace

const Table& time_table() {
  static const Table table{
      "time",
      "steps of both sides",
      {base::real("dem_fraction", "", "share of the grains' stable step (Rayleigh) to use")
           .above(0)
           .at_most(1)
           .otherwise(0.25),
       base::real("fem_fraction", "", "share of the bodies' stable step (2/omega_max) to use")
           .above(0)
           .at_most(1)
           .otherwise(0.9),
       base::real("dem_step", "s", "longest step of the grains, instead of dem_fraction")
           .above(0)
           .optional("from dem_fraction"),
       base::real("fem_step", "s", "longest step of the bodies, instead of fem_fraction")
           .above(0)
           .optional("from fem_fraction"),
       base::text("integrator", "of the grains; symplectic_euler is of first order. Packings take velocity_verlet")
           .among({"velocity_verlet", "symplectic_euler"})
           .otherwise("velocity_verlet"),
       base::boolean("force_step", "run even with a step above its limit; it will become unstable").otherwise(false)}};
  return table;
}

const Table& grain_material_table() {
  static const Table table{
      "grains.material",
      "elastic grains; also where the contact law reads no elastic constants, they limit the step",
      {base::name("name", "for messages").otherwise("grains"), young_modulus("the grains"), poisson_ratio("the grains"),
       base::real("density", "kg/m3", "density of the grains").above(0)}};
  return table;
}

const Table& shape_table() {
  static const Table table{
      "grains.shape",
      "a shape of grains: overlapping spheres that move as one body",
      {base::name("name", "for [[grain]] and [packing]"),
       base::path("file",
                  "spheres, a line x,y,z,radius [m] each, as those of meshes/ballast; scaled where it is used")}};
  return table;
}

const Table& periodic_table() {
  static const Table table{
      "grains.periodic",
      "a direction in which space repeats itself: grains that leave at one face come in at the other. Walls do not "
      "repeat: a mesh that carries grains must reach beyond the faces by the largest grain's radius",
      {base::text("axis", "of the direction").among({"x", "y", "z"}), base::real("lower", "m", "place of the one face"),
       base::real("upper", "m", "place of the other")}};
  return table;
}

const Table& grains_table() {
  static const Table table{
      "grains", "what all grains share; without this table there is no DEM",
      joined(
          {base::table("material", grain_material_table(), "of the grains"),
           base::tables("shape", shape_table(), "shapes that grains may have").otherwise_empty(),
           base::table("bond", bonds_table(), "cement between grains").optional("no bonds, or only [[bond]]"),
           base::tables("periodic", periodic_table(), "directions in which space repeats itself").otherwise_empty(),
           base::boolean("rotations", "grains may turn").otherwise(true),
           base::text("rotation_scheme", "how clumps turn (Irazabal2017 5.3.1). Packings take quaternion")
               .among({"quaternion", "runge_kutta", "direct"})
               .otherwise("quaternion"),
           base::text("precision",
                      "of contacts between grains; mixed: laws in single precision, state and sums in double; "
                      "packings stay double")
               .among({"double", "mixed"})
               .otherwise("double"),
           base::real("neighbour_skin", "m", "margin of the neighbour list; 0: chosen").at_least(0).otherwise(0.0),
           base::real("maximum_overlap", "", "overlap over the smaller radius above which a run is declared unstable")
               .above(0)
               .at_most(1)
               .otherwise(0.3)},
          grain_contact_parameters())};
  return table;
}

const Table& grain_table() {
  static const Table table{
      "grain",
      "one grain, or a grid of such",
      {base::vector("position", "m", "centre of mass; of a grid: of its first grain"),
       base::vector("repeat", "", "grains along x, y, z of a grid that starts at `position`").otherwise(Vec3{1, 1, 1}),
       base::vector("spacing", "m", "of the grid along x, y, z").otherwise(Vec3{}),
       base::real("radius", "m", "of a sphere").above(0).optional("`shape` instead"),
       base::text("shape", "name of a [[grains.shape]]").optional("a sphere"),
       base::real("size", "m", "of a shape: smallest square hole that it passes")
           .above(0)
           .optional("as in the shape's file"),
       base::vector("orientation", "rad", "of a shape: turn from its file's axes, about this vector by its length")
           .optional("as in the shape's file"),
       base::vector("velocity", "m/s", "at the start").otherwise(Vec3{}),
       base::vector("angular_velocity", "rad/s", "at the start").otherwise(Vec3{})}};
  return table;
}

const Table& wall_material_table() {
  static const Table table{
      "wall.material", "elastic constants of a wall", {young_modulus("the wall"), poisson_ratio("the wall")}};
  return table;
}

const Table& wall_table() {
  static const Table table{
      "wall", "a rigid wall for the grains",
      joined({base::name("name", "for messages and probes"),
              base::table("plane", plane_table(), "an infinite plane").optional("`mesh` instead"),
              base::path("mesh", "a surface from a .stl, .msh or .geo file").optional("`plane` instead"),
              base::numbers("mesh_parameters", "", "numbers set in the .geo").otherwise_empty(),
              base::vector("translation", "m", "added to every node of the mesh").otherwise(Vec3{}),
              base::table("material", wall_material_table(), "of the wall").optional(own),
              base::boolean("two_sided", "grains may touch a mesh from either side").otherwise(false)},
             joined(wall_motion_parameters(), partner_contact_parameters()))};
  return table;
}

const Table& layer_table() {
  static const Table table{
      "packing.layer",
      "one lift: poured or grown, settled, shaken, struck off at the box's top, levelled",
      {base::table("box", box_table(), "what the lift is to fill"),
       base::real("overfill", "", "more solid volume than needed by this share").at_least(0).otherwise(0.1),
       base::boolean("plate", "press a level plate down to the box's top afterwards").otherwise(true),
       base::texts("bodies", "bodies (and mesh walls) that are in place from this layer on, as rigid surfaces")
           .otherwise_empty(),
       base::real("settle", "s", "time for the grains to come down and calm").at_least(0).otherwise(0.5),
       base::text("method", "gravity: poured; growth: grown from small in the closed box")
           .among({"gravity", "growth"})
           .otherwise("gravity"),
       base::table("growth", growth_table(), "how, with method = \"growth\"").optional("its defaults"),
       base::table("vibration", vibration_table(), "shakes the container once the grains are calm").optional("none")}};
  return table;
}

const Table& packing_table() {
  static const Table table{
      "packing",
      "how the bed of grains is made",
      {base::pairs("grading", "m",
                   "[sieve size, mass share passing], rising, sizes spread evenly between sieves; or a name of "
                   "`trackbed list gradings`")
           .among(grading_names())
           .at_least(0)
           .at_most(1),
       base::texts("shapes", "names of [[grains.shape]] to pour, turned at random, each in its own share")
           .otherwise_empty(),
       base::reals("shape_shares", "", "share of every shape in the number of grains").above(0).optional("equal"),
       base::integer("seed", "of the random numbers").at_least(0).otherwise(1),
       young_modulus("the grains while packing").optional(own),
       base::real("friction", "", "Coulomb coefficient while packing, where it is lower").at_least(0).optional(own),
       base::real("rolling_friction", "", "rolling friction while packing, where it is lower")
           .at_least(0)
           .optional(own),
       base::real("target_porosity", "", "decides how many grains are poured").above(0).below(1).otherwise(0.4),
       base::real("tolerance", "", "a bed whose porosity is farther from the target is refused")
           .above(0)
           .below(1)
           .optional("the porosity reached is only reported"),
       base::integer("tries", "beds packed, with more or less friction, until one is within the tolerance")
           .at_least(1)
           .at_most(20)
           .otherwise(1),
       base::real("grain_damping", "1/s", "artificial damping -alpha m v while packing").at_least(0).otherwise(0.0),
       base::real("plate_speed", "m/s", "of the levelling plate").above(0).otherwise(0.2),
       base::boolean("cache", "keep the packing and use it again while nothing that makes it changes").otherwise(true),
       base::tables("cuts", cut_table(), "planes that trim the finished packing").otherwise_empty(),
       base::tables("loosen", loosen_table(), "parts of the bed that are to be less dense").otherwise_empty(),
       base::tables("erode", erode_table(), "parts of the bed that are to be empty").otherwise_empty(),
       base::tables("layer", layer_table(), "lifts, from below")}};
  return table;
}

const Family& material_family() {
  const auto row = [](const char* law, const char* meaning, const std::vector<base::Parameter>& own_parameters) {
    const auto selector = base::text("law", "stress from strain").among({law});
    const bool usual = std::string(law) == "linear_elastic";
    return Table{law, meaning,
                 joined({usual ? selector.otherwise(law) : selector,
                         base::text("group", "physical volume of the mesh").otherwise(""), young_modulus("the solid"),
                         base::real("poisson_ratio", "", "Poisson ratio of the solid").above(-1).below(0.5),
                         base::real("density", "kg/m3", "density of the solid").above(0)},
                        own_parameters)};
  };
  const std::vector<base::Parameter> viscosity{
      base::real("shear_viscosity", "Pa s", "mu_D of Nishiura2017 eq. 7").at_least(0).otherwise(0.0),
      base::real("bulk_viscosity", "Pa s", "lambda_D + 2/3 mu_D of Nishiura2017 eq. 7").at_least(0).otherwise(0.0)};
  static const Family family{
      "law",
      "materials",
      {row("linear_elastic", "isotropic Hooke's law, small strains", {}),
       row("kelvin_voigt", "Hooke's spring and a viscous dashpot side by side, small strains (Nishiura2017 eq. 7-8)",
           viscosity),
       row("left_cauchy_green",
           "the same in the left Green-Lagrange strain, for bodies that turn (Nishiura2017 eq. 2-4)", viscosity),
       row("drucker_prager",
           "elastic, perfectly plastic with friction; sqrt(J2) + alpha I1 <= k, tension positive, small strains",
           joined(
               {base::real("cohesion", "Pa", "c").at_least(0), base::real("friction_angle", "rad", "phi").at_least(0),
                base::real("dilation_angle", "rad", "psi, at most phi").at_least(0).otherwise(0.0),
                base::text("fit",
                           "of the cone to c and phi: outer (triaxial compression), inner (extension), plane_strain")
                    .among({"outer", "inner", "plane_strain"})
                    .otherwise("outer")},
               viscosity))}};
  return family;
}

const Table& support_table() {
  static const Table table{"body.support",
                           "a group that cannot move in some directions",
                           {base::text("group", "physical surface, curve or point of the mesh"),
                            base::texts("fix", "fixed directions").among({"x", "y", "z"})}};
  return table;
}

const Table& absorbing_table() {
  static const Table table{"body.absorbing",
                           "a surface that lets waves out: dashpots rho c_p along its normal, rho c_s across (Lysmer, "
                           "Kuhlemeyer 1969); it holds no static load",
                           {base::text("group", "physical surface of the mesh")}};
  return table;
}

const Table& periodic_faces_table() {
  static const Table table{"body.periodic",
                           "two faces that are one: what leaves at the first comes in at the second. Their nodes must "
                           "lie opposite each other",
                           {base::text("first", "physical surface of the mesh"),
                            base::text("second", "the surface opposite, a shift away")}};
  return table;
}

const Family& motion_family() {
  const auto row = [](const char* kind, const char* meaning, const char* unit) {
    return Table{
        kind,
        meaning,
        {base::name("name", "for history.csv and probes"), base::text("kind", "what the history gives").among({kind}),
         base::text("group", "physical group of the mesh"),
         base::texts("along", "directions that follow the history").among({"x", "y", "z"}),
         base::table("history", base::history_family(unit), "value over time, see `trackbed list histories`")}};
  };
  static const Family family{"kind",
                             "motions",
                             {row("displacement", "a group whose displacement is given", "m"),
                              row("velocity", "a group whose velocity is given", "m/s")}};
  return family;
}

const Family& load_family() {
  const auto row = [](const char* kind, const char* meaning, const char* unit) {
    Table table{kind,
                meaning,
                {base::name("name", "for history.csv and probes"),
                 base::text("kind", "how the history's value acts").among({kind}),
                 base::text("group", "physical group of the mesh")}};
    if (std::string(kind) != "pressure")
      table.parameters.push_back(base::vector("direction", "", "multiplied by the history's value"));
    table.parameters.push_back(
        base::table("history", base::history_family(unit), "value over time, see `trackbed list histories`"));
    return table;
  };
  static const Family family{"kind",
                             "loads",
                             {row("face_total", "total force spread evenly over the area of a surface", "N"),
                              row("nodal_total", "total force shared equally by the nodes of a group", "N"),
                              row("traction", "force per area of a surface", "Pa"),
                              row("pressure", "against the outward normal of an outer surface; > 0 presses", "Pa")}};
  return family;
}

const Table& contact_table() {
  static const Table table{"body.contact", "how the body's skin meets grains",
                           joined({young_modulus("the skin").optional("the body's first material"),
                                   poisson_ratio("the skin").optional("the body's first material")},
                                  partner_contact_parameters())};
  return table;
}

const Table& body_table() {
  static const Table table{
      "body",
      "a deformable body; without one there is no FEM",
      {base::name("name", "for files, probes and stages"), base::path("mesh", ".geo (meshed at the start) or .msh"),
       base::numbers("mesh_parameters", "", "numbers set in the .geo").otherwise_empty(),
       base::text("element", "see `trackbed list elements`").among(fem::element_names()).otherwise("hex8"),
       base::vector("translation", "m", "added to every node").otherwise(Vec3{}),
       base::boolean("gravity", "false: starts in geostatic balance, its own weight is left out").otherwise(true),
       base::real("damping", "1/s", "mass-proportional damping -alpha m v").at_least(0).otherwise(0.0),
       base::real(
           "stiffness_damping", "s",
           "stiffness-proportional (Rayleigh) damping beta: viscosity beta mu and beta K; shortens explicit steps")
           .at_least(0)
           .otherwise(0.0),
       base::texts("skin", "physical surfaces that grains can touch").otherwise_empty(),
       base::tables("material", material_family(), "one, or one per physical volume"),
       base::tables("support", support_table(), "where it is held").otherwise_empty(),
       base::tables("motion", motion_family(), "where it is driven").otherwise_empty(),
       base::tables("absorbing", absorbing_table(), "where waves leave it").otherwise_empty(),
       base::tables("periodic", periodic_faces_table(), "faces that are one").otherwise_empty(),
       base::tables("load", load_family(), "what pulls on it").otherwise_empty(),
       base::table("contact", contact_table(), "of its skin with grains").optional("all as in [grains]")}};
  return table;
}

const Table& stage_table() {
  static const Table table{
      "stage",
      "a stretch of simulated time; stages run in file order",
      {base::name("name", "for messages and histories"), base::real("duration", "s", "simulated time").above(0),
       base::real("grain_damping", "1/s", "artificial damping -alpha m v of the grains").at_least(0).otherwise(0.0),
       base::numbers("body_damping", "1/s", "damping per body, instead of the body's own")
           .at_least(0)
           .otherwise_empty(),
       base::texts("hold", "bodies fixed in place").otherwise_empty(),
       base::boolean("ramp_stiffness", "grains' modulus goes from its packing to its loading value").otherwise(false),
       base::boolean("packing_friction", "grains keep the friction and rolling friction of their packing")
           .otherwise(false),
       base::boolean("measure", "its start is the zero of displacement, energy and results").otherwise(false)}};
  return table;
}

const std::vector<ProbeRow>& probe_rows() {
  static const std::vector<ProbeRow> rows{
      {"displacement", "m", "displacement of a body", ProbeRow::body_motion},
      {"velocity", "m/s", "velocity of a body", ProbeRow::body_motion},
      {"acceleration", "m/s2", "acceleration of a body", ProbeRow::body_motion},
      {"load", "N", "value of a named load (traction, pressure: Pa) or motion (m, m/s)", ProbeRow::load},
      {"contact_force", "N", "sum of the grains' forces on a body or wall", ProbeRow::contact},
      {"contact_stress", "Pa", "the same over an area", ProbeRow::contact_area},
      {"porosity", "", "share of a region that no grain fills", ProbeRow::region},
      {"coordination", "", "mean number of grains that press on a grain of a region", ProbeRow::region},
      {"rattlers", "", "share of the grains of a region that have too few contacts to carry", ProbeRow::rattlers},
      {"mechanical_coordination", "", "coordination of the grains that are no rattlers", ProbeRow::rattlers},
      {"contact_force_mean", "N", "mean normal force of the contacts between grains", ProbeRow::forces},
      {"contact_force_quantile", "N", "normal force that a share of the contacts stays below",
       ProbeRow::force_quantile},
      {"strong_contacts", "", "share of the contacts whose normal force is above the mean", ProbeRow::forces},
      {"stress", "Pa", "mean stress of the grains in a region (Love, Weber)", ProbeRow::stress},
      {"heap_angle", "rad", "angle of repose of a heap", ProbeRow::heap},
      {"passing", "", "mass share of the grains that passes a sieve", ProbeRow::sieve},
      {"grain_displacement", "m", "of one grain since the measuring started", ProbeRow::grain},
      {"kinetic_energy", "J", "of all grains", ProbeRow::none},
      {"broken_bonds", "", "number of bonds that have broken since the start", ProbeRow::none},
      {"grain_position", "m", "centre of one grain", ProbeRow::grain},
      {"grain_velocity", "m/s", "velocity of one grain", ProbeRow::grain},
      {"grain_angular_velocity", "rad/s", "angular velocity of one grain", ProbeRow::grain},
      {"wall_displacement", "m", "how far a rigid wall has come since the measuring started", ProbeRow::wall},
      {"wall_velocity", "m/s", "velocity of a rigid wall", ProbeRow::wall},
      {"sum", "", "offset + sum of factor x probe, in the probes' unit", ProbeRow::sum},
      {"quotient", "", "one probe over another; 0 while that one is 0", ProbeRow::pair},
      {"angle", "rad", "arc tangent of one probe over another", ProbeRow::pair},
      {"reaction", "N", "sum of the supports' forces on the nodes of a group of a body", ProbeRow::body_group},
      {"mode_frequency", "Hz", "frequency of an elastic mode of a body, of fem.solver = \"modal\"", ProbeRow::mode},
      {"body_stress", "Pa", "stress of a body, from the elements around", ProbeRow::body_stress},
      {"body_plastic_strain", "", "plastic strain of a body, from the elements around", ProbeRow::body_strain},
      {"time", "s", "time since the run began, for results taken at an instant", ProbeRow::clock}};
  return rows;
}

const std::vector<std::string>& stress_components() {
  static const std::vector<std::string> names{"xx", "yy",        "zz",          "xy",          "yz",
                                              "xz", "von_mises", "principal_1", "principal_2", "principal_3"};
  return names;
}

namespace {
Table probe_table(const ProbeRow& row) {
  Table table{row.name,
              row.meaning + std::string(*row.unit ? std::string(" [") + row.unit + "]" : ""),
              {base::name("name", "column of history.csv"), base::text("kind", "what is measured").among({row.name})}};
  auto& list = table.parameters;
  const auto component = base::text("component", "direction").among({"x", "y", "z"}).otherwise("z");
  switch (row.where) {
    case ProbeRow::body_motion:
      list.push_back(base::text("body", "name of the body"));
      list.push_back(base::text("group", "mean over the nodes of this physical group").optional("`point` instead"));
      list.push_back(base::vector("point", "m", "at the node nearest to this point").optional("`group` instead"));
      list.push_back(component);
      break;
    case ProbeRow::load:
      list.push_back(base::text("load", "name of the load"));
      break;
    case ProbeRow::contact:
    case ProbeRow::contact_area:
      list.push_back(base::text("body", "on the skin of this body").optional("`wall` instead"));
      list.push_back(base::text("wall", "on this wall").optional("`body` instead"));
      list.push_back(base::table("box", box_table(), "contact points in it count").optional("all contacts"));
      if (row.where == ProbeRow::contact_area) list.push_back(base::real("area", "m2", "divides the force").above(0));
      list.push_back(component);
      break;
    case ProbeRow::region:
    case ProbeRow::rattlers:
    case ProbeRow::forces:
    case ProbeRow::force_quantile:
    case ProbeRow::stress:
    case ProbeRow::heap:
    case ProbeRow::sieve:
      list = joined(list, grain_probe_parameters(row.where, box_table()));
      break;
    case ProbeRow::none:
    case ProbeRow::clock:
      break;
    case ProbeRow::grain:
      list.push_back(base::integer("grain", "number of the [[grain]], from 0").at_least(0).optional("`point` instead"));
      list.push_back(
          base::vector("point", "m", "the grain nearest to it when the measuring starts").optional("`grain` instead"));
      list.push_back(component);
      break;
    case ProbeRow::wall:
      list.push_back(base::text("wall", "name of the wall"));
      list.push_back(component);
      break;
    case ProbeRow::sum:
      list.push_back(base::texts("of", "names of probes that stand before this one"));
      list.push_back(base::reals("factors", "", "one per probe; with them units may differ").optional("all 1"));
      list.push_back(base::text("unit", "of the sum, where the probes' units differ").optional("the first probe's"));
      list.push_back(base::real("offset", "", "SI value added").otherwise(0.0));
      break;
    case ProbeRow::pair:
      list.push_back(base::texts("of", "names of two probes that stand before this one: over, under"));
      break;
    case ProbeRow::body_group:
      list.push_back(base::text("body", "name of the body"));
      list.push_back(base::text("group", "physical group of its mesh"));
      list.push_back(component);
      break;
    case ProbeRow::body_stress:
    case ProbeRow::body_strain:
      list.push_back(base::text("body", "name of the body"));
      list.push_back(base::text("group", "mean over the area of this physical surface").optional("`point` instead"));
      list.push_back(base::vector("point", "m", "at the node nearest to this point").optional("`group` instead"));
      if (row.where == ProbeRow::body_stress)
        list.push_back(base::text("component", "of the stress, over a group of its mean")
                           .among(stress_components())
                           .otherwise("von_mises"));
      break;
    case ProbeRow::mode:
      list.push_back(base::text("body", "name of the body"));
      list.push_back(base::integer("mode", "its number, 1: the lowest").at_least(1));
      break;
  }
  list.push_back(base::real("scale", "", "factor on the value").otherwise(1.0));
  return table;
}
}  // namespace

const Family& probe_family() {
  static const Family family = [] {
    Family all{"kind", "probes", {}};
    for (const auto& row : probe_rows()) all.rows.push_back(probe_table(row));
    return all;
  }();
  return family;
}

const Table& result_table() {
  static const Table table{
      "result",
      "a number drawn from a probe, over the time that is measured",
      {base::name("name", "in summary.json"), base::text("probe", "name of the probe"),
       base::text("take",
                  "first_peak: before the first fall through mid-range; rise: max - first; ratio: max|probe| / "
                  "max|over|; frequency: of the swing about its middle; decay: rate at which a swing dies away; at: "
                  "when `over` first reaches `level`")
           .among({"first", "last", "min", "max", "first_peak", "rise", "max_abs", "mean", "range", "frequency",
                   "decay", "ratio", "at"})
           .otherwise("last"),
       base::text("over", "probe to divide by (ratio), or that reaches the level (at)").optional("none"),
       base::quantity("level", "of `over`, for at").optional("none"),
       base::real("smoothed", "s", "width of a moving mean that is taken first; 0: none").at_least(0).otherwise(0.0),
       base::real("scale", "", "factor on the value").otherwise(1.0),
       base::text("unit", "in which it is shown").optional("SI unit of the probe"),
       base::quantity("expected", "value to compare with").optional("none"),
       base::quantities("expected_range", "lower and upper value to compare with").optional("none"),
       base::text("source", "where the expected value comes from").otherwise("")}};
  return table;
}

const Table& output_table() {
  static const Table table{
      "output",
      "what is written, how often",
      {base::real("interval", "s", "between pictures of the state; 0: only the last").at_least(0).otherwise(0.0),
       base::real("probe_interval", "s", "between rows of history.csv; 0: every window").at_least(0).otherwise(0.0),
       base::real("checkpoint_interval", "s", "simulated time between checkpoints; 0: none").at_least(0).otherwise(0.0),
       base::real("checkpoint_wall_time", "s",
                  "wall time between checkpoints, as found with rows of history.csv; 0: none")
           .at_least(0)
           .otherwise(0.0),
       base::boolean("contacts", "write contacts.pvd (force chains) and contact_forces.csv").otherwise(false),
       base::reals("sieves", "m", "of sieve_curve.csv, the grains as the run starts with them")
           .above(0)
           .optional("those of the packing's grading")}};
  return table;
}

const Table& scene_table() {
  static const Table table{"scene",
                           "the whole file; `include = \"other.toml\"` at its top merges it onto another scene",
                           {base::text("title", "one line").otherwise(""),
                            base::vector("gravity", "m/s2", "acceleration of free fall").otherwise(Vec3{0, 0, -9.81}),
                            base::table("time", time_table(), "steps").otherwise_empty(),
                            base::table("fem", fem_table(), "how the bodies are solved").optional("explicit"),
                            base::table("coupling", coupling_table(), "what passes between grains and bodies")
                                .optional("sequential, steps chosen"),
                            base::table("grains", grains_table(), "what all grains share").optional("no DEM"),
                            base::tables("grain", grain_table(), "grains one by one").otherwise_empty(),
                            base::tables("bond", bond_table(), "bonds one by one").otherwise_empty(),
                            base::table("packing", packing_table(), "how the bed is made").optional("only [[grain]]"),
                            base::tables("wall", wall_table(), "rigid walls").otherwise_empty(),
                            base::tables("body", body_table(), "deformable bodies").otherwise_empty(),
                            base::tables("stage", stage_table(), "what happens, in order").otherwise_empty(),
                            base::tables("probe", probe_family(), "columns of history.csv").otherwise_empty(),
                            base::tables("result", result_table(), "numbers of summary.json").otherwise_empty(),
                            base::tables("spectrum", spectrum_table(), "columns of spectra.csv").otherwise_empty(),
                            base::table("output", output_table(), "what is written").otherwise_empty()}};
  return table;
}

}  // namespace coupling
