#include "coupling/skin_share.hpp"

namespace coupling {

std::vector<Interval> reaches_of_nodes(const base::Skin& skin) {
  std::vector<Interval> reaches(skin.nodes.size());
  const auto add = [&](std::span<const int> nodes, double beyond) {
    Interval of;
    for (const int node : nodes)
      if (node >= 0) of.include(skin.nodes[static_cast<std::size_t>(node)].x);
    const double more = beyond * (of.high - of.low);
    for (const int node : nodes) {
      if (node < 0) continue;
      reaches[static_cast<std::size_t>(node)].include(of.low - more);
      reaches[static_cast<std::size_t>(node)].include(of.high + more);
    }
  };
  for (const auto& facet : skin.facets) add(facet, 0);
  constexpr double bulge = 0.5;  // of its length: a curved face may go beyond its nodes
  for (const auto& face : skin.faces) add(face, bulge);
  return reaches;
}

SharedNodes shared_nodes(std::span<const Interval> reaches, std::span<const int> owned, const Interval& now,
                         const Interval& before) {
  const auto is_in = [](const Interval& reach, const Interval& wanted) {
    return reach.low <= wanted.high && reach.high >= wanted.low;
  };
  SharedNodes shared;
  for (std::size_t k = 0; k < owned.size(); ++k) {
    const Interval& reach = reaches[static_cast<std::size_t>(owned[k])];
    if (!is_in(reach, now)) continue;
    shared.all.push_back(static_cast<int>(k));
    if (!is_in(reach, before)) shared.fresh.push_back(static_cast<int>(k));
  }
  return shared;
}

}  // namespace coupling
