#include "fem/hinges.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "base/text.hpp"
#include "fem/rigid_motions.hpp"

namespace fem {
namespace {

using Six = Eigen::Matrix<double, 6, 1>;
using SixBySix = Eigen::Matrix<double, 6, 6>;
using Rows = Eigen::Matrix<double, 3, 6>;  // displacement at a place by the six motions of a part
constexpr double nought = 1e-12;           // of the largest eigenvalue

struct Part {
  Hinge::Side side;
  Vec3 lower{INFINITY, INFINITY, INFINITY}, upper = -lower;
  double size = 1;                    // [m] half the diagonal of the box
  SixBySix held = SixBySix::Zero();   // motions that supports, and its own nodes across a seam, keep it from
  int group = 0;                      // connected mesh that it belongs to
  Rows at(const Vec3& place) const {  // rotations scaled by the size
    Rows rows;
    for (int k = 0; k < 6; ++k) {
      const Vec3 u = rigid_motion(k, place - side.centre) * (k < 3 ? 1 : 1 / size);
      rows.col(k) << u.x, u.y, u.z;
    }
    return rows;
  }
};

struct Touch {  // a node of a part
  int part, node;
  auto operator<=>(const Touch&) const = default;
};
using Touches = std::map<int, std::vector<Touch>>;  // by unknown, where several nodes of parts meet

/// Cells by part, and where parts meet.
class Parts {
 public:
  explicit Parts(const Mesh& mesh) : mesh_(mesh), of_cell_(mesh.rigid_parts) {
    while (merge(meet())) {
    }
  }
  int count() const { return *std::ranges::max_element(of_cell_) + 1; }
  int of_cell(int e) const { return of_cell_[e]; }

  /// Where nodes of several parts, or several nodes of one part, share their unknowns.
  Touches meet() const {
    const int corners = cell_corners(mesh_.element_nodes);
    const auto each_corner = [&](auto&& call) {
      for (int e = 0; e < mesh_.element_count(); ++e) {
        for (int a = 0; a < corners; ++a)
          call(mesh_.unknown_of(mesh_.element(e)[a]), Touch{of_cell_[e], mesh_.element(e)[a]});
      }
    };
    std::vector<Touch> first(mesh_.nodes.size(), {-1, -1});
    std::vector<char> several(mesh_.nodes.size(), 0);
    each_corner([&](int unknown, const Touch& touch) {
      if (first[unknown].part < 0) first[unknown] = touch;
      several[unknown] |= first[unknown] != touch;
    });
    Touches touches;
    each_corner([&](int unknown, const Touch& touch) {
      if (several[unknown]) touches[unknown].push_back(touch);
    });
    for (auto& [unknown, all] : touches) {
      std::ranges::sort(all);
      all.erase(std::unique(all.begin(), all.end()), all.end());
    }
    return touches;
  }

 private:
  /// Makes one of parts that share three corners off a line; false: there are none.
  bool merge(const Touches& touches) {
    std::map<std::pair<int, int>, std::vector<int>> shared;
    for (const auto& [unknown, all] : touches) {
      for (std::size_t i = 0; i < all.size(); ++i) {
        for (std::size_t j = i + 1; j < all.size(); ++j) {
          if (all[i].node == all[j].node) shared[{all[i].part, all[j].part}].push_back(all[i].node);
        }
      }
    }
    std::vector<int> root(count());
    std::iota(root.begin(), root.end(), 0);
    const auto find = [&](int part) {
      while (root[part] != part) part = root[part];
      return part;
    };
    bool merged = false;
    for (const auto& [pair, nodes] : shared) {
      if (on_a_line(nodes)) continue;
      const int i = find(pair.first), j = find(pair.second);
      root[std::max(i, j)] = std::min(i, j);
      merged = true;
    }
    if (!merged) return false;
    std::vector<int> number(root.size());
    int next = 0;
    for (int part = 0; part < static_cast<int>(root.size()); ++part)
      number[part] = find(part) == part ? next++ : number[find(part)];
    for (int& part : of_cell_) part = number[part];
    return true;
  }

