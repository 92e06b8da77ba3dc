#pragma once
// index.html: the pictures of a run and its table of results on one page.
#include <filesystem>
#include <string>
#include <vector>

#include "coupling/run_directory.hpp"

namespace coupling {

/// The page as text. `pictures`: files in the same folder as the page.
std::string results_page(const RunDirectory&, const std::vector<std::filesystem::path>& pictures);

}  // namespace coupling
