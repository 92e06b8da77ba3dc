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
#include "fem/response.hpp"

namespace fem {
namespace {

/// Places in the tables of families.hpp.
struct Rows {
  int element = -1, law = -1, linear_law = -1;
};

bool has_avx2() { return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"); }

template <class Element, class Law>
class Block final : public ElementBlock {
 public:
  Block(const BlockInput& input, const Rows& rows) : law_data_(input.material), spring_data_(input.material) {
    lanes_ = input.lanes > 0 ? input.lanes : has_avx2() ? avx2_lanes : portable_lanes;
    const auto kernel = lanes_ == avx2_lanes ? avx2_kernel : portable_kernel;
    kernel_ = kernel(rows.element, rows.law);
    linear_kernel_ = kernel(rows.element, rows.linear_law);
    law_ = &law_data_;
    linear_law_ = &spring_data_;
    viscous_ = Law::viscous && is_viscous(input.material);
    keeps_history_ = Law::history > 0;
    has_simple_energy_ = std::is_same_v<Law, LinearElastic>;
    density_ = input.material.density;
    element_nodes_ = Element::nodes;
    elements_ = static_cast<int>(input.connectivity.size()) / Element::nodes;
    batches_ = (elements_ + lanes_ - 1) / lanes_;
    nodes_.resize(static_cast<std::size_t>(batches_) * lanes_ * Element::nodes);
    geometry_.resize(static_cast<std::size_t>(batches_) * lanes_ * Element::geometry_size);
    history_.assign(static_cast<std::size_t>(batches_) * lanes_ * history_size, 0.0);
    node_volume_.resize(static_cast<std::size_t>(elements_) * Element::nodes);
    for (int slot = 0; slot < batches_ * lanes_; ++slot) {
      const int e = std::min(slot, elements_ - 1);  // idle lanes repeat the last element; their forces are dropped
      fill(slot, input.connectivity.data() + static_cast<std::size_t>(e) * Element::nodes, input.nodes);
    }
  }

  std::unique_ptr<ElementBlock> detached(int first, int last) const override {
    return std::unique_ptr<ElementBlock>(new Block(*this, first, last));
  }

  void stresses(const double* displacements, const double* velocities,
                std::vector<std::array<double, 6>>& result) const override {
    for (int e = 0; e < elements_; ++e) {
      Single single(*this, e, displacements, velocities);
      std::array<double, 6> mean;
      Response<Element, Law, double>::mean_stress(single.geometry, law_data_, single.motion(), mean.data());
      result.push_back(mean);
    }
  }

  double stored(const double* displacements) const override {
    double sum = 0;
    for (int e = 0; e < elements_; ++e) {
      Single single(*this, e, displacements, nullptr);
      sum += Response<Element, Law, double>::stored(single.geometry, law_data_, single.motion());
    }
    return sum;
  }

  void plastic_strains(std::vector<double>& result) const override {
    for (int e = 0; e < elements_; ++e) {
      double largest = 0;
      for (int p = 0; p < Element::points && Law::history > 0; ++p)
        largest = std::max(largest, history_[at(e, (p + 1) * Law::history - 1, history_size)]);
      result.push_back(largest);
    }
  }

  Largest largest_element_eigenvalue(double worth, std::span<const int> order, double rate) const override {
    constexpr int size = 3 * Element::nodes;
    using Matrix = Eigen::Matrix<double, size, size>;
    Largest largest;
    // two invariants of the elements seen: in a structured mesh many elements are alike and need one solution only
    std::set<std::pair<float, float>> done;
    for (const int e : order) {
      Matrix a;
      double geometry[Element::geometry_size], scale[size];
      copy(geometry_, e, geometry);
      for (int i = 0; i < size; ++i)
        scale[i] = 1 / std::sqrt(density_ * node_volume_[static_cast<std::size_t>(e) * Element::nodes + i / 3]);
      for (int i = 0; i < size; ++i) {
        double u[Element::nodes][3] = {}, v[Element::nodes][3] = {}, f[Element::nodes][3];
        u[i / 3][i % 3] = scale[i];
        v[i / 3][i % 3] = rate * scale[i];
        Loss<double> loss;
        Response<Element, KelvinVoigt, double>::forces(geometry, spring_data_, {u, v, nullptr}, f, loss);
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
  static constexpr int history_size = Element::points * Law::history;

  Block(const Block& whole, int first, int last) : law_data_(whole.law_data_), spring_data_(whole.spring_data_) {
    lanes_ = whole.lanes_;
    kernel_ = whole.kernel_;
    linear_kernel_ = whole.linear_kernel_;
    law_ = &law_data_;
    linear_law_ = &spring_data_;
    viscous_ = whole.viscous_;
    keeps_history_ = whole.keeps_history_;
    has_simple_energy_ = whole.has_simple_energy_;
    density_ = whole.density_;
    element_nodes_ = Element::nodes;
    batches_ = last - first;
    elements_ = std::min(whole.elements_ - first * lanes_, batches_ * lanes_);
    const auto take = [&](auto& to, const auto& from, int size) {
      to.resize(static_cast<std::size_t>(batches_) * lanes_ * size);
      std::copy_n(from.data() + static_cast<std::ptrdiff_t>(first) * lanes_ * size,
                  static_cast<std::ptrdiff_t>(batches_) * lanes_ * size, to.data());
    };
    take(geometry_, whole.geometry_, Element::geometry_size);
    take(history_, whole.history_, history_size);
    nodes_.resize(static_cast<std::size_t>(batches_) * lanes_ * Element::nodes);
    for (int e = 0; e < batches_ * lanes_; ++e) {
      for (int a = 0; a < Element::nodes; ++a) nodes_[at(e, a, Element::nodes)] = e * Element::nodes + a;
    }
  }

  std::size_t at(int e, int i, int size) const {
    return (static_cast<std::size_t>(e / lanes_) * size + i) * lanes_ + e % lanes_;
  }

  template <class Numbers, std::size_t size>
  void copy(const Numbers& from, int e, double (&to)[size]) const {
    for (int i = 0; i < static_cast<int>(size); ++i) to[i] = from[at(e, i, size)];
  }

  /// What one element needs for its response, taken out of the batches.
  struct Single {
    Single(const Block& block, int e, const double* displacements, const double* velocities) {
      for (int a = 0; a < Element::nodes; ++a) {
        const std::size_t node = block.node(e, a);
        for (int c = 0; c < 3; ++c) u[a][c] = displacements[3 * node + c];
        for (int c = 0; c < 3; ++c) v[a][c] = velocities ? velocities[3 * node + c] : 0;
      }
      block.copy(block.geometry_, e, geometry);
      if constexpr (history_size > 0) block.copy(block.history_, e, history);
    }
    Motion<double> motion() { return {u, v, history}; }
    double u[Element::nodes][3], v[Element::nodes][3], geometry[Element::geometry_size];
    double history[history_size > 0 ? history_size : 1];
  };

  void fill(int slot, const int* connectivity, std::span<const Vec3> places) {
    double x[Element::nodes][3], geometry[Element::geometry_size];
    for (int a = 0; a < Element::nodes; ++a) {
      nodes_[at(slot, a, Element::nodes)] = connectivity[a];
      for (int c = 0; c < 3; ++c) x[a][c] = places[connectivity[a]][c];
    }
    Element::measure(x, law_data_.elastic(), geometry);
    for (int i = 0; i < Element::geometry_size; ++i) geometry_[at(slot, i, Element::geometry_size)] = geometry[i];
    if (slot < elements_)
      Element::node_volumes(x, geometry, node_volume_.data() + static_cast<std::size_t>(slot) * Element::nodes);
  }

  Law law_data_;
  KelvinVoigt spring_data_;  // small motions about the start
};

/// Calls `call` with (place, type tag) for the first row of the table that fits; false if there is none.
template <class Table, class Fits, class Call>
bool with_row(Fits&& fits, Call&& call) {
  bool found = false;
  const auto look = [&]<class Row>(int place, std::type_identity<Row> row) {
    if (found || !fits(row)) return;
    found = true;
    call(place, row);
  };
  [&]<std::size_t... i>(std::index_sequence<i...>) {
    (look(static_cast<int>(i), std::type_identity<std::tuple_element_t<i, Table>>{}), ...);
  }
  (std::make_index_sequence<std::tuple_size_v<Table>>{});
  return found;
}

template <class Call>
bool with_element(const std::string& name, Call&& call) {
  return with_row<Elements>([&]<class Row>(std::type_identity<Row>) { return name == Row::name; },
                            std::forward<Call>(call));
}

template <class Call>
bool with_law(const MaterialRegion& region, Call&& call) {
  return with_row<Laws>([&]<class Row>(std::type_identity<Row>) { return Row::serves(region); },
                        std::forward<Call>(call));
}

/// Names of a table's rows, each once.
template <class Table>
std::vector<std::string> names() {
  std::vector<std::string> all = []<class... Row>(std::type_identity<std::tuple<Row...>>) {
    return std::vector<std::string>{Row::name...};
  }(std::type_identity<Table>{});
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

}  // namespace

std::unique_ptr<ElementBlock> ElementBlock::make(const BlockInput& input) {
  std::unique_ptr<ElementBlock> block;
  Rows rows;
  with_law(input.material, [&](int law, auto) { rows.law = law; });
  MaterialRegion spring = input.material;
  spring.law = KelvinVoigt::name;
  with_law(spring, [&](int law, auto) { rows.linear_law = law; });
  with_element(input.element, [&]<class Element>(int element, std::type_identity<Element>) {
    rows.element = element;
    with_law(input.material, [&]<class Law>(int, std::type_identity<Law>) {
      block = std::make_unique<Block<Element, Law>>(input, rows);
    });
  });
  base::require_internal(block != nullptr, "unknown element or law");
  return block;
}

std::vector<std::string> element_names() { return names<Elements>(); }

int element_nodes(const std::string& element) {
  int count = 0;
  with_element(element, [&]<class Element>(int, std::type_identity<Element>) { count = Element::nodes; });
  return count;
}

double smallest_point_volume(const std::string& element, const double (*places)[3]) {
  double smallest = INFINITY;
  with_element(element, [&]<class Element>(int, std::type_identity<Element>) {
    double geometry[Element::geometry_size];
    Element::measure(places, {1, 1}, geometry);
    for (int p = 0; p < Element::points; ++p) smallest = std::min(smallest, Element::weight(geometry, p));
  });
  return smallest;
}

bool keeps_history(const MaterialRegion& material) {
  bool keeps = false;
  with_law(material, [&]<class Law>(int, std::type_identity<Law>) { keeps = Law::history > 0; });
  return keeps;
}

void check_material(const MaterialRegion& material, const std::string& head) {
  const auto known = names<Laws>();
  base::require_user(std::ranges::count(known, material.law) > 0,
                     fmt::format("{}law = \"{}\"; must be one of: {}", head, material.law, fmt::join(known, ", ")));
  with_law(material, [&]<class Law>(int, std::type_identity<Law>) { Law::check(material, head); });
}

void ElementBlock::add_inner_forces(const double* displacements, const double* velocities, double* forces, int first,
                                    int last) const {
  kernel_({nodes_.data(), geometry_.data(), law_, displacements, viscous_ ? velocities : nullptr, forces,
           history_.data(), nullptr, nullptr, elements_, batches_, first, last});
}

void ElementBlock::add_linear_forces(const double* displacements, const double* velocities, double* forces, int first,
                                     int last) const {
  linear_kernel_({nodes_.data(), geometry_.data(), linear_law_, displacements, velocities, forces, nullptr, nullptr,
                  nullptr, elements_, batches_, first, last});
}

void ElementBlock::advance(const double* displacements, const double* velocities, double* forces, Losses& losses,
                           int first, int last) {
  double lost[2] = {0, 0};
  kernel_({nodes_.data(), geometry_.data(), law_, displacements, viscous_ ? velocities : nullptr, forces,
           history_.data(), history_.data(), lost, elements_, batches_, first, last});
  losses.viscous_power += lost[0];
  losses.plastic_work += lost[1];
}

int ElementBlock::history_size() const {
  return batches_ == 0 ? 0 : static_cast<int>(history_.size()) / (batches_ * lanes_);
}

void ElementBlock::read_history(std::vector<double>& result) const {
  const int size = history_size();
  for (int e = 0; e < elements_; ++e)
    for (int i = 0; i < size; ++i)
      result.push_back(history_[(static_cast<std::size_t>(e / lanes_) * size + i) * lanes_ + e % lanes_]);
}

void ElementBlock::set_history(const double* values) {
  const int size = history_size();
  for (int slot = 0; slot < batches_ * lanes_; ++slot) {
    const std::size_t e = std::min(slot, elements_ - 1);  // idle lanes repeat the last element
    for (int i = 0; i < size; ++i)
      history_[(static_cast<std::size_t>(slot / lanes_) * size + i) * lanes_ + slot % lanes_] = values[e * size + i];
  }
}

void ElementBlock::add_lumped_mass(double* nodal_mass) const {
  for (int e = 0; e < elements_; ++e) {
    for (int a = 0; a < element_nodes_; ++a) {
      nodal_mass[node(e, a)] += density_ * node_volume_[static_cast<std::size_t>(e) * element_nodes_ + a];
    }
  }
}

}  // namespace fem
