#include "coupling/wall_mesh.hpp"

#include <fmt/core.h>
#include <gmsh.h>

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

}  // namespace

base::Skin read_wall_mesh(const WallScene& wall) {
  base::Skin skin;
  skin.body = wall.name;
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
  } catch (...) {  // gmsh 4.8 throws integers and strings
    throw base::UserError(fmt::format("{}: wall \"{}\": {}: gmsh cannot read it; give a .stl, .msh or .geo surface",
                                      wall.origin, wall.name, file));
  }
  base::require_user(!skin.facets.empty(),
                     fmt::format("{}: wall \"{}\": {}: holds no triangle or quadrilateral; give a surface mesh",
                                 wall.origin, wall.name, file));
  for (Vec3& node : skin.nodes) node += wall.translation;
  return skin;
}

}  // namespace coupling
