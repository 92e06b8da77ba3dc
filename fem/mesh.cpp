#include "fem/mesh.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "fem/cells.hpp"
#include "fem/communication.hpp"
#include "fem/families.hpp"

namespace fem {
namespace {

std::vector<std::string> volume_names(const RawMesh& mesh) {
  std::vector<std::string> names;
  for (const auto& [name, tags] : mesh.volumes) names.push_back(name);
  return names;
}

/// Which material each of gmsh's volumes has.
std::map<int, int> regions_of_volumes(const RawMesh& raw, const Body& body) {
  std::map<int, int> region;
  for (int m = 0; m < static_cast<int>(body.materials.size()); ++m) {
    const auto& material = body.materials[m];
    const std::string head = message_head(material.origin, body.name);
    std::vector<int> tags = raw.cell_volume;
    if (!material.group.empty()) {
      const auto group = raw.volumes.find(material.group);
      base::require_user(group != raw.volumes.end(),
                         fmt::format("{}material.group = \"{}\"; the mesh has no such physical volume; it has: {}",
                                     head, material.group, fmt::join(volume_names(raw), ", ")));
      tags = group->second;
    }
    std::ranges::sort(tags);
    tags.erase(std::unique(tags.begin(), tags.end()), tags.end());
    for (const int tag : tags) {
      const auto [place, fresh] = region.try_emplace(tag, m);
      base::require_user(fresh,
                         fmt::format("{}material.group = \"{}\" shares cells with material.group = \"{}\"; give every "
                                     "cell exactly one material (an empty group is the whole body)",
                                     head, material.group, body.materials[place->second].group));
    }
  }
  return region;
}

std::vector<int> regions_of_cells(const RawMesh& raw, const Body& body) {
  const auto region = regions_of_volumes(raw, body);
  std::vector<int> regions(raw.cells.size());
  for (std::size_t e = 0; e < raw.cells.size(); ++e) {
    const auto place = region.find(raw.cell_volume[e]);
    if (place == region.end()) {
      std::string group = "(outside every physical volume)";
      for (const auto& [name, tags] : raw.volumes) {
        if (std::ranges::count(tags, raw.cell_volume[e]) > 0) group = "\"" + name + "\"";
      }
      throw base::UserError(
          fmt::format("{}the physical volume {} has no material; add a [[body.material]] with this group",
                      message_head(body.origin, body.name), group));
    }
    regions[e] = place->second;
  }
  return regions;
}

/// Curved cells can be inside out although their corners are not.
void check_points(const Mesh& mesh, const Body& body, const std::string& head) {
  for (int e = 0; e < mesh.element_count(); ++e) {
    double places[20][3];
    for (int a = 0; a < mesh.element_nodes; ++a) {
      for (int c = 0; c < 3; ++c) places[a][c] = mesh.nodes[mesh.element(e)[a]][c];
    }
    const Vec3 centre = mesh.centre(e);
    base::require_user(smallest_point_volume(body.element, places) > 0,
                       fmt::format("{}element {} at ({:.6g}, {:.6g}, {:.6g}) m is bent inside out by its middle nodes; "
                                   "use a finer mesh, or straight sides",
                                   head, e + 1, centre.x, centre.y, centre.z));
  }
}

Mesh checked(RawMesh raw, const Body& body) {
  const std::string head = message_head(body.origin, body.name);
  const int wanted = element_nodes(body.element);
  check_volumes(raw, head);
  check_doubles(raw, head);
  if (cell_corners(wanted) == 4 && raw.cell_nodes == 8) split_into_tetrahedra(raw, head);
  if (wanted > 8 && raw.cell_nodes == cell_corners(wanted)) add_middle_nodes(raw);
  base::require_user(cell_corners(wanted) == 4 || cell_corners(raw.cell_nodes) == 8,
                     fmt::format("{}element = \"{}\" needs hexahedra; mesh = \"{}\" holds tetrahedra; use element = "
                                 "\"tet4\" or \"tet10\", or mesh with Recombine",
                                 head, body.element, body.mesh_file));
  base::require_user(
      cell_corners(wanted) == cell_corners(raw.cell_nodes),
      fmt::format("{}element = \"{}\" needs tetrahedra, or hexahedra of 8 nodes to cut; mesh = \"{}\" holds "
                  "hexahedra of 20; use element = \"hex20\", or mesh with Mesh.ElementOrder = 1",
                  head, body.element, body.mesh_file));
  base::require_user(wanted == raw.cell_nodes,
                     fmt::format("{}element = \"{}\" has no middle nodes; mesh = \"{}\" has; use element = \"{}\", or "
                                 "mesh with Mesh.ElementOrder = 1",
                                 head, body.element, body.mesh_file, raw.cell_nodes == 10 ? "tet10" : "hex20"));
  Mesh mesh;
  mesh.regions = regions_of_cells(raw, body);
  mesh.element_nodes = raw.cell_nodes;
  for (const auto& cell : raw.cells) mesh.elements.insert(mesh.elements.end(), cell.begin(), cell.begin() + wanted);
  const FaceTable faces(raw);
  mesh.rigid_parts = faces.rigid_parts(mesh.element_count());
  for (auto& [name, nodes] : raw.nodes_of) mesh.groups[name].nodes = std::move(nodes);
  for (const auto& [name, facets] : raw.surfaces) {
    auto& group = mesh.groups[name];
    for (const auto& facet : facets) {
      const auto found = faces.find(facet);
      base::require_user(found.cells > 0,
                         fmt::format("{}mesh = \"{}\": the physical surface \"{}\" has facets that belong "
                                     "to no volume cell",
                                     head, body.mesh_file, name));
      group.facets.push_back(found.facet);
      group.facet_regions.push_back(mesh.regions[found.cell]);
      group.outside = group.outside && found.cells == 1;
    }
  }
  mesh.nodes = std::move(raw.nodes);
  for (auto& node : mesh.nodes) node += body.translation;
  if (wanted > 8) check_points(mesh, body, head);
  return mesh;
}

void share(MPI_Comm comm, Mesh& mesh) {
  broadcast(comm, mesh.nodes);
  broadcast(comm, mesh.element_nodes);
  broadcast(comm, mesh.elements);
  broadcast(comm, mesh.regions);
  broadcast(comm, mesh.rigid_parts);
  std::vector<std::string> names;
  for (const auto& [name, group] : mesh.groups) names.push_back(name);
  int count = static_cast<int>(names.size());
  broadcast(comm, count);
  names.resize(count);
  for (auto& name : names) {
    std::vector<char> letters(name.begin(), name.end());
    broadcast(comm, letters);
    auto& group = mesh.groups[std::string(letters.begin(), letters.end())];
    broadcast(comm, group.nodes);
    broadcast(comm, group.facets);
    broadcast(comm, group.facet_regions);
    int outside = group.outside;
    broadcast(comm, outside);
    group.outside = outside != 0;
  }
}

}  // namespace

Vec3 Mesh::centre(int e) const {
  Vec3 sum;
  for (int a = 0; a < element_nodes; ++a) sum += nodes[element(e)[a]];
  return sum * (1.0 / element_nodes);
}

void check_body(const Body& body) {
  const std::string head = message_head(body.origin, body.name);
  const auto known = element_names();
  base::require_user(std::ranges::count(known, body.element) > 0,
                     fmt::format("{}element = \"{}\"; must be one of: {}", head, body.element, fmt::join(known, ", ")));
  base::require_user(body.damping >= 0, fmt::format("{}damping = {}; must be >= 0 1/s", head, body.damping));
  base::require_user(body.stiffness_damping >= 0,
                     fmt::format("{}stiffness_damping = {}; must be >= 0 s", head, body.stiffness_damping));
  base::require_user(!body.materials.empty(), head + "has no material; add a [[body.material]]");
  for (const auto& material : body.materials) check_material(material, message_head(material.origin, body.name));
}

Mesh read_mesh(MPI_Comm comm, const Body& body) {
  Mesh mesh;
  on_first_rank(comm, [&] { mesh = checked(read_with_gmsh(body), body); });
  share(comm, mesh);
  return mesh;
}

const Group& find_group(const Mesh& mesh, const Body& body, const Origin& origin, const std::string& key,
                        const std::string& group) {
  const auto place = mesh.groups.find(group);
  if (place == mesh.groups.end()) {
    std::vector<std::string> names;
    for (const auto& [name, members] : mesh.groups) names.push_back(name);
    throw base::UserError(fmt::format("{}{} = \"{}\"; the mesh has no such physical group; it has: {}",
                                      message_head(origin, body.name), key, group,
                                      names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "))));
  }
  return place->second;
}

}  // namespace fem
