#include "coupling/scene_changes.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <toml++/toml.h>

#include <array>
#include <fstream>
#include <functional>
#include <map>
#include <sstream>
#include <string_view>

namespace coupling {
namespace {

/// Keys that decide nothing about the steps to come.
constexpr std::array left_out{
    "title", "result", "spectrum", "packing.cache", "output.checkpoint_interval", "output.checkpoint_wall_time"};

bool counts(const std::string& key) {
  for (const std::string_view name : left_out)
    if (key == name || (key.starts_with(name) && key[name.size()] == '.')) return false;
  return true;
}

std::string content(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return fmt::format("content {:016x}", std::hash<std::string>{}(text.str()));
}

std::string text_of(const toml::node& node) {
  if (const auto* real = node.as_floating_point()) return fmt::format("{}", real->get());
  if (const auto* array = node.as_array()) {
    std::vector<std::string> entries;
    for (const auto& entry : *array) entries.push_back(text_of(entry));
    return fmt::format("[{}]", fmt::join(entries, ", "));
  }
  std::ostringstream text;
  node.visit([&](const auto& value) { text << value; });
  return text.str();
}

void flatten(const toml::node& node, const std::string& key, std::string& lines) {
  if (!counts(key)) return;
  const auto below = [&](std::string_view name) {
    return key.empty() ? std::string(name) : fmt::format("{}.{}", key, name);
  };
  if (const auto* table = node.as_table()) {
    for (const auto& [name, entry] : *table) flatten(entry, below(name.str()), lines);
    return;
  }
  const auto* array = node.as_array();
  if (array && array->is_array_of_tables()) {
    int number = 0;
    for (const auto& row : *array) {
      const auto name = row.as_table()->get_as<std::string>("name");
      ++number;
      flatten(row, below(name ? name->get() : std::to_string(number)), lines);
    }
    return;
  }
  const auto* text = node.as_string();
  const bool file = text && (key.ends_with(".mesh") || key.ends_with(".file"));
  lines += fmt::format("{} = {}\n", key, file ? content(text->get()) : text_of(node));
}

std::map<std::string, std::string> by_key(const std::string& lines) {
  std::map<std::string, std::string> values;
  std::istringstream in(lines);
  for (std::string line; std::getline(in, line);) {
    const std::size_t equals = line.find(" = ");
    if (equals != std::string::npos) values[line.substr(0, equals)] = line.substr(equals + 3);
  }
  return values;
}

}  // namespace

std::string scene_values(const std::string& resolved_toml) {
  std::string lines;
  flatten(toml::parse(resolved_toml), "", lines);
  return lines;
}

std::vector<std::string> changed_values(const std::string& before, const std::string& now) {
  const auto old_values = by_key(before), new_values = by_key(now);
  std::vector<std::string> changes;
  for (const auto& [key, value] : new_values) {
    const auto old = old_values.find(key);
    if (old == old_values.end())
      changes.push_back(fmt::format("{} = {}, was not there", key, value));
    else if (old->second != value)
      changes.push_back(fmt::format("{} = {}, was {}", key, value, old->second));
  }
  for (const auto& [key, value] : old_values)
    if (!new_values.contains(key)) changes.push_back(fmt::format("{} is gone, was {}", key, value));
  return changes;
}

}  // namespace coupling
