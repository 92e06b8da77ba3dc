#include "fem/blocks.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <set>
#include <type_traits>
#include <utility>

#include "fem/families.hpp"
#include "fem/kernels.hpp"

namespace fem {
namespace {

bool has_avx2() { return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"); }

template <class Element, class Law>
class Block final : public ElementBlock {
 public:
  Block(const BlockInput& input, int element, int law) : law_data_(input.material) {
    lanes_ = input.lanes > 0 ? input.lanes : has_avx2() ? avx2_lanes : portable_lanes;
    kernel_ = lanes_ == avx2_lanes ? avx2_kernel(element, law) : portable_kernel(element, law);
    law_ = &law_data_;
    density_ = input.material.density;
    element_nodes_ = Element::nodes;
    elements_ = static_cast<int>(input.connectivity.size()) / Element::nodes;
    batches_ = (elements_ + lanes_ - 1) / lanes_;
    nodes_.resize(static_cast<std::size_t>(batches_) * lanes_ * Element::nodes);
    geometry_.resize(static_cast<std::size_t>(batches_) * lanes_ * Element::geometry_size);
    node_volume_.resize(static_cast<std::size_t>(elements_) * Element::nodes);
    for (int slot = 0; slot < batches_ * lanes_; ++slot) {
      const int e = std::min(slot, elements_ - 1);  // idle lanes repeat the last element; their forces are dropped
      fill(slot, input.connectivity.data() + static_cast<std::size_t>(e) * Element::nodes, input.nodes);
      if (slot < elements_) {
        double geometry[Element::geometry_size];
        geometry_of(slot, geometry);
        Element::node_volumes(geometry, node_volume_.data() + static_cast<std::size_t>(slot) * Element::nodes);
      }
    }
  }

  void stresses(const double* displacements, std::vector<std::array<double, 6>>& result) const override {
    for (int e = 0; e < elements_; ++e) {
      double u[Element::nodes][3], geometry[Element::geometry_size];
      for (int a = 0; a < Element::nodes; ++a) {
        for (int c = 0; c < 3; ++c) u[a][c] = displacements[3 * static_cast<std::size_t>(node(e, a)) + c];
      }
      geometry_of(e, geometry);
      std::array<double, 6> mean;
      Single<Element, Law>::stress(geometry, law_, u, mean.data());
      result.push_back(mean);
    }
  }

  Largest largest_element_eigenvalue(double worth, std::span<const int> order) const override {
    constexpr int size = 3 * Element::nodes;
    using Matrix = Eigen::Matrix<double, size, size>;
    Largest largest;
    // two invariants of the elements seen: in a structured mesh many elements are alike and need one solution only
    std::set<std::pair<float, float>> done;
    for (const int e : order) {
      Matrix a;
      double geometry[Element::geometry_size], scale[size];
      geometry_of(e, geometry);
      for (int i = 0; i < size; ++i)
        scale[i] = 1 / std::sqrt(density_ * node_volume_[static_cast<std::size_t>(e) * Element::nodes + i / 3]);
      for (int i = 0; i < size; ++i) {
        double u[Element::nodes][3] = {}, f[Element::nodes][3];
        u[i / 3][i % 3] = scale[i];
        Single<Element, Law>::forces(geometry, law_, u, f);
        for (int j = 0; j < size; ++j) a(j, i) = f[j / 3][j % 3] * scale[j];
      }
      const double trace = a.trace();  // no eigenvalue is negative, so none exceeds the sum of all
      if (trace <= std::max(worth, largest.eigenvalue)) continue;
      if (!done.insert({static_cast<float>(trace), static_cast<float>(a.norm())}).second) continue;
      const double value = Eigen::SelfAdjointEigenSolver<Matrix>(a, Eigen::EigenvaluesOnly).eigenvalues()[size - 1];
      if (value > largest.eigenvalue * (1 + alike)) largest = {value, e};
    }
    return largest;
  }

 private:
  int node(int e, int a) const {
    return nodes_[(static_cast<std::size_t>(e / lanes_) * Element::nodes + a) * lanes_ + e % lanes_];
  }

  void geometry_of(int e, double* geometry) const {
    for (int i = 0; i < Element::geometry_size; ++i) {
      geometry[i] =
          geometry_[(static_cast<std::size_t>(e / lanes_) * Element::geometry_size + i) * lanes_ + e % lanes_];
    }
  }

  void fill(int slot, const int* connectivity, std::span<const Vec3> places) {
    double x[Element::nodes][3], geometry[Element::geometry_size];
    const std::size_t batch = slot / lanes_, lane = slot % lanes_;
    for (int a = 0; a < Element::nodes; ++a) {
      nodes_[(batch * Element::nodes + a) * lanes_ + lane] = connectivity[a];
      for (int c = 0; c < 3; ++c) x[a][c] = places[connectivity[a]][c];
    }
    Element::measure(x, geometry);
    for (int i = 0; i < Element::geometry_size; ++i)
      geometry_[(batch * Element::geometry_size + i) * lanes_ + lane] = geometry[i];
  }

  Law law_data_;
};

/// Calls `call` with (place, type tag) for the row of the table whose name it is; false if there is none.
template <class Table, class Call>
bool with_row(const std::string& name, Call&& call) {
  bool found = false;
  [&]<std::size_t... i>(std::index_sequence<i...>) {
    ((name == std::tuple_element_t<i, Table>::name
          ? (call(static_cast<int>(i), std::type_identity<std::tuple_element_t<i, Table>>{}), void(found = true))
          : void()),
     ...);
  }
  (std::make_index_sequence<std::tuple_size_v<Table>>{});
  return found;
}

template <class Table>
std::vector<std::string> names() {
  return []<class... Row>(std::type_identity<std::tuple<Row...>>) {
    return std::vector<std::string>{Row::name...};
  }(std::type_identity<Table>{});
}

}  // namespace

std::unique_ptr<ElementBlock> ElementBlock::make(const BlockInput& input) {
  std::unique_ptr<ElementBlock> block;
  with_row<Elements>(input.element, [&]<class Element>(int element, std::type_identity<Element>) {
    with_row<Laws>(input.material.law, [&]<class Law>(int law, std::type_identity<Law>) {
      block = std::make_unique<Block<Element, Law>>(input, element, law);
    });
  });
  base::require_internal(block != nullptr, "unknown element or law");
  return block;
}

std::vector<std::string> element_names() { return names<Elements>(); }

int element_nodes(const std::string& element) {
  int count = 0;
  with_row<Elements>(element, [&]<class Element>(int, std::type_identity<Element>) { count = Element::nodes; });
  return count;
}

void check_material(const MaterialRegion& material, const std::string& head) {
  const bool found =
      with_row<Laws>(material.law, [&]<class Law>(int, std::type_identity<Law>) { Law::check(material, head); });
  base::require_user(
      found, fmt::format("{}law = \"{}\"; must be one of: {}", head, material.law, fmt::join(names<Laws>(), ", ")));
}

void ElementBlock::add_inner_forces(const double* displacements, double* forces, int first, int last) const {
  kernel_({nodes_.data(), geometry_.data(), law_, displacements, forces, elements_, batches_, first, last});
}

void ElementBlock::add_lumped_mass(double* nodal_mass) const {
  for (int e = 0; e < elements_; ++e) {
    for (int a = 0; a < element_nodes_; ++a) {
      const int node = nodes_[(static_cast<std::size_t>(e / lanes_) * element_nodes_ + a) * lanes_ + e % lanes_];
      nodal_mass[node] += density_ * node_volume_[static_cast<std::size_t>(e) * element_nodes_ + a];
    }
  }
}

}  // namespace fem
