#include "fem/periodic.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

#include "base/error.hpp"

namespace fem {
namespace {

struct Box {
  Vec3 lower{1e300, 1e300, 1e300}, upper{-1e300, -1e300, -1e300};
};

Box box_of(const Mesh& mesh, const std::vector<int>& nodes) {
  Box box;
  for (const int node : nodes) {
    for (int c = 0; c < 3; ++c) {
      box.lower[c] = std::min(box.lower[c], mesh.nodes[node][c]);
      box.upper[c] = std::max(box.upper[c], mesh.nodes[node][c]);
    }
  }
  return box;
}

/// Nodes of a group sorted along a line that no regular mesh is aligned with.
class Finder {
 public:
  Finder(const Mesh& mesh, const std::vector<int>& nodes) : mesh_(mesh) {
    for (const int node : nodes) sorted_.emplace_back(place(mesh.nodes[node]), node);
    std::ranges::sort(sorted_);
  }
  /// The node within `tolerance` of a point, or -1.
  int at(const Vec3& point, double tolerance) const {
    auto next = std::ranges::lower_bound(sorted_, std::pair{place(point) - tolerance, -1});
    for (; next != sorted_.end() && next->first <= place(point) + tolerance; ++next)
      if (base::norm(mesh_.nodes[next->second] - point) <= tolerance) return next->second;
    return -1;
  }

 private:
  static double place(const Vec3& x) { return 0.259 * x.x + 0.541 * x.y + 0.8 * x.z; }  // shorter than x
  const Mesh& mesh_;
  std::vector<std::pair<double, int>> sorted_;
};

struct Faces {
  const Group &first, &second;
  Vec3 shift;        // [m] from the first to the second
  double tolerance;  // [m]
};

Faces find_faces(const Mesh& mesh, const Body& body, const PeriodicFaces& faces) {
  const Group& first = find_group(mesh, body, faces.origin, "periodic.first", faces.first);
  const Group& second = find_group(mesh, body, faces.origin, "periodic.second", faces.second);
  const std::string head = message_head(faces.origin, body.name);
  for (const auto& [key, name, group] :
       {std::tuple{"first", faces.first, &first}, std::tuple{"second", faces.second, &second}}) {
    base::require_user(
        !group->facets.empty() && group->outside,
        fmt::format("{}periodic.{} = \"{}\" is not an outer surface of the body; name a physical surface that is", head,
                    key, name));
  }
  const Box from = box_of(mesh, first.nodes), to = box_of(mesh, second.nodes);
  const Vec3 shift = to.lower - from.lower;
  const double tolerance = 1e-6 * std::max(base::norm(shift), base::norm(from.upper - from.lower));
  base::require_user(base::norm(shift) > tolerance,
                     fmt::format("{}periodic.second = \"{}\" lies where periodic.first = \"{}\" does; name two "
                                 "opposite faces",
                                 head, faces.second, faces.first));
  return {first, second, shift, tolerance};
}

[[noreturn]] void refuse(const Mesh& mesh, const Body& body, const PeriodicFaces& faces, int node, bool of_first,
                         const Vec3& partner) {
  const Vec3& x = mesh.nodes[node];
  throw base::UserError(fmt::format(
      "{}node {} of periodic.{} = \"{}\" at ({:.6g}, {:.6g}, {:.6g}) m has no partner at ({:.6g}, {:.6g}, {:.6g}) m in "
      "\"{}\"; mesh both faces alike (transfinite, or Periodic Surface in the .geo)",
      message_head(faces.origin, body.name), node + 1, of_first ? "first" : "second",
      of_first ? faces.first : faces.second, x.x, x.y, x.z, partner.x, partner.y, partner.z,
      of_first ? faces.second : faces.first));
}

}  // namespace

Vec3 shift_of(const Mesh& mesh, const Body& body, const PeriodicFaces& faces) {
  return find_faces(mesh, body, faces).shift;
}

std::vector<int> tie_periodic_faces(const Mesh& mesh, const Body& body) {
  if (body.periodic.empty()) return {};
  std::vector<int> root(mesh.nodes.size());
  std::iota(root.begin(), root.end(), 0);
  const auto find = [&](int node) {
    while (root[node] != node) node = root[node] = root[root[node]];
    return node;
  };
  for (const auto& faces : body.periodic) {
    const auto [first, second, shift, tolerance] = find_faces(mesh, body, faces);
    const Finder in_first(mesh, first.nodes), in_second(mesh, second.nodes);
    for (const int node : second.nodes) {
      const Vec3 wanted = mesh.nodes[node] - shift;
      if (in_first.at(wanted, tolerance) < 0) refuse(mesh, body, faces, node, false, wanted);
    }
    for (const int node : first.nodes) {
      const Vec3 wanted = mesh.nodes[node] + shift;
      const int partner = in_second.at(wanted, tolerance);
      if (partner < 0) refuse(mesh, body, faces, node, true, wanted);
      const int i = find(node), j = find(partner);
      root[std::max(i, j)] = std::min(i, j);
    }
  }
  for (int node = 0; node < static_cast<int>(root.size()); ++node) root[node] = find(node);
  return root;
}

}  // namespace fem
