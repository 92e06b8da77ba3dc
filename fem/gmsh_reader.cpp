#include "fem/gmsh_reader.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmsh.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <set>

#include "base/error.hpp"
#include "fem/families.hpp"

namespace fem {

std::string message_head(const Origin& origin, const std::string& body) {
  return (origin.empty() ? "" : origin + ": ") + "body \"" + body + "\": ";
}

namespace {

/// gmsh lives exactly as long as this object, quiet, with nothing left over from the mesh before.
struct Session {
  Session() {
    gmsh::initialize();
    gmsh::option::setNumber("General.Terminal", 0);
    gmsh::onelab::clear();
    gmsh::logger::start();
  }
  ~Session() {
    gmsh::logger::stop();
    gmsh::finalize();
  }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;
};

/// Runs a gmsh call and turns what gmsh complains about, thrown or logged, into the user's error.
void guarded(const std::string& head, const Body& body, const std::function<void()>& call) {
  bool thrown = false;
  try {
    call();
  } catch (...) {  // gmsh 4.8 throws integers and strings
    thrown = true;
  }
  std::vector<std::string> log, errors;
  gmsh::logger::get(log);
  for (const auto& line : log) {
    if (line.starts_with("Error: ")) errors.push_back(line.substr(7));
  }
  if (errors.empty() && thrown) errors.push_back("no reason given");
  base::require_user(errors.empty(), fmt::format("{}mesh = \"{}\"; gmsh cannot make a mesh of it: {}", head,
                                                 body.mesh_file, fmt::join(errors, "; ")));
}

void set_parameters(const std::string& head, const Body& body) {
  std::vector<std::string> names, known;
  gmsh::onelab::getNames(names);
  for (const auto& name : names) {
    if (!name.starts_with("Gmsh/") && !name.starts_with("ONELAB/")) known.push_back(name);
  }
  for (const auto& [name, value] : body.mesh_parameters) {
    base::require_user(
        std::ranges::count(known, name) > 0,
        fmt::format("{}mesh_parameters.{} = {}; \"{}\" has no such parameter; {}", head, name, value, body.mesh_file,
                    known.empty() ? "it has none" : fmt::format("it has: {}", fmt::join(known, ", "))));
    gmsh::onelab::setNumber(name, {value});
  }
}

const std::set<int>& volume_tags(const gmsh::vectorpair& entities, std::set<int>& tags) {
  for (const auto& [dimension, tag] : entities) tags.insert(tag);
  return tags;
}

/// Node numbers 0 … n-1 in the order in which the cells first name gmsh's node tags.
class Numbering {
 public:
  int of(std::size_t tag) {
    const auto [place, fresh] = numbers_.try_emplace(tag, static_cast<int>(numbers_.size()));
    return place->second;
  }
  int find(std::size_t tag) const {
    const auto place = numbers_.find(tag);
    return place == numbers_.end() ? -1 : place->second;
  }
  std::size_t size() const { return numbers_.size(); }

