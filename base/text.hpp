#pragma once
// Small text helpers for messages.
#include <string>
#include <string_view>
#include <vector>

namespace base {

/// Number of insertions, deletions, replacements and swaps of neighbours that turn one text into the other (letters are
/// compared without case; optimal string alignment).
int edit_distance(std::string_view a, std::string_view b);

/// The candidate nearest to a mistyped name; empty when none is near (more than a third of its letters differ).
std::string nearest(std::string_view name, const std::vector<std::string>& candidates);

/// "a, b, c"; "none" when empty.
std::string join(const std::vector<std::string>& parts, std::string_view separator = ", ");

/// `did you mean "x"?`, or `known NOUN: a, b, c` when nothing is near.
std::string suggest(std::string_view name, const std::vector<std::string>& candidates, std::string_view noun);

}  // namespace base
