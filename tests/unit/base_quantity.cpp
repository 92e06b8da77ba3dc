// Units: SI values by definition of the units (BIPM SI brochure); messages by their text.
#include <gtest/gtest.h>

#include <numbers>

#include "base/quantity.hpp"

namespace {

using base::parse_quantity;
using base::parse_unit;

std::string error_of(const std::string& text, const std::string& unit) {
  try {
    parse_quantity(text, unit);
  } catch (const base::UserError& error) {
    return error.what();
  }
  return "";
}

TEST(Quantity, ReadsUnitsAsSi) {
  EXPECT_DOUBLE_EQ(parse_quantity("30 GPa", "Pa"), 30e9);
  EXPECT_DOUBLE_EQ(parse_quantity("16.8GPa", "Pa"), 16.8e9);
  EXPECT_DOUBLE_EQ(parse_quantity("250 km/h", "m/s"), 250 / 3.6);
  EXPECT_DOUBLE_EQ(parse_quantity("75 kN/mm", "N/m"), 75e6);
  EXPECT_DOUBLE_EQ(parse_quantity("5 1/s", "1/s"), 5);
  EXPECT_DOUBLE_EQ(parse_quantity("2700 kg/m3", "kg/m3"), 2700);
  EXPECT_DOUBLE_EQ(parse_quantity("2.7 g/cm^3", "kg/m3"), 2700);
  EXPECT_DOUBLE_EQ(parse_quantity("20 kPa", "Pa"), 20e3);
  EXPECT_DOUBLE_EQ(parse_quantity("1.2 deg", "rad"), 1.2 * std::numbers::pi / 180);
  EXPECT_DOUBLE_EQ(parse_quantity("9.81 m/s^2", "m/s2"), 9.81);
  EXPECT_DOUBLE_EQ(parse_quantity("9.81 m s^-2", "m/s2"), 9.81);
  EXPECT_DOUBLE_EQ(parse_quantity("176.21 um", "m"), 176.21e-6);
  EXPECT_DOUBLE_EQ(parse_quantity("29.29 Hz", "1/s"), 29.29);
  EXPECT_DOUBLE_EQ(parse_quantity("90 cm2", "m2"), 90e-4);
  EXPECT_DOUBLE_EQ(parse_quantity("0.4", "Pa"), 0.4);  // a bare number is SI
  EXPECT_DOUBLE_EQ(parse_quantity(" +1e-3 ", ""), 1e-3);
}

TEST(Quantity, DecimalUnitsAreCorrectlyRounded) {  // a product with the inexact 0.001 would be one bit off
  EXPECT_EQ(parse_quantity("2.5 mm", "m"), 0.0025);
  EXPECT_EQ(parse_quantity("22.4 mm", "m"), 0.0224);
  EXPECT_EQ(parse_quantity("31.5 mm", "m"), 0.0315);
  EXPECT_EQ(parse_quantity("10 ms", "s"), 0.01);
}

TEST(Quantity, MessagesNameRuleAndRemedy) {
  EXPECT_EQ(error_of("30 mm", "Pa"), "mm is a length, must be a pressure; write a number with a unit such as Pa");
  EXPECT_EQ(error_of("30 GPz", "Pa"), "unknown unit \"GPz\"; did you mean \"GPa\"?");
  EXPECT_EQ(error_of("3 furlong/s", "m/s").substr(0, 45), "unknown unit \"furlong\"; known units: 1, %, m,");
  EXPECT_EQ(error_of("high", "Pa"), "not a number; write a number with a unit such as Pa");
  EXPECT_EQ(error_of("nan", ""), "not a number; write a number");
  EXPECT_EQ(error_of("0.5 m", ""), "m is a length, must be a plain number; write a number");
  EXPECT_EQ(error_of("1 m^x", "m"), "cannot read the unit \"m^x\"; write it like \"kg/m3\" or \"m/s^2\"");
}

TEST(Quantity, UnitGoesBothWays) {
  EXPECT_DOUBLE_EQ(parse_unit("kN/mm").from_si(75e6), 75);
  EXPECT_DOUBLE_EQ(base::unit_factor("kN/mm"), 1e6);
  EXPECT_EQ(base::dimension_name(parse_unit("kN/mm").dimension), "a stiffness");
}

}  // namespace
