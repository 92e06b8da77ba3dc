#pragma once
// Checks that need meshes or grains: what read_scene() cannot see. Shared by `run` and `check`.
#include <optional>
#include <span>
#include <string>

#include "coupling/scene.hpp"

namespace coupling {

/// Throws base::UserError when the bounding boxes of two bodies share a volume.
void check_overlaps(const Scene&, std::span<const fem::BodyCounts>);

/// Throws base::UserError when a step set by hand exceeds its limit and time.force_step is off.
void check_step(const std::string& key, const Scene&, const std::optional<ChosenStep>&, double limit,
                const std::string& limiter);

}  // namespace coupling
