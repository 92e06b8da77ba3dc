// Reading a raw value by its declaration: types, units, ranges, names of keys, defaults.
#include <fmt/format.h>

#include <cmath>
#include <filesystem>

#include "base/parameter.hpp"
#include "base/quantity.hpp"
#include "base/text.hpp"

namespace base {

namespace {

Value with_data(const Value& raw, Value::Data data) {
  Value checked = raw;
  checked.data = std::move(data);
  return checked;
}

/// A number of the parameter's unit and range; messages are about `raw`.
double checked_number(const Value& raw, const std::string& unit, const Range& range) {
  double number = 0;
  if (raw.is<std::string>()) {
    try {
      number = parse_quantity(raw.text(), unit);
    } catch (const QuantityError& error) {
      fail(raw, error.rule, error.remedy);
    }
  } else if (raw.is_number()) {
    number = raw.real();
  } else {
    fail(raw, "must be a number", unit.empty() ? "" : fmt::format("bare (SI) or with a unit, such as \"1 {}\"", unit));
  }
  if (!std::isfinite(number)) fail(raw, "must be finite");
  if (!range.contains(number)) fail(raw, fmt::format("must be {}{}{}", range.text(), unit.empty() ? "" : " ", unit));
  return number;
}

std::string checked_text(const Value& raw, const Parameter& parameter) {
  if (!raw.is<std::string>()) fail(raw, "must be text", "put it in quotes");
  const std::string& found = raw.text();
  if (!parameter.choices.empty()) {
    for (const auto& choice : parameter.choices) {
      if (choice == found) return found;
    }
    const std::string near = nearest(found, parameter.choices);
    fail(raw, "must be one of: " + join(parameter.choices), near.empty() ? "" : "did you mean \"" + near + "\"?");
  }
  return found;
}

std::string checked_name(const Value& raw) {
  if (!raw.is<std::string>()) fail(raw, "must be a name", "put it in quotes");
  const bool plain = raw.text().find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-") ==
                     std::string::npos;
  if (!plain || raw.text().empty()) fail(raw, "a name is made of letters, digits, - and _", "rename it");
  return raw.text();
}

std::string checked_path(const Value& raw) {
  namespace fs = std::filesystem;
  if (!raw.is<std::string>()) fail(raw, "must be a file name", "put it in quotes");
  const fs::path folder = raw.line > 0 ? fs::path(raw.file).parent_path() : fs::path();
  const fs::path full = fs::absolute(folder / raw.text()).lexically_normal();
  std::error_code ignored;
  if (!fs::is_regular_file(full, ignored)) {
    fail(raw, fmt::format("no such file: {}", full.string()),
         raw.line > 0 ? "give a path relative to the folder of " + raw.file : "give a path to a file that exists");
  }
  return full.string();
}

Value::List checked_list(const Value& raw, const char* what) {
  if (!raw.is<Value::List>()) fail(raw, fmt::format("must be a list of {}", what), "put it in [ ]");
  return raw.list();
}

void name_items(Value& raw) {
  if (!raw.is<Value::List>()) return;
  const bool several = raw.list().size() > 1;
  int number = 0;
  for (auto& item : raw.list()) {
    ++number;
    const Value* name = item.is<Value::Table>() ? item.find("name") : nullptr;
    if (name && name->is<std::string>()) {
      item.key = raw.key + "." + name->text();
    } else {
      item.key = several ? fmt::format("{}[{}]", raw.key, number) : raw.key;
    }
  }
}

Value check_nested(const Value& raw, const Parameter& parameter) {
  return parameter.family ? check(raw, *parameter.family) : check(raw, *parameter.rows);
}

Value checked_value(Value raw, const Parameter& p) {
  name_items(raw);
  switch (p.type) {
    case Type::real:
      return with_data(raw, checked_number(raw, p.unit, p.range));
    case Type::integer:
      if (!raw.is<std::int64_t>()) fail(raw, "must be a whole number");
      if (!p.range.contains(raw.real())) fail(raw, "must be " + p.range.text());
      return raw;
    case Type::boolean:
      if (!raw.is<bool>()) fail(raw, "must be true or false");
      return raw;
    case Type::text:
      return with_data(raw, checked_text(raw, p));
    case Type::name:
      return with_data(raw, checked_name(raw));
    case Type::path:
      return with_data(raw, checked_path(raw));
    case Type::vector:
    case Type::reals: {
      Value::List items = checked_list(raw, "numbers");
      if (p.type == Type::vector && items.size() != 3) fail(raw, "must have three components");
      for (auto& item : items) item = with_data(item, checked_number(item, p.unit, p.range));
      return with_data(raw, items);
    }
    case Type::texts: {
      Value::List items = checked_list(raw, "texts");
      for (auto& item : items) item = with_data(item, checked_text(item, p));
      return with_data(raw, items);
    }
    case Type::pairs: {
      if (!p.choices.empty() && raw.is<std::string>()) return with_data(raw, checked_text(raw, p));
      Value::List items = checked_list(raw, "pairs of numbers");
      for (auto& item : items) {
        if (!item.is<Value::List>() || item.list().size() != 2) fail(item, "must be a pair of numbers");
        Value& first = item.list()[0];
        Value& second = item.list()[1];
        first.key = second.key = item.key;
        first.data = checked_number(first, p.unit, {});
        second.data = checked_number(second, "", p.range);
      }
      return with_data(raw, items);
    }
    case Type::quantity:
      if (!raw.is_number() && !raw.is<std::string>()) fail(raw, "must be a number", "bare (SI) or with a unit");
      return raw;
    case Type::quantities:
      return with_data(raw, checked_list(raw, "numbers"));
    case Type::numbers: {
      if (!raw.is<Value::Table>()) fail(raw, "must be a table of numbers", "write { name = value }");
      Value::Table entries = raw.table();
      for (auto& [name, entry] : entries) {
        entry.key = raw.key + "." + name;
        entry.data = checked_number(entry, p.unit, p.range);
      }
      return with_data(raw, entries);
    }
    case Type::table:
      if (!raw.is<Value::Table>()) fail(raw, "must be a table", "write it as [" + raw.key + "] or { key = value }");
      return check_nested(raw, p);
    case Type::tables: {
      if (!raw.is<Value::List>()) fail(raw, "must be a list of tables", "write it as [[" + raw.key + "]]");
      Value::List items = raw.list();
      for (auto& item : items) {
        if (!item.is<Value::Table>()) fail(item, "must be a table", "write { key = value }");
        item = check_nested(item, p);
      }
      return with_data(raw, items);
    }
  }
  throw InternalError("parameter type without a reader");
}

}  // namespace

Value check(const Value& raw, const Table& table) {
  std::vector<std::string> known;
  for (const auto& parameter : table.parameters) known.push_back(parameter.name);
  Value checked = raw;
  checked.data = Value::Table{};
  const auto full_key = [&](const std::string& name) { return raw.key.empty() ? name : raw.key + "." + name; };

  const Value* first_unknown = nullptr;
  std::string unknown_name;
  for (const auto& [name, value] : raw.table()) {
    bool found = false;
    for (const auto& candidate : known) found = found || candidate == name;
    if (!found && (!first_unknown || value.line < first_unknown->line)) {
      first_unknown = &value;
      unknown_name = name;
    }
  }
  if (first_unknown) {
    Value unknown = *first_unknown;
    unknown.key = full_key(unknown_name);
    fail(unknown, "unknown key", suggest(unknown_name, known, "keys"));
  }

  for (const auto& parameter : table.parameters) {
    if (const Value* found = raw.find(parameter.name)) {
      Value value = *found;
      value.key = full_key(parameter.name);
      checked.table()[parameter.name] = checked_value(std::move(value), parameter);
    } else if (parameter.fallback) {
      Value& value = checked.set(parameter.name, parameter.fallback->data);
      if (parameter.type == Type::table) value = check_nested(value, parameter);
    } else if (parameter.is_required) {
      fail(raw, fmt::format("\"{}\" is missing", parameter.name),
           fmt::format("add {}: {}{}", parameter.name, parameter.meaning,
                       parameter.unit.empty() ? "" : " [" + parameter.unit + "]"));
    }
  }
  return checked;
}

const Table& row_of(const Value& value, const Family& family) {
  const Value* selector = value.find(family.selector);
  if (!selector) {
    for (const auto& parameter : family.rows.front().parameters) {
      if (parameter.name == family.selector && parameter.fallback) return family.row(parameter.fallback->text());
    }
    fail(value, fmt::format("\"{}\" is missing", family.selector), "choose one of: " + join(family.names()));
  }
  Value named = *selector;
  named.key = value.key + "." + family.selector;
  Parameter choice;
  choice.choices = family.names();
  return family.row(checked_text(named, choice));
}

double number_of(const Value& raw, const std::string& unit) { return checked_number(raw, unit, {}); }

Value check(const Value& raw, const Family& family) { return check(raw, row_of(raw, family)); }

}  // namespace base
