#include "coupling/model_checks.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.hpp"

namespace coupling {

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
      const auto shows_skin = [&](const std::string& name) {
        return std::any_of(scene.bodies.begin(), scene.bodies.end(),
                           [&](const fem::Body& body) { return body.name == name && !body.skin.empty(); });
      };
      if (!overlap || !shows_skin(bodies[a].name) || !shows_skin(bodies[b].name)) continue;
      throw base::UserError(fmt::format(
          "{}: bodies \"{}\" and \"{}\" overlap in the box ({:.4g}, {:.4g}, {:.4g}) .. ({:.4g}, {:.4g}, {:.4g}) m; "
          "bodies "
          "must not share space; change a translation or a mesh parameter",
          scene.file.string(), bodies[a].name, bodies[b].name, lower.x, lower.y, lower.z, upper.x, upper.y, upper.z));
    }
}

void check_step(const std::string& key, const Scene& scene, std::optional<double> step, double limit,
                const std::string& limiter) {
  base::require_user(
      !step || *step <= limit || scene.time.force_step,
      fmt::format(
          "{}: {} = {:.6g} s; must be at most the stable step {:.6g} s ({}); leave {} out to have it chosen, or set "
          "time.force_step = true to run into the instability",
          scene.file.string(), key, step.value_or(0), limit, limiter, key));
}

}  // namespace coupling
