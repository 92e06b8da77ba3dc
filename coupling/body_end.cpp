#include "coupling/body_end.hpp"

#include <algorithm>

#include "base/error.hpp"
#include "coupling/agree.hpp"

namespace coupling {

BodyEnd::BodyEnd(const Interface& is, MPI_Comm joint, int dem_ranks, int rank)
    : is_(is), joint_(joint), owned_(is.owned[static_cast<std::size_t>(rank)]) {
  for (std::size_t s = 0; s < is.skins.size(); ++s) {
    reaches_.push_back(reaches_of_nodes(is.skins[s]));
    const std::vector<base::Vec3> zero(owned_[s].size());
    for (Field* field : {&leaving_, &told_, &told_velocity_, &start_, &start_velocity_, &waiting_})
      field->push_back(zero);
    for (std::size_t k = 0; k < zero.size(); ++k)
      told_[s][k] = is.skins[s].nodes[static_cast<std::size_t>(owned_[s][k])];
  }
  const std::size_t skins = is.skins.size();
  for (int part = 0; part < dem_ranks; ++part) {
    parts_.push_back({.rank = part,
                      .before = std::vector<Interval>(skins),
                      .now = std::vector<Interval>(skins, everything),
                      .shared = std::vector<SharedNodes>(skins)});
    share(parts_.back());
  }
}

/// Lists and messages of the coming window.
void BodyEnd::share(Part& part) {
  std::size_t nodes = 0, fresh = 0;
  for (std::size_t s = 0; s < part.now.size(); ++s) {
    part.shared[s] = shared_nodes(reaches_[s], owned_[s], part.now[s], part.before[s]);
    nodes += part.shared[s].all.size();
    fresh += part.shared[s].fresh.size();
  }
  part.out.resize(skin_header(part.now.size()) + 6 * (nodes + fresh));
  part.in.resize(impulse_header(part.now.size()) + 3 * nodes);
}

void BodyEnd::begin_window(const fem::Model& model) {
  if (is_.settings.skin_motion != SkinMotion::quadratic) return;
  for (std::size_t s = 0; s < owned_.size(); ++s) {
    std::vector<base::Vec3> positions(owned_[s].size());
    model.skin_state(static_cast<int>(s), positions, leaving_[s]);
  }
}

void BodyEnd::send_skins(const fem::Model& model, double ahead, bool failed) {
  std::swap(start_, told_);
  std::swap(start_velocity_, told_velocity_);
  std::vector<Interval> moved(owned_.size());
  for (std::size_t s = 0; s < owned_.size(); ++s) {
    auto &positions = told_[s], &velocities = told_velocity_[s];
    model.skin_state(static_cast<int>(s), positions, velocities);
    for (std::size_t k = 0; k < positions.size(); ++k) {
      positions[k] += ahead * velocities[k];
      moved[s].include(positions[k].x - is_.skins[s].nodes[static_cast<std::size_t>(owned_[s][k])].x);
    }
    if (is_.settings.skin_motion == SkinMotion::quadratic) velocities = leaving_[s];
  }
  for (Part& part : parts_) {
    double* value = part.out.data();
    const auto put = [&](const base::Vec3& v) {
      for (int d = 0; d < 3; ++d) *value++ = v[d];
    };
    *value++ = failed ? 1 : 0;
    put(applied_);
    for (const Interval& of : moved) {
      *value++ = of.low;
      *value++ = of.high;
    }
    for (std::size_t s = 0; s < owned_.size(); ++s)
      for (const int k : part.shared[s].all) {
        put(told_[s][static_cast<std::size_t>(k)]);
        put(told_velocity_[s][static_cast<std::size_t>(k)]);
      }
    for (std::size_t s = 0; s < owned_.size(); ++s)
      for (const int k : part.shared[s].fresh) {
        put(start_[s][static_cast<std::size_t>(k)]);
        put(start_velocity_[s][static_cast<std::size_t>(k)]);
      }
    MPI_Isend(part.out.data(), static_cast<int>(part.out.size()), MPI_DOUBLE, part.rank, skin_tag, joint_,
              &part.out_request);
  }
}

bool BodyEnd::receive_impulses(double& waited) {
  for (Part& part : parts_)
    MPI_Irecv(part.in.data(), static_cast<int>(part.in.size()), MPI_DOUBLE, part.rank, impulse_tag, joint_,
              &part.in_request);
  bool sound = true;
  for (Part& part : parts_) {
    waited += wait_politely(part.in_request);
    sound = sound && part.in[0] == 0;
  }
  // The sends lie in buffers that are about to change.
  waited += finish_window();
  if (!sound) return false;
  for (auto& impulses : waiting_) std::ranges::fill(impulses, base::Vec3{});
  for (Part& part : parts_) {
    const double* value = part.in.data() + impulse_header(owned_.size());
    for (std::size_t s = 0; s < owned_.size(); ++s)
      for (const int k : part.shared[s].all) {
        waiting_[s][static_cast<std::size_t>(k)] += base::Vec3{value[0], value[1], value[2]};
        value += 3;
      }
    std::vector<Interval> next;
    for (std::size_t s = 0; s < owned_.size(); ++s) next.push_back({part.in[1 + 2 * s], part.in[2 + 2 * s]});
    const bool changes = part.now != next || part.before != part.now;
    part.before = std::exchange(part.now, next);
    if (changes) share(part);
  }
  return true;
}

void BodyEnd::apply(fem::Model& model, double window) {
  applied_ = {};
  std::vector<base::Vec3> forces;
  for (std::size_t s = 0; s < waiting_.size(); ++s) {
    forces.clear();
    for (const auto& impulse : waiting_[s]) {
      forces.push_back((1.0 / window) * impulse);
      applied_ += window * forces.back();
    }
    model.set_skin_forces(static_cast<int>(s), forces);
  }
}

double BodyEnd::finish_window() {
  double waited = 0;
  for (Part& part : parts_)
    if (part.out_request != MPI_REQUEST_NULL) waited += wait_politely(part.out_request);
  return waited;
}

void BodyEnd::restore(std::span<const std::vector<std::array<Interval, 2>>> intervals) {
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    for (std::size_t s = 0; s < owned_.size(); ++s) {
      parts_[p].before[s] = intervals[p][s][0];
      parts_[p].now[s] = intervals[p][s][1];
    }
    share(parts_[p]);
  }
}

