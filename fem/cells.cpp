#include "fem/cells.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "base/error.hpp"
#include "fem/elements/hex20.hpp"
#include "fem/elements/tet10.hpp"

namespace fem {
namespace {

using Cell = std::array<int, 20>;

constexpr int hexahedron_faces[6][4] = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                        {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
constexpr int tetrahedron_faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
constexpr int kuhn[6][4] = {{0, 1, 2, 6}, {0, 2, 3, 6}, {0, 3, 7, 6}, {0, 7, 4, 6}, {0, 4, 5, 6}, {0, 5, 1, 6}};
constexpr int corner_bits[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                   {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
constexpr int corner_of_bits[8] = {0, 1, 3, 2, 4, 5, 7, 6};  // index x + 2 y + 4 z

/// The hexahedron with its numbering turned so that `first` becomes corner 0; still right-handed.
Cell turned(const Cell& cell, int first) {
  const int* s = corner_bits[first];
  const bool swap = (s[0] + s[1] + s[2]) % 2 == 1;  // an odd number of mirrored axes: exchange two of them
  Cell result{};
  for (int a = 0; a < 8; ++a) {
    int x = corner_bits[a][0], y = corner_bits[a][1];
    if (swap) std::swap(x, y);
    result[a] = cell[corner_of_bits[(x ^ s[0]) + 2 * (y ^ s[1]) + 4 * (corner_bits[a][2] ^ s[2])]];
  }
  return result;
}

std::array<int, 4> sorted_key(const Facet& facet) {
  std::array<int, 4> corners{facet[0], facet[1], facet[2], facet[3]};
  std::ranges::sort(corners);
  return corners;
}

/// Ends of the edges on whose middles the further nodes of a second-order cell lie.
std::vector<std::array<int, 2>> middle_edges(int corners) {
  std::vector<std::array<int, 2>> edges;
  if (corners == 4) {
    for (const auto& edge : Tet10Shape::middles) edges.push_back({edge[0], edge[1]});
  } else {
    for (const auto& edge : Hex20Shape<2>::middles) edges.push_back({edge[0], edge[1]});
  }
  return edges;
}

double determinant(const Vec3& a, const Vec3& b, const Vec3& c) { return base::dot(a, base::cross(b, c)); }

/// Smallest determinant of the three edges that meet in a corner: the Jacobian there, up to the same factor everywhere.
double smallest_corner_volume(const RawMesh& mesh, const Cell& cell) {
  if (cell_corners(mesh.cell_nodes) == 4) {
    const Vec3 origin = mesh.nodes[cell[0]];
    return determinant(mesh.nodes[cell[1]] - origin, mesh.nodes[cell[2]] - origin, mesh.nodes[cell[3]] - origin);
  }
  double smallest = INFINITY;
  for (int a = 0; a < 8; ++a) {
    const auto corner = turned(cell, a);
    const Vec3 origin = mesh.nodes[corner[0]];
    smallest = std::min(smallest, determinant(mesh.nodes[corner[1]] - origin, mesh.nodes[corner[3]] - origin,
                                              mesh.nodes[corner[4]] - origin));
  }
  return smallest;
}

}  // namespace

void split_into_tetrahedra(RawMesh& mesh, const std::string& head) {
  const int boundary_before = FaceTable(mesh).boundary_faces();
  RawMesh split = mesh;
  split.cell_nodes = 4;
  split.cells.clear();
  split.cell_volume.clear();
  for (std::size_t e = 0; e < mesh.cells.size(); ++e) {
    int first = 0;
    double least = INFINITY;
    for (int a = 0; a < 8; ++a) {
      const Vec3& x = mesh.nodes[mesh.cells[e][a]];
      if (x.x + x.y + x.z < least) {
        least = x.x + x.y + x.z;
        first = a;
      }
    }
    const auto cell = turned(mesh.cells[e], first);
    for (const auto& tetrahedron : kuhn) {
      Cell part{};
      for (int a = 0; a < 4; ++a) part[a] = cell[tetrahedron[a]];
      split.cells.push_back(part);
      split.cell_volume.push_back(mesh.cell_volume[e]);
    }
  }
  const FaceTable faces(split);
  base::require_user(
      faces.boundary_faces() == 2 * boundary_before,
      head +
          "element = \"tet4\" or \"tet10\": the tetrahedra cut from this mesh's hexahedra do not fit together; "
          "mesh it with tetrahedra (no Recombine) or use hexahedral elements");
  for (auto& [name, facets] : split.surfaces) {
    std::vector<Facet> triangles;
    const auto triangle = [](int a, int b, int c) { return Facet{a, b, c, -1, -1, -1, -1, -1}; };
    for (const auto& facet : facets) {
      const int a = facet[0], b = facet[1], c = facet[2], d = facet[3];
      const bool through_ac = faces.find(triangle(a, b, c)).cells > 0;
      triangles.push_back(through_ac ? triangle(a, b, c) : triangle(a, b, d));
      triangles.push_back(through_ac ? triangle(a, c, d) : triangle(b, c, d));
    }
    facets = std::move(triangles);
  }
  mesh = std::move(split);
}

void add_middle_nodes(RawMesh& mesh) {
  const int corners = cell_corners(mesh.cell_nodes);
  const auto edges = middle_edges(corners);
  std::map<std::array<int, 2>, int> middles;
  const auto key = [](int a, int b) { return std::array{std::min(a, b), std::max(a, b)}; };
  const auto middle = [&](int a, int b) {
    const auto found = middles.find(key(a, b));
    return found == middles.end() ? -1 : found->second;
  };
  for (auto& cell : mesh.cells) {
    for (std::size_t m = 0; m < edges.size(); ++m) {
      const int a = cell[edges[m][0]], b = cell[edges[m][1]];
      const auto [place, fresh] = middles.try_emplace(key(a, b), static_cast<int>(mesh.nodes.size()));
      if (fresh) mesh.nodes.push_back((mesh.nodes[a] + mesh.nodes[b]) * 0.5);
      cell[corners + m] = place->second;
    }
  }
  mesh.cell_nodes = corners == 4 ? 10 : 20;
  const auto add = [&](const std::string& group, int node) {
    if (node >= 0) mesh.nodes_of[group].push_back(node);
  };
  for (auto& [name, facets] : mesh.surfaces) {
    for (auto& facet : facets) {
      const int count = corners_of(facet);
      for (int a = 0; a < count; ++a) add(name, facet[4 + a] = middle(facet[a], facet[(a + 1) % count]));
    }
  }
  for (const auto& [name, lines] : mesh.curves) {
    for (const auto& [a, b] : lines) add(name, middle(a, b));
  }
  for (const auto& [name, tags] : mesh.volumes) {
    for (std::size_t e = 0; e < mesh.cells.size(); ++e) {
      if (std::ranges::count(tags, mesh.cell_volume[e]) == 0) continue;
      for (int m = corners; m < mesh.cell_nodes; ++m) add(name, mesh.cells[e][m]);
    }
  }
  for (auto& [name, nodes] : mesh.nodes_of) {
    std::ranges::sort(nodes);
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  }
}

void check_volumes(const RawMesh& mesh, const std::string& head) {
  for (std::size_t e = 0; e < mesh.cells.size(); ++e) {
    const auto& cell = mesh.cells[e];
    Vec3 centre, lower{INFINITY, INFINITY, INFINITY}, upper = -lower;
    for (int a = 0; a < mesh.cell_nodes; ++a) {
      const Vec3& x = mesh.nodes[cell[a]];
      centre += x * (1.0 / mesh.cell_nodes);
      for (int c = 0; c < 3; ++c) {
        lower[c] = std::min(lower[c], x[c]);
        upper[c] = std::max(upper[c], x[c]);
      }
    }
    const double volume = smallest_corner_volume(mesh, cell), size = base::norm(upper - lower);
    base::require_user(
        volume > 1e-10 * size * size * size,
        fmt::format("{}element {} at ({:.6g}, {:.6g}, {:.6g}) m is flat or inside out (smallest Jacobian "
                    "{:.3g} m3); look for a layer of no thickness or crossed nodes in the mesh",
                    head, e + 1, centre.x, centre.y, centre.z, volume));
  }
}

void check_doubles(const RawMesh& mesh, const std::string& head) {
  const int corners = cell_corners(mesh.cell_nodes);
  const auto corners_of_cell = [&](int e) {
    std::array<int, 8> sorted;
    for (int a = 0; a < 8; ++a) sorted[a] = a < corners ? mesh.cells[e][a] : -1;
    std::ranges::sort(sorted);
    return sorted;
  };
  std::vector<std::pair<std::array<int, 8>, int>> cells(mesh.cells.size());
  for (int e = 0; e < static_cast<int>(cells.size()); ++e) cells[e] = {corners_of_cell(e), e};
  std::ranges::sort(cells);
  for (std::size_t i = 1; i < cells.size(); ++i) {
    if (cells[i].first != cells[i - 1].first) continue;
    Vec3 centre;
    for (int a = 0; a < corners; ++a) centre += mesh.nodes[mesh.cells[cells[i].second][a]] * (1.0 / corners);
    throw base::UserError(
        fmt::format("{}elements {} and {} at ({:.6g}, {:.6g}, {:.6g}) m have the same corners; the mesh holds this "
                    "cell twice, with twice its mass and stiffness; take one out",
                    head, cells[i - 1].second + 1, cells[i].second + 1, centre.x, centre.y, centre.z));
  }
}

FaceTable::FaceTable(const RawMesh& mesh) {
  const bool hexahedra = cell_corners(mesh.cell_nodes) == 8, middles = mesh.cell_nodes > 8;
  const int faces = hexahedra ? 6 : 4, corners = hexahedra ? 4 : 3;
  const auto edges = middle_edges(cell_corners(mesh.cell_nodes));
  entries_.reserve(mesh.cells.size() * faces);
  for (std::size_t e = 0; e < mesh.cells.size(); ++e) {
    const auto& cell = mesh.cells[e];
    for (int f = 0; f < faces; ++f) {
      Facet facet = no_facet;
      const int* face = hexahedra ? hexahedron_faces[f] : tetrahedron_faces[f];
      for (int a = 0; a < corners; ++a) facet[a] = cell[face[a]];
      for (int a = 0; a < corners && middles; ++a) {
        const int from = face[a], to = face[(a + 1) % corners];
        const auto edge = std::ranges::find_if(edges, [&](const auto& ends) {
          return (ends[0] == from && ends[1] == to) || (ends[0] == to && ends[1] == from);
        });
        facet[4 + a] = cell[cell_corners(mesh.cell_nodes) + static_cast<std::size_t>(edge - edges.begin())];
      }
      entries_.push_back({sorted_key(facet), facet, static_cast<int>(e)});
    }
  }
  std::ranges::stable_sort(entries_, {}, &Entry::key);
}

FaceTable::Found FaceTable::find(const Facet& facet) const {
  const auto range = std::ranges::equal_range(entries_, sorted_key(facet), {}, &Entry::key);
  if (range.empty()) return {};
  return {range.front().facet, static_cast<int>(range.size()), range.front().cell};
}

int FaceTable::boundary_faces() const {
  int count = 0;
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    const bool same_before = i > 0 && entries_[i - 1].key == entries_[i].key;
    const bool same_after = i + 1 < entries_.size() && entries_[i + 1].key == entries_[i].key;
    if (!same_before && !same_after) ++count;
  }
  return count;
}

std::vector<int> FaceTable::rigid_parts(int cells) const {
  std::vector<int> root(cells);
  std::iota(root.begin(), root.end(), 0);
  const auto find = [&](int cell) {
    while (root[cell] != cell) cell = root[cell] = root[root[cell]];
    return cell;
  };
  for (std::size_t i = 1; i < entries_.size(); ++i) {
    if (entries_[i].key != entries_[i - 1].key) continue;
    const int one = find(entries_[i - 1].cell), other = find(entries_[i].cell);
    root[std::max(one, other)] = std::min(one, other);
  }
  std::vector<int> part(cells);
  int count = 0;
  for (int e = 0; e < cells; ++e) part[e] = find(e) == e ? count++ : part[find(e)];
  return count > 1 ? part : std::vector<int>{};
}

}  // namespace fem
