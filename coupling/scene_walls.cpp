// How the walls of a scene move.
#include <fmt/format.h>

#include <algorithm>

#include "base/error.hpp"
#include "coupling/scene_parts.hpp"

namespace coupling {

using base::fail;
using base::Value;

namespace {

int stage_named(const Value& text, const Scene& scene) {
  std::vector<std::string> names;
  for (const auto& stage : scene.stages) names.push_back(stage.name);
  require_known(text, names, "stage", "stages");
  return static_cast<int>(std::find(names.begin(), names.end(), text.text()) - names.begin());
}

std::array<bool, 3> read_axes(const Value& list) {
  std::array<bool, 3> axes{};
  for (const auto& axis : list.texts()) axes[static_cast<std::size_t>(axis[0] - 'x')] = true;
  return axes;
}

WallBodyScene read_wall_body(const Value& table) {
  WallBodyScene body;
  body.is.mass = table.at("mass").real();
  body.is.moves = read_axes(table.at("moves"));
  body.is.turns = read_axes(table.at("turns"));
  body.is.weighs = table.at("weighs").boolean();
  body.is.damping = table.at("damping").real();
  if (const Value* centre = table.find("centre")) body.centre = centre->vector();
  if (const Value* inertia = table.find("inertia")) body.is.inertia = inertia->vector();
  for (int axis = 0; axis < 3; ++axis) {
    if (!body.is.turns[static_cast<std::size_t>(axis)] || body.is.inertia[axis] > 0) continue;
    fail(table.has("inertia") ? table.at("inertia") : table,
         fmt::format("a body that turns about {} needs a moment of inertia > 0 there", "xyz"[axis]),
         "give inertia = [Ixx, Iyy, Izz], or leave the axis out of turns");
  }
  return body;
}

WallLoad read_wall_load(const Value& row, const Scene& scene) {
  WallLoad load;
  load.direction = row.at("direction").vector();
  if (!(base::norm(load.direction) > 0)) fail(row.at("direction"), "must not be zero", "give a direction");
  if (const Value* area = row.find("area")) load.direction *= area->real();
  load.history = read_history(row.at("history"), scene);
  return load;
}

}  // namespace

void read_wall_motion(const Value& row, const Scene& scene, WallScene& wall) {
  wall.velocity = row.at("velocity").vector();
  for (const auto& motion : row.rows("motion"))
    wall.motions.push_back({stage_named(motion.at("stage"), scene), motion.at("velocity").vector()});
  wall.packing_only = row.at("packing_only").boolean();
  wall.run_only = row.at("run_only").boolean();
  if (wall.packing_only && wall.run_only)
    fail(row.at("run_only"), "stands beside packing_only", "set one of the two: such a wall would never be there");
  if (const Value* stage = row.find("removed_at")) wall.removed_at = stage_named(*stage, scene);
  const auto& loads = row.rows("load");
  if (const Value* body = row.find("body")) {
    if (row.has("plane")) fail(*body, "a plane cannot be a body: it has no end", "use a mesh");
    wall.body = read_wall_body(*body);
    for (const auto& load : loads) wall.body->loads.push_back(read_wall_load(load, scene));
  } else if (!loads.empty()) {
    fail(loads.front(), "only a wall that is a body takes loads", "add [wall.body], or remove the load");
  }
}

}  // namespace coupling
