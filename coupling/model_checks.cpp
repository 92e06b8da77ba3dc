#include "coupling/model_checks.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.hpp"

namespace coupling {

namespace {

const fem::Body* with_skin(const Scene& scene, const std::string& name) {
  for (const fem::Body& body : scene.bodies)
    if (body.name == name && !body.skin.empty()) return &body;
  return nullptr;
}

}  // namespace

void check_overlaps(const Scene& scene, std::span<const fem::BodyCounts> bodies) {
  constexpr double slack = 1e-9;  // [m] bodies may touch
  for (std::size_t a = 0; a < bodies.size(); ++a)
    for (std::size_t b = a + 1; b < bodies.size(); ++b) {
      bool overlap = true;
      Vec3 lower, upper;
      for (int d = 0; d < 3; ++d) {
        lower[d] = std::max(bodies[a].lower[d], bodies[b].lower[d]);
        upper[d] = std::min(bodies[a].upper[d], bodies[b].upper[d]);
        overlap = overlap && upper[d] - lower[d] > slack;
      }
      // The cantilevers of one scene may stand in the same place: without a skin bodies never meet.
      const auto* first = with_skin(scene, bodies[a].name);
      const auto* second = with_skin(scene, bodies[b].name);
      if (!overlap || !first || !second) continue;
      throw base::UserError(
          fmt::format("{}: body \"{}\" overlaps body \"{}\" ({}) in the box ({:.4g}, {:.4g}, {:.4g}) .. ({:.4g}, "
                      "{:.4g}, {:.4g}) m; "
                      "bodies must not share space; change a translation or a mesh parameter",
                      second->origin, second->name, first->name, first->origin, lower.x, lower.y, lower.z, upper.x,
                      upper.y, upper.z));
    }
}

void check_step(const std::string& key, const Scene& scene, const std::optional<ChosenStep>& step, double limit,
                const std::string& limiter) {
  if (!step || step->seconds <= limit || scene.time.force_step) return;
  throw base::UserError(fmt::format(
      "{}: {} = {:.6g} s; must be at most the stable step {:.6g} s ({}); leave {} out to have it chosen, or set "
      "time.force_step = true to run into the instability",
      step->origin, key, step->seconds, limit, limiter, key));
}

}  // namespace coupling