  bool on_a_line(const std::vector<int>& nodes) const {
    const Vec3 origin = mesh_.nodes[nodes.front()];
    Vec3 along;
    for (const int node : nodes) {
      if (base::norm(mesh_.nodes[node] - origin) > base::norm(along)) along = mesh_.nodes[node] - origin;
    }
    return std::ranges::all_of(nodes, [&](int node) {
      return base::norm(base::cross(mesh_.nodes[node] - origin, along)) <= 1e-6 * base::norm2(along);
    });
  }

  const Mesh& mesh_;
  std::vector<int> of_cell_;
};

/// Turned into the projection on its range: what holds counts, not how many nodes do.
SixBySix range_of(const SixBySix& gram) {
  const Eigen::SelfAdjointEigenSolver<SixBySix> solver(gram);
  SixBySix projection = SixBySix::Zero();
  for (int k = 0; k < 6; ++k) {
    if (solver.eigenvalues()[k] <= nought * std::max(1.0, solver.eigenvalues()[5])) continue;
    projection += solver.eigenvectors().col(k) * solver.eigenvectors().col(k).transpose();
  }
  return projection;
}

std::vector<Part> measure(const Mesh& mesh, const Parts& parts, const Touches& touches, const Mechanisms& whole,
                          const std::vector<std::array<bool, 3>>& held) {
  std::vector<Part> result(parts.count());
  for (int e = 0; e < mesh.element_count(); ++e) {
    Part& part = result[parts.of_cell(e)];
    ++part.side.cells;
    part.group = whole.part_of_node[mesh.element(e)[0]];
    for (int a = 0; a < mesh.element_nodes; ++a) {
      const Vec3& x = mesh.nodes[mesh.element(e)[a]];
      for (int c = 0; c < 3; ++c) {
        part.lower[c] = std::min(part.lower[c], x[c]);
        part.upper[c] = std::max(part.upper[c], x[c]);
      }
    }
  }
  for (auto& part : result) {
    part.side.centre = (part.lower + part.upper) * 0.5;
    part.size = 0.5 * base::norm(part.upper - part.lower);
  }
  for (int e = 0; e < mesh.element_count(); ++e) {
    Part& part = result[parts.of_cell(e)];
    for (int a = 0; a < mesh.element_nodes; ++a) {
      const int node = mesh.element(e)[a];
      if (!held[node][0] && !held[node][1] && !held[node][2]) continue;
      const Rows rows = part.at(mesh.nodes[node]);
      for (int c = 0; c < 3; ++c) {
        if (held[node][c]) part.held += rows.row(c).transpose() * rows.row(c);
      }
    }
  }
  for (const auto& [unknown, all] : touches) {
    for (std::size_t i = 1; i < all.size(); ++i) {
      if (all[i].part != all[i - 1].part) continue;
      Part& part = result[all[i].part];
      const Rows rows = part.at(mesh.nodes[all[i].node]) - part.at(mesh.nodes[all[i - 1].node]);
      part.held += rows.transpose() * rows;
    }
  }
  for (auto& part : result) part.held = range_of(part.held);
  return result;
}

/// One connected mesh: its parts, and its free motions as columns, six numbers per part.
class Cluster {
 public:
  Cluster(const Mesh& mesh, const std::vector<Part>& parts, const Touches& touches, int group)
      : mesh_(mesh), parts_(parts), place_(parts.size(), -1) {
    for (int p = 0; p < static_cast<int>(parts.size()); ++p) {
      if (parts[p].group != group) continue;
      place_[p] = static_cast<int>(members_.size());
      members_.push_back(p);
    }
    for (const auto& [unknown, all] : touches) {
      if (place_[all.front().part] >= 0) touches_.push_back(all);
    }
  }
  bool is_one() const { return members_.size() < 2; }
  bool is_large() const { return members_.size() > most_parts; }

