// Stages and deformable bodies of a scene.
#include <fmt/format.h>

#include "base/histories.hpp"
#include "base/text.hpp"
#include "coupling/scene_parts.hpp"

namespace coupling {

using base::fail;
using base::Value;

void build_stages(Value& root, Scene& scene) {
  auto& rows = root.at("stage").list();
  if (scene.is_modal()) return;
  if (rows.empty()) fail(root, "\"stage\" is missing", "add stage: what happens, in order");
  require_unique(rows, "stage");
  const auto body_names = names_of(root.rows("body"));
  const Value* measured = nullptr;
  for (const auto& row : rows) {
    Stage stage;
    stage.name = row.at("name").text();
    stage.duration = row.at("duration").real();
    stage.grain_damping = row.at("grain_damping").real();
    stage.body_damping = read_numbers(row.at("body_damping"));
    for (const auto& [name, value] : row.at("body_damping").table()) {
      bool known = false;
      for (const auto& body : body_names) known = known || body == name;
      if (!known) fail(value, "no such body", base::suggest(name, body_names, "bodies"));
    }
    stage.hold = row.at("hold").texts();
    for (const auto& body : row.at("hold").list()) require_known(body, body_names, "body", "bodies");
    if (!scene.is_explicit() && !stage.hold.empty())
      fail(row.at("hold"), "only fem.solver = \"explicit\" holds bodies in place", "remove it, or support the body");
    stage.ramp_stiffness = row.at("ramp_stiffness").boolean();
    if (stage.ramp_stiffness && !root.has("packing")) {
      fail(row.at("ramp_stiffness"), "there is no packing whose modulus could be ramped",
           "remove it, or add [packing]");
    }
    stage.packing_friction = row.at("packing_friction").boolean();
    if (stage.packing_friction && !root.has("packing")) {
      fail(row.at("packing_friction"), "there is no packing whose friction could be kept",
           "remove it, or add [packing]");
    }
    if (stage.grain_damping > 0 && !root.has("grains")) {
      fail(row.at("grain_damping"), "there are no grains to damp", "remove it, or add [grains]");
    }
    stage.measure = row.at("measure").boolean();
    if (stage.measure && measured) {
      fail(row.at("measure"), "the measuring starts already at " + measured->origin(), "set measure in one stage only");
    }
    if (stage.measure) measured = &row.at("measure");
    stage.origin = row.origin();
    scene.stages.push_back(std::move(stage));
  }
  if (!measured) {
    scene.stages.front().measure = true;
    rows.front().set("measure", true);
  }
}

namespace {

/// Simulated time [s] at which the time of a checked history is zero.
double history_zero(const Value& history, const Scene& scene) {
  const Value* wanted = history.find("start_stage");
  if (!wanted) return 0;
  double time = 0;
  std::vector<std::string> names;
  for (const auto& stage : scene.stages) {
    if (stage.name == wanted->text()) return time;
    time += stage.duration;
    names.push_back(stage.name);
  }
  require_known(*wanted, names, "stage", "stages");
  return time;
}

}  // namespace

base::HistoryPtr read_history(const Value& checked, const Scene& scene) {
  const double zero = history_zero(checked, scene);
  double end = 0;
  for (const auto& stage : scene.stages) end += stage.duration;
  base::require_bounded(checked, zero, end);
  return base::make_history(checked, zero);
}

namespace {

fem::Load read_load(const Value& row, const Scene& scene) {
  fem::Load load;
  load.name = row.at("name").text();
  load.group = row.at("group").text();
  const std::string& kind = row.at("kind").text();
  load.kind = kind == "pressure"      ? fem::LoadKind::pressure
              : kind == "traction"    ? fem::LoadKind::traction
              : kind == "nodal_total" ? fem::LoadKind::nodal_total
                                      : fem::LoadKind::face_total;
  if (load.kind != fem::LoadKind::pressure) {
    load.direction = row.at("direction").vector();
    if (!(base::norm(load.direction) > 0)) fail(row.at("direction"), "must not be zero", "give a direction");
  }
  load.history = read_history(row.at("history"), scene);
  load.origin = row.origin();
  return load;
}

fem::PrescribedMotion read_motion(const Value& row, const Scene& scene) {
  fem::PrescribedMotion motion;
  motion.name = row.at("name").text();
  motion.group = row.at("group").text();
  motion.kind = row.at("kind").text() == "velocity" ? fem::PrescribedMotion::Kind::velocity
                                                    : fem::PrescribedMotion::Kind::displacement;
  if (row.at("along").list().empty()) fail(row.at("along"), "leads nowhere", "give some of \"x\", \"y\", \"z\"");
  for (const auto& axis : row.at("along").texts()) motion.along[static_cast<std::size_t>(axis[0] - 'x')] = true;
  motion.history = read_history(row.at("history"), scene);
  motion.origin = row.origin();
  return motion;
}

fem::MaterialRegion read_material(const Value& row) {
  fem::MaterialRegion region;
  region.group = row.at("group").text();
  region.law = row.at("law").text();
  region.young_modulus = row.at("young_modulus").real();
  region.poisson_ratio = row.at("poisson_ratio").real();
  region.density = row.at("density").real();
  const auto number = [&](const char* key, double& value) {
    if (const Value* given = row.find(key)) value = given->real();
  };
  number("shear_viscosity", region.shear_viscosity);
  number("bulk_viscosity", region.bulk_viscosity);
  number("cohesion", region.cohesion);
  number("friction_angle", region.friction_angle);
  number("dilation_angle", region.dilation_angle);
  if (const Value* fit = row.find("fit")) region.fit = fit->text();
  region.origin = row.origin();
  return region;
}

fem::Support read_support(const Value& row) {
  fem::Support support;
  support.group = row.at("group").text();
  if (row.at("fix").list().empty()) fail(row.at("fix"), "fixes nothing", "give some of \"x\", \"y\", \"z\"");
  for (const auto& axis : row.at("fix").texts()) support.fixed[static_cast<std::size_t>(axis[0] - 'x')] = true;
  support.origin = row.origin();
  return support;
}

fem::Body read_body(const Value& row, const Scene& scene) {
  fem::Body body;
  body.name = row.at("name").text();
  body.mesh_file = row.at("mesh").text();
  require_mesh_parameters(row);
  body.mesh_parameters = read_numbers(row.at("mesh_parameters"));
  body.element = row.at("element").text();
  body.translation = row.at("translation").vector();
  body.gravity = row.at("gravity").boolean();
  body.damping = row.at("damping").real();
  body.stiffness_damping = row.at("stiffness_damping").real();
  body.skin = row.at("skin").texts();
  body.origin = row.origin();
  const auto& materials = row.at("material").list();
  if (materials.empty()) fail(row.at("material"), "a body needs a material", "add [[body.material]]");
  std::map<std::string, std::string> groups;
  for (const auto& material : materials) {
    body.materials.push_back(read_material(material));
    const auto [known, added] = groups.emplace(body.materials.back().group, material.origin());
    if (!added) {
      fail(material.at("group"), "the group has a material at " + known->second,
           "give each physical volume one material");
    }
  }
  if (materials.size() > 1 && groups.count("")) {
    fail(row.at("material"), "a material without a group fills the whole body", "give every material its group");
  }
  for (const auto& support : row.at("support").list()) body.supports.push_back(read_support(support));
  for (const auto& motion : row.at("motion").list()) body.motions.push_back(read_motion(motion, scene));
  for (const auto& absorbing : row.at("absorbing").list())
    body.absorbing.push_back({absorbing.at("group").text(), absorbing.origin()});
  for (const auto& faces : row.at("periodic").list())
    body.periodic.push_back({faces.at("first").text(), faces.at("second").text(), faces.origin()});
  for (const auto& load : row.at("load").list()) body.loads.push_back(read_load(load, scene));
  return body;
}

}  // namespace

void build_bodies(Value& root, Scene& scene) {
  const auto& rows = root.rows("body");
  require_unique(rows, "body");
  Value::List loads;
  for (const auto& row : rows) {
    scene.bodies.push_back(read_body(row, scene));
    loads.insert(loads.end(), row.at("motion").list().begin(), row.at("motion").list().end());
    loads.insert(loads.end(), row.at("load").list().begin(), row.at("load").list().end());
  }
  require_unique(loads, "load");
}

}  // namespace coupling
