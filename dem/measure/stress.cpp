#include "dem/measure/stress.hpp"

#include <algorithm>
#include <cmath>

namespace dem {
namespace {

const Grain* find(std::span<const Grain> grains, std::int64_t id) {
  const auto found = std::lower_bound(grains.begin(), grains.end(), id,
                                      [](const Grain& grain, std::int64_t value) { return grain.id < value; });
  return found != grains.end() && found->id == id ? &*found : nullptr;
}

void add(RegionStress& sum, double weight, const Vec3& f, const Vec3& l) {
  sum.xx += weight * f.x * l.x;
  sum.yy += weight * f.y * l.y;
  sum.zz += weight * f.z * l.z;
  sum.xy += weight * 0.5 * (f.x * l.y + f.y * l.x);
  sum.yz += weight * 0.5 * (f.y * l.z + f.z * l.y);
  sum.zx += weight * 0.5 * (f.z * l.x + f.x * l.z);
}

}  // namespace

double RegionStress::von_mises() const {
  const double a = xx - yy, b = yy - zz, c = zz - xx;
  return std::sqrt(0.5 * (a * a + b * b + c * c) + 3 * (xy * xy + yz * yz + zx * zx));
}

RegionStress region_stress(const Region& region, std::span<const Grain> grains,
                           std::span<const GrainContact> grain_contacts, std::span<const WallContact> wall_contacts) {
  RegionStress sum;
  const double whole = volume(region);
  if (!(whole > 0)) return sum;
  const auto carry = [&](const Vec3& from, const Vec3& to, const Vec3& force) {
    const double share = share_inside(region, from, to);
    if (share > 0) add(sum, share / whole, force, to - from);
  };
  for (const GrainContact& contact : grain_contacts) {
    const Grain *i = find(grains, contact.id_i), *j = find(grains, contact.id_j);
    if (i == nullptr || j == nullptr) continue;
    carry(i->position, j->position + contact.period, contact.force);
    // Across a periodic face the rest of the branch lies at the other face.
    if (norm2(contact.period) > 0) carry(i->position - contact.period, j->position, contact.force);
  }
  for (const WallContact& contact : wall_contacts) {
    if (const Grain* grain = find(grains, contact.id)) carry(grain->position, contact.point, contact.force);
  }
  return sum;
}

}  // namespace dem
