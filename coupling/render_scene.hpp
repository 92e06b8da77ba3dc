#pragma once
// The three-dimensional pictures of a run at one moment: the whole bay, and cuts across the track.
#include <filesystem>
#include <vector>

#include "coupling/run_directory.hpp"

namespace coupling {

/// Draws view.png, and with enough grains to fill a section cut_stress.png and cut_displacement.png (middle of the bay
/// along the track, seen along -x). Needs a display. Returns the files written; none when no state was written.
std::vector<std::filesystem::path> render_scene(const RunDirectory&, const Moment&,
                                                const std::filesystem::path& pictures);

}  // namespace coupling
