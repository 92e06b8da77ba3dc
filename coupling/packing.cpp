#include "coupling/packing.hpp"

#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "base/error.hpp"
#include "coupling/packer.hpp"
#include "coupling/packing_cache.hpp"

namespace coupling {
namespace {

/// Interleaves the lowest 21 bits of three cell numbers (Morton order).
std::uint64_t morton(std::uint64_t x, std::uint64_t y, std::uint64_t z) {
  std::uint64_t code = 0;
  for (unsigned bit = 0; bit < 21; ++bit) {
    code |= ((x >> bit & 1) << (3 * bit)) | ((y >> bit & 1) << (3 * bit + 1)) | ((z >> bit & 1) << (3 * bit + 2));
  }
  return code;
}

/// Neighbours in space become neighbours in memory; ids count up from `first_id` in that order.
void sort_by_place(std::vector<dem::Grain>& grains, std::int64_t first_id) {
  if (grains.empty()) return;
  Vec3 lower = grains.front().position;
  double cell = 0;
  for (const dem::Grain& grain : grains) {
    for (int axis = 0; axis < 3; ++axis) lower[axis] = std::min(lower[axis], grain.position[axis]);
    cell = std::max(cell, 2 * grain.radius);
  }
  const auto code = [&](const dem::Grain& grain) {
    const Vec3 offset = (grain.position - lower) * (1 / cell);
    return morton(static_cast<std::uint64_t>(offset.x), static_cast<std::uint64_t>(offset.y),
                  static_cast<std::uint64_t>(offset.z));
  };
  std::vector<std::pair<std::uint64_t, dem::Grain>> coded;
  for (const dem::Grain& grain : grains) coded.emplace_back(code(grain), grain);
  std::sort(coded.begin(), coded.end(), [](const auto& a, const auto& b) {
    return a.first != b.first ? a.first < b.first : a.second.id < b.second.id;
  });
  for (std::size_t i = 0; i < grains.size(); ++i) {
    grains[i] = coded[i].second;
    grains[i].id = first_id + static_cast<std::int64_t>(i);
  }
}

/// Packs until the porosity is within the tolerance. Denser than asked: more friction, and the other way round; between
/// none and the grains' own, halving the interval. The nearest bed is kept.
std::vector<dem::Grain> pack_to_target(const Scene& scene, const std::vector<base::Skin>& skins, dem::Backend backend,
                                       PackingReport& report, const MakeGrains& make) {
  constexpr double same_friction = 1e-3;
  Scene tried = scene;
  Packing& packing = *tried.grains->packing;
  double least = 0, most = scene.grains->interactions.front().friction;
  std::vector<dem::Grain> best;
  for (int attempt = 1;; ++attempt) {
    PackingReport found;
    found.friction = packing.friction;
    std::vector<dem::Grain> grains = Packer(tried, skins, backend, make).run(found);
    const double miss = found.porosity - packing.target_porosity;
    if (attempt == 1 || std::abs(miss) < std::abs(report.porosity - packing.target_porosity)) {
      best = std::move(grains);
      report = found;
    }
    if (packing.tries > 1)
      spdlog::info("try {}: packing friction {:.4g} gives a porosity of {:.3f}", attempt, found.friction,
                   found.porosity);
    (miss < 0 ? least : most) = packing.friction;
    if (attempt >= packing.tries || std::abs(miss) <= packing.tolerance.value_or(0) || most - least < same_friction)
      return best;
    packing.friction = 0.5 * (least + most);
  }
}

void judge(const Packing& packing, const PackingReport& report) {
  constexpr double noticed = 0.03;  // difference that is worth a warning where no tolerance is given
  const double miss = std::abs(report.porosity - packing.target_porosity);
  const std::string text =
      fmt::format("packing: porosity asked {:.3f}, reached {:.3f}", packing.target_porosity, report.porosity);
  if (packing.tolerance && miss > *packing.tolerance) {
    const bool dense = report.porosity < packing.target_porosity;
    throw base::UserError(fmt::format(
        "{}: packing.target_porosity = {:g}; the bed came out at {:.3f}, farther away than packing.tolerance = {:g}; "
        "{} packing.friction = {:.4g}, raise packing.tries{}, or ask for what was reached",
        packing.origin, packing.target_porosity, report.porosity, *packing.tolerance, dense ? "raise" : "lower",
        report.friction, dense ? "" : ", shake the layers (vibration)"));
  }
  if (!packing.tolerance && miss > noticed)
    spdlog::warn("{}", text);
  else
    spdlog::info("{}", text);
}

}  // namespace

dem::Interaction for_beds(dem::Interaction between) {
  if (between.law != "stress_friction") return between;
  between.law = dem::Interaction().law;
  between.critical_stress = between.friction_exponent = 0;
  return between;
}

dem::Interaction while_packing(const dem::Interaction& between, const Packing& packing) {
  dem::Interaction smooth = between;
  smooth.friction = std::min(between.friction, packing.friction);
  smooth.rolling_friction = std::min(between.rolling_friction, packing.rolling_friction);
  return smooth;
}

std::vector<dem::Grain> pack(const Scene& scene, const std::vector<base::Skin>& skins, dem::Backend backend,
                             PackingReport& report, const MakeGrains& make) {
  base::require_internal(scene.grains && scene.grains->packing, "pack() needs a scene with a packing");
  const auto start = std::chrono::steady_clock::now();
  const auto elapsed = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); };
  report = {};
  const bool use_cache = scene.grains->packing->use_cache;
  const auto surfaces = arriving_surfaces(scene, skins);
  const std::string key = packing_key(scene, surfaces, backend);
  if (use_cache) {
    if (auto cached = load_packing(key, report)) {
      report.seconds = elapsed();
      judge(*scene.grains->packing, report);
      return *cached;
    }
  }
  std::vector<dem::Grain> grains = pack_to_target(scene, surfaces, backend, report, make);
  std::int64_t first_id = 0;  // grains that the scene lists keep their own ids
  for (const dem::Grain& grain : scene.grains->list) first_id = std::max(first_id, grain.id + 1);
  sort_by_place(grains, first_id);
  report.grains = static_cast<std::int64_t>(grains.size());
  report.seconds = elapsed();
  if (use_cache) store_packing(key, grains, report);
  judge(*scene.grains->packing, report);
  return grains;
}

}  // namespace coupling
