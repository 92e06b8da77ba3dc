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

/// Elements of one material, and in how many directions their centres tell a slope: those in which they lie apart by
/// as much as an element is long.
struct Patch {
  static constexpr double determined = 0.4;  // moment of the centres over that of an element's nodes, two layers: 1

  Patch(const Mesh& mesh, std::vector<int> given) : elements(std::move(given)), centres(elements.size(), 3) {
    Eigen::Matrix3d own = Eigen::Matrix3d::Zero();
    for (std::size_t i = 0; i < elements.size(); ++i) {
      const Vec3 centre = mesh.centre(elements[i]);
      centres.row(static_cast<Eigen::Index>(i)) << centre.x, centre.y, centre.z;
      for (int a = 0; a < mesh.element_nodes; ++a) {
        const Vec3 arm = mesh.nodes[mesh.element(elements[i])[a]] - centre;
        const Eigen::Vector3d from(arm.x, arm.y, arm.z);
        own += from * from.transpose();
      }
    }
    mean = centres.colwise().mean();
    centres.rowwise() -= mean;
    const double number = static_cast<double>(elements.size());
    const Eigen::Matrix3d apart = centres.transpose() * centres / number;
    axes.compute(apart, own / (number * mesh.element_nodes));
  }

  bool tells(int axis) const { return axes.eigenvalues()[axis] > determined; }
  int slopes() const { return tells(0) + tells(1) + tells(2); }

  Recovery recovery(const Vec3& place) const {
    const Eigen::Vector3d from = Eigen::Vector3d(place.x, place.y, place.z) - mean.transpose();
    Eigen::VectorXd weights = Eigen::VectorXd::Ones(centres.rows());
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d axis = axes.eigenvectors().col(i);
      if (tells(i)) weights += from.dot(axis) / axes.eigenvalues()[i] * (centres * axis);
    }
    weights /= static_cast<double>(elements.size());
    return {elements, {weights.data(), weights.data() + weights.size()}};
  }

  std::vector<int> elements;
  Eigen::MatrixX3d centres;
  Eigen::RowVector3d mean;
  Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::Matrix3d> axes;
};

Recovery recovery_at(const Mesh& mesh, const Neighbours& neighbours, int node) {
  auto around = neighbours.with({node});
  const int material = mesh.regions[around.front()];
  const auto of_others = [&](int e) { return mesh.regions[e] != material; };
  std::erase_if(around, of_others);
  Patch patch(mesh, around);
  while (patch.slopes() < 3) {  // a ring more, as long as that tells more
    std::set<int> nodes;
    for (const int e : patch.elements) nodes.insert(mesh.element(e), mesh.element(e) + mesh.element_nodes);
    around = neighbours.with(nodes);
    std::erase_if(around, of_others);
    Patch wider(mesh, around);
    if (wider.slopes() <= patch.slopes()) break;
    patch = std::move(wider);
  }
  return patch.recovery(mesh.nodes[node]);
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
