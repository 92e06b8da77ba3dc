#include "fem/recovery.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "fem/faces.hpp"

namespace fem {
namespace {

/// The elements of every node.
class Neighbours {
 public:
  explicit Neighbours(const Mesh& mesh) : start_(mesh.nodes.size() + 1, 0), elements_(mesh.elements.size()) {
    for (const int node : mesh.elements) ++start_[node];
    std::partial_sum(start_.begin(), start_.end(), start_.begin());
    for (std::size_t i = mesh.elements.size(); i-- > 0;)
      elements_[--start_[mesh.elements[i]]] = static_cast<int>(i) / mesh.element_nodes;
  }

  /// Those that have one of the nodes, rising.
  std::vector<int> with(const std::set<int>& nodes) const {
    std::set<int> result;
    for (const int node : nodes) result.insert(elements_.begin() + start_[node], elements_.begin() + start_[node + 1]);
    return {result.begin(), result.end()};
  }

 private:
  std::vector<int> start_, elements_;
};

Recovery recovery_at(const Mesh& mesh, const Neighbours& neighbours, int node) {
  constexpr double determined = 0.01;  // smallest over largest moment of the centres
  std::set<int> nodes{node};
  std::size_t before = 0;
  while (true) {
    const auto elements = neighbours.with(nodes);
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

}  // namespace

Recovery recovery_at(const Mesh& mesh, int node) { return recovery_at(mesh, Neighbours(mesh), node); }

Recovery recovery_over(const Mesh& mesh, const std::vector<Facet>& facets) {
  std::map<int, double> areas, weights;  // of nodes, of elements
  double total = 0;
  for (const auto& facet : facets) {
    for (const auto& node : integrate(mesh, facet)) {
      areas[node.node] += node.area;
      total += node.area;
    }
  }
  const Neighbours neighbours(mesh);
  for (const auto& [node, area] : areas) {
    const auto at = recovery_at(mesh, neighbours, node);
    for (std::size_t i = 0; i < at.elements.size(); ++i) weights[at.elements[i]] += area / total * at.weights[i];
  }
  Recovery result;
  for (const auto& [element, weight] : weights) {
    result.elements.push_back(element);
    result.weights.push_back(weight);
  }
  return result;
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
