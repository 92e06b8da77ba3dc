#pragma once
// Which code this is. Written into every run directory.
#include <string_view>

namespace base {

/// "0.1.0"
std::string_view version();
/// Git commit, shortened; "-dirty" at its end when files differ from it; "unknown" outside a git checkout.
std::string_view commit();

}  // namespace base
