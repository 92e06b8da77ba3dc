#pragma once
// Whether a run may go on with a scene: every value of the scene as text, and which of them are others than before.
#include <string>
#include <vector>

namespace coupling {

/// One line `key = value` for everything in a resolved scene that decides how the run goes on; rows of lists go by
/// their names. A file that the scene names counts by its content. Left out: titles, results, spectra, how often
/// checkpoints are written.
std::string scene_values(const std::string& resolved_toml);

/// What differs, a text per key: `time.dem_fraction = 0.2, was 0.1`.
std::vector<std::string> changed_values(const std::string& before, const std::string& now);

}  // namespace coupling
