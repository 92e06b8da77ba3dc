#include "coupling/scene_file.hpp"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "base/error.hpp"
#include "base/text.hpp"

namespace coupling {

namespace {

namespace fs = std::filesystem;
using base::Value;

Value convert(const toml::node& node, const std::string& file, const std::string& key) {
  Value value;
  value.file = file;
  value.line = static_cast<int>(node.source().begin.line);
  value.key = key;
  if (const auto* table = node.as_table()) {
    for (const auto& [name, entry] : *table) {
      const std::string text(name.str());
      Value item = convert(entry, file, key.empty() ? text : key + "." + text);
      // A key's own line is where the user looks; a header like [a.b] gives no line to a.
      if (item.line == 0) item.line = static_cast<int>(name.source().begin.line);
      value.table()[text] = std::move(item);
    }
    if (value.line == 0 && !table->empty()) value.line = static_cast<int>(table->begin()->second.source().begin.line);
  } else if (const auto* array = node.as_array()) {
    Value::List items;
    for (const auto& entry : *array) items.push_back(convert(entry, file, key));
    value.data = std::move(items);
  } else if (const auto* text = node.as_string()) {
    value.data = text->get();
  } else if (const auto* integer = node.as_integer()) {
    value.data = integer->get();
  } else if (const auto* number = node.as_floating_point()) {
    value.data = number->get();
  } else if (const auto* boolean = node.as_boolean()) {
    value.data = boolean->get();
  } else {
    throw base::UserError(
        fmt::format("{}: {}; dates and times have no use in a scene; remove it", value.origin(), key));
  }
  return value;
}

/// Rows of a list of tables that all have a name.
bool rows_have_names(const Value& value) {
  return value.is<Value::List>() && !value.list().empty() &&
         std::all_of(value.list().begin(), value.list().end(), [](const Value& row) {
           const Value* name = row.is<Value::Table>() ? row.find("name") : nullptr;
           return name && name->is<std::string>();
         });
}

void merge(Value& below, Value above) {
  if (below.is<Value::Table>() && above.is<Value::Table>()) {
    for (auto& [name, value] : above.table()) {
      const auto known = below.table().find(name);
      if (known == below.table().end()) {
        below.table()[name] = std::move(value);
      } else {
        merge(known->second, std::move(value));
      }
    }
    return;
  }
  if (rows_have_names(below) && rows_have_names(above)) {
    for (auto& row : above.list()) {
      auto& rows = below.list();
      const auto known = std::find_if(rows.begin(), rows.end(), [&](const Value& candidate) {
        return candidate.at("name").text() == row.at("name").text();
      });
      if (known == rows.end()) {
        rows.push_back(std::move(row));
      } else {
        merge(*known, std::move(row));
      }
    }
    return;
  }
  below = std::move(above);
}

Value read_file(const fs::path& path, std::vector<fs::path> above) {
  std::error_code ignored;
  if (!fs::is_regular_file(path, ignored)) {
    throw base::UserError(fmt::format("{}: no such scene file; give the path of a .toml file", path.string()));
  }
  const fs::path full = fs::weakly_canonical(path);
  if (std::find(above.begin(), above.end(), full) != above.end()) {
    throw base::UserError(fmt::format("{}: the file includes itself; break the circle of includes", path.string()));
  }
  above.push_back(full);
  base::require_user(std::ifstream(path).good(),
                     fmt::format("{}: no permission to read it; change its permissions or copy it", path.string()));
  Value raw;
  try {
    raw = convert(toml::parse_file(path.string()), path.string(), "");
  } catch (const toml::parse_error& error) {
    throw base::UserError(fmt::format("{}:{}: not valid TOML: {}; column {}", path.string(),
                                      static_cast<int>(error.source().begin.line), error.description(),
                                      static_cast<int>(error.source().begin.column)));
  }
  raw.line = 0;
  const Value* include = raw.find("include");
  if (!include) return raw;
  if (!include->is<std::string>()) base::fail(*include, "must be a file name", "put it in quotes");
  const fs::path other = (path.parent_path() / include->text()).lexically_normal();
  if (!fs::is_regular_file(other, ignored)) {
    base::fail(*include, fmt::format("no such file: {}", fs::absolute(other).string()),
               "give a path relative to the folder of " + path.string());
  }
  raw.table().erase("include");
  Value below = read_file(other, above);
  below.file = raw.file;
  merge(below, std::move(raw));
  return below;
}

void mark_override(Value& value) {
  value.file = "--set";
  value.line = 0;
  if (value.is<Value::Table>()) {
    for (auto& [name, entry] : value.table()) mark_override(entry);
  } else if (value.is<Value::List>()) {
    for (auto& entry : value.list()) mark_override(entry);
  }
}

/// A TOML value where the text is one (0.5, true, [1, 2], "x"), else the text itself (20 ms, tet4).
Value override_value(const std::string& text) {
  Value value(text);
  try {
    const toml::table parsed = toml::parse("value = " + text);
    if (parsed.size() == 1) value = convert(*parsed.get("value"), "--set", "");
  } catch (const toml::parse_error&) {
  } catch (const base::UserError&) {
  }
  mark_override(value);
  return value;
}

/// Row of a list that a part of an override's key means: its name, or its number counted from 1.
Value* find_row(Value& list, const std::string& part) {
  auto& rows = list.list();
  for (auto& row : rows) {
    const Value* name = row.is<Value::Table>() ? row.find("name") : nullptr;
    if (name && name->is<std::string>() && name->text() == part) return &row;
  }
  const bool number = !part.empty() && part.size() < 6 && part.find_first_not_of("0123456789") == std::string::npos;
  const std::size_t index = number ? std::stoul(part) : 0;
  return index >= 1 && index <= rows.size() ? &rows[index - 1] : nullptr;
}

std::vector<std::string> row_names(const Value& list) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < list.list().size(); ++i) {
    const Value& row = list.list()[i];
    const Value* name = row.is<Value::Table>() ? row.find("name") : nullptr;
    names.push_back(name && name->is<std::string>() ? name->text() : std::to_string(i + 1));
  }
  return names;
}

