#include "coupling/grain_end.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.hpp"
#include "coupling/agree.hpp"
#include "coupling/body_end.hpp"
#include "coupling/stopwatch.hpp"

namespace coupling {

namespace {

base::Vec3 vector_at(const double* value) { return {value[0], value[1], value[2]}; }

}  // namespace

GrainEnd::GrainEnd(Interface is, MPI_Comm joint, int dem_ranks, std::vector<int> walls)
    : is_(std::move(is)), joint_(joint), walls_(std::move(walls)) {
  int ranks = 1;
  MPI_Comm_size(joint, &ranks);
  lone_ = ranks == 1;
  const std::size_t skins = is_.skins.size();
  for (const auto& skin : is_.skins) {
    reaches_.push_back(reaches_of_nodes(skin));
    whole_.emplace_back();
    for (const Interval& reach : reaches_.back()) {
      whole_.back().include(reach.low);
      whole_.back().include(reach.high);
    }
    positions_.push_back(skin.nodes);
    velocities_.emplace_back(skin.nodes.size());
    impulses_.emplace_back(skin.nodes.size());
  }
  for (std::size_t f = 0; f < is_.owned.size(); ++f)
    peers_.push_back({.rank = lone_ ? 0 : dem_ranks + static_cast<int>(f),
                      .shared = std::vector<SharedNodes>(skins),
                      .place = std::vector<const double*>(skins),
                      .fresh_place = std::vector<const double*>(skins)});
  before_.resize(skins);
  now_.assign(skins, everything);
  moved_.resize(skins);
  share();
}

GrainEnd::~GrainEnd() { finish(); }

WindowReport GrainEnd::window(dem::Simulation& grains, const WindowOrder& order) {
  report_.alive = receive();
  FailureText failure;
  if (order.refused) failure = {Failure::unstable, "stopped with the part of the grains that leads"};
  if (report_.alive && !order.refused)
    failure = caught([&] {
      take(grains);
      grains.advance(order.steps, order.dt);
      pack(grains, choose_next(grains, order.steps * order.dt));
    });
  send(failure.kind != Failure::none || !report_.alive);
  raise(failure);
  return report_;
}

/// False when any of the bodies' ranks has failed; all have been heard then.
bool GrainEnd::receive() {
  finish();
  for (Peer& peer : peers_)
    MPI_Irecv(peer.in.data(), static_cast<int>(peer.in.size()), MPI_DOUBLE, peer.rank, skin_tag, joint_,
              &peer.in_request);
  bool sound = true;
  for (Peer& peer : peers_) {
    report_.waited += wait_politely(peer.in_request);
    peer.bytes += static_cast<double>(peer.in.size() * sizeof(double));
    peer.sound = peer.in[0] == 0;
    sound = sound && peer.sound;
  }
  return sound;
}

/// What has come, to the grains.
void GrainEnd::take(dem::Simulation& grains) {
  Stopwatch watch(report_.seconds);
  report_.applied = {};
  const auto moved_before = std::exchange(moved_, std::vector<Interval>(moved_.size()));
  for (const Peer& peer : peers_) {
    report_.applied += vector_at(peer.in.data() + 1);
    const double* value = peer.in.data() + skin_header(0);
    for (Interval& moved : moved_)
      for (int end = 0; end < 2; ++end, ++value)
        if (std::isfinite(*value)) moved.include(*value);
  }
  if (changed_) know_nodes(grains);
  Interval within = everything;
  skin_way_ = 0;
  for (std::size_t s = 0; s < walls_.size(); ++s) {
    Interval both = moved_[s].low > moved_[s].high ? Interval{0, 0} : moved_[s];
    if (moved_before[s].low <= moved_before[s].high && moved_[s].low <= moved_[s].high)
      skin_way_ = std::max(
          {skin_way_, std::abs(moved_[s].low - moved_before[s].low), std::abs(moved_[s].high - moved_before[s].high)});
    for (const double end : {moved_before[s].low, moved_before[s].high})
      if (std::isfinite(end)) both.include(end);
    // There is no limit on a side where all is known.
    if (now_[s].low > whole_[s].low) within.low = std::max(within.low, now_[s].low + both.high + 0.25 * margin_);
    if (now_[s].high < whole_[s].high) within.high = std::min(within.high, now_[s].high + both.low - 0.25 * margin_);
    for (std::size_t f = 0; f < peers_.size(); ++f) {
      const double* value = peers_[f].place[s];
      for (const int k : peers_[f].shared[s].all) {
        const auto node = static_cast<std::size_t>(is_.owned[f][s][static_cast<std::size_t>(k)]);
        positions_[s][node] = vector_at(value);
        velocities_[s][node] = vector_at(value + 3);
        value += 6;
      }
    }
  }
  grains.keep_within(within.low, within.high);
  const auto way = is_.settings.skin_motion == SkinMotion::quadratic ? dem::MeshWay::parabola : dem::MeshWay::line;
  for (std::size_t s = 0; s < walls_.size(); ++s) grains.set_mesh_target(walls_[s], positions_[s], velocities_[s], way);
}

/// Other nodes than before: those that are new with their places at the window's start.
void GrainEnd::know_nodes(dem::Simulation& grains) {
  for (std::size_t s = 0; s < walls_.size(); ++s) {
    std::vector<int> nodes, fresh;
    std::vector<base::Vec3> positions, velocities;
    for (std::size_t f = 0; f < peers_.size(); ++f) {
      const auto& owned = is_.owned[f][s];
      for (const int k : peers_[f].shared[s].all) nodes.push_back(owned[static_cast<std::size_t>(k)]);
      const double* value = peers_[f].fresh_place[s];
      for (const int k : peers_[f].shared[s].fresh) {
        fresh.push_back(owned[static_cast<std::size_t>(k)]);
        positions.push_back(vector_at(value));
        velocities.push_back(vector_at(value + 3));
        value += 6;
      }
    }
    grains.know_mesh_nodes(walls_[s], nodes, fresh, positions, velocities);
  }
}

/// Per skin: the interval of the next window.
std::vector<Interval> GrainEnd::choose_next(const dem::Simulation& grains, double window) {
  constexpr double enough = 0.5, good = 1.5, more_than_enough = 3;  // margins
  const dem::Reach reach = grains.reach();
  std::vector<Interval> next(now_.size());
  if (lone_) return now_;  // knows all
  if (reach.low > reach.high) return next;
  margin_ = 2 * reach.grain + 4 * (reach.speed * window + skin_way_);
  for (std::size_t s = 0; s < now_.size(); ++s) {
    const Interval moved = moved_[s].low > moved_[s].high ? Interval{0, 0} : moved_[s];
    const Interval needed{reach.low - moved.high, reach.high - moved.low};
    const double below = (needed.low - now_[s].low) / margin_, above = (now_[s].high - needed.high) / margin_;
    const bool keeps = below >= enough && above >= enough && below <= more_than_enough && above <= more_than_enough;
    next[s] = keeps ? now_[s] : Interval{needed.low - good * margin_, needed.high + good * margin_};
  }
  return next;
}

/// What goes out, and then all that the next window's messages need: from here on nothing may fail.
void GrainEnd::pack(const dem::Simulation& grains, const std::vector<Interval>& next) {
  Stopwatch watch(report_.seconds);
  report_.given = {};
  report_.all = 0;
  for (std::size_t s = 0; s < walls_.size(); ++s) {
    grains.nodal_impulse(walls_[s], impulses_[s]);
    report_.given += grains.wall_impulse_on_grains(walls_[s]);
    for (const auto& impulse : impulses_[s]) report_.all += base::norm(impulse);
  }
  for (std::size_t f = 0; f < peers_.size(); ++f) {
    auto& out = peers_[f].out;
    out.assign(1, 0);
    for (const Interval& interval : next) out.insert(out.end(), {interval.low, interval.high});
    for (std::size_t s = 0; s < walls_.size(); ++s)
      for (const int k : peers_[f].shared[s].all) {
        const auto& impulse = impulses_[s][static_cast<std::size_t>(is_.owned[f][s][static_cast<std::size_t>(k)])];
        out.insert(out.end(), {impulse.x, impulse.y, impulse.z});
      }
  }
  const bool changes = changed_ || next != now_;
  before_ = std::exchange(now_, next);
  if (changes) share();
}

void GrainEnd::send(bool failed) {
  // Within one process nobody else has to be told, and nobody would take the message.
  if (failed && lone_) return;
  for (Peer& peer : peers_) {
    if (!peer.sound) continue;  // waits for nothing
    if (failed) peer.out.assign(1, 1);
    peer.bytes += static_cast<double>(peer.out.size() * sizeof(double));
    MPI_Isend(peer.out.data(), static_cast<int>(peer.out.size()), MPI_DOUBLE, peer.rank, impulse_tag, joint_,
              &peer.out_request);
  }
}

void GrainEnd::finish() {
  for (Peer& peer : peers_)
    if (peer.out_request != MPI_REQUEST_NULL) report_.waited += wait_politely(peer.out_request);
}

/// Lists and messages of the coming window.
void GrainEnd::share() {
  changed_ = before_ != now_;
  for (std::size_t f = 0; f < peers_.size(); ++f) {
    Peer& peer = peers_[f];
    std::size_t nodes = 0, fresh = 0;
    for (std::size_t s = 0; s < now_.size(); ++s) {
      peer.shared[s] = shared_nodes(reaches_[s], is_.owned[f][s], now_[s], before_[s]);
      nodes += peer.shared[s].all.size();
      fresh += peer.shared[s].fresh.size();
    }
    peer.in.resize(skin_header(now_.size()) + 6 * (nodes + fresh));
    const double* place = peer.in.data() + skin_header(now_.size());
    for (std::size_t s = 0; s < now_.size(); place += 6 * peer.shared[s].all.size(), ++s) peer.place[s] = place;
    for (std::size_t s = 0; s < now_.size(); place += 6 * peer.shared[s].fresh.size(), ++s) peer.fresh_place[s] = place;
  }
}

PairTraffic GrainEnd::traffic() const {
  PairTraffic traffic;
  for (const Peer& peer : peers_) {
    int nodes = 0;
    for (const SharedNodes& shared : peer.shared) nodes += static_cast<int>(shared.all.size());
    traffic.nodes.push_back(nodes);
    traffic.bytes.push_back(peer.bytes);
  }
  return traffic;
}

std::vector<double> GrainEnd::save() const {
  std::vector<double> saved;
  for (std::size_t s = 0; s < now_.size(); ++s)
    for (const Interval& interval : {before_[s], now_[s], moved_[s]})
      saved.insert(saved.end(), {interval.low, interval.high});
  saved.push_back(margin_);
  return saved;
}

std::vector<std::array<Interval, 2>> GrainEnd::intervals_of(const std::vector<double>& saved, std::size_t skins) {
  std::vector<std::array<Interval, 2>> intervals;
  for (std::size_t s = 0; s < skins; ++s) {
    const double* value = saved.data() + 6 * s;
    intervals.push_back({Interval{value[0], value[1]}, Interval{value[2], value[3]}});
  }
  return intervals;
}

void GrainEnd::restore(const std::vector<double>& saved) {
  const auto intervals = intervals_of(saved, now_.size());
  for (std::size_t s = 0; s < now_.size(); ++s) {
    before_[s] = intervals[s][0];
    now_[s] = intervals[s][1];
    moved_[s] = {saved[6 * s + 4], saved[6 * s + 5]};
  }
  margin_ = saved.back();
  share();
}

}  // namespace coupling
