#pragma once
// Numbers with units: "30 GPa", "2.5 mm", "250 km/h", "75 kN/mm", "5 1/s", "2700 kg/m3", "1.2 deg". Inside, all is SI.
#include <string>
#include <string_view>

#include "base/error.hpp"

namespace base {

/// Exponents of metre, kilogram, second and radian.
struct Dimension {
  int length = 0, mass = 0, time = 0, angle = 0;
  bool operator==(const Dimension&) const = default;
};

/// value in SI = value * multiply / divide; kept as two numbers so that 2.5 mm is the double nearest to 0.0025.
struct Unit {
  double multiply = 1, divide = 1;
  Dimension dimension;
  double to_si(double value) const { return value * multiply / divide; }
  double from_si(double value) const { return value * divide / multiply; }
};

/// A quantity that cannot be read. `rule` and `remedy` are the parts that a message about a key is made of.
struct QuantityError : UserError {
  QuantityError(std::string r, std::string m) : UserError(r + "; " + m), rule(std::move(r)), remedy(std::move(m)) {}
  std::string rule, remedy;
};

/// "kN/mm", "kg/m3", "m/s^2", "1/s"; empty: dimensionless. Throws QuantityError on an unknown unit, naming the nearest.
Unit parse_unit(std::string_view text);

/// SI value of one of the unit: 1e6 for "kN/mm".
double unit_factor(std::string_view unit);

/// Reads "number unit" as SI. A number alone is SI already. `unit`: a unit of the expected dimension.
/// Throws QuantityError when the number, the unit or its dimension is wrong.
double parse_quantity(std::string_view text, std::string_view unit);

/// "a pressure", "a length", …; the base units when the dimension has no name.
std::string dimension_name(const Dimension&);

}  // namespace base
