#pragma once
// The packing phase of a scene: grains only, deformable bodies stand in as rigid surfaces.
#include <vector>

#include "coupling/scene.hpp"

namespace coupling {

struct PackingReport {
  double porosity = 0;      // of the packed region (all layer boxes, inside walls and cuts, outside the bodies)
  double coordination = 0;  // mean contacts per grain at the end of packing
  std::int64_t grains = 0;
  double seconds = 0;  // [s] wall time
  bool from_cache = false;
};

/// Packs the scene's grains, or reads them from the cache. `skins`: one per deformable body that has a skin.
/// Deterministic: the same scene gives bit-identical grains on the same backend, whatever the number of threads.
std::vector<dem::Grain> pack(const Scene&, const std::vector<base::Skin>& skins, dem::Backend, PackingReport&);

}  // namespace coupling
