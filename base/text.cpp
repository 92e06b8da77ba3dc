#include "base/text.hpp"

#include <algorithm>
#include <cctype>

namespace base {

namespace {
char lower(char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); }
}  // namespace

int edit_distance(std::string_view a, std::string_view b) {
  const std::size_t rows = a.size() + 1, columns = b.size() + 1;
  std::vector<int> d(rows * columns);
  auto at = [&](std::size_t i, std::size_t j) -> int& { return d[i * columns + j]; };
  for (std::size_t i = 0; i < rows; ++i) at(i, 0) = static_cast<int>(i);
  for (std::size_t j = 0; j < columns; ++j) at(0, j) = static_cast<int>(j);
  for (std::size_t i = 1; i < rows; ++i) {
    for (std::size_t j = 1; j < columns; ++j) {
      const bool same = lower(a[i - 1]) == lower(b[j - 1]);
      at(i, j) = std::min({at(i - 1, j) + 1, at(i, j - 1) + 1, at(i - 1, j - 1) + (same ? 0 : 1)});
      const bool swapped = i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) && lower(a[i - 2]) == lower(b[j - 1]);
      if (swapped) at(i, j) = std::min(at(i, j), at(i - 2, j - 2) + 1);
    }
  }
  return at(rows - 1, columns - 1);
}

std::string nearest(std::string_view name, const std::vector<std::string>& candidates) {
  std::string best;
  int best_distance = 0;
  for (const auto& candidate : candidates) {
    const int longest = static_cast<int>(std::max(name.size(), candidate.size()));
    const int distance = edit_distance(name, candidate);
    if (distance > std::max(1, longest / 3) || distance >= longest) continue;
    if (best.empty() || distance < best_distance) {
      best = candidate;
      best_distance = distance;
    }
  }
  return best;
}

std::string join(const std::vector<std::string>& parts, std::string_view separator) {
  if (parts.empty()) return "none";
  std::string all = parts.front();
  for (std::size_t i = 1; i < parts.size(); ++i) all.append(separator).append(parts[i]);
  return all;
}

std::string suggest(std::string_view name, const std::vector<std::string>& candidates, std::string_view noun) {
  const std::string near = nearest(name, candidates);
  if (!near.empty()) return "did you mean \"" + near + "\"?";
  return "known " + std::string(noun) + ": " + join(candidates);
}

}  // namespace base