  void find_motions() {
    if (is_large()) return find_motions_of_single_parts();
    const auto size = static_cast<Eigen::Index>(6 * members_.size());
    Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(size, size);
    for (std::size_t i = 0; i < members_.size(); ++i) gram.block<6, 6>(6 * i, 6 * i) = parts_[members_[i]].held;
    for (const auto& all : touches_) {
      for (std::size_t i = 1; i < all.size(); ++i) {
        if (all[i].part == all[0].part) continue;
        const Rows one = parts_[all[0].part].at(mesh_.nodes[all[0].node]);
        const Rows other = parts_[all[i].part].at(mesh_.nodes[all[i].node]);
        const int p = 6 * place_[all[0].part], q = 6 * place_[all[i].part];
        gram.block<6, 6>(p, p) += one.transpose() * one;
        gram.block<6, 6>(q, q) += other.transpose() * other;
        gram.block<6, 6>(p, q) -= one.transpose() * other;
        gram.block<6, 6>(q, p) -= other.transpose() * one;
      }
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(gram);
    Eigen::Index count = 0;  // eigenvalues rise
    while (count < size && solver.eigenvalues()[count] <= nought * std::max(1.0, solver.eigenvalues()[size - 1]))
      ++count;
    motions_ = solver.eigenvectors().leftCols(count);
  }
  int motions() const { return static_cast<int>(motions_.cols()); }

  /// Joints of two parts that some motion turns.
  std::vector<Hinge> hinges() const {
    std::map<std::pair<int, int>, std::vector<int>> shared;
    for (const auto& all : touches_) {
      for (std::size_t i = 0; i < all.size(); ++i) {
        for (std::size_t j = i + 1; j < all.size(); ++j) {
          if (all[i].node == all[j].node) shared[{all[i].part, all[j].part}].push_back(all[i].node);
        }
      }
    }
    std::vector<Hinge> found;
    for (const auto& [pair, nodes] : shared) {
      const Part &one = parts_[pair.first], &other = parts_[pair.second];
      const Eigen::MatrixXd turn =
          std::min(one.size, other.size) * (spin(pair.second) / other.size - spin(pair.first) / one.size);
      const Eigen::JacobiSVD<Eigen::MatrixXd> values(turn, Eigen::ComputeThinU);
      Hinge hinge{.from = mesh_.nodes[nodes.front()],
                  .to = mesh_.nodes[nodes.front()],
                  .axes = {},
                  .first = one.side,
                  .second = other.side};
      for (int k = 0; k < values.singularValues().size(); ++k) {
        const auto axis = values.matrixU().col(k);
        if (values.singularValues()[k] > 1e-7) hinge.axes.push_back({axis[0], axis[1], axis[2]});
      }
      if (hinge.axes.empty()) continue;
      span(nodes, hinge);
      found.push_back(hinge);
    }
    return found;
  }

 private:
  Eigen::MatrixXd spin(int part) const { return motions_.middleRows(6 * place_[part] + 3, 3); }

  /// Each part on its own, the others at rest.
  void find_motions_of_single_parts() {
    std::vector<SixBySix> gram;
    for (const int part : members_) gram.push_back(parts_[part].held);
    for (const auto& all : touches_) {
      if (all.front().part == all.back().part) continue;
      for (const auto& [part, node] : all) {
        const Rows rows = parts_[part].at(mesh_.nodes[node]);
        gram[place_[part]] += rows.transpose() * rows;
      }
    }
    motions_.resize(static_cast<Eigen::Index>(6 * members_.size()), 0);
    for (std::size_t i = 0; i < members_.size(); ++i) {
      const SixBySix free = SixBySix::Identity() - range_of(gram[i]);
      const Eigen::SelfAdjointEigenSolver<SixBySix> solver(free);
      for (int k = 0; k < 6; ++k) {
        if (solver.eigenvalues()[k] < 0.5) continue;
        motions_.conservativeResize(Eigen::NoChange, motions_.cols() + 1);
        motions_.rightCols<1>().setZero();
        motions_.rightCols<1>().segment<6>(6 * i) = solver.eigenvectors().col(k);
      }
    }
  }

  /// The ends of the edge through these nodes, and its axis.
  void span(const std::vector<int>& nodes, Hinge& hinge) const {
    const auto farthest = [&](const Vec3& from) {
      return mesh_
          .nodes[*std::ranges::max_element(nodes, {}, [&](int node) { return base::norm(mesh_.nodes[node] - from); })];
    };
    hinge.to = farthest(hinge.from);
    hinge.from = farthest(hinge.to);
    const bool single = hinge.axes.size() == 1;
    if (hinge.is_edge() && single) hinge.axes = {(hinge.to - hinge.from) * (1 / base::norm(hinge.to - hinge.from))};
    const Vec3& axis = hinge.axes.front();
    const double sign = std::abs(axis.x) > 1e-9 ? axis.x : std::abs(axis.y) > 1e-9 ? axis.y : axis.z;
    if (!single || sign > 0) return;
    std::swap(hinge.from, hinge.to);
    hinge.axes.front() *= -1;
  }

  const Mesh& mesh_;
  const std::vector<Part>& parts_;
  std::vector<int> place_, members_;  // number in this mesh of each part, -1: elsewhere; the parts
  std::vector<std::vector<Touch>> touches_;
  Eigen::MatrixXd motions_;
};

}  // namespace

Hinges find_hinges(const Mesh& mesh, const std::vector<std::array<bool, 3>>& held) {
  Hinges result;
  if (mesh.rigid_parts.empty()) return result;
  const Parts parts(mesh);
  const auto touches = parts.meet();
  if (parts.count() == 1) return result;
  const auto whole = find_mechanisms(mesh, held);
  const auto measured = measure(mesh, parts, touches, whole, held);
  std::vector<int> groups;
  for (const auto& part : measured) groups.push_back(part.group);
  std::ranges::sort(groups);
  groups.erase(std::unique(groups.begin(), groups.end()), groups.end());
  for (const int number : groups) {
    Cluster group(mesh, measured, touches, number);
    if (group.is_one()) continue;
    group.find_motions();
    const auto of_the_whole = group.is_large() ? 0 : std::ranges::count(whole.free, number, &Mechanism::part);
    const int motions = group.motions() - static_cast<int>(of_the_whole);
    if (motions <= 0) continue;
    result.motions += motions;
    const auto hinges = group.hinges();
    result.joints.insert(result.joints.end(), hinges.begin(), hinges.end());
  }
  return result;
}

std::string describe(const Hinges& hinges) {
  if (hinges.motions == 0) return "";
  if (hinges.joints.empty()) return "its parts can slide against each other across a periodic seam";
  const Hinge& hinge = hinges.joints.front();
  const auto place = [](const Vec3& x, double size) {
    const auto tidy = [&](double value) { return std::abs(value) < 1e-9 * size ? 0.0 : value; };
    return fmt::format("({:.6g}, {:.6g}, {:.6g})", tidy(x.x), tidy(x.y), tidy(x.z));
  };
  const double size = base::norm(hinge.first.centre - hinge.second.centre);
  const auto side = [&](const Hinge::Side& of) {
    return fmt::format("{} cell{} round {} m", of.cells, of.cells == 1 ? "" : "s", place(of.centre, size));
  };
  std::string joint = fmt::format("the node at {} m", place(hinge.from, size)), about = "any axis through it";
  if (hinge.is_edge()) joint = fmt::format("the edge from {} to {} m", place(hinge.from, size), place(hinge.to, size));
  if (hinge.axes.size() < 3) {
    std::vector<std::string> axes;
    for (const Vec3& axis : hinge.axes) axes.push_back(place(axis, 1));
    about = axes.size() == 1 ? "the axis " + axes[0] : "the axes " + base::join(axes);
  }
  const auto more = hinges.joints.size() - 1;
  return fmt::format(
      "{} and {} share no more than {} and turn against each other about {}{}", side(hinge.first), side(hinge.second),
      joint, about, more == 0 ? "" : fmt::format(", as others do at {} more such joint{}", more, more == 1 ? "" : "s"));
}

}  // namespace fem
