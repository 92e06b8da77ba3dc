// Probes and results of a scene.
#include <fmt/format.h>

#include <algorithm>

#include "base/quantity.hpp"
#include "base/text.hpp"
#include "coupling/grain_probes.hpp"
#include "coupling/scene_parts.hpp"
#include "coupling/scene_tables.hpp"

namespace coupling {

using base::fail;
using base::Value;

namespace {

/// Exactly one of two keys.
void require_one(const Value& row, const char* a, const char* b) {
  if (row.has(a) && row.has(b)) fail(row.at(b), fmt::format("stands beside {}", a), "give one of the two");
  if (!row.has(a) && !row.has(b)) {
    fail(row, fmt::format("\"{}\" or \"{}\" is missing", a, b), fmt::format("add {} or {}", a, b));
  }
}

void require_body(const Value& name, const Scene& scene, bool with_skin) {
  std::vector<std::string> names;
  for (const auto& body : scene.bodies) names.push_back(body.name);
  require_known(name, names, "body", "bodies");
  for (const auto& body : scene.bodies) {
    if (with_skin && body.name == name.text() && body.skin.empty()) {
      fail(name, "the body has no skin that grains could touch", "give it skin = [...]");
    }
  }
}

void read_load_name(const Value& name, const Scene& scene, Probe& probe) {
  std::vector<std::string> names;
  for (const auto& body : scene.bodies) {
    for (const auto& load : body.loads) {
      names.push_back(load.name);
      if (load.name == name.text() && (load.kind == fem::LoadKind::traction || load.kind == fem::LoadKind::pressure))
        probe.unit = "Pa";
    }
    for (const auto& motion : body.motions) {
      names.push_back(motion.name);
      if (motion.name == name.text()) probe.unit = motion.kind == fem::PrescribedMotion::Kind::velocity ? "m/s" : "m";
    }
  }
  require_known(name, names, "load", "loads");
  probe.load = name.text();
}

void read_wall_name(const Value& name, const Scene& scene, Probe& probe) {
  std::vector<std::string> names;
  for (const auto& wall : scene.grains->walls) names.push_back(wall.name);
  require_known(name, names, "wall", "walls");
  for (const auto& wall : scene.grains->walls) {
    if (wall.name == name.text() && wall.packing_only) {
      fail(name, "the wall is there only while packing", "choose another wall");
    }
  }
  probe.wall = name.text();
}

void read_grain_number(const Value& number, const Scene& scene, Probe& probe) {
  const auto listed = static_cast<std::int64_t>(scene.grains->list.size());
  if (number.integer() >= listed) {
    fail(number, fmt::format("there are {} grains given by [[grain]]", listed), "numbers start from 0");
  }
  probe.grain = number.integer();
}

/// A probe of other probes: their indices, factors and unit.
void read_combination(const Value& row, const Scene& scene, Probe& probe) {
  std::vector<std::string> before;
  for (const auto& other : scene.probes) before.push_back(other.name);
  for (const auto& name : row.at("of").list()) {
    require_known(name, before, "probe before this one", "probes before this one");
    probe.of.push_back(static_cast<std::size_t>(std::find(before.begin(), before.end(), name.text()) - before.begin()));
  }
  const auto unit = [&](std::size_t k) { return scene.probes[probe.of[k]].unit; };
  if (probe.kind != ProbeKind::sum) {
    if (probe.of.size() != 2) fail(row.at("of"), "must name two probes", "the one above the line, then the one below");
    if (probe.kind == ProbeKind::quotient && unit(0) != unit(1))
      probe.unit = unit(1).empty() ? unit(0) : fmt::format("{}/{}", unit(0).empty() ? "1" : unit(0), unit(1));
    if (probe.kind == ProbeKind::angle && unit(0) != unit(1))
      fail(row.at("of"), fmt::format("units {} and {} make no angle", unit(0), unit(1)), "name probes of one unit");
    return;
  }
  if (probe.of.empty()) fail(row.at("of"), "names no probe", "name one or more");
  probe.factors.assign(probe.of.size(), 1.0);
  if (const Value* factors = row.find("factors")) probe.factors = factors->reals();
  if (probe.factors.size() != probe.of.size())
    fail(row.at("factors"), fmt::format("{} factors for {} probes", probe.factors.size(), probe.of.size()),
         "give one for every probe");
  probe.offset = row.at("offset").real();
  probe.unit = row.has("unit") ? row.at("unit").text() : unit(0);
  for (std::size_t k = 1; k < probe.of.size(); ++k)
    if (!row.has("unit") && unit(k) != unit(0))
      fail(row.at("of"), fmt::format("adds {} to {}", unit(k), unit(0)), "name probes of one unit, or give unit");
  try {
    if (base::parse_unit(probe.unit).to_si(1) != 1)
      fail(row.at("unit"), "must be an SI unit: probes have SI values", "for example N instead of kN");
  } catch (const base::QuantityError& error) {
    fail(row.at("unit"), error.rule, error.remedy);
  }
}

Probe read_probe(const Value& row, const Scene& scene) {
  Probe probe;
  probe.name = row.at("name").text();
  const auto& kinds = probe_rows();
  std::size_t kind = 0;
  while (kinds[kind].name != row.at("kind").text()) ++kind;
  probe.kind = static_cast<ProbeKind>(kind);
  probe.unit = kinds[kind].unit;
  probe.scale = row.at("scale").real();
  probe.origin = row.origin();
  const auto where = kinds[kind].where;
  const bool combined = where == ProbeRow::sum || where == ProbeRow::pair;
  if (combined) read_combination(row, scene, probe);
  const bool of_mode = where == ProbeRow::mode;
  const bool at_spot =
      where == ProbeRow::body_motion || where == ProbeRow::body_stress || where == ProbeRow::body_strain;
  const bool of_body = at_spot || where == ProbeRow::body_group || of_mode;
  const bool of_grains = !of_body && where != ProbeRow::load && where != ProbeRow::clock && !combined;
  if (of_mode != scene.is_modal() && !combined)
    fail(row.at("kind"),
         of_mode ? "only fem.solver = \"modal\" finds modes" : "fem.solver = \"modal\" goes through no time",
         of_mode ? "remove the probe, or choose that solver" : "use kind = \"mode_frequency\"");
  if (of_grains && !scene.has_grains()) fail(row.at("kind"), "there are no grains to measure", "remove the probe");
  if (probe.kind == ProbeKind::broken_bonds && !scene.grains->bonding.any())
    fail(row.at("kind"), "no grains are bonded", "add [grains.bond] or [[bond]], or remove the probe");
  if (at_spot) require_one(row, "group", "point");
  if (where == ProbeRow::contact || where == ProbeRow::contact_area) require_one(row, "body", "wall");
  if (const Value* body = row.find("body")) {
    require_body(*body, scene, !of_body);
    probe.body = body->text();
  }
  if (const Value* group = row.find("group")) probe.group = group->text();
  if (const Value* point = row.find("point")) probe.point = point->vector();
  if (const Value* box = row.find("box")) probe.box = read_box(*box);
  if (const Value* area = row.find("area")) probe.area = area->real();
  if (const Value* load = row.find("load")) read_load_name(*load, scene, probe);
  if (const Value* wall = row.find("wall")) read_wall_name(*wall, scene, probe);
  const Value* component = row.find("component");
  if (component && where == ProbeRow::body_stress) {
    const auto& names = stress_components();
    probe.component = static_cast<int>(std::find(names.begin(), names.end(), component->text()) - names.begin());
  } else if (component && where != ProbeRow::stress) {
    probe.component = component->text()[0] - 'x';
  }
  if (const Value* mode = row.find("mode")) {
    probe.mode = static_cast<int>(mode->integer());
    if (probe.mode > scene.modes)
      fail(*mode, fmt::format("fem.modes = {}", scene.modes), "ask for more modes, or for a lower one");
  }
  if (const Value* grain = row.find("grain")) read_grain_number(*grain, scene, probe);
  if (where == ProbeRow::grain) require_one(row, "grain", "point");
  if (measures_grains(probe.kind)) probe.look = read_grain_probe(row, where);
  return probe;
}

std::string unit_of(const Scene& scene, const std::string& probe_name) {
  for (const auto& probe : scene.probes) {
    if (probe.name == probe_name) return probe.unit;
  }
  return "";
}

/// SI unit of the result's value.
std::string value_unit(const Value& row, const Scene& scene) {
  const std::string& take = row.at("take").text();
  const std::string unit = unit_of(scene, row.at("probe").text());
  if (take == "frequency") return "Hz";
  if (take == "decay") return "1/s";
  if (take != "ratio") return unit;
  const std::string over = unit_of(scene, row.at("over").text());
  if (unit == over) return "";
  return over.empty() ? unit : (unit.empty() ? "1" : unit) + "/" + over;
}

/// The unit the result is shown in; throws when it does not fit the value.
std::string shown_unit(Value& row, const std::string& si) {
  const Value* given = row.find("unit");
  if (!given) {
    row.set("unit", si);
    return si;
  }
  try {
    const auto dimension = base::parse_unit(given->text()).dimension, wanted = base::parse_unit(si).dimension;
    if (!(dimension == wanted)) {
      fail(*given, fmt::format("is {}, the value is {}", base::dimension_name(dimension), base::dimension_name(wanted)),
           si.empty() ? "leave it out" : fmt::format("use a unit such as {}", si));
    }
  } catch (const base::QuantityError& error) {
    fail(*given, error.rule, error.remedy);
  }
  return given->text();
}

Result read_result(Value& row, const Scene& scene) {
  std::vector<std::string> probes;
  for (const auto& probe : scene.probes) probes.push_back(probe.name);
  Result result;
  result.name = row.at("name").text();
  result.probe = row.at("probe").text();
  require_known(row.at("probe"), probes, "probe", "probes");
  result.take = row.at("take").text();
  const bool at = result.take == "at";
  if (result.take == "ratio" && !row.has("over")) fail(row, "\"over\" is missing", "add the probe to divide by");
  if (at && !row.has("over")) fail(row, "\"over\" is missing", "add the probe that reaches the level");
  if (at != row.has("level"))
    fail(at ? row : row.at("level"), at ? "\"level\" is missing" : "only take = \"at\" has a level",
         at ? "add the value that `over` is to reach" : "remove it, or set take = \"at\"");
  if (const Value* over = row.find("over")) {
    if (result.take != "ratio" && !at)
      fail(*over, "only take = \"ratio\" divides", "remove it, or set take = \"ratio\" or \"at\"");
    require_known(*over, probes, "probe", "probes");
    result.over = over->text();
  }
  if (at) {
    result.level = base::number_of(row.at("level"), unit_of(scene, result.over));
    row.at("level").data = result.level;
  }
  result.smoothed = row.at("smoothed").real();
  result.scale = row.at("scale").real();
  const std::string si = value_unit(row, scene);
  result.unit = shown_unit(row, si);
  if (row.has("expected") && row.has("expected_range")) {
    fail(row.at("expected_range"), "stands beside expected", "give one of the two");
  }
  if (const Value* expected = row.find("expected")) {
    result.expected = base::number_of(*expected, si);
    row.at("expected").data = *result.expected;
  }
  if (row.has("expected_range")) {
    Value& range = row.at("expected_range");
    if (range.list().size() != 2) fail(range, "must be a lower and an upper value");
    for (auto& end : range.list()) end.data = base::number_of(end, si);
    result.expected_range = {range.list()[0].real(), range.list()[1].real()};
    if (!((*result.expected_range)[0] <= (*result.expected_range)[1])) {
      fail(range, "the lower value must come first", "swap the two");
    }
  }
  result.source = row.at("source").text();
  result.origin = row.origin();
  return result;
}

}  // namespace

void build_probes(Value& root, Scene& scene) {
  const auto& rows = root.rows("probe");
  require_unique(rows, "probe");
  for (const auto& row : rows) scene.probes.push_back(read_probe(row, scene));
}

void build_results(Value& root, Scene& scene) {
  auto& rows = root.at("result").list();
  require_unique(rows, "result");
  for (auto& row : rows) scene.results.push_back(read_result(row, scene));
}

}  // namespace coupling
