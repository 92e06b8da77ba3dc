// The whole state as columns, for a checkpoint: nodes and elements by their global numbers, which do not depend on the
// number of ranks. Sums that every rank keeps for itself (works and losses) are kept rank by rank; on another number of
// ranks the first one takes them all.
#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "fem/communication.hpp"
#include "fem/explicit_model.hpp"
#include "fem/families.hpp"

namespace fem {
namespace {

constexpr std::size_t energy_terms = sizeof(base::Energy) / sizeof(double);

std::string of_body(std::size_t body, const char* what) { return fmt::format("body/{}/{}", body, what); }

bool remembers(const Body& body) { return std::ranges::any_of(body.materials, keeps_history); }

}  // namespace

/// Three numbers per node of all ranks; whole on the first rank.
std::vector<double> ExplicitModel::by_global_number(std::span<const double> owned) const {
  const auto all = gathered<double>(layout_.comm, owned, MPI_DOUBLE);
  if (layout_.rank != 0) return {};
  std::vector<double> sorted(3 * static_cast<std::size_t>(layout_.global_count()));  // tied nodes have the same numbers
  for (int node = 0; node < layout_.global_count(); ++node)
    std::copy_n(all.begin() + 3 * layout_.petsc_of_global[node], 3,
                sorted.begin() + 3 * static_cast<std::size_t>(node));
  return sorted;
}

void ExplicitModel::take_owned(const base::Columns& columns, const std::string& name, std::span<double> owned) const {
  const auto& all = base::column<std::vector<double>>(columns, name);
  base::require_user(all.size() == 3 * static_cast<std::size_t>(layout_.global_count()),
                     fmt::format("column {} has another number of nodes", name));
  for (int node = 0; node < layout_.owned; ++node)
    std::copy_n(all.begin() + 3 * static_cast<std::size_t>(layout_.global_of_local[node]), 3, owned.begin() + 3 * node);
}

std::vector<double> ExplicitModel::of_all_ranks(std::span<const double> mine) const {
  return gathered<double>(layout_.comm, mine, MPI_DOUBLE);
}

std::vector<double> ExplicitModel::share_of_rank(const base::Columns& columns, const std::string& name,
                                                 std::size_t numbers) const {
  const auto& all = base::column<std::vector<double>>(columns, name);
  base::require_user(!all.empty() && all.size() % numbers == 0, fmt::format("column {} has another length", name));
  const std::size_t ranks = all.size() / numbers;
  std::vector<double> mine(numbers, 0.0);
  for (std::size_t r = 0; r < ranks; ++r) {
    const bool taken =
        ranks == static_cast<std::size_t>(layout_.ranks) ? static_cast<int>(r) == layout_.rank : layout_.rank == 0;
    for (std::size_t i = 0; taken && i < numbers; ++i) mine[i] += all[r * numbers + i];
  }
  return mine;
}

/// Where the numbers of each skin begin in a column of all skins' nodes; one more at the end.
std::vector<std::size_t> ExplicitModel::first_numbers_of_skins() const {
  std::vector<std::size_t> first{0};
  for (const auto& skin : skins_) first.push_back(first.back() + 3 * skin.nodes.size());
  return first;
}

/// Forces on the nodes of all skins, on every rank. Several nodes of a periodic skin may be one unknown.
std::vector<double> ExplicitModel::on_skins(std::vector<Vec3> Contact::*forces) const {
  const auto first = first_numbers_of_skins();
  std::vector<double> all(first.back(), 0.0);
  for (std::size_t s = 0; s < contacts_.size(); ++s) {
    for (std::size_t i = 0; i < contacts_[s].nodes.size(); ++i) {
      for (int c = 0; c < 3; ++c) all[first[s] + 3 * contacts_[s].skin_nodes[i] + c] = (contacts_[s].*forces)[i][c];
    }
  }
  sum(layout_.comm, all.data(), static_cast<int>(all.size()));  // one rank owns each
  return all;
}

base::Columns ExplicitModel::save() const {
  base::Columns columns;
  base::Saver saver(columns);
  const auto field = [&](const char* name, std::span<const double> owned) {
    saver.rows(fmt::format("nodes/{}", name), by_global_number(owned));
  };
  for (std::size_t b = 0; b < meshes_.size(); ++b) {
    saver.rows(of_body(b, "places"), meshes_[b].nodes);
    saver.rows(of_body(b, "regions"), meshes_[b].regions);
    saver.numbers(of_body(b, "state"), states_[b].damping, states_[b].held);
  }
  saver.numbers("clock", time_, steps_);
  const std::size_t owned = external_.size();
  field("displacement", {displacement_.data(), owned});
  field("velocity", {velocity_.data(), owned});
  field("acceleration", {acceleration_.data(), owned});
  field("inner", {inner_.data(), owned});
  field("external", external_);
  int zeroed = zero_.empty() ? 0 : 1;  // a rank without nodes has none
  MPI_Allreduce(MPI_IN_PLACE, &zeroed, 1, MPI_INT, MPI_MAX, layout_.comm);
  if (zeroed) field("zero", zero_);
  std::vector<double> loads;
  for (const auto& load : loads_) loads.push_back(load.value);
  saver.rows("loads", loads);
  if (!motions_.empty()) {
    std::vector<double> reactions(owned, 0.0);
    for (const auto& driven : driven_) reactions[driven.index] = driven.reaction;
    field("reaction", reactions);
  }
  if (!skins_.empty()) {
    saver.rows("skins/given", on_skins(&Contact::given));
    saver.rows("skins/used", on_skins(&Contact::used));
  }
  std::vector<double> mine(energy_terms + 2);
  std::memcpy(mine.data(), &ledger_, sizeof ledger_);
  mine[energy_terms] = gravity_zero_;
  mine[energy_terms + 1] = viscous_power_;
  saver.rows("ranks/energy", of_all_ranks(mine));
  save_histories(columns);
  output_->save(columns);
  if (layout_.rank != 0) columns.clear();
  return columns;
}

void ExplicitModel::save_histories(base::Columns& columns) const {
  base::Saver saver(columns);
  for (std::size_t b = 0; b < meshes_.size(); ++b) {
    if (!remembers(setup_.bodies[b])) continue;
    const auto own = assembly_.histories(static_cast<int>(b));
    const auto elements = gathered<int>(layout_.comm, assembly_.elements_of(static_cast<int>(b)), MPI_INT);
    const auto sizes = gathered<int>(layout_.comm, own.sizes, MPI_INT);
    const auto values = gathered<double>(layout_.comm, own.values, MPI_DOUBLE);
    std::vector<int> sorted_sizes(elements.size());
    for (std::size_t i = 0; i < elements.size(); ++i) sorted_sizes[elements[i]] = sizes[i];
    std::vector<std::size_t> starts(elements.size());
    std::exclusive_scan(sorted_sizes.begin(), sorted_sizes.end(), starts.begin(), std::size_t{0});
    std::vector<double> sorted(values.size());
    auto next = values.begin();
    for (std::size_t i = 0; i < elements.size(); next += sizes[i], ++i)
      std::copy_n(next, sizes[i], sorted.begin() + starts[elements[i]]);
    saver.rows(of_body(b, "history_sizes"), sorted_sizes);
    saver.rows(of_body(b, "history"), sorted);
  }
}

void ExplicitModel::require_same_meshes(const base::Columns& columns) const {
  for (std::size_t b = 0; b < meshes_.size(); ++b) {
    std::vector<Vec3> places;
    std::vector<int> regions;
    base::Loader loader(columns);
    loader.rows(of_body(b, "places"), places);
    loader.rows(of_body(b, "regions"), regions);
    const bool same = std::ranges::equal(places, meshes_[b].nodes, [](const Vec3& one, const Vec3& other) {
      return one.x == other.x && one.y == other.y && one.z == other.z;
    });
    base::require_user(same && regions == meshes_[b].regions,
                       fmt::format("body \"{}\" had another mesh", setup_.bodies[b].name));
  }
}

void ExplicitModel::restore(const base::Columns& columns) {
  require_same_meshes(columns);
  base::Loader loader(columns);
  const std::size_t owned = external_.size();
  for (std::size_t b = 0; b < meshes_.size(); ++b)
    loader.numbers(of_body(b, "state"), states_[b].damping, states_[b].held);
  loader.numbers("clock", time_, steps_);
  half_step_ = 0;
  take_owned(columns, "nodes/displacement", {displacement_.data(), owned});
  take_owned(columns, "nodes/velocity", {velocity_.data(), owned});
  take_owned(columns, "nodes/acceleration", {acceleration_.data(), owned});
  take_owned(columns, "nodes/inner", {inner_.data(), owned});
  take_owned(columns, "nodes/external", external_);
  zero_.clear();
  if (columns.contains("nodes/zero")) {
    zero_.resize(owned);
    take_owned(columns, "nodes/zero", zero_);
  }
  std::vector<double> loads;
  loader.rows("loads", loads);
  base::require_user(loads.size() == loads_.size(), "column loads is of other loads");
  for (std::size_t i = 0; i < loads.size(); ++i) loads_[i].value = loads[i];
  std::vector<double> values(owned);
  if (!motions_.empty()) {
    take_owned(columns, "nodes/reaction", values);
    for (auto& driven : driven_) driven.reaction = values[driven.index];
  }
  const auto first = first_numbers_of_skins();
  for (const auto& [name, forces] : {std::pair{"skins/given", &Contact::given}, {"skins/used", &Contact::used}}) {
    if (skins_.empty()) break;
    std::vector<double> all;
    loader.rows(name, all);
    base::require_user(all.size() == first.back(), fmt::format("column {} is of other skins", name));
    for (std::size_t s = 0; s < contacts_.size(); ++s) {
      for (std::size_t i = 0; i < contacts_[s].nodes.size(); ++i) {
        for (int c = 0; c < 3; ++c) (contacts_[s].*forces)[i][c] = all[first[s] + 3 * contacts_[s].skin_nodes[i] + c];
      }
    }
  }
  const auto mine = share_of_rank(columns, "ranks/energy", energy_terms + 2);
  std::memcpy(static_cast<void*>(&ledger_), mine.data(), sizeof ledger_);
  gravity_zero_ = mine[energy_terms];
  viscous_power_ = mine[energy_terms + 1];
  restore_histories(columns);
  output_->restore(columns);
  for (NodalField* moved : {&displacement_, &velocity_}) {
    moved->begin_to_ghosts();
    moved->end_to_ghosts();
  }
}

void ExplicitModel::restore_histories(const base::Columns& columns) {
  for (std::size_t b = 0; b < meshes_.size(); ++b) {
    if (!remembers(setup_.bodies[b])) continue;
    const auto& sizes = base::column<std::vector<int>>(columns, of_body(b, "history_sizes"));
    const auto& all = base::column<std::vector<double>>(columns, of_body(b, "history"));
    std::vector<std::size_t> starts(sizes.size() + 1, 0);
    std::inclusive_scan(sizes.begin(), sizes.end(), starts.begin() + 1, std::plus<>(), std::size_t{0});
    base::require_user(sizes.size() == meshes_[b].regions.size() && starts.back() == all.size(),
                       fmt::format("column {} is of other elements", of_body(b, "history")));
    std::vector<double> own;
    const auto elements = assembly_.elements_of(static_cast<int>(b));
    const auto present = assembly_.histories(static_cast<int>(b)).sizes;
    for (std::size_t i = 0; i < elements.size(); ++i) {
      base::require_user(sizes[elements[i]] == present[i],
                         fmt::format("column {} is of other laws", of_body(b, "history")));
      own.insert(own.end(), all.begin() + starts[elements[i]], all.begin() + starts[elements[i] + 1]);
    }
    assembly_.set_histories(static_cast<int>(b), own);
  }
}

}  // namespace fem