 private:
  std::map<std::size_t, int> numbers_;
};

/// gmsh's element types that are read, with their nodes.
struct Kind {
  int type, dimension, nodes;
};
constexpr Kind kinds[] = {{1, 1, 2},  {8, 1, 3}, {2, 2, 3},   {9, 2, 6}, {3, 2, 4},
                          {16, 2, 8}, {4, 3, 4}, {11, 3, 10}, {5, 3, 8}, {17, 3, 20}};
constexpr int gmsh_tetrahedron = 4, gmsh_hexahedron = 5;

/// Nodes of a cell, face or line of this type; 0: not one that is read.
int nodes_of_type(int type) {
  for (const auto& kind : kinds) {
    if (kind.type == type) return kind.nodes;
  }
  return 0;
}

/// Middle nodes where the element wants them and gmsh's cells have its shape.
void raise_order(const Body& body) {
  const int wanted = element_nodes(body.element);
  if (wanted != 10 && wanted != 20) return;
  std::vector<int> types;
  gmsh::model::mesh::getElementTypes(types, 3);
  if (types != std::vector{wanted == 20 ? gmsh_hexahedron : gmsh_tetrahedron}) return;
  gmsh::option::setNumber("Mesh.SecondOrderIncomplete", 1);  // hexahedra of 20 nodes, not 27
  gmsh::model::mesh::setOrder(2);
}

void read_cells(const std::string& head, const Body& body, RawMesh& mesh, Numbering& numbering) {
  gmsh::vectorpair volumes;
  gmsh::model::getEntities(volumes, 3);
  std::set<int> tags;
  for (const int volume : volume_tags(volumes, tags)) {
    std::vector<int> types;
    std::vector<std::vector<std::size_t>> elements, nodes;
    gmsh::model::mesh::getElements(types, elements, nodes, 3, volume);
    for (std::size_t t = 0; t < types.size(); ++t) {
      const int count = nodes_of_type(types[t]);
      std::string type_name;
      int dimension = 0, order = 0, node_count = 0, primary = 0;
      std::vector<double> local;
      gmsh::model::mesh::getElementProperties(types[t], type_name, dimension, order, node_count, local, primary);
      base::require_user(count > 0 && (mesh.cell_nodes == 0 || mesh.cell_nodes == count),
                         fmt::format("{}mesh = \"{}\" holds cells of type \"{}\"; a mesh must be all "
                                     "hexahedra of 8 or of 20 nodes (Mesh.SecondOrderIncomplete = 1) or all tetrahedra "
                                     "of 4 or of 10 nodes",
                                     head, body.mesh_file, type_name));
      mesh.cell_nodes = count;
      for (std::size_t e = 0; e < elements[t].size(); ++e) {
        std::array<int, 20> cell{};
        for (int a = 0; a < count; ++a) cell[a] = numbering.of(nodes[t][e * count + a]);
        mesh.cells.push_back(cell);
        mesh.cell_volume.push_back(volume);
      }
    }
  }
  base::require_user(
      !mesh.cells.empty(),
      fmt::format("{}mesh = \"{}\" holds no volume cells; it needs a meshed physical volume", head, body.mesh_file));
}

void read_nodes(RawMesh& mesh, const Numbering& numbering, const Body& body, const std::string& head) {
  std::vector<std::size_t> tags;
  std::vector<double> coordinates, parametric;
  gmsh::model::mesh::getNodes(tags, coordinates, parametric);
  mesh.nodes.resize(numbering.size());
  for (std::size_t i = 0; i < tags.size(); ++i) {
    const int node = numbering.find(tags[i]);
    if (node < 0) continue;
    const double* x = coordinates.data() + 3 * i;
    base::require_user(std::isfinite(x[0]) && std::isfinite(x[1]) && std::isfinite(x[2]),
                       fmt::format("{}mesh = \"{}\": node {} lies at ({}, {}, {}) m; coordinates must be numbers", head,
                                   body.mesh_file, tags[i], x[0], x[1], x[2]));
    mesh.nodes[node] = {x[0], x[1], x[2]};
  }
}

void read_facets(int surface, const Numbering& numbering, std::vector<Facet>& facets) {
  std::vector<int> types;
  std::vector<std::vector<std::size_t>> elements, nodes;
  gmsh::model::mesh::getElements(types, elements, nodes, 2, surface);
  for (std::size_t t = 0; t < types.size(); ++t) {
    const int count = nodes_of_type(types[t]), corners = count % 4 == 0 ? 4 : 3;
    for (std::size_t e = 0; e < elements[t].size() && count > 0; ++e) {
      Facet facet = no_facet;
      for (int a = 0; a < count; ++a)
        facet[a < corners ? a : 4 + a - corners] = numbering.find(nodes[t][e * count + a]);
      facets.push_back(facet);
    }
  }
}

void read_lines(int curve, const Numbering& numbering, std::vector<std::array<int, 2>>& lines) {
  std::vector<int> types;
  std::vector<std::vector<std::size_t>> elements, nodes;
  gmsh::model::mesh::getElements(types, elements, nodes, 1, curve);
  for (std::size_t t = 0; t < types.size(); ++t) {
    const int count = nodes_of_type(types[t]);
    for (std::size_t e = 0; e < elements[t].size() && count > 0; ++e)
      lines.push_back({numbering.find(nodes[t][e * count]), numbering.find(nodes[t][e * count + 1])});
  }
}

void read_groups(RawMesh& mesh, const Numbering& numbering) {
  gmsh::vectorpair groups;
  gmsh::model::getPhysicalGroups(groups);
  for (const auto& [dimension, group] : groups) {
    std::string name;
    gmsh::model::getPhysicalName(dimension, group, name);
    if (name.empty()) name = std::to_string(group);
    std::vector<int> entities;
    gmsh::model::getEntitiesForPhysicalGroup(dimension, group, entities);
    if (dimension == 3) mesh.volumes[name] = entities;
    if (dimension == 2) {
      for (const int surface : entities) read_facets(surface, numbering, mesh.surfaces[name]);
    }
    if (dimension == 1) {
      for (const int curve : entities) read_lines(curve, numbering, mesh.curves[name]);
    }
    std::vector<std::size_t> tags;
    std::vector<double> coordinates;
    gmsh::model::mesh::getNodesForPhysicalGroup(dimension, group, tags, coordinates);
    auto& nodes = mesh.nodes_of[name];
    for (const auto tag : tags) {
      if (const int node = numbering.find(tag); node >= 0) nodes.push_back(node);
    }
    std::ranges::sort(nodes);
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  }
}

}  // namespace

RawMesh read_with_gmsh(const Body& body) {
  const std::string head = message_head(body.origin, body.name);
  base::require_user(std::filesystem::is_regular_file(body.mesh_file),
                     fmt::format("{}mesh = \"{}\"; there is no such file", head, body.mesh_file));
  const bool geometry = std::filesystem::path(body.mesh_file).extension() == ".geo";
  base::require_user(
      geometry || body.mesh_parameters.empty(),
      fmt::format("{}mesh_parameters are for .geo files; \"{}\" is a finished mesh", head, body.mesh_file));
  const Session session;
  guarded(head, body, [&] { gmsh::open(body.mesh_file); });
  if (geometry) {
    if (!body.mesh_parameters.empty()) {
      set_parameters(head, body);
      gmsh::clear();
      guarded(head, body, [&] { gmsh::open(body.mesh_file); });
    }
    guarded(head, body, [&] {
      gmsh::model::mesh::generate(3);
      raise_order(body);
    });
  }
  RawMesh mesh;
  Numbering numbering;
  read_cells(head, body, mesh, numbering);
  read_nodes(mesh, numbering, body, head);
  read_groups(mesh, numbering);
  return mesh;
}

}  // namespace fem
