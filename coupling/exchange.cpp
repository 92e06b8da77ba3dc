#include "coupling/exchange.hpp"

#include <algorithm>
#include <string>

#include "base/error.hpp"
#include "coupling/slab_simulation.hpp"
#include "coupling/stopwatch.hpp"

namespace coupling {

namespace {

void broadcast(std::vector<int>& values, int root, MPI_Comm communicator) {
  int count = static_cast<int>(values.size());
  MPI_Bcast(&count, 1, MPI_INT, root, communicator);
  values.resize(static_cast<std::size_t>(count));
  MPI_Bcast(values.data(), count, MPI_INT, root, communicator);
}

void broadcast(base::Skin& skin, int root, MPI_Comm communicator) {
  int sizes[5] = {static_cast<int>(skin.body.size()), static_cast<int>(skin.nodes.size()),
                  static_cast<int>(skin.facets.size()), static_cast<int>(skin.faces.size()),
                  static_cast<int>(skin.face_of.size())};
  MPI_Bcast(sizes, 5, MPI_INT, root, communicator);
  skin.body.resize(static_cast<std::size_t>(sizes[0]));
  skin.nodes.resize(static_cast<std::size_t>(sizes[1]));
  skin.facets.resize(static_cast<std::size_t>(sizes[2]));
  skin.faces.resize(static_cast<std::size_t>(sizes[3]));
  skin.face_of.resize(static_cast<std::size_t>(sizes[4]));
  MPI_Bcast(skin.body.data(), sizes[0], MPI_CHAR, root, communicator);
  MPI_Bcast(skin.nodes.data(), 3 * sizes[1], MPI_DOUBLE, root, communicator);
  MPI_Bcast(skin.facets.data(), 4 * sizes[2], MPI_INT, root, communicator);
  MPI_Bcast(skin.faces.data(), 8 * sizes[3], MPI_INT, root, communicator);
  MPI_Bcast(skin.face_of.data(), sizes[4], MPI_INT, root, communicator);
}

std::string part_column(int part) { return "exchange_of_part_" + std::to_string(part); }

}  // namespace

Exchange::Exchange(const Roles& roles, const fem::Model* model, const CouplingSettings& settings) : roles_(roles) {
  is_.settings = settings;
  if (model) is_.skins = model->skins();
  int count = static_cast<int>(is_.skins.size());
  MPI_Bcast(&count, 1, MPI_INT, roles.first_fem_rank, roles.world);
  is_.skins.resize(static_cast<std::size_t>(count));
  for (auto& skin : is_.skins) {
    broadcast(skin, roles.first_fem_rank, roles.world);
    mobility_.emplace_back(skin.nodes.size());
  }
  for (int peer = 0; peer < roles.fem_ranks; ++peer) {
    const int owner = roles.first_fem_rank + peer;
    auto& of_owner = is_.owned.emplace_back();
    for (int s = 0; s < count; ++s) {
      std::vector<int> owned;
      std::vector<double> mobility;
      if (model && roles.rank == owner) {
        const auto mine = model->owned_skin_nodes(s);
        owned.assign(mine.begin(), mine.end());
        mobility = model->skin_mobility(s);
      }
      broadcast(owned, owner, roles.world);
      mobility.resize(owned.size());
      MPI_Bcast(mobility.data(), static_cast<int>(mobility.size()), MPI_DOUBLE, owner, roles.world);
      for (std::size_t i = 0; i < owned.size(); ++i)
        mobility_[static_cast<std::size_t>(s)][static_cast<std::size_t>(owned[i])] = mobility[i];
      of_owner.push_back(std::move(owned));
    }
  }
  if (roles.is_fem)
    bodies_ = std::make_unique<BodyEnd>(is_, roles.joint, roles.dem_ranks, roles.rank - roles.first_fem_rank);
}

void Exchange::begin_window(const fem::Model& model) {
  Stopwatch watch(seconds_);
  bodies_->begin_window(model);
}

void Exchange::send_skins(const fem::Model& model, double ahead, bool failed) {
  Stopwatch watch(seconds_);
  bodies_->send_skins(model, ahead, failed);
}

bool Exchange::receive_impulses() {
  const double before = waited_;
  Stopwatch watch(seconds_);
  const bool sound = bodies_->receive_impulses(waited_);
  seconds_ -= waited_ - before;
  return sound;
}

void Exchange::apply(fem::Model& model, double window) {
  Stopwatch watch(seconds_);
  bodies_->apply(model, window);
}

void Exchange::finish_window() {
  if (bodies_) waited_ += bodies_->finish_window();
}

void Exchange::join(dem::Simulation& grains, SlabSimulation* parts, const std::vector<int>& walls) {
  grains_ = &grains;
  parts_ = parts;
  if (parts)
    parts->join_bodies(is_, walls);
  else
    own_end_ = std::make_unique<GrainEnd>(is_, roles_.joint, roles_.dem_ranks, walls);
}

bool Exchange::window(int steps, double dt, bool refused) {
  const WindowOrder order{.steps = steps, .dt = dt, .refused = refused};
  const auto reports = parts_ ? parts_->window(order) : std::vector<WindowReport>{own_end_->window(*grains_, order)};
  spent_.resize(reports.size());
  Impulse given;
  double longest = 0, longest_before = 0;
  for (std::size_t part = 0; part < reports.size(); ++part) {
    if (!reports[part].alive) return false;
    given.sum += reports[part].given;
    given.all += reports[part].all;
    longest_before = std::max(longest_before, spent_[part].seconds);
    longest = std::max(longest, reports[part].seconds);
    if (part == 0) waited_ += reports[part].waited - spent_[part].waited;
    spent_[part] = {reports[part].seconds, reports[part].waited};
  }
  seconds_ += longest - longest_before;
  // What the bodies have applied is that of the window before, or of the one before that.
  const Impulse& taken = is_.settings.scheme == Scheme::concurrent ? given_before_ : given_;
  if (taken.all > 0)
    momentum_error_ = std::max(momentum_error_, base::norm(reports[0].applied + taken.sum) / taken.all);
  given_before_ = std::exchange(given_, given);
  return true;
}

std::vector<PairTraffic> Exchange::traffic() const {
  if (parts_) return parts_->traffic();
  return own_end_ ? std::vector<PairTraffic>{own_end_->traffic()} : std::vector<PairTraffic>{};
}

void Exchange::save(base::Columns& grains, base::Columns& bodies) const {
  if (roles_.is_dem) {
    base::Saver saver(grains);
    saver.numbers("exchange", given_, given_before_, momentum_error_, seconds_, waited_);
    const auto ends = parts_ ? parts_->save_ends() : std::vector<std::vector<double>>{own_end_->save()};
    for (int part = 0; part < static_cast<int>(ends.size()); ++part)
      saver.rows(part_column(part), ends[static_cast<std::size_t>(part)]);
  }
  if (!roles_.is_fem) return;
  std::vector<base::Vec3> applied(static_cast<std::size_t>(roles_.fem_ranks));
  MPI_Gather(&bodies_->applied(), 3, MPI_DOUBLE, applied.data(), 3, MPI_DOUBLE, 0, roles_.fem);
  if (roles_.is_fem_root()) base::Saver(bodies).rows("exchange/applied", applied);
  bodies_->save(bodies, roles_.fem);
}

/// On another number of DEM ranks every part starts with the whole skins again.
void Exchange::restore_ends(const base::Columns& grains) {
  std::vector<std::vector<double>> ends;
  while (grains.contains(part_column(static_cast<int>(ends.size())))) {
    std::vector<double> end;
    base::Loader(grains).rows(part_column(static_cast<int>(ends.size())), end);
    ends.push_back(std::move(end));
  }
  int parts = static_cast<int>(ends.size());  // which the DEM rank alone has read
  MPI_Bcast(&parts, 1, MPI_INT, roles_.dem_rank, roles_.world);
  if (parts != roles_.dem_ranks) return;
  ends.resize(static_cast<std::size_t>(parts));
  std::vector<std::vector<std::array<Interval, 2>>> intervals;
  for (auto& end : ends) {
    end.resize(GrainEnd::saved_numbers(is_.skins.size()));
    MPI_Bcast(end.data(), static_cast<int>(end.size()), MPI_DOUBLE, roles_.dem_rank, roles_.world);
    intervals.push_back(GrainEnd::intervals_of(end, is_.skins.size()));
  }
  if (bodies_) bodies_->restore(intervals);
  if (own_end_) own_end_->restore(ends[0]);
  if (parts_) parts_->restore_ends(ends);
}

void Exchange::restore(const base::Columns& grains, const base::Columns& bodies) {
  restore_ends(grains);
  if (roles_.is_dem)
    base::Loader(grains).numbers("exchange", given_, given_before_, momentum_error_, seconds_, waited_);
  if (!roles_.is_fem) return;
  std::vector<base::Vec3> applied;
  base::Loader(bodies).rows("exchange/applied", applied);
  const bool same = applied.size() == static_cast<std::size_t>(roles_.fem_ranks);
  const int mine = roles_.rank - roles_.first_fem_rank;
  bodies_->applied() = {};
  for (int rank = 0; rank < static_cast<int>(applied.size()); ++rank)
    if (same ? rank == mine : roles_.is_fem_root()) bodies_->applied() += applied[static_cast<std::size_t>(rank)];
  bodies_->load(bodies);
}

}  // namespace coupling