/// Fields that the next window depends on, by their names in a checkpoint.
template <class Self, class Visit>
void BodyEnd::each_field(Self& self, const Visit& visit) {
  visit("exchange/waiting_", self.waiting_);
  visit("exchange/told_", self.told_);
  visit("exchange/told_velocity_", self.told_velocity_);
}

void BodyEnd::save(base::Columns& columns, MPI_Comm fem) const {
  int rank = 0;
  MPI_Comm_rank(fem, &rank);
  each_field(*this, [&](const std::string& name, const Field& field) {
    for (std::size_t s = 0; s < owned_.size(); ++s) {
      std::vector<base::Vec3> mine(is_.skins[s].nodes.size()), all(mine.size());
      for (std::size_t k = 0; k < owned_[s].size(); ++k) mine[static_cast<std::size_t>(owned_[s][k])] = field[s][k];
      MPI_Reduce(mine.data(), all.data(), static_cast<int>(3 * mine.size()), MPI_DOUBLE, MPI_SUM, 0, fem);
      if (rank == 0) base::Saver(columns).rows(name + std::to_string(s), all);
    }
  });
}

void BodyEnd::load(const base::Columns& columns) {
  each_field(*this, [&](const std::string& name, Field& field) {
    for (std::size_t s = 0; s < owned_.size(); ++s) {
      std::vector<base::Vec3> all;
      base::Loader(columns).rows(name + std::to_string(s), all);
      base::require_user(all.size() == is_.skins[s].nodes.size(), "skin " + is_.skins[s].body + " has other nodes");
      for (std::size_t k = 0; k < owned_[s].size(); ++k) field[s][k] = all[static_cast<std::size_t>(owned_[s][k])];
    }
  });
}

}  // namespace coupling
