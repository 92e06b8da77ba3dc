#pragma once
// Declared parameters. A parameter is declared once (name, type, unit, range, default, meaning); reading, checking,
// `trackbed list` and the resolved scene all work from that declaration.
//
//   static const Table table{"stage", "a stretch of simulated time",
//                            {real("duration", "s", "simulated time").above(0),
//                             integer("seed", "of the random numbers").otherwise(1),
//                             text("body", "name of a body").optional("all bodies")}};
//   Value checked = check(raw, table);          // SI, defaults filled in, or a base::UserError
//   double duration = checked.at("duration").real();
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "base/value.hpp"

namespace base {

enum class Type {
  real,        // a number with a unit
  integer,     // a whole number
  boolean,     // true or false
  text,        // free, or one of `choices`
  name,        // text of letters, digits, - and _
  path,        // an existing file; relative to the file it is written in; checked value: absolute
  vector,      // three numbers with a unit
  reals,       // a list of numbers with a unit
  texts,       // a list of texts
  pairs,       // a list of pairs of numbers, the first with `unit`, the second plain; or one of `choices`, if any
  quantity,    // a number whose unit something else decides: see number_of()
  quantities,  // a list of them
  numbers,     // a table of free keys and numbers with a unit
  table,       // one declared table, or one row of a family
  tables,      // a list of them
};

struct Range {
  double lower = -std::numeric_limits<double>::infinity(), upper = std::numeric_limits<double>::infinity();
  bool lower_included = true, upper_included = true;
  bool contains(double) const;
  std::string text() const;  // "> 0", "in (-1, 0.5]"; empty when everything is allowed
};

struct Table;
struct Family;

struct Parameter {
  std::string name;
  Type type{};
  std::string unit;  // shown; decides the physical dimension
  std::string meaning;
  Range range;  // of every number of the value
  std::vector<std::string> choices;
  bool is_required = true;
  std::optional<Value> fallback;   // the default
  std::string without;             // what holds when it is absent and there is no default
  const Table* rows = nullptr;     // of table, tables
  const Family* family = nullptr;  // of table, tables: the row is chosen by the family's selector

  // ---- to be chained behind a declaration
  Parameter above(double limit) const;
  Parameter at_least(double limit) const;
  Parameter below(double limit) const;
  Parameter at_most(double limit) const;
  Parameter among(std::vector<std::string> allowed) const;
  Parameter otherwise(double) const;
  Parameter otherwise(int) const;
  Parameter otherwise(bool) const;
  Parameter otherwise(const char*) const;
  Parameter otherwise(const Vec3&) const;
  Parameter otherwise_empty() const;  // an empty list or table
  /// May be absent; `meaning_when_absent` says what holds then.
  Parameter optional(std::string meaning_when_absent) const;

  std::string type_text() const;     // "number", "list of texts", …
  std::string default_text() const;  // "required", "0.25", "(the grains' own)"
};

struct Table {
  std::string name, meaning;
  std::vector<Parameter> parameters;
};

/// Tables of one kind that a key tells apart: histories by `kind`, materials by `law`.
struct Family {
  std::string selector, noun;  // noun in the plural, for messages
  std::vector<Table> rows;     // named by the selector's value; each declares the selector itself
  std::vector<std::string> names() const;
  const Table& row(const std::string& name) const;
};

Parameter real(std::string name, std::string unit, std::string meaning);
Parameter integer(std::string name, std::string meaning);
Parameter boolean(std::string name, std::string meaning);
Parameter text(std::string name, std::string meaning);
Parameter name(std::string name, std::string meaning);
Parameter path(std::string name, std::string meaning);
Parameter vector(std::string name, std::string unit, std::string meaning);
Parameter reals(std::string name, std::string unit, std::string meaning);
Parameter texts(std::string name, std::string meaning);
Parameter pairs(std::string name, std::string unit, std::string meaning);
Parameter quantity(std::string name, std::string meaning);
Parameter quantities(std::string name, std::string meaning);
Parameter numbers(std::string name, std::string unit, std::string meaning);
Parameter table(std::string name, const Table&, std::string meaning);
Parameter table(std::string name, const Family&, std::string meaning);
Parameter tables(std::string name, const Table&, std::string meaning);
Parameter tables(std::string name, const Family&, std::string meaning);

/// The value with units turned into SI, defaults filled in and paths made absolute. Throws base::UserError.
Value check(const Value& raw, const Table&);
Value check(const Value& raw, const Family&);
/// A raw quantity as SI, now that its unit is known. Throws base::UserError.
double number_of(const Value& raw, const std::string& unit);
/// The row of a family that a checked or raw table belongs to.
const Table& row_of(const Value& table, const Family&);

/// One block of `trackbed list`: the table's parameters with type, unit, range, default and meaning.
std::string describe(const Table&);
/// A checked table as TOML that reads back to the same values; units stand in comments.
std::string to_toml(const Value& checked, const Table&);

}  // namespace base
