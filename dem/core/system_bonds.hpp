#pragma once
// The simulation's side of bonds: making them, their host copies, and their part of the stable step.
#include <map>
#include <unordered_map>

#include "dem/contact_step.hpp"
#include "dem/core/system.hpp"

namespace dem::TRACKBED_DEM_SYSTEM {

inline void System::add_bonds(std::span<const Bond> bonds) {
  if (bonds.empty()) return;
  base::require_user(!in_company(), "dem: bonds need all grains in one place; use one rank for grains");
  const auto ids = download(grains_.id);
  const auto place = download(grains_.place);
  std::unordered_map<std::int64_t, int> sphere;
  for (std::size_t s = 0; s < ids.size(); ++s) sphere[ids[s]] = static_cast<int>(s);
  const auto shape = download(bodies_.shape), body = download(bodies_.of_sphere);
  const auto named = [](const Bond& b) {
    return "dem: bond of grains " + std::to_string(b.i) + " and " + std::to_string(b.j);
  };
  std::map<std::array<std::int64_t, 2>, bool> bonded;
  for (const BondNow& b : this->bonds())
    if (!b.broken) bonded[{std::min(b.i, b.j), std::max(b.i, b.j)}] = true;
  std::vector<std::int64_t> ends;
  std::vector<BondRow> rows;
  for (const Bond& b : bonds) {
    check_bond(b.is);
    base::require_user(b.i != b.j, named(b) + ": a grain cannot be bonded to itself");
    for (const std::int64_t id : {b.i, b.j}) {
      const auto found = sphere.find(id);
      base::require_user(found != sphere.end(), named(b) + ": there is no grain " + std::to_string(id));
      base::require_user(shape.empty() || shape[body[found->second]] < 0,
                         named(b) + ": grain " + std::to_string(id) + " is a clump; bonds join spheres");
    }
    base::require_user(bonded.emplace(std::array{std::min(b.i, b.j), std::max(b.i, b.j)}, true).second,
                       named(b) + ": they are bonded already");
    const Place &i = place[sphere[b.i]], &j = place[sphere[b.j]];
    const Vec3 between = periods_.shortest(i.position - j.position);
    const double distance = norm(between);
    base::require_user(distance > 0, named(b) + ": they are at one place");
    ends.insert(ends.end(), {b.i, b.j});
    rows.push_back({b.is, {i.radius + j.radius - distance, (1 / distance) * between, {}}, 0});
  }
  bonds_.add(ends, rows, setup_.track_energy);
  list_is_stale_ = forces_are_stale_ = true;
}

inline std::vector<BondNow> System::bonds() const {
  const auto id = download(bonds_.id);
  const auto row = download(bonds_.row);
  const auto pull = download(bonds_.pull);
  const auto ledger = download(bonds_.ledger);
  std::vector<BondNow> now;
  for (std::size_t b = 0; b < row.size(); ++b) {
    if (!(row[b].is.radius > 0) && !row[b].broken) continue;  // its grain is gone
    now.push_back({id[2 * b], id[2 * b + 1], row[b].broken != 0, pull[b].force, pull[b].moment,
                   ledger.empty() ? 0 : ledger[b].elastic});
  }
  return now;
}

/// Springs of the bonds that hold, as both their grains see them.
inline std::vector<GrainSpring> System::bond_springs() const {
  std::vector<GrainSpring> springs;
  if (!bonds_.any()) return springs;
  const auto ids = download(grains_.id);
  const auto place = download(grains_.place);
  const auto body = download(bodies_.of_sphere);
  const auto id = download(bonds_.id);
  const auto row = download(bonds_.row);
  std::unordered_map<std::int64_t, int> sphere;
  for (std::size_t s = 0; s < ids.size(); ++s) sphere[ids[s]] = static_cast<int>(s);
  for (std::size_t b = 0; b < row.size(); ++b) {
    const auto i = sphere.find(id[2 * b]), j = sphere.find(id[2 * b + 1]);
    if (!(row[b].is.radius > 0) || i == sphere.end() || j == sphere.end()) continue;
    const kernels::BondSection section(row[b].is);
    const Vec3 between = periods_.shortest(place[i->second].position - place[j->second].position);
    const double distance = norm(between), overlap = place[i->second].radius + place[j->second].radius - distance;
    GrainSpring s;
    s.normal = distance > 0 ? (1 / distance) * between : row[b].state.normal;
    s.normal_stiffness = section.normal_stiffness;
    s.shear_stiffness = section.shear_stiffness;
    s.bending_stiffness = section.bending_stiffness;
    s.twist_stiffness = section.twist_stiffness;
    s.bond = true;
    for (const auto& [sphere_of, sign] : {std::pair{i->second, -1.0}, std::pair{j->second, 1.0}}) {
      s.grain = body.empty() ? sphere_of : body[sphere_of];
      s.lever = (sign * (place[sphere_of].radius - 0.5 * overlap)) * s.normal;
      springs.push_back(s);
    }
  }
  return springs;
}

/// A limit without bonds, and with them: highest frequencies add up, omega^2 <= omega_1^2 + omega_2^2.
inline StableStep System::with_bonds(const StableStep& without) const {
  const auto springs = bond_springs();
  if (springs.empty()) return without;
  const StableStep bonds = contact_step(inertias(), springs);
  const double omega_1 = 1 / without.limit, omega_2 = 1 / bonds.limit;
  return {1 / std::sqrt(omega_1 * omega_1 + omega_2 * omega_2), omega_2 > omega_1
                                                                    ? bonds.limiter + ", with " + without.limiter
                                                                    : without.limiter + ", with " + bonds.limiter};
}

}  // namespace dem::TRACKBED_DEM_SYSTEM
