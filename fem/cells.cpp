#include "fem/cells.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"

namespace fem {
namespace {

constexpr int hexahedron_faces[6][4] = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                        {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
constexpr int tetrahedron_faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
constexpr int kuhn[6][4] = {{0, 1, 2, 6}, {0, 2, 3, 6}, {0, 3, 7, 6}, {0, 7, 4, 6}, {0, 4, 5, 6}, {0, 5, 1, 6}};
constexpr int corner_bits[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                   {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
constexpr int corner_of_bits[8] = {0, 1, 3, 2, 4, 5, 7, 6};  // index x + 2 y + 4 z

/// The hexahedron with its numbering turned so that `first` becomes corner 0; still right-handed.
std::array<int, 8> turned(const std::array<int, 8>& cell, int first) {
  const int* s = corner_bits[first];
  const bool swap = (s[0] + s[1] + s[2]) % 2 == 1;  // an odd number of mirrored axes: exchange two of them
  std::array<int, 8> result{};
  for (int a = 0; a < 8; ++a) {
    int x = corner_bits[a][0], y = corner_bits[a][1];
    if (swap) std::swap(x, y);
    result[a] = cell[corner_of_bits[(x ^ s[0]) + 2 * (y ^ s[1]) + 4 * (corner_bits[a][2] ^ s[2])]];
  }
  return result;
}

std::array<int, 4> sorted_key(Facet facet) {
  std::ranges::sort(facet);
  return facet;
}

double determinant(const Vec3& a, const Vec3& b, const Vec3& c) { return base::dot(a, base::cross(b, c)); }

/// Smallest determinant of the three edges that meet in a corner: the Jacobian there, up to the same factor everywhere.
double smallest_corner_volume(const RawMesh& mesh, const std::array<int, 8>& cell) {
  if (mesh.cell_nodes == 4) {
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
      std::array<int, 8> part{};
      for (int a = 0; a < 4; ++a) part[a] = cell[tetrahedron[a]];
      split.cells.push_back(part);
      split.cell_volume.push_back(mesh.cell_volume[e]);
    }
  }
  const FaceTable faces(split);
  base::require_user(faces.boundary_faces() == 2 * boundary_before,
                     head +
                         "element = \"tet4\": the tetrahedra cut from this mesh's hexahedra do not fit together; "
                         "mesh it with tetrahedra (no Recombine) or use hexahedral elements");
  for (auto& [name, facets] : split.surfaces) {
    std::vector<Facet> triangles;
    for (const auto& [a, b, c, d] : facets) {
      const bool through_ac = faces.find({a, b, c, -1}).cells > 0;
      triangles.push_back(through_ac ? Facet{a, b, c, -1} : Facet{a, b, d, -1});
      triangles.push_back(through_ac ? Facet{a, c, d, -1} : Facet{b, c, d, -1});
    }
    facets = std::move(triangles);
  }
  mesh = std::move(split);
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

FaceTable::FaceTable(const RawMesh& mesh) {
  const int faces = mesh.cell_nodes == 8 ? 6 : 4;
  entries_.reserve(mesh.cells.size() * faces);
  for (const auto& cell : mesh.cells) {
    for (int f = 0; f < faces; ++f) {
      Facet facet{-1, -1, -1, -1};
      const int corners = mesh.cell_nodes == 8 ? 4 : 3;
      for (int a = 0; a < corners; ++a)
        facet[a] = cell[corners == 4 ? hexahedron_faces[f][a] : tetrahedron_faces[f][a]];
      entries_.push_back({sorted_key(facet), facet});
    }
  }
  std::ranges::stable_sort(entries_, {}, &Entry::key);
}

FaceTable::Found FaceTable::find(const Facet& facet) const {
  const auto range = std::ranges::equal_range(entries_, sorted_key(facet), {}, &Entry::key);
  if (range.empty()) return {};
  return {range.front().facet, static_cast<int>(range.size())};
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

}  // namespace fem
