#include "fem/recovery.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <set>

namespace fem {
namespace {

/// Elements that have one of the nodes.
std::vector<int> elements_with(const Mesh& mesh, const std::set<int>& nodes) {
  std::vector<int> result;
  for (int e = 0; e < mesh.element_count(); ++e) {
    const int* first = mesh.element(e);
    if (std::any_of(first, first + mesh.element_nodes, [&](int node) { return nodes.count(node) > 0; }))
      result.push_back(e);
  }
  return result;
}

}  // namespace

Recovery recovery_at(const Mesh& mesh, int node) {
  constexpr double determined = 0.01;  // smallest over largest moment of the centres
  std::set<int> nodes{node};
  std::size_t before = 0;
  while (true) {
    const auto elements = elements_with(mesh, nodes);
    Eigen::MatrixX3d centres(elements.size(), 3);
    for (std::size_t i = 0; i < elements.size(); ++i) {
      const Vec3 centre = mesh.centre(elements[i]);
      centres.row(static_cast<Eigen::Index>(i)) << centre.x, centre.y, centre.z;
    }
    const Eigen::RowVector3d mean = centres.colwise().mean();
    centres.rowwise() -= mean;
    const Eigen::Matrix3d moments = centres.transpose() * centres;
    const Eigen::Vector3d sizes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(moments).eigenvalues();
    if (sizes[0] > determined * sizes[2] || elements.size() == before) {
      const Vec3& place = mesh.nodes[node];
      const Eigen::Vector3d from = Eigen::Vector3d(place.x, place.y, place.z) - mean.transpose();
      const Eigen::CompleteOrthogonalDecomposition<Eigen::Matrix3d> inverse(moments);
      const Eigen::VectorXd weights =
          (centres * inverse.solve(from)).array() + 1 / static_cast<double>(elements.size());
      return {elements, {weights.data(), weights.data() + weights.size()}};
    }
    before = elements.size();
    for (const int e : elements) nodes.insert(mesh.element(e), mesh.element(e) + mesh.element_nodes);
  }
}

double von_mises(const std::array<double, 6>& s) {
  const double xy = s[0] - s[1], yz = s[1] - s[2], zx = s[2] - s[0];
  return std::sqrt(0.5 * (xy * xy + yz * yz + zx * zx) + 3 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]));
}

std::array<double, 3> principal(const std::array<double, 6>& s) {
  Eigen::Matrix3d tensor;
  tensor << s[0], s[3], s[5], s[3], s[1], s[4], s[5], s[4], s[2];
  const Eigen::Vector3d values =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(tensor, Eigen::EigenvaluesOnly).eigenvalues();
  return {values[2], values[1], values[0]};
}

}  // namespace fem
