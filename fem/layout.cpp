#include "fem/layout.hpp"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <span>

namespace fem {
namespace {

struct Item {
  Vec3 centre;
  int body, element;
  std::uint64_t place;  // along the space-filling curve
  double work;          // in element-force evaluations of a tetrahedron
  int rank = 0;
};

struct Bounds {
  Vec3 lower{1e300, 1e300, 1e300}, upper{-1e300, -1e300, -1e300};
  void take(const Vec3& x) {
    for (int c = 0; c < 3; ++c) {
      lower[c] = std::min(lower[c], x[c]);
      upper[c] = std::max(upper[c], x[c]);
    }
  }
};

std::uint64_t spread(std::uint64_t v) {  // 21 bits, two zeros between each
  v &= 0x1fffff;
  v = (v | v << 32) & 0x1f00000000ffff;
  v = (v | v << 16) & 0x1f0000ff0000ff;
  v = (v | v << 8) & 0x100f00f00f00f00f;
  v = (v | v << 4) & 0x10c30c30c30c30c3;
  v = (v | v << 2) & 0x1249249249249249;
  return v;
}

std::uint64_t morton(const Vec3& x, const Bounds& bounds) {
  std::uint64_t code = 0;
  double longest = 0;
  for (int c = 0; c < 3; ++c) longest = std::max(longest, bounds.upper[c] - bounds.lower[c]);
  for (int c = 0; c < 3; ++c) {
    const double share = longest > 0 ? (x[c] - bounds.lower[c]) / longest : 0;
    code |= spread(static_cast<std::uint64_t>(share * 0x1ffffe)) << c;
  }
  return code;
}

/// All elements: body by body, along a space-filling curve.
std::vector<Item> sorted_items(const std::vector<Mesh>& meshes) {
  std::vector<Item> items;
  for (int b = 0; b < static_cast<int>(meshes.size()); ++b) {
    const Mesh& mesh = meshes[b];
    Bounds bounds;
    for (const auto& node : mesh.nodes) bounds.take(node);
    const int nodes = mesh.element_nodes;
    const double work = nodes == 20 ? 24 : nodes == 10 ? 6 : nodes == 8 ? 8 : 1;
    for (int e = 0; e < mesh.element_count(); ++e) {
      const Vec3 centre = mesh.centre(e);
      items.push_back({centre, b, e, morton(centre, bounds), work});
    }
  }
  std::ranges::sort(items, [](const Item& a, const Item& b) {
    return std::tie(a.body, a.place, a.element) < std::tie(b.body, b.place, b.element);
  });
  return items;
}

void bisect(std::span<Item*> items, int first_rank, int ranks) {
  if (ranks == 1) {
    for (Item* item : items) item->rank = first_rank;
    return;
  }
  Bounds bounds;
  double total = 0;
  for (const Item* item : items) {
    bounds.take(item->centre);
    total += item->work;
  }
  int axis = 0;
  for (int c = 1; c < 3; ++c) {
    if (bounds.upper[c] - bounds.lower[c] > bounds.upper[axis] - bounds.lower[axis]) axis = c;
  }
  std::ranges::stable_sort(items, [axis](const Item* a, const Item* b) { return a->centre[axis] < b->centre[axis]; });
  const int left_ranks = ranks / 2;
  const double target = total * left_ranks / ranks;
  double sum = 0;
  std::size_t cut = 0;
  while (cut < items.size() && sum + 0.5 * items[cut]->work < target) sum += items[cut++]->work;
  bisect(items.first(cut), first_rank, left_ranks);
  bisect(items.subspan(cut), first_rank + left_ranks, ranks - left_ranks);
}

}  // namespace

Layout::Layout(MPI_Comm communicator, const std::vector<Mesh>& meshes) : comm(communicator) {
  MPI_Comm_rank(comm, &rank);
  MPI_Comm_size(comm, &ranks);
  const int bodies = static_cast<int>(meshes.size());
  first_node.assign(1, 0);
  for (const auto& mesh : meshes) first_node.push_back(first_node.back() + static_cast<int>(mesh.nodes.size()));

  for (std::size_t b = 0; b < meshes.size(); ++b) {
    for (int node = 0; node < static_cast<int>(meshes[b].nodes.size()); ++node)
      unknown_of_global.push_back(first_node[b] + meshes[b].unknown_of(node));
  }

  auto items = sorted_items(meshes);
  std::vector<Item*> pointers;
  for (auto& item : items) pointers.push_back(&item);
  bisect(pointers, 0, ranks);

  std::vector<int> owner(global_count(), ranks);
  const auto each_node = [&](const Item& item, auto&& call) {
    const Mesh& mesh = meshes[item.body];
    for (int a = 0; a < mesh.element_nodes; ++a) call(first_node[item.body] + mesh.element(item.element)[a]);
  };
  for (const auto& item : items) {
    each_node(item, [&](int node) {
      int& of = owner[unknown_of_global[node]];
      of = std::min(of, item.rank);
    });
  }

  std::vector<int> next(ranks + 1, 0);  // next free petsc number of each rank
  for (int node = 0; node < global_count(); ++node) {
    if (unknown_of_global[node] == node) ++next[owner[node] + 1];
  }
  std::partial_sum(next.begin(), next.end(), next.begin());
  const int first_petsc = next[rank];
  owned = next[rank + 1] - next[rank];
  petsc_of_global.assign(global_count(), -1);
  for (const auto& item : items) {
    each_node(item, [&](int node) {
      int& number = petsc_of_global[unknown_of_global[node]];
      if (owner[unknown_of_global[node]] == item.rank && number < 0) number = next[item.rank]++;
    });
  }
  for (int node = 0; node < global_count(); ++node) petsc_of_global[node] = petsc_of_global[unknown_of_global[node]];

  local_of_global.assign(global_count(), -1);
  global_of_local.assign(owned, -1);
  elements.resize(bodies);
  std::vector<int> ghost_nodes;
  for (int node = 0; node < global_count(); ++node) {
    if (owner[node] != rank || unknown_of_global[node] != node) continue;
    local_of_global[node] = petsc_of_global[node] - first_petsc;
    global_of_local[local_of_global[node]] = node;
  }
  for (const auto& item : items) {
    if (item.rank != rank) continue;
    elements[item.body].push_back(item.element);
    each_node(item, [&](int node) {
      if (owner[node] != rank || unknown_of_global[node] != node) ghost_nodes.push_back(node);
    });
  }
  for (auto& own : elements) own.shrink_to_fit();
  std::ranges::sort(ghost_nodes, {}, [&](int node) { return std::pair{petsc_of_global[node], node}; });
  ghost_nodes.erase(std::unique(ghost_nodes.begin(), ghost_nodes.end()), ghost_nodes.end());
  for (const int node : ghost_nodes) {
    local_of_global[node] = local_count();
    global_of_local.push_back(node);
    ghosts.push_back(petsc_of_global[node]);
  }
  first_owned.assign(bodies + 1, 0);
  for (int i = 0; i < owned; ++i) {
    const auto body = std::ranges::upper_bound(first_node, global_of_local[i]) - first_node.begin();  // one past
    ++first_owned[body];
  }
  std::partial_sum(first_owned.begin(), first_owned.end(), first_owned.begin());
}

std::vector<int> Layout::owned_nodes(int body, std::span<const int> nodes) const {
  std::vector<int> result;
  for (const int node : nodes) {
    if (const int local = owned_node(body, node); local >= 0) result.push_back(local);
  }
  std::ranges::sort(result);
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return result;
}

}  // namespace fem
