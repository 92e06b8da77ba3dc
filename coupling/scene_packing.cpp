// Methods, target and regions of a scene's packing.
#include <fmt/format.h>

#include <algorithm>

#include "base/parameter.hpp"
#include "coupling/scene_parts.hpp"
#include "coupling/scene_tables.hpp"

namespace coupling {

using base::fail;
using base::Value;

void read_growth(Value& row, PackingLayer& layer) {
  if (row.at("method").text() != "growth") {
    if (row.has("growth"))
      fail(row.at("growth"), fmt::format("method = \"{}\" grows no grains", row.at("method").text()),
           "remove it, or choose method = \"growth\"");
    return;
  }
  if (!row.has("growth")) {
    Value& empty = row.set("growth", Value::Table{});
    empty = base::check(empty, growth_table());
  }
  const Value& table = row.at("growth");
  layer.growth = {.start = table.at("start").real(),
                  .overlap = table.at("overlap").real(),
                  .damping = table.at("damping").real(),
                  .gravity_factor = table.at("gravity_factor").real(),
                  .lowering = table.at("lowering").real()};
}

void read_vibration(const Value& row, PackingLayer& layer) {
  const Value* table = row.find("vibration");
  if (!table) return;
  const Vec3 direction = table->at("direction").vector();
  const double length = norm(direction);
  if (!(length > 0)) fail(table->at("direction"), "must not be zero", "give the direction of the motion");
  layer.vibration = {.amplitude = table->at("amplitude").real(),
                     .frequency = table->at("frequency").real(),
                     .time = table->at("time").real(),
                     .direction = direction * (1 / length),
                     .origin = table->at("frequency").origin()};
}

void read_target(const Value& table, Packing& packing) {
  if (const Value* tolerance = table.find("tolerance")) packing.tolerance = tolerance->real();
  packing.tries = static_cast<int>(table.at("tries").integer());
  if (packing.tries > 1 && !packing.tolerance)
    fail(table.at("tries"), "nothing says when a bed is good enough", "give packing.tolerance, or remove it");
}

namespace {

/// Box of a region; throws when no layer has a part of it.
Box reached_box(const Value& row, const Packing& packing) {
  const Box box = read_box(row.at("box"));
  const auto meets = [&](const PackingLayer& layer) {
    for (int axis = 0; axis < 3; ++axis)
      if (box.lower[axis] >= layer.box.upper[axis] || box.upper[axis] <= layer.box.lower[axis]) return false;
    return true;
  };
  if (std::none_of(packing.layers.begin(), packing.layers.end(), meets))
    fail(row.at("box"),
         fmt::format("from ({:g}, {:g}, {:g}) to ({:g}, {:g}, {:g}) m it lies outside every packing.layer.box",
                     box.lower.x, box.lower.y, box.lower.z, box.upper.x, box.upper.y, box.upper.z),
         "move it into the bed");
  return box;
}

}  // namespace

void read_regions(const Value& table, Packing& packing) {
  for (const auto& row : table.at("loosen").list()) {
    LooseRegion region{.box = reached_box(row, packing), .friction = {}, .share = 0, .origin = row.origin()};
    if (const Value* friction = row.find("friction")) region.friction = friction->real();
    if (const Value* share = row.find("share")) region.share = share->real();
    if (!row.has("friction") && !row.has("share"))
      fail(row, "nothing loosens it", "give share (of the grains to take out), or a friction above packing.friction");
    if (region.friction && *region.friction <= packing.friction)
      fail(row.at("friction"), fmt::format("loosens nothing: packing.friction is {}", packing.friction),
           "give a larger one, or share instead");
    packing.loosened.push_back(region);
  }
  for (const auto& row : table.at("erode").list()) {
    ErodedRegion region{.box = reached_box(row, packing), .above = {}, .settle = 1, .origin = row.origin()};
    if (const Value* plane = row.find("above")) region.above = read_plane(*plane);
    region.settle = row.at("settle").real();
    packing.eroded.push_back(region);
  }
}

}  // namespace coupling
