// `trackbed list`: every family straight from its declarations.
#include <fmt/format.h>

#include "base/error.hpp"
#include "base/histories.hpp"
#include "base/text.hpp"
#include "coupling/contact_tables.hpp"
#include "coupling/scene.hpp"
#include "coupling/scene_tables.hpp"
#include "dem/grading.hpp"

namespace coupling {

namespace {

std::string describe_all(const base::Family& family) {
  std::string text;
  for (const auto& row : family.rows) {
    if (!text.empty()) text += '\n';
    text += base::describe(row);
  }
  return text;
}

std::string describe_all(const std::vector<base::Table>& rows, const std::string& head) {
  std::string text = head + "\n";
  for (const auto& row : rows)
    text += "\n" + (row.parameters.empty() ? row.name + ": " + row.meaning + "\n" : base::describe(row));
  return text;
}

constexpr const char* contact_keys =
    "Young's modulus and Poisson ratio are the material's; the rest are keys of [grains], and of [[wall]] and\n"
    "[body.contact] for a contact that is not as between grains.";

std::string laws() {
  return describe_all(contact_law_tables(), "contact laws of grains (key `law`)\n" + std::string(contact_keys));
}

std::string rolling() {
  return describe_all(rolling_model_tables(), "rolling models of grains (key `rolling`)\n" + std::string(contact_keys));
}

std::string elements() {
  std::string text = "elements of a body (its parameter `element`):\n";
  for (const auto& name : fem::element_names()) text += "  " + name + "\n";
  return text + "\n" + base::describe(body_table());
}

std::string probes() { return describe_all(probe_family()); }

std::string gradings() {
  std::string text = "gradings (key `grading` of [packing]): mass share passing each sieve\n";
  for (const auto& row : dem::named_gradings()) {
    text += fmt::format("\n{}: {}; {}\n ", row.name, row.text, row.source);
    for (const auto& [size, passing] : row.curve) text += fmt::format(" {:g} mm {:g} %,", 1e3 * size, 100 * passing);
    text.back() = '\n';
  }
  return text;
}

std::string scene() {
  std::string text;
  for (const base::Table* table :
       {&scene_table(),          &time_table(),          &fem_table(),       &grains_table(),  &grain_material_table(),
        &shape_table(),          &grain_table(),         &bonds_table(),     &bond_table(),    &packing_table(),
        &layer_table(),          &growth_table(),        &vibration_table(), &loosen_table(),  &erode_table(),
        &wall_table(),           &wall_material_table(), &body_table(),      &support_table(), &absorbing_table(),
        &periodic_faces_table(), &contact_table(),       &stage_table(),     &result_table(),  &spectrum_table(),
        &output_table()}) {
    text += base::describe(*table) + "\n";
  }
  return text +
         "further families: " + base::join({"gradings", "histories", "loads", "materials", "motions", "probes"}) + "\n";
}

struct FamilyRow {
  const char* name;
  std::string (*text)();
};

// One row per family that `trackbed list` knows.
const FamilyRow family_rows[] = {
    {"laws", laws},
    {"rolling", rolling},
    {"elements", elements},
    {"materials", [] { return describe_all(material_family()); }},
    {"histories", [] { return describe_all(base::history_family("N")); }},
    {"loads", [] { return describe_all(load_family()); }},
    {"motions", [] { return describe_all(motion_family()); }},
    {"gradings", gradings},
    {"probes", probes},
    {"results", [] { return base::describe(result_table()); }},
    {"scene", scene},
};

}  // namespace

std::vector<std::string> families() {
  std::vector<std::string> names;
  for (const auto& row : family_rows) names.emplace_back(row.name);
  return names;
}

std::string list_family(const std::string& family) {
  for (const auto& row : family_rows) {
    if (family == row.name) return row.text();
  }
  const std::string near = base::nearest(family, families());
  throw base::UserError(fmt::format("list {}: no such family; {}choose one of: {}", family,
                                    near.empty() ? "" : "did you mean \"" + near + "\"? ", base::join(families())));
}

}  // namespace coupling
