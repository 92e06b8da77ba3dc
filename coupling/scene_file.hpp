#pragma once
// A scene file as raw values: TOML read, an included file and command-line overrides merged in. Nothing is checked yet.
#include <filesystem>
#include <vector>

#include "base/value.hpp"
#include "coupling/scene.hpp"

namespace coupling {

/// Every value knows the file and line where it was written. Throws base::UserError (no such file, TOML syntax, a
/// circle of includes, an override that leads nowhere).
///
/// `include = "other.toml"` at the top: this file's tables are merged onto that file's. Tables merge key by key; lists
/// of tables whose rows have a `name` merge by name, a new name adds a row; every other value replaces the other
/// file's.
base::Value read_scene_file(const std::filesystem::path&, const std::vector<Override>&);

}  // namespace coupling
