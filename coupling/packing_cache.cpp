#include "coupling/packing_cache.hpp"

#include <fmt/core.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <bit>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "coupling/contact_tables.hpp"

namespace coupling {
namespace {

namespace fs = std::filesystem;

/// Raise it whenever the packing procedure changes what comes out.
constexpr int format_version = 6;

/// FNV-1a, 64 bit.
class Hash {
 public:
  void add(const std::string& text) {
    for (const char c : text) byte(static_cast<unsigned char>(c));
    byte(0);
  }
  void add(double value) { add(std::bit_cast<std::uint64_t>(value)); }
  void add(std::uint64_t value) {
    for (int i = 0; i < 8; ++i) byte(static_cast<unsigned char>(value >> (8 * i)));
  }
  void add(int value) { add(static_cast<std::uint64_t>(value)); }
  void add(bool value) { byte(value ? 1 : 0); }
  void add(const Vec3& v) { add(v.x), add(v.y), add(v.z); }
  void add(const dem::Plane& plane) { add(plane.point), add(plane.normal); }
  std::uint64_t value() const { return value_; }
  std::string text() const { return fmt::format("{:016x}", value_); }

 private:
  void byte(unsigned char b) { value_ = (value_ ^ b) * 0x100000001b3ULL; }
  std::uint64_t value_ = 0xcbf29ce484222325ULL;
};

void add_packing(Hash& hash, const Packing& packing) {
  for (const GradingRow& row : packing.grading) hash.add(row.size), hash.add(row.passing);
  hash.add(packing.seed);
  for (const double value : {packing.young_modulus, packing.friction, packing.rolling_friction, packing.target_porosity,
                             packing.grain_damping, packing.plate_speed}) {
    hash.add(value);
  }
  for (const int shape : packing.shapes) hash.add(shape);
  for (const double share : packing.shape_shares) hash.add(share);
  hash.add(packing.tolerance.value_or(-1)), hash.add(packing.tries);
  for (const LooseRegion& region : packing.loosened) {
    hash.add(region.box.lower), hash.add(region.box.upper), hash.add(region.friction.value_or(-1));
    hash.add(region.share);
  }
  for (const ErodedRegion& region : packing.eroded) {
    hash.add(region.box.lower), hash.add(region.box.upper), hash.add(region.settle);
    if (region.above) hash.add(*region.above);
  }
  for (const PackingLayer& layer : packing.layers) {
    if (const auto& grown = layer.growth) {
      for (const double value : {grown->start, grown->overlap, grown->damping, grown->gravity_factor, grown->lowering})
        hash.add(value);
    }
    if (const auto& shaken = layer.vibration) {
      hash.add(shaken->amplitude), hash.add(shaken->frequency), hash.add(shaken->time), hash.add(shaken->direction);
    }
    hash.add(layer.box.lower), hash.add(layer.box.upper);
    hash.add(layer.overfill), hash.add(layer.settle), hash.add(layer.plate);
    for (const std::string& body : layer.bodies) hash.add(body);
  }
  for (const dem::Plane& cut : packing.cuts) hash.add(cut);
}

/// The same however the facets and nodes are numbered: the numbering may depend on the number of ranks.
std::uint64_t surface_value(const base::Skin& skin) {
  std::uint64_t sum = skin.faces.size();
  for (const auto& facet : skin.facets) {
    std::uint64_t corners = 0;
    for (const int node : facet) {
      Hash corner;
      if (node >= 0) corner.add(skin.nodes[static_cast<std::size_t>(node)]);
      corners += corner.value();
    }
    Hash whole;
    whole.add(corners);
    sum += whole.value();
  }
  return sum;
}

std::string checksum(const std::string& text) {
  Hash hash;
  hash.add(text);
  return hash.text();
}

/// The folder, or nothing when the environment names none.
std::optional<fs::path> folder() {
  const auto variable = [](const char* name) -> std::optional<fs::path> {
    const char* value = std::getenv(name);
    if (value == nullptr || *value == '\0') return std::nullopt;
    return fs::path(value);
  };
  if (const auto path = variable("TRACKBED_CACHE")) return path;
  if (const auto path = variable("XDG_CACHE_HOME")) return *path / "trackbed";
  if (const auto path = variable("HOME")) return *path / ".cache" / "trackbed";
  return std::nullopt;
}

std::string header(const std::string& key, const PackingReport& report, const std::string& sum) {
  std::string text = fmt::format(
      "# trackbed packing, format {}\n# key {}\n"
      "# grains {} porosity {:a} coordination {:a} friction {:a} steps {} checksum {}\n",
      format_version, key, report.grains, report.porosity, report.coordination, report.friction, report.steps.size(),
      sum);
  for (const PackingStep& step : report.steps)
    text += fmt::format("# {} {} taken {} porosity {:a} {:a}\n", step.what, step.number, step.taken,
                        step.porosity_before, step.porosity_after);
  return text;
}

constexpr const char* columns = "id,x [m],y [m],z [m],radius [m]; of a clump also shape,orientation w,x,y,z";

std::string body_of(std::span<const dem::Grain> grains) {
  std::string text = std::string(columns) + "\n";
  for (const dem::Grain& g : grains) {
    text += fmt::format("{},{:a},{:a},{:a},{:a}", g.id, g.position.x, g.position.y, g.position.z, g.radius);
    const auto& q = g.orientation;
    if (g.shape >= 0) text += fmt::format(",{},{:a},{:a},{:a},{:a}", g.shape, q.w, q.x, q.y, q.z);
    text += '\n';
  }
  return text;
}

/// Throws std::runtime_error with the reason when the text is not the packing of this key.
std::vector<dem::Grain> parse(const std::string& text, const std::string& key, PackingReport& report) {
  const auto fail = [](const char* why) { throw std::runtime_error(why); };
  std::size_t begin = 0;
  const auto next_line = [&] {
    const std::size_t start = begin, end = text.find('\n', begin);
    if (end == std::string::npos) fail("truncated");
    begin = end + 1;
    return text.substr(start, end - start);
  };
  const std::array<std::string, 3> lines{next_line(), next_line(), next_line()};
  if (lines[0] != fmt::format("# trackbed packing, format {}", format_version)) fail("of another format");
  if (lines[1] != "# key " + key) fail("of another scene");
  std::istringstream third(lines[2]);
  std::string mark, word, porosity, coordination, friction, sum;
  std::size_t steps = 0;
  third >> mark >> word >> report.grains >> word >> porosity >> word >> coordination >> word >> friction >> word >>
      steps >> word >> sum;
  report.steps.clear();
  for (std::size_t i = 0; third && i < steps; ++i) {
    std::istringstream line(next_line());
    PackingStep step;
    std::string before, after;
    line >> mark >> step.what >> step.number >> word >> step.taken >> word >> before >> after;
    if (!line) fail("damaged");
    step.porosity_before = std::strtod(before.c_str(), nullptr);
    step.porosity_after = std::strtod(after.c_str(), nullptr);
    report.steps.push_back(step);
  }
  const std::string body = text.substr(begin);
  if (!third || sum != checksum(body)) fail("damaged or truncated");
  report.porosity = std::strtod(porosity.c_str(), nullptr);
  report.coordination = std::strtod(coordination.c_str(), nullptr);
  report.friction = std::strtod(friction.c_str(), nullptr);
  std::vector<dem::Grain> grains;
  const char* at = body.c_str() + body.find('\n') + 1;
  while (*at != '\0') {
    dem::Grain grain;
    char* next = nullptr;
    grain.id = std::strtoll(at, &next, 10);
    const auto take = [&](std::initializer_list<double*> values) {
      for (double* value : values) {
        if (*next != ',') fail("damaged");
        *value = std::strtod(next + 1, &next);
      }
    };
    take({&grain.position.x, &grain.position.y, &grain.position.z, &grain.radius});
    if (*next == ',') {
      grain.shape = static_cast<int>(std::strtol(next + 1, &next, 10));
      take({&grain.orientation.w, &grain.orientation.x, &grain.orientation.y, &grain.orientation.z});
    }
    if (*next != '\n') fail("damaged");
    at = next + 1;
    grains.push_back(grain);
  }
  if (static_cast<std::int64_t>(grains.size()) != report.grains) fail("incomplete");
  return grains;
}

}  // namespace

std::string packing_key(const Scene& scene, const std::vector<base::Skin>& skins, dem::Backend backend) {
  Hash hash;
  const GrainsScene& grains = *scene.grains;
  hash.add(format_version);
  hash.add(static_cast<int>(backend));
  hash.add(scene.packing_hash);
  hash.add(scene.gravity);
  hash.add(scene.time.dem_fraction);
  hash.add(grains.neighbour_skin);
  for (const dem::Material& m : grains.materials)
    hash.add(m.young_modulus), hash.add(m.poisson_ratio), hash.add(m.density);
  for (const dem::Interaction& between : grains.interactions) {
    const dem::Interaction i = for_beds(between);
    hash.add(i.law), hash.add(i.rolling);
    for (const auto& constant : contact_constants())
      std::visit([&](const auto member) { hash.add(i.*member); }, constant.member);
  }
  for (const dem::Period& along : grains.periods) hash.add(along.lower), hash.add(along.length);
  for (const dem::Grain& grain : grains.list) hash.add(static_cast<std::uint64_t>(grain.id));
  for (const auto& [body, material] : grains.body_material) hash.add(body), hash.add(material);
  for (const GrainShape& shape : grains.shapes)
    for (const dem::Sphere& sphere : shape.clump.spheres) hash.add(sphere.position), hash.add(sphere.radius);
  add_packing(hash, *grains.packing);
  for (const WallScene& wall : grains.walls) {
    if (wall.run_only) continue;
    if (wall.plane) hash.add(*wall.plane);
    hash.add(wall.mesh.string()), hash.add(wall.translation);
    std::error_code ignored;
    if (!wall.mesh.empty()) hash.add(static_cast<std::uint64_t>(fs::file_size(wall.mesh, ignored)));
    for (const auto& [name, value] : wall.mesh_parameters) hash.add(name), hash.add(value);
    hash.add(wall.material), hash.add(wall.two_sided), hash.add(wall.packing_only);
  }
  for (const base::Skin& skin : skins) hash.add(skin.body), hash.add(surface_value(skin));
  return hash.text();
}

std::optional<std::vector<dem::Grain>> load_packing(const std::string& key, PackingReport& report) {
  const auto directory = folder();
  if (!directory) return std::nullopt;
  const fs::path file = *directory / fmt::format("packing-{}.csv", key);
  std::error_code ignored;
  if (!fs::exists(file, ignored)) return std::nullopt;
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  PackingReport found = report;
  try {
    if (!stream) throw std::runtime_error("unreadable");
    auto grains = parse(text.str(), key, found);
    report = found;
    report.from_cache = true;
    return grains;
  } catch (const std::runtime_error& error) {
    spdlog::warn("the cached packing {} is {}; packing again", file.string(), error.what());
    return std::nullopt;
  }
}

void store_packing(const std::string& key, std::span<const dem::Grain> grains, const PackingReport& report) {
  const auto directory = folder();
  if (!directory) {
    spdlog::warn("the packing is not kept: neither TRACKBED_CACHE nor XDG_CACHE_HOME nor HOME is set");
    return;
  }
  const fs::path file = *directory / fmt::format("packing-{}.csv", key);
  const fs::path temporary = *directory / fmt::format(".packing-{}.{}", key, getpid());
  std::error_code error;
  fs::create_directories(*directory, error);
  {
    std::ofstream stream(temporary, std::ios::binary);
    const std::string body = body_of(grains);
    stream << header(key, report, checksum(body)) << body;
    stream.close();
    if (stream) fs::rename(temporary, file, error);
    if (!stream || error) {
      spdlog::warn("the packing is not kept: cannot write {}", file.string());
      fs::remove(temporary, error);
    }
  }
}

}  // namespace coupling
