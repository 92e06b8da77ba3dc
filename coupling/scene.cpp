#include "coupling/scene.hpp"

#include <fmt/format.h>

#include "base/version.hpp"
#include "coupling/scene_file.hpp"
#include "coupling/scene_parts.hpp"
#include "coupling/scene_tables.hpp"

namespace coupling {

using base::Value;

namespace {

std::optional<ChosenStep> chosen_step(const Value& table, const std::string& name) {
  const Value* value = table.find(name);
  return value ? std::optional<ChosenStep>({value->real(), value->origin()}) : std::nullopt;
}

TimeSettings read_time(const Value& table) {
  TimeSettings time;
  time.dem_fraction = table.at("dem_fraction").real();
  time.fem_fraction = table.at("fem_fraction").real();
  time.dem_step = chosen_step(table, "dem_step");
  time.fem_step = chosen_step(table, "fem_step");
  time.integrator = table.at("integrator").text() == "symplectic_euler" ? dem::TimeScheme::symplectic_euler
                                                                        : dem::TimeScheme::velocity_verlet;
  time.force_step = table.at("force_step").boolean();
  return time;
}

Output read_output(const Value& table) {
  Output output;
  output.interval = table.at("interval").real();
  output.probe_interval = table.at("probe_interval").real();
  output.checkpoint_interval = table.at("checkpoint_interval").real();
  output.checkpoint_wall_time = table.at("checkpoint_wall_time").real();
  output.contacts = table.at("contacts").boolean();
  if (const Value* sieves = table.find("sieves")) output.sieves = sieves->reals();
  return output;
}

}  // namespace

Scene read_scene(const std::filesystem::path& file, const std::vector<Override>& overrides) {
  Value root = base::check(read_scene_file(file, overrides), scene_table());
  Scene scene;
  scene.file = file;
  scene.title = root.at("title").text();
  scene.gravity = root.at("gravity").vector();
  scene.time = read_time(root.at("time"));
  scene.output = read_output(root.at("output"));
  build_solver(root, scene);
  build_coupling(root, scene);
  build_stages(root, scene);
  build_bodies(root, scene);
  build_grains(root, scene);
  build_bonds(root, scene);
  if (!scene.has_grains() && !scene.has_bodies()) {
    base::fail(root, "nothing to simulate", "add [grains] or [[body]]");
  }
  build_probes(root, scene);
  build_results(root, scene);
  build_spectra(root, scene);
  scene.packing_hash = packing_hash(root, scene);
  scene.resolved_toml =
      fmt::format("# {} with every default and derived value, in SI units. Can be run again.\n# Trackbed {}\n\n{}",
                  file.string(), base::code_version(), base::to_toml(root, scene_table()));
  return scene;
}

}  // namespace coupling
