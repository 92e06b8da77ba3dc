#include "fem/rigid_motions.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/text.hpp"

namespace fem {
namespace {

using Six = Eigen::Matrix<double, 6, 1>;
using SixBySix = Eigen::Matrix<double, 6, 6>;

Vec3 axis(int c) { return {c == 0 ? 1.0 : 0.0, c == 1 ? 1.0 : 0.0, c == 2 ? 1.0 : 0.0}; }

/// Parts of the mesh that share no node, numbered by their smallest node.
std::vector<int> parts_of(const Mesh& mesh) {
  std::vector<int> root(mesh.nodes.size());
  std::iota(root.begin(), root.end(), 0);
  const auto find = [&](int node) {
    while (root[node] != node) node = root[node] = root[root[node]];
    return node;
  };
  for (int e = 0; e < mesh.element_count(); ++e) {
    for (int a = 1; a < mesh.element_nodes; ++a) {
      const int i = find(mesh.element(e)[0]), j = find(mesh.element(e)[a]);
      root[std::max(i, j)] = std::min(i, j);
    }
  }
  for (int node = 0; node < static_cast<int>(root.size()); ++node) {
    const int i = find(node), j = find(mesh.unknown_of(node));
    root[std::max(i, j)] = std::min(i, j);
  }
  std::vector<int> part(root.size());
  int count = 0;
  for (int node = 0; node < static_cast<int>(root.size()); ++node)
    part[node] = find(node) == node ? count++ : part[find(node)];
  return part;
}

/// A number as people write it: no -0, no 1e-17.
double tidy(double value, double scale) { return std::abs(value) < 1e-9 * scale ? 0 : value; }

/// Free motions of a part as an orthonormal basis, rotations scaled by `size`; columns are motions.
Eigen::Matrix<double, 6, Eigen::Dynamic> basis_of(const Mechanisms& all, int part, double size) {
  Eigen::Matrix<double, 6, Eigen::Dynamic> basis(6, 0);
  for (const auto& free : all.free) {
    if (free.part != part) continue;
    basis.conservativeResize(6, basis.cols() + 1);
    for (int c = 0; c < 3; ++c) {
      basis(c, basis.cols() - 1) = free.translation[c];
      basis(3 + c, basis.cols() - 1) = size * free.spin[c];
    }
  }
  if (basis.cols() == 0) return basis;
  return Eigen::HouseholderQR<Eigen::MatrixXd>(basis).householderQ() * Eigen::MatrixXd::Identity(6, basis.cols());
}

}  // namespace

Vec3 rigid_motion(int k, const Vec3& from_centre) { return k < 3 ? axis(k) : base::cross(axis(k - 3), from_centre); }

Mechanisms find_mechanisms(const Mesh& mesh, const std::vector<std::array<bool, 3>>& held) {
  Mechanisms result;
  result.part_of_node = parts_of(mesh);
  const int parts = 1 + *std::ranges::max_element(result.part_of_node);
  std::vector<Vec3> centre(parts);
  std::vector<double> count(parts, 0.0), size(parts, 0.0);
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
    centre[result.part_of_node[i]] += mesh.nodes[i];
    count[result.part_of_node[i]] += 1;
  }
  for (int p = 0; p < parts; ++p) centre[p] *= 1 / count[p];
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
    const int p = result.part_of_node[i];
    size[p] = std::max(size[p], base::norm(mesh.nodes[i] - centre[p]));
  }
  std::vector<SixBySix> gram(parts, SixBySix::Zero());
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
    const int p = result.part_of_node[i], other = mesh.unknown_of(static_cast<int>(i));
    const auto motion = [&](int k, const Vec3& x) {
      return rigid_motion(k, x - centre[p]) * (k < 3 ? 1 : 1 / size[p]);
    };
    for (int c = 0; c < 3; ++c) {
      Six row;
      for (int k = 0; k < 6; ++k) row[k] = motion(k, mesh.nodes[i])[c];
      if (held[i][c]) gram[p] += row * row.transpose();
      for (int k = 0; k < 6; ++k) row[k] -= motion(k, mesh.nodes[other])[c];
      gram[p] += row * row.transpose();  // nought unless the node shares the other's motion
    }
  }
  for (int p = 0; p < parts; ++p) {
    const Eigen::SelfAdjointEigenSolver<SixBySix> solver(gram[p]);
    for (int k = 0; k < 6; ++k) {
      if (solver.eigenvalues()[k] > 1e-12 * std::max(1.0, solver.eigenvalues()[5])) continue;
      const Six motion = solver.eigenvectors().col(k);
      result.free.push_back({p,
                             {motion[0], motion[1], motion[2]},
                             Vec3{motion[3], motion[4], motion[5]} * (1 / size[p]),
                             centre[p],
                             size[p]});
    }
  }
  return result;
}

std::string describe(const Mechanisms& all, int part) {
  const auto first = std::ranges::find(all.free, part, &Mechanism::part);
  if (first == all.free.end()) return "none";
  const double size = first->size;
  const Vec3 centre = first->centre;
  const auto basis = basis_of(all, part, size);
  std::vector<std::string> words;
  std::vector<Six> named;
  for (int c = 0; c < 3; ++c) {
    Six motion = Six::Zero();
    motion[c] = 1;
    if ((motion - basis * (basis.transpose() * motion)).norm() > 1e-6) continue;
    words.push_back(fmt::format("translation along {}", "xyz"[c]));
    named.push_back(motion);
  }
  for (int c = 0; c < 3; ++c) {
    // a free motion whose rotation is about this axis: the axis passes where its translation leaves it
    const Eigen::MatrixXd rotations = basis.bottomRows(3);
    const Eigen::Vector3d wanted = Eigen::Vector3d::Unit(c) * size;
    const Eigen::VectorXd shares = rotations.completeOrthogonalDecomposition().solve(wanted);
    if ((rotations * shares - wanted).norm() > 1e-6 * size) continue;
    const Six motion = basis * shares;
    const Vec3 through = centre + base::cross(axis(c), Vec3{motion[0], motion[1], motion[2]});
    words.push_back(fmt::format("rotation about {} through ({:.4g}, {:.4g}, {:.4g}) m", "xyz"[c], tidy(through.x, size),
                                tidy(through.y, size), tidy(through.z, size)));
    named.push_back(motion);
  }
  Eigen::MatrixXd span(6, named.size());
  for (std::size_t i = 0; i < named.size(); ++i) span.col(static_cast<Eigen::Index>(i)) = named[i].normalized();
  const auto rank = named.empty() ? 0 : Eigen::ColPivHouseholderQR<Eigen::MatrixXd>(span).setThreshold(1e-6).rank();
  if (rank < basis.cols()) words.push_back("a motion along no coordinate axis");
  return base::join(words);
}

}  // namespace fem
