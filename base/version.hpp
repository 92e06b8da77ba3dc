#pragma once
// Which code this is: printed by `trackbed --version` and written into every run directory.
#include <string_view>

namespace base {

/// Version and git commit, "0.1.0 (0123456789ab)". The commit ends in "-dirty" when files differ from it, and is
/// "unknown" outside a git checkout.
std::string_view code_version();

}  // namespace base
