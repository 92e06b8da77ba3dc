#include "coupling/exchange.hpp"

#include <chrono>
#include <cmath>
#include <string>

#include "base/error.hpp"
#include "coupling/agree.hpp"

namespace coupling {

namespace {

constexpr int skin_tag = 11, force_tag = 12;
constexpr std::size_t skin_header = 4;   // status, sum of the impulses applied
constexpr std::size_t force_header = 1;  // status

class Stopwatch {
 public:
  explicit Stopwatch(double& total) : total_(total) {}
  ~Stopwatch() { total_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

 private:
  double& total_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

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

std::size_t node_count(const std::vector<std::vector<int>>& nodes) {
  std::size_t count = 0;
  for (const auto& list : nodes) count += list.size();
  return count;
}

}  // namespace

Exchange::Exchange(const Roles& roles, const fem::Model* model, const CouplingSettings& settings)
    : roles_(roles), settings_(settings) {
  if (model) skins_ = model->skins();
  int count = static_cast<int>(skins_.size());
  MPI_Bcast(&count, 1, MPI_INT, roles.first_fem_rank, roles.world);
  skins_.resize(static_cast<std::size_t>(count));
  for (auto& skin : skins_) {
    broadcast(skin, roles.first_fem_rank, roles.world);
    mobility_.emplace_back(skin.nodes.size());
  }
  for (int peer = 0; peer < roles.fem_ranks; ++peer) {
    Peer owner;
    owner.rank = roles.first_fem_rank + peer;
    for (int s = 0; s < count; ++s) {
      std::vector<int> owned;
      if (model && roles.rank == owner.rank) {
        const auto mine = model->owned_skin_nodes(s);
        owned.assign(mine.begin(), mine.end());
      }
      broadcast(owned, owner.rank, roles.world);
      std::vector<double> mobility(owned.size());
      if (model && roles.rank == owner.rank) mobility = model->skin_mobility(s);
      MPI_Bcast(mobility.data(), static_cast<int>(mobility.size()), MPI_DOUBLE, owner.rank, roles.world);
      for (std::size_t i = 0; i < owned.size(); ++i) mobility_[s][static_cast<std::size_t>(owned[i])] = mobility[i];
      owner.nodes.push_back(std::move(owned));
    }
    const std::size_t nodes = node_count(owner.nodes);
    if (roles.is_fem && roles.rank == owner.rank) {
      dem_peer_ = owner;
      dem_peer_.rank = roles.dem_rank;
      dem_peer_.out.resize(skin_header + 6 * nodes);
      dem_peer_.in.resize(force_header + 3 * nodes);
      for (const auto& owned : owner.nodes) {
        waiting_.emplace_back(owned.size());
        leaving_.emplace_back(owned.size());
      }
    }
    owner.in.resize(skin_header + 6 * nodes);
    owner.out.resize(force_header + 3 * nodes);
    if (roles.is_dem) fem_peers_.push_back(std::move(owner));
  }
  if (roles.is_dem)
    for (const auto& skin : skins_) {
      positions_.push_back(skin.nodes);
      velocities_.emplace_back(skin.nodes.size());
      impulses_.emplace_back(skin.nodes.size());
    }
}

void Exchange::begin_window(const fem::Model& model) {
  if (settings_.skin_motion != SkinMotion::quadratic) return;
  Stopwatch watch(seconds_);
  for (std::size_t s = 0; s < skins_.size(); ++s) {
    local_positions_.resize(leaving_[s].size());
    model.skin_state(static_cast<int>(s), local_positions_, leaving_[s]);
  }
}

void Exchange::send_skins(const fem::Model& model, double ahead, bool failed) {
  Stopwatch watch(seconds_);
  auto& out = dem_peer_.out;
  out[0] = failed ? 1 : 0;
  for (int d = 0; d < 3; ++d) out[static_cast<std::size_t>(1 + d)] = applied_[d];
  double* value = out.data() + skin_header;
  for (std::size_t s = 0; s < skins_.size(); ++s) {
    const std::size_t n = dem_peer_.nodes[s].size();
    local_positions_.resize(n);
    local_velocities_.resize(n);
    model.skin_state(static_cast<int>(s), local_positions_, local_velocities_);
    const auto& sent = settings_.skin_motion == SkinMotion::quadratic ? leaving_[s] : local_velocities_;
    for (std::size_t i = 0; i < n; ++i, value += 6)
      for (int d = 0; d < 3; ++d) {
        value[d] = local_positions_[i][d] + ahead * local_velocities_[i][d];
        value[3 + d] = sent[i][d];
      }
  }
  MPI_Isend(out.data(), static_cast<int>(out.size()), MPI_DOUBLE, dem_peer_.rank, skin_tag, roles_.world,
            &dem_peer_.out_request);
}

bool Exchange::receive_skins(dem::Simulation& grains, std::span<const int> walls) {
  for (auto& peer : fem_peers_)
    MPI_Irecv(peer.in.data(), static_cast<int>(peer.in.size()), MPI_DOUBLE, peer.rank, skin_tag, roles_.world,
              &peer.in_request);
  bool sound = true;
  base::Vec3 applied;
  for (auto& peer : fem_peers_) {
    waited_ += wait_politely(peer.in_request);
    Stopwatch watch(seconds_);
    sound = sound && peer.in[0] == 0;
    for (int d = 0; d < 3; ++d) applied[d] += peer.in[static_cast<std::size_t>(1 + d)];
    const double* value = peer.in.data() + skin_header;
    for (std::size_t s = 0; s < skins_.size(); ++s)
      for (const int node : peer.nodes[s]) {
        positions_[s][static_cast<std::size_t>(node)] = {value[0], value[1], value[2]};
        velocities_[s][static_cast<std::size_t>(node)] = {value[3], value[4], value[5]};
        value += 6;
      }
  }
  Stopwatch watch(seconds_);
  const Impulse& given = settings_.scheme == Scheme::concurrent ? given_before_ : given_;
  if (given.all > 0) momentum_error_ = std::max(momentum_error_, base::norm(applied + given.sum) / given.all);
  const auto way = settings_.skin_motion == SkinMotion::quadratic ? dem::MeshWay::parabola : dem::MeshWay::line;
  if (sound)
    for (std::size_t s = 0; s < skins_.size(); ++s)
      grains.set_mesh_target(walls[s], positions_[s], velocities_[s], way);
  return sound;
}

void Exchange::send_impulses(const dem::Simulation& grains, std::span<const int> walls, bool failed) {
  Stopwatch watch(seconds_);
  given_before_ = given_;
  given_ = {};
  for (std::size_t s = 0; s < skins_.size(); ++s) {
    if (failed) break;
    grains.nodal_impulse(walls[s], impulses_[s]);
    given_.sum += grains.wall_impulse_on_grains(walls[s]);
    for (const auto& impulse : impulses_[s]) given_.all += base::norm(impulse);
  }
  for (auto& peer : fem_peers_) {
    peer.out[0] = failed ? 1 : 0;
    double* value = peer.out.data() + force_header;
    for (std::size_t s = 0; s < skins_.size(); ++s)
      for (const int node : peer.nodes[s])
        for (int d = 0; d < 3; ++d) *value++ = impulses_[s][static_cast<std::size_t>(node)][d];
    MPI_Isend(peer.out.data(), static_cast<int>(peer.out.size()), MPI_DOUBLE, peer.rank, force_tag, roles_.world,
              &peer.out_request);
  }
}

bool Exchange::receive_impulses() {
  MPI_Irecv(dem_peer_.in.data(), static_cast<int>(dem_peer_.in.size()), MPI_DOUBLE, dem_peer_.rank, force_tag,
            roles_.world, &dem_peer_.in_request);
  waited_ += wait_politely(dem_peer_.in_request);
  Stopwatch watch(seconds_);
  if (dem_peer_.in[0] != 0) return false;
  const double* value = dem_peer_.in.data() + force_header;
  for (auto& impulses : waiting_)
    for (auto& impulse : impulses) {
      impulse = {value[0], value[1], value[2]};
      value += 3;
    }
  return true;
}

void Exchange::apply(fem::Model& model, double window) {
  Stopwatch watch(seconds_);
  applied_ = {};
  for (std::size_t s = 0; s < waiting_.size(); ++s) {
    local_forces_.clear();
    for (const auto& impulse : waiting_[s]) {
      local_forces_.push_back((1.0 / window) * impulse);
      applied_ += window * local_forces_.back();
    }
    model.set_skin_forces(static_cast<int>(s), local_forces_);
  }
}

void Exchange::finish_window() {
  if (dem_peer_.out_request != MPI_REQUEST_NULL) waited_ += wait_politely(dem_peer_.out_request);
  for (auto& peer : fem_peers_)
    if (peer.out_request != MPI_REQUEST_NULL) waited_ += wait_politely(peer.out_request);
}

void Exchange::save(base::Columns& grains, base::Columns& bodies) const {
  if (roles_.is_dem) base::Saver(grains).numbers("exchange", given_, given_before_, momentum_error_, seconds_, waited_);
  if (!roles_.is_fem) return;
  std::vector<base::Vec3> applied(static_cast<std::size_t>(roles_.fem_ranks));
  MPI_Gather(&applied_, 3, MPI_DOUBLE, applied.data(), 3, MPI_DOUBLE, 0, roles_.fem);
  if (roles_.is_fem_root()) base::Saver(bodies).rows("exchange/applied", applied);
  save_waiting(bodies);
}

/// Impulses that the bodies will take in the next window, by skin and node.
void Exchange::save_waiting(base::Columns& bodies) const {
  for (std::size_t s = 0; s < skins_.size(); ++s) {
    std::vector<base::Vec3> mine(skins_[s].nodes.size()), all(mine.size());
    for (std::size_t i = 0; i < waiting_[s].size(); ++i)
      mine[static_cast<std::size_t>(dem_peer_.nodes[s][i])] = waiting_[s][i];
    MPI_Reduce(mine.data(), all.data(), static_cast<int>(3 * mine.size()), MPI_DOUBLE, MPI_SUM, 0, roles_.fem);
    if (roles_.is_fem_root()) base::Saver(bodies).rows("exchange/waiting_" + std::to_string(s), all);
  }
}

void Exchange::restore_waiting(const base::Columns& bodies) {
  for (std::size_t s = 0; s < skins_.size(); ++s) {
    std::vector<base::Vec3> all;
    base::Loader(bodies).rows("exchange/waiting_" + std::to_string(s), all);
    base::require_user(all.size() == skins_[s].nodes.size(), "skin " + skins_[s].body + " has other nodes");
    for (std::size_t i = 0; i < waiting_[s].size(); ++i)
      waiting_[s][i] = all[static_cast<std::size_t>(dem_peer_.nodes[s][i])];
  }
}

void Exchange::restore(const base::Columns& grains, const base::Columns& bodies) {
  if (roles_.is_dem)
    base::Loader(grains).numbers("exchange", given_, given_before_, momentum_error_, seconds_, waited_);
  if (!roles_.is_fem) return;
  std::vector<base::Vec3> applied;
  base::Loader(bodies).rows("exchange/applied", applied);
  const bool same = applied.size() == static_cast<std::size_t>(roles_.fem_ranks);
  const int mine = roles_.rank - roles_.first_fem_rank;
  applied_ = {};
  for (int rank = 0; rank < static_cast<int>(applied.size()); ++rank)
    if (same ? rank == mine : roles_.is_fem_root()) applied_ += applied[static_cast<std::size_t>(rank)];
  restore_waiting(bodies);
}

}  // namespace coupling
