#pragma once
// Which nodes of a skin the grains of one DEM part may need: those of all facets, and of the faces of the second order
// that these are parts of, that reach into an interval along x. It is counted on the undeformed skin, which every rank
// has, so that both ends of a pair find the same nodes from two numbers; how far the skin has moved along x goes into
// the interval.
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "base/skin.hpp"
#include "coupling/bytes.hpp"
#include "coupling/window.hpp"

namespace coupling {

/// Along x [m]; low > high: nothing.
struct Interval {
  double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();
  bool operator==(const Interval&) const = default;
  void include(double x) {
    low = x < low ? x : low;
    high = x > high ? x : high;
  }
};
constexpr Interval everything{-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};

/// What all ends of the exchange know of the skins.
struct Interface {
  std::vector<base::Skin> skins;
  std::vector<std::vector<std::vector<int>>> owned;  // per FEM rank, per skin: its nodes
  CouplingSettings settings;
};

/// How far along x the facets and faces with each node reach, undeformed.
std::vector<Interval> reaches_of_nodes(const base::Skin&);

/// The nodes that one pair of ranks shares, by their places in the list of those that the FEM rank owns.
struct SharedNodes {
  std::vector<int> all, fresh;  // fresh: not shared in the window before
};
/// `now`, `before`: the part's interval of the coming window and of the one before.
SharedNodes shared_nodes(std::span<const Interval> reaches, std::span<const int> owned, const Interval& now,
                         const Interval& before);

}  // namespace coupling
