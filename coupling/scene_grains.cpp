// Grains, walls, packing and the contact of skins of a scene.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "coupling/scene_parts.hpp"
#include "dem/grading.hpp"

namespace coupling {

using base::fail;
using base::Value;

namespace {

int add_material(GrainsScene& grains, dem::Material material, const dem::Interaction& with_grains) {
  grains.materials.push_back(std::move(material));
  const std::size_t n = grains.materials.size();
  std::vector<dem::Interaction> larger(n * n);
  for (std::size_t i = 0; i + 1 < n; ++i) {
    for (std::size_t j = 0; j + 1 < n; ++j) larger[i * n + j] = grains.interactions[i * (n - 1) + j];
  }
  larger[n - 1] = larger[(n - 1) * n] = with_grains;
  grains.interactions = std::move(larger);
  return static_cast<int>(n - 1);
}

WallScene read_wall(Value& row, const Value& grains_table, const Scene& scene, GrainsScene& grains) {
  WallScene wall;
  wall.name = row.at("name").text();
  if (row.has("plane") == row.has("mesh")) {
    fail(row, row.has("plane") ? "has both a plane and a mesh" : "has neither plane nor mesh", "give one of the two");
  }
  if (row.has("plane")) {
    wall.plane = read_plane(row.at("plane"));
    if (!row.at("mesh_parameters").table().empty()) fail(row.at("mesh_parameters"), "a plane has none", "remove it");
    if (row.at("two_sided").boolean()) fail(row.at("two_sided"), "a plane has one side", "use a mesh, or two planes");
    if (base::norm(row.at("translation").vector()) > 0)
      fail(row.at("translation"), "a plane has its point", "change plane.point");
  } else {
    require_mesh_parameters(row);
    wall.mesh = row.at("mesh").text();
  }
  wall.mesh_parameters = read_numbers(row.at("mesh_parameters"));
  wall.translation = row.at("translation").vector();
  const dem::Interaction contact = read_contact(row, &grains_table);
  if (row.has("material")) refuse_elastic_constants(row.at("material"), contact);
  dem::Material elastic{wall.name, grains.materials[0].young_modulus, grains.materials[0].poisson_ratio, 0};
  if (row.has("material")) {
    elastic.young_modulus = row.at("material").at("young_modulus").real();
    elastic.poisson_ratio = row.at("material").at("poisson_ratio").real();
  } else if (reads_elastic_constants(contact)) {
    Value& material = row.set("material", Value::Table{});
    material.set("young_modulus", elastic.young_modulus);
    material.set("poisson_ratio", elastic.poisson_ratio);
  }
  wall.material = add_material(grains, std::move(elastic), contact);
  read_wall_motion(row, scene, wall);
  wall.two_sided = row.at("two_sided").boolean();
  wall.origin = row.origin();
  return wall;
}

void read_shapes(const Value& table, GrainsScene& grains) {
  require_unique(table.rows("shape"), "shape");
  for (const auto& row : table.rows("shape")) {
    try {
      grains.shapes.push_back(read_shape(row.at("name").text(), row.at("file").text()));
    } catch (const base::UserError& error) {
      fail(row.at("file"), fmt::format("no shape: {}", error.what()));
    }
  }
}

/// Number of the shape that this text names; shapes turn, so that rotations must be on.
int shape_named(const Value& text, const Value& grains_table) {
  const auto names = names_of(grains_table.rows("shape"));
  require_known(text, names, "shape", "shapes");
  if (!grains_table.at("rotations").boolean())
    fail(grains_table.at("rotations"), fmt::format("grains of shape \"{}\" turn", text.text()), "remove it");
  return static_cast<int>(std::find(names.begin(), names.end(), text.text()) - names.begin());
}

dem::Grain read_grain(Value& row, const Value& grains_table, const GrainsScene& grains) {
  if (row.has("radius") == row.has("shape"))
    fail(row, row.has("radius") ? "has both a radius and a shape" : "has neither radius nor shape",
         "give radius for a sphere, shape (and size) for another grain");
  dem::Grain grain;
  if (row.has("shape")) {
    const int shape = shape_named(row.at("shape"), grains_table);
    if (!row.has("size")) row.set("size", grains.shapes[static_cast<std::size_t>(shape)].sieve);
    const Vec3 turn = row.has("orientation") ? row.at("orientation").vector() : Vec3{};
    grain = shaped_grain(grains.shapes, shape, row.at("size").real(), dem::kernels::turn_by(turn));
  } else {
    for (const char* name : {"size", "orientation"})
      if (row.has(name)) fail(row.at(name), "a sphere has none", "remove it, or give a shape instead of the radius");
    grain.radius = row.at("radius").real();
  }
  grain.velocity = row.at("velocity").vector();
  grain.angular_velocity = row.at("angular_velocity").vector();
  return grain;
}

/// Where the grains of a row lie: at its position, or on a grid from there, x first.
std::vector<Vec3> read_places(const Value& row) {
  const Vec3 first = row.at("position").vector(), number = row.at("repeat").vector();
  const Vec3 spacing = row.at("spacing").vector();
  for (int axis = 0; axis < 3; ++axis) {
    if (!(number[axis] >= 1 && number[axis] <= 1e6) || number[axis] != std::floor(number[axis]))
      fail(row.at("repeat"), "is no number of grains", "give whole numbers from 1 on for x, y, z");
    if ((number[axis] > 1) != (spacing[axis] != 0))
      fail(row.at("repeat"), fmt::format("and spacing do not fit along {}", "xyz"[axis]),
           "give a spacing where there is more than one grain, and 0 elsewhere");
  }
  std::vector<Vec3> places;
  for (int k = 0; k < number.z; ++k)
    for (int j = 0; j < number.y; ++j)
      for (int i = 0; i < number.x; ++i) places.push_back(first + Vec3{i * spacing.x, j * spacing.y, k * spacing.z});
  return places;
}

void read_packed_shapes(Value& table, const Value& grains_table, Packing& packing) {
  for (const auto& name : table.at("shapes").list()) packing.shapes.push_back(shape_named(name, grains_table));
  packing.shape_shares.assign(packing.shapes.size(), 1.0);
  if (const Value* shares = table.find("shape_shares")) {
    if (shares->list().size() != packing.shapes.size())
      fail(*shares, fmt::format("{} shares for {} shapes", shares->list().size(), packing.shapes.size()),
           "give one for every name in shapes");
    packing.shape_shares = shares->reals();
  }
  double sum = 0;
  for (const double share : packing.shape_shares) sum += share;
  for (double& share : packing.shape_shares) share /= sum;
}

/// A grading by its name becomes the pairs that it stands for.
void resolve_grading(Value& value) {
  if (!value.is<std::string>()) return;
  const auto& known = dem::named_gradings();
  const auto named =
      std::find_if(known.begin(), known.end(), [&](const auto& row) { return row.name == value.text(); });
  Value::List pairs;
  for (const auto& [size, passing] : named->curve) pairs.emplace_back(Value::List{Value(size), Value(passing)});
  value.data = std::move(pairs);
}

std::vector<GradingRow> read_grading(const Value& value) {
  std::vector<GradingRow> rows;
  for (const auto& pair : value.list()) {
    rows.push_back({pair.list()[0].real(), pair.list()[1].real()});
    const GradingRow& row = rows.back();
    if (!(row.size > 0)) fail(pair, "a sieve size must be > 0 m");
    if (rows.size() == 1) continue;
    const GradingRow& before = rows[rows.size() - 2];
    if (!(row.size > before.size)) fail(pair, fmt::format("sizes must rise: {} m follows {} m", row.size, before.size));
    if (row.passing < before.passing) {
      fail(pair, fmt::format("the share passing must not fall: {} follows {}", row.passing, before.passing));
    }
  }
  if (rows.size() < 2) fail(value, "needs two sieves or more");
  if (rows.back().passing != 1) fail(value, "all grains must pass the largest sieve", "end with a share of 1");
  return rows;
}

PackingLayer read_layer(Value& row, const Value& root) {
  PackingLayer layer;
  layer.box = read_box(row.at("box"));
  layer.overfill = row.at("overfill").real();
  layer.plate = row.at("plate").boolean();
  layer.bodies = row.at("bodies").texts();
  std::vector<std::string> known = names_of(root.rows("body"));
  for (const auto& wall : root.rows("wall"))
    if (wall.has("mesh") && !wall.at("run_only").boolean()) known.push_back(wall.at("name").text());
  for (const auto& name : row.at("bodies").list()) {
    require_known(name, known, "body", "bodies and mesh walls");
    for (const auto& body : root.rows("body")) {
      if (body.at("name").text() == name.text() && body.at("skin").list().empty()) {
        fail(name, "the body has no skin that grains could touch", "give it skin = [...], or leave it out");
      }
    }
  }
  layer.settle = row.at("settle").real();
  read_growth(row, layer);
  read_vibration(row, layer);
  layer.origin = row.origin();
  return layer;
}

Packing read_packing(Value& table, const Value& root, const dem::Interaction& contact) {
  const Value& grains = root.at("grains");
  if (const Value* softened = table.find("young_modulus")) refuse_elastic_constants(*softened, contact);
  if (const Value* rolling = table.find("rolling_friction"); rolling && !grains.has("rolling_friction"))
    fail(*rolling, fmt::format("grains.rolling = \"{}\" has no rolling friction", contact.rolling), "remove it");
  for (const char* name : {"friction", "rolling_friction"}) {
    if (!table.has(name) && grains.has(name)) table.set(name, grains.at(name).data);
  }
  const Value& modulus = grains.at("material").at("young_modulus");
  if (!table.has("young_modulus") && reads_elastic_constants(contact)) table.set("young_modulus", modulus.data);
  Packing packing;
  resolve_grading(table.at("grading"));
  packing.grading = read_grading(table.at("grading"));
  read_packed_shapes(table, grains, packing);
  packing.seed = static_cast<std::uint64_t>(table.at("seed").integer());
  packing.young_modulus = (table.has("young_modulus") ? table.at("young_modulus") : modulus).real();
  packing.friction = table.at("friction").real();
  if (table.has("rolling_friction")) packing.rolling_friction = table.at("rolling_friction").real();
  packing.target_porosity = table.at("target_porosity").real();
  packing.grain_damping = table.at("grain_damping").real();
  packing.plate_speed = table.at("plate_speed").real();
  if (table.at("layer").list().empty()) fail(table.at("layer"), "a packing needs a layer", "add [[packing.layer]]");
  for (auto& row : table.at("layer").list()) packing.layers.push_back(read_layer(row, root));
  read_target(table, packing);
  read_regions(table, packing);
  for (const auto& cut : table.at("cuts").list()) packing.cuts.push_back(read_plane(cut));
  packing.use_cache = table.at("cache").boolean();
  packing.origin = table.origin();
  return packing;
}

void build_contact(Value& body, const Value& grains_table, GrainsScene& grains) {
  if (body.at("skin").list().empty()) {
    if (const Value* contact = body.find("contact")) {
      fail(*contact, "the body has no skin that grains could touch", "give it skin = [...], or remove this table");
    }
    return;
  }
  if (!body.has("contact")) body.set("contact", Value::Table{});
  Value& contact = body.at("contact");
  const Value& material = body.at("material").list().front();
  const dem::Interaction interaction = read_contact(contact, &grains_table);
  for (const char* name : {"young_modulus", "poisson_ratio"}) {
    if (const Value* stated = contact.find(name))
      refuse_elastic_constants(*stated, interaction);
    else if (reads_elastic_constants(interaction))
      contact.set(name, material.at(name).data);
  }
  const auto constant = [&](const char* name) { return (contact.has(name) ? contact : material).at(name).real(); };
  const std::string& name = body.at("name").text();
  grains.body_material[name] =
      add_material(grains, {name, constant("young_modulus"), constant("poisson_ratio"), 0}, interaction);
}

void read_periods(const Value& table, GrainsScene& grains) {
  for (const auto& row : table.rows("periodic")) {
    const std::string& axis = row.at("axis").text();
    dem::Period& along = grains.periods[static_cast<std::size_t>(axis[0] - 'x')];
    if (along.length > 0) fail(row.at("axis"), axis + " is periodic already", "remove one of the two");
    along.lower = row.at("lower").real();
    along.length = row.at("upper").real() - along.lower;
    if (!(along.length > 0)) fail(row.at("upper"), "does not lie above lower", "swap the two");
  }
}

/// Walls and the packing must leave periodic directions open.
void check_periods(const Value& root, const GrainsScene& grains) {
  const auto& walls = root.at("wall").list();
  for (std::size_t w = 0; w < walls.size(); ++w) {
    if (!grains.walls[w].plane) continue;
    if (const auto axis = cuts_period(*grains.walls[w].plane, grains.periods))
      fail(walls[w].at("plane"), fmt::format("cuts the direction {}, which is periodic", "xyz"[*axis]),
           "remove the wall, or the [[grains.periodic]] of this axis");
  }
  if (!grains.packing) return;
  const auto& layers = root.at("packing").at("layer").list();
  for (std::size_t k = 0; k < layers.size(); ++k) {
    const Box& box = grains.packing->layers[k].box;
    for (int axis = 0; axis < 3; ++axis) {
      const dem::Period& along = grains.periods[static_cast<std::size_t>(axis)];
      const double slack = 1e-9 * along.length;
      if (along.length > 0 &&
          (box.lower[axis] < along.lower - slack || box.upper[axis] > along.lower + along.length + slack))
        fail(layers[k].at("box"),
             fmt::format("reaches beyond the periodic faces {} = {:g} m and {:g} m", "xyz"[axis], along.lower,
                         along.lower + along.length),
             "end the box at the faces");
    }
  }
}

}  // namespace

void build_grains(Value& root, Scene& scene) {
  auto& singles = root.at("grain").list();
  auto& walls = root.at("wall").list();
  if (!root.has("grains")) {
    const Value* orphan = root.find("packing");
    if (!orphan && !singles.empty()) orphan = &singles.front();
    if (!orphan && !walls.empty()) orphan = &walls.front();
    if (orphan) fail(*orphan, "there are no [grains] that it could belong to", "add [grains], or remove it");
    return;
  }
  Value& table = root.at("grains");
  if (singles.empty() && !root.has("packing")) {
    fail(table, "there are no grains", "add [packing] or [[grain]], or remove [grains]");
  }
  GrainsScene grains;
  const Value& material = table.at("material");
  grains.materials.push_back({material.at("name").text(), material.at("young_modulus").real(),
                              material.at("poisson_ratio").real(), material.at("density").real()});
  grains.interactions.push_back(read_contact(table, nullptr));
  const dem::Interaction contact = grains.interactions.front();
  for (const auto& stage_row : root.rows("stage"))
    if (stage_row.at("ramp_stiffness").boolean()) refuse_elastic_constants(stage_row.at("ramp_stiffness"), contact);
  grains.neighbour_skin = table.at("neighbour_skin").real();
  grains.maximum_overlap = table.at("maximum_overlap").real();
  grains.rotations = table.at("rotations").boolean();
  const std::string& scheme = table.at("rotation_scheme").text();
  if (scheme == "runge_kutta") grains.rotation_scheme = dem::kernels::RotationScheme::runge_kutta;
  if (scheme == "direct") grains.rotation_scheme = dem::kernels::RotationScheme::direct;
  if (table.at("precision").text() == "mixed") grains.precision = dem::Precision::mixed;
  read_periods(table, grains);
  read_shapes(table, grains);
  for (auto& row : singles) {
    dem::Grain grain = read_grain(row, table, grains);
    for (const Vec3& place : read_places(row)) {
      grain.position = place;
      grain.id = static_cast<std::int64_t>(grains.list.size());
      grains.list.push_back(grain);
    }
  }
  require_unique(walls, "wall");
  for (auto& row : walls) grains.walls.push_back(read_wall(row, table, scene, grains));
  for (auto& row : root.at("body").list()) build_contact(row, table, grains);
  if (root.has("packing")) grains.packing = read_packing(root.at("packing"), root, contact);
  check_periods(root, grains);
  scene.grains = std::move(grains);
}

}  // namespace coupling
