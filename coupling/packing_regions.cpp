// Parts of the bed that are not sound.
// Loosened (Irazabal2017 7.2.3, the bumpy track): he packs the grains of the loose section with a friction of 0.6
// between them and the rest of the track without friction, and reaches porosities of 0.4386 and 0.3941. `friction` does
// the same: a grain counts to the region when the place where it is about to come to rest, were the poured column
// pressed together evenly, lies in the box; grains of the region meet each other with that friction and all others with
// the packing's. Where we differ: `share` takes that share of the grains in the box out of the finished bed, at random,
// and lets it settle with the scene's own friction: how much looser the bed gets is then chosen, not found.
// Measured (poured without friction, box of 0.22 m, walls included): a friction of 0.6 makes 0.452 of 0.426.
// Eroded (7.2.4): he packs the whole track, gives the grains their own friction, opens a part of the floor and lets
// them fall through until the rest stands freely. Here the hole is a box: grains whose centre comes into it are taken
// out until none comes any more. A box on the floor is his hole; a box up to the surface takes the shoulder away, one
// under a sleeper its support. Bodies stand still meanwhile, as they do in all of the packing.
#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <unordered_set>

#include "base/error.hpp"
#include "coupling/measure.hpp"
#include "coupling/packer.hpp"

namespace coupling {
namespace {

constexpr double settle_earliest = 0.1;  // [s] that the bed gets at least: it takes time to start moving
constexpr double settle_time = 0.5;      // [s] at most, after loosening
constexpr double look = 0.01;            // [s] between looks at what has come into an eroded box
constexpr int quiet_looks = 10;          // in a row without a grain, after which none is expected

void require_some(const dem::Simulation& grains, const std::string& origin, const std::string& key) {
  base::require_user(!grains.grains().empty(),
                     fmt::format("{}: {}: no grain of the bed is left; make the box smaller", origin, key));
}

}  // namespace

int Packer::material_at(const Vec3& place) const {
  int material = static_cast<int>(scene_.grains->materials.size());
  for (const LooseRegion& region : packing_.loosened) {
    if (!region.friction) continue;
    if (contains(region.box, place)) return material;
    ++material;
  }
  return 0;
}

void Packer::loosen() {
  for (std::size_t i = 0; i < packing_.loosened.size(); ++i) {
    const LooseRegion& region = packing_.loosened[i];
    PackingStep done{"loosen", static_cast<int>(i + 1), 0, region_.porosity_in(region.box, simulation_->spheres()), 0};
    if (region.share > 0) {
      std::vector<std::int64_t> inside;
      for (const dem::Grain& grain : simulation_->grains()) {
        if (contains(region.box, grain.position)) inside.push_back(grain.id);
      }
      dem::Random random(packing_.seed + 40000003 * (i + 1));
      const auto count = static_cast<std::size_t>(std::lround(region.share * static_cast<double>(inside.size())));
      for (std::size_t k = 0; k < count; ++k) std::swap(inside[k], inside[k + random.index(inside.size() - k)]);
      done.taken = static_cast<std::int64_t>(count);
      const std::unordered_set<std::int64_t> chosen(inside.begin(),
                                                    inside.begin() + static_cast<std::ptrdiff_t>(count));
      remove_if([&](const dem::Grain& grain) { return chosen.count(grain.id) > 0; });
      spdlog::info("loosened region {}: {} of {} grains taken out", i + 1, count, inside.size());
      require_some(*simulation_, region.origin, "packing.loosen");
      settle(settle_earliest, settle_time);
    }
    done.porosity_after = region_.porosity_in(region.box, simulation_->spheres());
    steps_.push_back(done);
    spdlog::info("loosened region {}: porosity {:.3f} before, {:.3f} after; {:.3f} in the sound bed", i + 1,
                 done.porosity_before, done.porosity_after, region_.porosity(simulation_->spheres(), median_));
  }
}

void Packer::erode() {
  for (std::size_t i = 0; i < packing_.eroded.size(); ++i) {
    const ErodedRegion& region = packing_.eroded[i];
    phase_ = fmt::format("packing: eroded region {}", i + 1);
    PackingStep done{"erode", static_cast<int>(i + 1), 0, region_.porosity_in(region.box, simulation_->spheres()), 0};
    const auto swallowed = [&](const dem::Grain& grain) {
      return contains(region.box, grain.position) && (!region.above || height_above(*region.above, grain.position) > 0);
    };
    int quiet = 0;
    double time = 0;
    for (; time < region.settle && quiet < quiet_looks; time += look) {
      const std::size_t taken = remove_if(swallowed);
      done.taken += static_cast<std::int64_t>(taken);
      quiet = taken > 0 ? 0 : quiet + 1;
      if (taken > 0) require_some(*simulation_, region.origin, "packing.erode");
      advance(look);
      show(0);
    }
    if (quiet < quiet_looks)
      spdlog::warn("{}: packing.erode: grains still come into the box after {:g} s; raise packing.erode.settle",
                   region.origin, region.settle);
    settle(0, settle_time);
    done.taken += static_cast<std::int64_t>(remove_if(swallowed));
    done.porosity_after = region_.porosity_in(region.box, simulation_->spheres());
    steps_.push_back(done);
    spdlog::info("eroded region {}: {} grains taken out in {:.2f} s; porosity {:.3f} before, {:.3f} after", i + 1,
                 done.taken, time, done.porosity_before, done.porosity_after);
  }
}

}  // namespace coupling
