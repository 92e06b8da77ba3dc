#pragma once
// The packing phase of a scene: grains only, deformable bodies stand in as rigid surfaces.
#include <string>
#include <vector>

#include "coupling/make_grains.hpp"
#include "coupling/scene.hpp"

namespace coupling {

/// Something done to a layer or a region, and what it changed.
struct PackingStep {
  std::string what;                                // growth | vibration | loosen | erode
  int number = 0;                                  // of the layer or region, from 1
  std::int64_t taken = 0;                          // grains taken out
  double porosity_before = 0, porosity_after = 0;  // of the layer's inside, or of the region's box
};

struct PackingReport {
  double porosity = 0;      // of the packed region (all layer boxes, inside walls and cuts, outside the bodies), apart
                            // from boxes that are loosened or eroded, and before they are
  double coordination = 0;  // mean contacts per grain at the end of packing
  double friction = 0;      // while packing
  std::vector<PackingStep> steps;
  std::int64_t grains = 0;
  double seconds = 0;  // [s] wall time
  bool from_cache = false;
};

/// Packs the scene's grains, or reads them from the cache. `skins`: one per deformable body that has a skin.
/// Throws base::UserError when the scene cannot be packed, or the porosity reached is outside the scene's tolerance.
/// Deterministic: the same scene gives bit-identical grains on the same backend and number of threads; the cache does
/// not look at that number.
std::vector<dem::Grain> pack(const Scene&, const std::vector<base::Skin>& skins, dem::Backend, PackingReport&,
                             const MakeGrains& = dem::Simulation::create);

/// The scene's interaction as beds are made with it: friction that falls with stress is the classical one there, so
/// that one bed serves the tests of both (Irazabal2017 6.3.2, 6.3.4).
dem::Interaction for_beds(dem::Interaction);

/// The interaction with the frictions of the packing, where they are the lower ones.
dem::Interaction while_packing(const dem::Interaction&, const Packing&);

/// Methods, target and regions of a packing, for `trackbed check`.
std::string packing_text(const Packing&);

}  // namespace coupling
