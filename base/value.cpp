#include "base/value.hpp"

#include <fmt/format.h>

#include <utility>

#include "base/error.hpp"

namespace base {

namespace {
template <class T, class V>
auto& get(V& value, const char* what) {
  auto* p = std::get_if<T>(&value.data);
  if (!p) throw InternalError(fmt::format("{} read as {}", value.key, what));
  return *p;
}
}  // namespace

double Value::real() const {
  if (is<std::int64_t>()) return static_cast<double>(std::get<std::int64_t>(data));
  return get<double>(*this, "a number");
}
std::int64_t Value::integer() const { return get<std::int64_t>(*this, "an integer"); }
bool Value::boolean() const { return get<bool>(*this, "a boolean"); }
const std::string& Value::text() const { return get<std::string>(*this, "text"); }
const Value::List& Value::list() const { return get<List>(*this, "a list"); }
const Value::Table& Value::table() const { return get<Table>(*this, "a table"); }
Value::List& Value::list() { return get<List>(*this, "a list"); }
Value::Table& Value::table() { return get<Table>(*this, "a table"); }

Vec3 Value::vector() const {
  const auto values = reals();
  require_internal(values.size() == 3, "a vector has three components");
  return {values[0], values[1], values[2]};
}
std::vector<double> Value::reals() const {
  std::vector<double> values;
  for (const auto& item : list()) values.push_back(item.real());
  return values;
}
std::vector<std::string> Value::texts() const {
  std::vector<std::string> values;
  for (const auto& item : list()) values.push_back(item.text());
  return values;
}

const Value* Value::find(const std::string& name) const {
  const auto& entries = table();
  const auto entry = entries.find(name);
  return entry == entries.end() ? nullptr : &entry->second;
}
const Value& Value::at(const std::string& name) const {
  const Value* value = find(name);
  if (!value) throw InternalError(fmt::format("{} has no entry {}", key, name));
  return *value;
}
Value& Value::at(const std::string& name) { return const_cast<Value&>(std::as_const(*this).at(name)); }

Value& Value::set(const std::string& name, Data d) {
  Value value(std::move(d));
  value.key = key.empty() ? name : key + "." + name;
  value.file = file;
  value.line = line;
  return table()[name] = std::move(value);
}
const Value::List& Value::rows(const std::string& name) const {
  static const List none;
  const Value* value = find(name);
  return value ? value->list() : none;
}

std::string Value::origin() const { return line > 0 ? fmt::format("{}:{}", file, line) : file; }

std::string show(const Value& value) {
  if (value.is<bool>()) return value.boolean() ? "true" : "false";
  if (value.is<std::int64_t>()) return fmt::format("{}", value.integer());
  if (value.is<double>()) {
    std::string text = fmt::format("{}", value.real());
    return text.find_first_not_of("-0123456789") == std::string::npos ? text + ".0" : text;
  }
  if (value.is<std::string>()) {
    std::string text = "\"";
    for (const char c : value.text()) {
      if (c == '"' || c == '\\') text += '\\';
      if (static_cast<unsigned char>(c) < 0x20) {
        text += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
      } else {
        text += c;
      }
    }
    return text + "\"";
  }
  if (value.is<Value::List>()) {
    std::string text;
    for (const auto& item : value.list()) {
      if (text.size() > 60) return "[" + text + ", ...]";
      text += (text.empty() ? "" : ", ") + show(item);
    }
    return "[" + text + "]";
  }
  return "{...}";
}

void fail(const Value& value, const std::string& rule, const std::string& remedy) {
  std::string message = value.origin().empty() ? "" : value.origin() + ": ";
  if (!value.key.empty()) {
    message += value.key;
    if (!value.is<Value::Table>()) message += " = " + show(value);
    message += "; ";
  }
  throw UserError(message + rule + (remedy.empty() ? "" : "; " + remedy));
}

}  // namespace base
