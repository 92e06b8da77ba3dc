// The packing's fingerprint: a cached packing is used again only while all of this is the same.
#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "base/parameter.hpp"
#include "coupling/scene_parts.hpp"
#include "coupling/scene_tables.hpp"

namespace coupling {

using base::Value;

namespace {

// Raise it whenever the way of packing changes what comes out.
constexpr int packing_version = 1;

/// FNV-1a, 64 bit (Fowler, Noll, Vo: offset basis and prime of the 64-bit variant), from two starts: 128 bits together.
class Fingerprint {
 public:
  void add(const std::string& text) {
    for (const char c : text + '\n') {
      a_ = (a_ ^ static_cast<unsigned char>(c)) * prime;
      b_ = (b_ ^ static_cast<unsigned char>(c ^ 0x5a)) * prime;
    }
  }
  std::string text() const { return fmt::format("{:016x}{:016x}", a_, b_); }

 private:
  static constexpr std::uint64_t prime = 0x100000001b3u;
  std::uint64_t a_ = 0xcbf29ce484222325u, b_ = 0x84222325cbf29ce4u;
};

std::string file_text(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

/// The table's values without its file names, which may differ from machine to machine: the files' text counts.
void add_with_mesh(Fingerprint& print, Value table, const base::Table& declaration) {
  if (const Value* mesh = table.find("mesh")) {
    print.add(file_text(mesh->text()));
    table.table().erase("mesh");
  }
  print.add(base::to_toml(table, declaration));
}

}  // namespace

std::string packing_hash(const Value& root, const Scene& scene) {
  if (!scene.grains || !scene.grains->packing) return "";
  Fingerprint print;
  print.add(std::to_string(packing_version));
  for (int axis = 0; axis < 3; ++axis) print.add(fmt::format("{}", scene.gravity[axis]));
  Value grains = root.at("grains");
  grains.at("material").table().erase("young_modulus");  // only the packing's own counts
  grains.table().erase("friction");
  grains.table().erase("rolling_friction");
  grains.table().erase("bond");             // made afterwards
  grains.table().erase("rotation_scheme");  // the packing takes its own, so that runs with any start from one bed
  grains.table().erase("precision");        // packings are made in double
  for (auto& shape : grains.at("shape").list()) {
    print.add(file_text(shape.at("file").text()));
    shape.table().erase("file");
  }
  print.add(base::to_toml(grains, grains_table()));
  Value time = root.at("time");  // the grains' step changes how they fall
  time.table().erase("fem_fraction");
  time.table().erase("fem_step");
  time.table().erase("integrator");  // likewise
  print.add(base::to_toml(time, time_table()));
  Value packing = root.at("packing");
  packing.table().erase("cache");
  print.add(base::to_toml(packing, packing_table()));
  for (const auto& grain : root.rows("grain")) print.add(base::to_toml(grain, grain_table()));
  for (Value wall : root.rows("wall")) {
    if (wall.at("run_only").boolean()) continue;
    for (const char* later : {"velocity", "motion", "body", "load", "removed_at"}) wall.table().erase(later);
    add_with_mesh(print, wall, wall_table());
  }
  for (const auto& body : root.rows("body")) {
    const auto& layers = scene.grains->packing->layers;
    const bool named = std::any_of(layers.begin(), layers.end(), [&](const PackingLayer& layer) {
      return std::count(layer.bodies.begin(), layer.bodies.end(), body.at("name").text()) > 0;
    });
    if (!named && body.at("skin").list().empty()) continue;
    Value shape = body;  // loads, supports and elastic constants do not matter to the packing
    for (const char* name :
         {"material", "support", "motion", "absorbing", "periodic", "load", "gravity", "damping", "stiffness_damping"})
      shape.table().erase(name);
    add_with_mesh(print, shape, body_table());
  }
  return print.text();
}

}  // namespace coupling
