#include "base/quantity.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <numbers>
#include <vector>

#include "base/text.hpp"

namespace base {

namespace {

struct NamedUnit {
  const char* name;
  double multiply, divide;
  Dimension dimension;  // length, mass, time, angle
};

const std::vector<NamedUnit>& named_units() {
  static const std::vector<NamedUnit> units{
      {"1", 1, 1, {}},
      {"%", 1, 100, {}},
      {"m", 1, 1, {1}},
      {"km", 1000, 1, {1}},
      {"cm", 1, 100, {1}},
      {"mm", 1, 1000, {1}},
      {"um", 1, 1e6, {1}},
      {"\u00b5m", 1, 1e6, {1}},
      {"\u03bcm", 1, 1e6, {1}},
      {"nm", 1, 1e9, {1}},
      {"kg", 1, 1, {0, 1}},
      {"g", 1, 1000, {0, 1}},
      {"t", 1000, 1, {0, 1}},
      {"s", 1, 1, {0, 0, 1}},
      {"ms", 1, 1000, {0, 0, 1}},
      {"us", 1, 1e6, {0, 0, 1}},
      {"ns", 1, 1e9, {0, 0, 1}},
      {"min", 60, 1, {0, 0, 1}},
      {"h", 3600, 1, {0, 0, 1}},
      {"Hz", 1, 1, {0, 0, -1}},
      {"kHz", 1000, 1, {0, 0, -1}},
      {"rad", 1, 1, {0, 0, 0, 1}},
      {"deg", std::numbers::pi, 180, {0, 0, 0, 1}},
      {"N", 1, 1, {1, 1, -2}},
      {"mN", 1, 1000, {1, 1, -2}},
      {"kN", 1000, 1, {1, 1, -2}},
      {"MN", 1e6, 1, {1, 1, -2}},
      {"Pa", 1, 1, {-1, 1, -2}},
      {"kPa", 1000, 1, {-1, 1, -2}},
      {"MPa", 1e6, 1, {-1, 1, -2}},
      {"GPa", 1e9, 1, {-1, 1, -2}},
      {"bar", 1e5, 1, {-1, 1, -2}},
      {"J", 1, 1, {2, 1, -2}},
      {"mJ", 1, 1000, {2, 1, -2}},
      {"kJ", 1000, 1, {2, 1, -2}},
      {"W", 1, 1, {2, 1, -3}},
      {"kW", 1000, 1, {2, 1, -3}},
  };
  return units;
}

/// One factor such as "m3" or "s^-2", times `sign` in the exponent.
void multiply_by(Unit& unit, std::string_view factor, int sign, std::string_view whole) {
  const std::size_t digits = factor == "1" ? 1 : factor.find_first_of("^-0123456789");
  const std::string name(factor.substr(0, digits));
  int power = 1;
  if (digits < factor.size()) {
    const std::string_view exponent = factor.substr(digits + (factor[digits] == '^' ? 1 : 0));
    const auto [end, error] = std::from_chars(exponent.data(), exponent.data() + exponent.size(), power);
    if (error != std::errc() || end != exponent.data() + exponent.size()) power = 0;
    if (power == 0 || std::abs(power) > 9) {
      throw QuantityError(fmt::format("cannot read the unit \"{}\"", whole), "write it like \"kg/m3\" or \"m/s^2\"");
    }
  }
  for (const auto& known : named_units()) {
    if (name != known.name) continue;
    for (int i = 0; i < std::abs(power); ++i) {
      const bool above = (power > 0) == (sign > 0);
      unit.multiply *= above ? known.multiply : known.divide;
      unit.divide *= above ? known.divide : known.multiply;
      const int by = above ? 1 : -1;
      unit.dimension.length += by * known.dimension.length;
      unit.dimension.mass += by * known.dimension.mass;
      unit.dimension.time += by * known.dimension.time;
      unit.dimension.angle += by * known.dimension.angle;
    }
    return;
  }
  std::vector<std::string> names;
  for (const auto& known : named_units()) names.emplace_back(known.name);
  throw QuantityError(fmt::format("unknown unit \"{}\"", name), suggest(name, names, "units"));
}

std::string_view trim(std::string_view text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

}  // namespace

Unit parse_unit(std::string_view text) {
  Unit unit;
  int sign = 1;
  std::size_t start = 0;
  const std::string_view trimmed = trim(text);
  while (start < trimmed.size()) {
    const std::size_t end = std::min(trimmed.find_first_of("/* ", start), trimmed.size());
    if (end > start) multiply_by(unit, trimmed.substr(start, end - start), sign, trimmed);
    if (end < trimmed.size() && trimmed[end] == '/') sign = -1;
    if (end < trimmed.size() && trimmed[end] == '*') sign = 1;
    start = end + 1;
  }
  return unit;
}

double unit_factor(std::string_view unit) { return parse_unit(unit).to_si(1); }

double parse_quantity(std::string_view text, std::string_view expected) {
  const std::string_view trimmed = trim(text);
  double number = 0;
  const char* begin = trimmed.data() + (!trimmed.empty() && trimmed[0] == '+' ? 1 : 0);
  const auto [end, error] = std::from_chars(begin, trimmed.data() + trimmed.size(), number);
  const std::string wanted = expected.empty() ? "a number" : fmt::format("a number with a unit such as {}", expected);
  if (error != std::errc() || !std::isfinite(number)) throw QuantityError("not a number", "write " + wanted);
  const std::string_view rest = trim(trimmed.substr(static_cast<std::size_t>(end - trimmed.data())));
  if (rest.empty()) return number;
  const Unit unit = parse_unit(rest);
  const Dimension dimension = parse_unit(expected).dimension;
  if (!(unit.dimension == dimension)) {
    throw QuantityError(
        fmt::format("{} is {}, must be {}", rest, dimension_name(unit.dimension), dimension_name(dimension)),
        "write " + wanted);
  }
  return unit.to_si(number);
}

std::string dimension_name(const Dimension& dimension) {
  struct Name {
    const char* name;
    const char* unit;
  };
  static const std::vector<Name> names{
      {"a plain number", ""}, {"a length", "m"},           {"an area", "m2"},      {"a volume", "m3"},
      {"a mass", "kg"},       {"a density", "kg/m3"},      {"a time", "s"},        {"a rate", "1/s"},
      {"a speed", "m/s"},     {"an acceleration", "m/s2"}, {"an angle", "rad"},    {"an angular velocity", "rad/s"},
      {"a force", "N"},       {"a pressure", "Pa"},        {"a stiffness", "N/m"}, {"an energy", "J"},
      {"a power", "W"},       {"a viscosity", "Pa s"}};
  for (const auto& [name, unit] : names) {
    if (parse_unit(unit).dimension == dimension) return name;
  }
  return fmt::format("in m^{} kg^{} s^{} rad^{}", dimension.length, dimension.mass, dimension.time, dimension.angle);
}

}  // namespace base
