#include "base/parameter.hpp"

#include <fmt/format.h>

#include "base/error.hpp"
#include "base/quantity.hpp"
#include "base/text.hpp"

namespace base {

bool Range::contains(double x) const {
  return (lower_included ? x >= lower : x > lower) && (upper_included ? x <= upper : x < upper);
}

std::string Range::text() const {
  const double infinity = std::numeric_limits<double>::infinity();
  if (lower == -infinity && upper == infinity) return "";
  if (upper == infinity) return fmt::format("{} {}", lower_included ? ">=" : ">", lower);
  if (lower == -infinity) return fmt::format("{} {}", upper_included ? "<=" : "<", upper);
  return fmt::format("in {}{}, {}{}", lower_included ? "[" : "(", lower, upper, upper_included ? "]" : ")");
}

Parameter Parameter::above(double limit) const {
  Parameter p = *this;
  p.range.lower = limit;
  p.range.lower_included = false;
  return p;
}
Parameter Parameter::at_least(double limit) const {
  Parameter p = *this;
  p.range.lower = limit;
  p.range.lower_included = true;
  return p;
}
Parameter Parameter::below(double limit) const {
  Parameter p = *this;
  p.range.upper = limit;
  p.range.upper_included = false;
  return p;
}
Parameter Parameter::at_most(double limit) const {
  Parameter p = *this;
  p.range.upper = limit;
  p.range.upper_included = true;
  return p;
}
Parameter Parameter::among(std::vector<std::string> allowed) const {
  Parameter p = *this;
  p.choices = std::move(allowed);
  return p;
}
namespace {
Parameter with_default(const Parameter& parameter, Value::Data data) {
  Parameter p = parameter;
  p.fallback = Value(std::move(data));
  p.is_required = false;
  return p;
}
}  // namespace
Parameter Parameter::otherwise(double value) const { return with_default(*this, value); }
Parameter Parameter::otherwise(int value) const {
  if (type == Type::real) return with_default(*this, static_cast<double>(value));
  return with_default(*this, static_cast<std::int64_t>(value));
}
Parameter Parameter::otherwise(bool value) const { return with_default(*this, value); }
Parameter Parameter::otherwise(const char* value) const { return with_default(*this, std::string(value)); }
Parameter Parameter::otherwise(const Vec3& value) const {
  return with_default(*this, Value::List{Value(value.x), Value(value.y), Value(value.z)});
}
Parameter Parameter::otherwise_empty() const {
  if (type == Type::numbers || type == Type::table) return with_default(*this, Value::Table{});
  return with_default(*this, Value::List{});
}
Parameter Parameter::optional(std::string meaning_when_absent) const {
  Parameter p = *this;
  p.is_required = false;
  p.without = std::move(meaning_when_absent);
  return p;
}

std::string Parameter::type_text() const {
  switch (type) {
    case Type::real:
      return "number";
    case Type::integer:
      return "integer";
    case Type::boolean:
      return "true or false";
    case Type::text:
      return choices.empty() ? "text" : join(choices, " | ");
    case Type::name:
      return "name";
    case Type::path:
      return "file";
    case Type::vector:
      return "three numbers";
    case Type::reals:
      return "list of numbers";
    case Type::texts:
      return choices.empty() ? "list of texts" : "list of " + join(choices, " | ");
    case Type::pairs:
      return choices.empty() ? "list of pairs" : "list of pairs, or " + join(choices, " | ");
    case Type::quantity:
      return "number with a unit";
    case Type::quantities:
      return "list of numbers with a unit";
    case Type::numbers:
      return "numbers by name";
    case Type::table:
      return "table";
    case Type::tables:
      return "list of tables";
  }
  throw InternalError("parameter type without a text");
}

std::string Parameter::default_text() const {
  if (is_required) return "required";
  if (!fallback) return "(" + without + ")";
  return fallback->is<Value::Table>() ? "{}" : show(*fallback);
}

namespace {
Parameter make(std::string name, Type type, std::string unit, std::string meaning) {
  Parameter p;
  p.name = std::move(name);
  p.type = type;
  p.unit = std::move(unit);
  p.meaning = std::move(meaning);
  return p;
}
}  // namespace

Parameter real(std::string name, std::string unit, std::string meaning) {
  return make(std::move(name), Type::real, std::move(unit), std::move(meaning));
}
Parameter integer(std::string name, std::string meaning) {
  return make(std::move(name), Type::integer, "", std::move(meaning));
}
Parameter boolean(std::string name, std::string meaning) {
  return make(std::move(name), Type::boolean, "", std::move(meaning));
}
Parameter text(std::string name, std::string meaning) {
  return make(std::move(name), Type::text, "", std::move(meaning));
}
Parameter name(std::string name, std::string meaning) {
  return make(std::move(name), Type::name, "", std::move(meaning));
}
Parameter path(std::string name, std::string meaning) {
  return make(std::move(name), Type::path, "", std::move(meaning));
}
Parameter vector(std::string name, std::string unit, std::string meaning) {
  return make(std::move(name), Type::vector, std::move(unit), std::move(meaning));
}
Parameter reals(std::string name, std::string unit, std::string meaning) {
  return make(std::move(name), Type::reals, std::move(unit), std::move(meaning));
}
Parameter texts(std::string name, std::string meaning) {
  return make(std::move(name), Type::texts, "", std::move(meaning));
}
Parameter pairs(std::string name, std::string unit, std::string meaning) {
  return make(std::move(name), Type::pairs, std::move(unit), std::move(meaning));
}
Parameter quantity(std::string name, std::string meaning) {
  return make(std::move(name), Type::quantity, "", std::move(meaning));
}
Parameter quantities(std::string name, std::string meaning) {
  return make(std::move(name), Type::quantities, "", std::move(meaning));
}
Parameter numbers(std::string name, std::string unit, std::string meaning) {
  return make(std::move(name), Type::numbers, std::move(unit), std::move(meaning));
}
namespace {
Parameter nested(Parameter p, const Table* rows, const Family* family) {
  p.rows = rows;
  p.family = family;
  return p;
}
}  // namespace
Parameter table(std::string name, const Table& rows, std::string meaning) {
  return nested(make(std::move(name), Type::table, "", std::move(meaning)), &rows, nullptr);
}
Parameter table(std::string name, const Family& family, std::string meaning) {
  return nested(make(std::move(name), Type::table, "", std::move(meaning)), nullptr, &family);
}
Parameter tables(std::string name, const Table& rows, std::string meaning) {
  return nested(make(std::move(name), Type::tables, "", std::move(meaning)), &rows, nullptr);
}
Parameter tables(std::string name, const Family& family, std::string meaning) {
  return nested(make(std::move(name), Type::tables, "", std::move(meaning)), nullptr, &family);
}

std::vector<std::string> Family::names() const {
  std::vector<std::string> all;
  for (const auto& row : rows) all.push_back(row.name);
  return all;
}
const Table& Family::row(const std::string& wanted) const {
  for (const auto& row : rows) {
    if (row.name == wanted) return row;
  }
  throw InternalError("no row " + wanted + " among the " + noun);
}

}  // namespace base
