#pragma once
// Grains that change their size between two calls of advance().
#include "dem/core/system_bodies.hpp"

namespace dem::TRACKBED_DEM_SYSTEM {

struct ScaleSphere {
  const double* factor;  // of every grain
  Place* place;
  TRACKBED_HD void operator()(int g) const { place[g].radius *= factor[g]; }
};

struct ScaleBody {
  const double* factor;  // of every body
  Place* place;          // of bodies
  double* volume;
  Vec3* inertia_per_mass;
  const int* start;
  Place* sphere;
  Vec3* offset;
  TRACKBED_HD void operator()(int b) const {
    const double f = factor[b];
    place[b].radius *= f;
    volume[b] *= f * f * f;
    inertia_per_mass[b] *= f * f;
    for (int s = start[b]; s < start[b + 1]; ++s) {
      sphere[s].radius *= f;
      offset[s] *= f;
    }
  }
};

inline void System::scale_grains(std::span<const std::int64_t> ids, double factor) {
  base::require_user(factor > 0 && std::isfinite(factor), "dem: grains can be scaled by a factor > 0 only");
  std::vector<std::int64_t> chosen(ids.begin(), ids.end());
  std::sort(chosen.begin(), chosen.end());
  std::vector<double> factors;
  for (const std::int64_t id : download(bodies_.any() ? bodies_.id : grains_.id))
    factors.push_back(std::binary_search(chosen.begin(), chosen.end(), id) ? factor : 1);
  settle_gravity();
  Vector<double> of_row;
  upload(factors, of_row);
  if (bodies_.any()) {
    launch(bodies_.size(), ScaleBody{pointer(of_row), pointer(bodies_.place), pointer(bodies_.volume),
                                     pointer(bodies_.inertia_per_mass), pointer(bodies_.start), pointer(grains_.place),
                                     pointer(bodies_.offset)});
    carry_spheres();
  } else {
    launch(grains_.size(), ScaleSphere{pointer(of_row), pointer(grains_.place)});
  }
  set_masses();
  mark_grains_changed();
}

}  // namespace dem::TRACKBED_DEM_SYSTEM
