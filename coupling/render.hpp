#pragma once
// `trackbed render`: pictures of a finished run.
#include <filesystem>
#include <vector>

namespace coupling {

/// Writes PNGs and index.html into RUNDIR/pictures and returns the files made. Needs a display (xvfb-run).
/// Throws base::UserError when the folder holds no run.
std::vector<std::filesystem::path> render(const std::filesystem::path& run_directory);

}  // namespace coupling
