// Declarations and checked values as text: `trackbed list` and the resolved scene.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "base/error.hpp"
#include "base/parameter.hpp"

namespace base {

namespace {

/// Number of columns that a UTF-8 text takes.
std::size_t width(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

std::string whole(const Value& value) {
  if (value.is<Value::List>()) {
    std::string text;
    for (const auto& item : value.list()) text += (text.empty() ? "" : ", ") + whole(item);
    return "[" + text + "]";
  }
  if (value.is<Value::Table>()) {
    std::string text;
    for (const auto& [name, item] : value.table()) {
      Value quoted(name);
      const bool bare = name.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-") ==
                            std::string::npos &&
                        !name.empty();
      text += fmt::format("{}{} = {}", text.empty() ? "" : ", ", bare ? name : show(quoted), whole(item));
    }
    return text.empty() ? "{}" : "{ " + text + " }";
  }
  return show(value);
}

void write(std::string& out, const Value& table, const Table& declaration, const std::string& header) {
  for (const auto& p : declaration.parameters) {
    const Value* value = table.find(p.name);
    if (!value || p.type == Type::table || p.type == Type::tables) continue;
    out += fmt::format("{} = {}{}\n", p.name, whole(*value), p.unit.empty() ? "" : "  # " + p.unit);
  }
  for (const auto& p : declaration.parameters) {
    const Value* value = table.find(p.name);
    if (!value || (p.type != Type::table && p.type != Type::tables)) continue;
    const std::string name = header.empty() ? p.name : header + "." + p.name;
    const bool several = p.type == Type::tables;
    const Value::List rows = several ? value->list() : Value::List{*value};
    for (const auto& row : rows) {
      out += fmt::format("\n{}{}{}\n", several ? "[[" : "[", name, several ? "]]" : "]");
      write(out, row, p.family ? row_of(row, *p.family) : *p.rows, name);
    }
  }
}

}  // namespace

std::string describe(const Table& table) {
  std::vector<std::array<std::string, 6>> lines{{"parameter", "type", "unit", "range", "default", "meaning"}};
  for (const auto& p : table.parameters) {
    const std::string range = p.range.text();
    lines.push_back({p.name, p.type_text(), p.unit.empty() ? "-" : p.unit, range.empty() ? "-" : range,
                     p.default_text(), p.meaning});
  }
  std::array<std::size_t, 6> columns{};
  for (const auto& line : lines) {
    for (std::size_t c = 0; c < columns.size(); ++c) columns[c] = std::max(columns[c], width(line[c]));
  }
  std::string out = fmt::format("{}: {}\n", table.name, table.meaning);
  for (const auto& line : lines) {
    out += " ";
    for (std::size_t c = 0; c < columns.size(); ++c) {
      out += " " + line[c];
      if (c + 1 < columns.size()) out.append(columns[c] - width(line[c]) + 1, ' ');
    }
    out += "\n";
  }
  return out;
}

std::string to_toml(const Value& checked, const Table& declaration) {
  std::string out;
  write(out, checked, declaration, "");
  return out;
}

}  // namespace base
