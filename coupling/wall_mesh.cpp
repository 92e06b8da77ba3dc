#include "coupling/wall_mesh.hpp"

#include <fmt/core.h>
#include <gmsh.h>

#include <algorithm>
#include <map>

#include "base/error.hpp"

namespace coupling {

namespace {

constexpr int triangle = 2, quadrilateral = 3;  // gmsh's element types

/// gmsh open for as long as this lives; quiet.
class Gmsh {
 public:
  Gmsh() {
    gmsh::initialize();
    gmsh::option::setNumber("General.Terminal", 0);
    gmsh::onelab::clear();
  }
  ~Gmsh() { gmsh::finalize(); }
  Gmsh(const Gmsh&) = delete;
  Gmsh& operator=(const Gmsh&) = delete;
};

void append(base::Skin& skin, std::map<std::size_t, int>& numbers, int type, int corners) {
  std::vector<std::size_t> elements, nodes;
  gmsh::model::mesh::getElementsByType(type, elements, nodes);
  for (std::size_t e = 0; e < elements.size(); ++e) {
    std::array<int, 4> facet{-1, -1, -1, -1};
    for (int c = 0; c < corners; ++c) {
      const std::size_t tag = nodes[e * static_cast<std::size_t>(corners) + static_cast<std::size_t>(c)];
      const auto [entry, fresh] = numbers.try_emplace(tag, static_cast<int>(skin.nodes.size()));
      if (fresh) {
        std::vector<double> x, parameters;
        gmsh::model::mesh::getNode(tag, x, parameters);
        skin.nodes.push_back({x[0], x[1], x[2]});
      }
      facet[static_cast<std::size_t>(c)] = entry->second;
    }
    skin.facets.push_back(facet);
  }
}

int corners_of(const std::array<int, 4>& facet) { return facet[3] < 0 ? 3 : 4; }

/// Six times the volume under a facet, seen from the origin.
double volume_under(const base::Skin& skin, const std::array<int, 4>& facet) {
  const auto node = [&](int k) { return skin.nodes[static_cast<std::size_t>(facet[static_cast<std::size_t>(k)])]; };
  double six = dot(node(0), cross(node(1), node(2)));
  if (corners_of(facet) == 4) six += dot(node(0), cross(node(2), node(3)));
  return six;
}

void flip(std::array<int, 4>& facet) { std::swap(facet[1], facet[static_cast<std::size_t>(corners_of(facet) - 1)]); }

/// Turns the facets of closed surfaces outwards: gmsh's faces of a solid look either way. Neighbours walk their common
/// edge in opposite directions; of each connected surface the enclosed volume then says which way is out.
void orient_outwards(base::Skin& skin) {
  using Edge = std::pair<int, int>;
  std::map<Edge, std::vector<std::size_t>> facets_at;
  const auto edges = [](const std::array<int, 4>& facet) {
    std::vector<Edge> list;
    for (int k = 0, n = corners_of(facet); k < n; ++k)
      list.emplace_back(facet[static_cast<std::size_t>(k)], facet[static_cast<std::size_t>((k + 1) % n)]);
    return list;
  };
  for (std::size_t f = 0; f < skin.facets.size(); ++f)
    for (const auto& [a, b] : edges(skin.facets[f])) facets_at[std::minmax(a, b)].push_back(f);
  std::vector<char> seen(skin.facets.size(), 0);
  for (std::size_t first = 0; first < skin.facets.size(); ++first) {
    if (seen[first]) continue;
    std::vector<std::size_t> surface{first};
    seen[first] = 1;
    double six_volumes = 0;
    for (std::size_t next = 0; next < surface.size(); ++next) {
      const auto& facet = skin.facets[surface[next]];
      six_volumes += volume_under(skin, facet);
      for (const Edge& edge : edges(facet))
        for (const std::size_t other : facets_at[std::minmax(edge.first, edge.second)]) {
          if (seen[other]) continue;
          const auto walked = edges(skin.facets[other]);
          if (std::find(walked.begin(), walked.end(), edge) != walked.end()) flip(skin.facets[other]);
          seen[other] = 1;
          surface.push_back(other);
        }
    }
    if (six_volumes < 0)
      for (const std::size_t f : surface) flip(skin.facets[f]);
  }
}

}  // namespace

base::Skin read_wall_mesh(const WallScene& wall) {
  base::Skin skin;
  skin.body = wall.name;
  bool solid = false;
  const std::string file = wall.mesh.string();
  Gmsh gmsh;
  try {
    for (const auto& [name, value] : wall.mesh_parameters) gmsh::onelab::setNumber(name, {value});
    gmsh::open(file);
    if (wall.mesh.extension() == ".geo") gmsh::model::mesh::generate(2);
    gmsh::model::mesh::removeDuplicateNodes();
    std::map<std::size_t, int> numbers;
    append(skin, numbers, triangle, 3);
    append(skin, numbers, quadrilateral, 4);
    gmsh::vectorpair volumes;
    gmsh::model::getEntities(volumes, 3);
    solid = !volumes.empty();
  } catch (...) {  // gmsh 4.8 throws integers and strings
    throw base::UserError(fmt::format("{}: wall \"{}\": {}: gmsh cannot read it; give a .stl, .msh or .geo surface",
                                      wall.origin, wall.name, file));
  }
  base::require_user(!skin.facets.empty(),
                     fmt::format("{}: wall \"{}\": {}: holds no triangle or quadrilateral; give a surface mesh",
                                 wall.origin, wall.name, file));
  if (solid) orient_outwards(skin);
  for (Vec3& node : skin.nodes) node += wall.translation;
  return skin;
}

}  // namespace coupling
