#pragma once
// Finished packings on disk, named by the hash of everything that made them. The folder is $TRACKBED_CACHE, else
// $XDG_CACHE_HOME/trackbed, else ~/.cache/trackbed. A damaged file or a folder that cannot be written costs a warning
// and a new packing, never the run.
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "coupling/packing.hpp"

namespace coupling {

/// 16 hexadecimal digits over all that decides the packing: grains, walls, layers, step, body surfaces, backend.
std::string packing_key(const Scene&, const std::vector<base::Skin>& skins, dem::Backend);

/// Nothing when there is no such packing, or an unreadable one (one warning). Fills the report's measured values.
std::optional<std::vector<dem::Grain>> load_packing(const std::string& key, PackingReport&);

/// Written under another name first, then renamed: a reader never sees half a file.
void store_packing(const std::string& key, std::span<const dem::Grain>, const PackingReport&);

}  // namespace coupling