struct Assignment {
  std::string origin;              // "--set key=value", for messages
  std::vector<std::string> parts;  // of the dotted key
  Value value;
};

/// Follows the key from its part number `next` on, and assigns at its end.
void assign(Value& here, std::size_t next, const Assignment& set) {
  const bool last = next + 1 == set.parts.size();
  if (here.is<Value::List>()) {
    if (Value* row = find_row(here, set.parts[next])) {
      if (last) throw base::UserError(set.origin + ": names a table; add the key to set in it");
      assign(*row, next + 1, set);
    } else if (here.list().size() == 1) {  // the only row needs no name
      assign(here.list()[0], next, set);
    } else {
      throw base::UserError(fmt::format("{}: no row \"{}\"; {}", set.origin, set.parts[next],
                                        base::suggest(set.parts[next], row_names(here), "rows")));
    }
  } else if (!here.is<Value::Table>()) {
    throw base::UserError(
        fmt::format("{}: {} holds a value, not a table; remove .{}", set.origin, set.parts[next - 1], set.parts[next]));
  } else if (last) {
    here.table()[set.parts[next]] = set.value;
  } else {
    if (!here.has(set.parts[next])) {
      Value table;
      mark_override(table);
      here.table()[set.parts[next]] = table;
    }
    assign(here.at(set.parts[next]), next + 1, set);
  }
}

void apply(Value& root, const Override& setting) {
  Assignment set{"--set " + setting.key + "=" + setting.value, {}, override_value(setting.value)};
  std::istringstream words(setting.key);
  for (std::string part; std::getline(words, part, '.');) set.parts.push_back(part);
  if (set.parts.empty() || std::find(set.parts.begin(), set.parts.end(), "") != set.parts.end()) {
    throw base::UserError(set.origin + ": the key has an empty part; write --set table.key=value");
  }
  assign(root, 0, set);
}

}  // namespace

Value read_scene_file(const fs::path& file, const std::vector<Override>& overrides) {
  Value raw = read_file(file, {});
  for (const auto& setting : overrides) apply(raw, setting);
  return raw;
}

}  // namespace coupling
