#pragma once
// Grains that are near one plane at rest and near no other wall, as dem/plane_sweep.hpp takes them, and all others that
// are near walls; OpenMP system only.
#include "dem/core/wall_list.hpp"
#include "dem/plane_sweep.hpp"

namespace dem::TRACKBED_DEM_SYSTEM {

class PlaneList {
 public:
  void clear() { *this = {}; }

  /// Sorts the grains of the list. `kinds`: pairs of materials, of a grain and a wall.
  void make(const WallColumns& list, const Walls& walls, const Vector<int>& material, int materials) {
    clear();
    std::vector<std::vector<int>> by_kind(static_cast<std::size_t>(materials) * materials);
    const WallGeometry geometry = walls.geometry();
    for (int w = 0; w < list.near_grains(); ++w) {
      const int c = list.start[w];
      const Facet& facet = geometry.facet[list.candidate[c]];
      const WallRow& wall = geometry.wall[facet.wall];
      const bool alone = list.start[w + 1] == c + 1, rests = !(wall.moves || wall.body || wall.nodal || wall.interface);
      if (alone && facet.node[1] < 0 && rests)
        by_kind[material[list.grain[w]] * materials + wall.material].push_back(w);
      else
        others.push_back(w);
    }
    for (std::size_t kind = 0; kind < by_kind.size(); ++kind) {
      if (by_kind[kind].empty()) continue;
      kinds.push_back(static_cast<int>(kind));
      begin.push_back(static_cast<int>(slot.size()));
      for (const int w : by_kind[kind]) {
        const int c = list.start[w];
        const Facet& facet = geometry.facet[list.candidate[c]];
        const Vec3 normal = geometry.wall[facet.wall].plane_normal;
        row.push_back(list.grain[w]);
        candidate.push_back(c);
        slot.push_back(w);
        plane.push_back({normal, dot(normal, geometry.position[facet.node[0]])});
      }
    }
    begin.push_back(static_cast<int>(slot.size()));
  }

  /// Share number `share` of the contacts; what it calls gets a kind and the range of contacts that are of it.
  template <class Press>
  void each_kind(int share, int shares, const Press& press) const {
    const long long contacts = static_cast<long long>(slot.size());
    const int from = static_cast<int>(contacts * share / shares),
              to = static_cast<int>(contacts * (share + 1) / shares);
    for (std::size_t k = 0; k < kinds.size(); ++k) {
      const int low = std::max(begin[k], from), high = std::min(begin[k + 1], to);
      if (low < high) press(kinds[k], low, high);
    }
  }

  int near_grains() const { return static_cast<int>(slot.size() + others.size()); }
  std::size_t bytes() const {
    return bytes_of(row) + bytes_of(candidate) + bytes_of(slot) + bytes_of(plane) + bytes_of(others);
  }

  Vector<int> row, candidate, slot;  // of each contact, by kind
  Vector<Quad> plane;
  Vector<int> others;             // of the list's grains
  std::vector<int> kinds, begin;  // kinds that there are, and their first contacts
};

}  // namespace dem::TRACKBED_DEM_SYSTEM
