// Declared parameters: what is read, what is refused and in which words, and that the text form reads back.
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "base/parameter.hpp"
#include "base/text.hpp"

namespace {

using base::Value;

const base::Table& grain() {
  static const base::Table table{
      "grain",
      "what the tests read",
      {base::name("name", "of the grain"), base::real("radius", "m", "of the sphere").above(0),
       base::real("poisson_ratio", "", "of its material").above(-1).at_most(0.5).otherwise(0.2),
       base::integer("seed", "of the random numbers").at_least(0).otherwise(1),
       base::boolean("rotations", "may it turn").otherwise(true),
       base::text("axis", "which way").among({"x", "y", "z"}).otherwise("z"),
       base::vector("velocity", "m/s", "at the start").otherwise(base::Vec3{}),
       base::numbers("mesh_parameters", "", "of the mesh").otherwise_empty(),
       base::real("stiffness", "N/m", "of the contact").optional("the grains' own")}};
  return table;
}

Value at_line(Value::Data data, int line) {
  Value value(std::move(data));
  value.file = "a.toml";
  value.line = line;
  return value;
}

Value raw(Value::Table extra = {}) {
  Value table =
      at_line(Value::Table{{"name", at_line(std::string("one"), 2)}, {"radius", at_line(std::string("12 mm"), 3)}}, 1);
  table.key = "grain.one";
  for (auto& [name, value] : extra) table.table()[name] = value;
  return table;
}

std::string error_of(const std::string& key, Value::Data data) {
  try {
    check(raw({{key, at_line(std::move(data), 12)}}), grain());
  } catch (const base::UserError& error) {
    return error.what();
  }
  return "";
}

TEST(Parameter, FillsDefaultsAndTurnsToSi) {
  const Value checked = check(raw(), grain());
  EXPECT_EQ(checked.at("radius").real(), 0.012);
  EXPECT_EQ(checked.at("poisson_ratio").real(), 0.2);
  EXPECT_EQ(checked.at("seed").integer(), 1);
  EXPECT_TRUE(checked.at("rotations").boolean());
  EXPECT_EQ(checked.at("axis").text(), "z");
  EXPECT_FALSE(checked.has("stiffness"));
}

TEST(Parameter, EveryMistakeIsNamed) {
  EXPECT_EQ(error_of("poisson_ratio", 2.0), "a.toml:12: grain.one.poisson_ratio = 2.0; must be in (-1, 0.5]");
  EXPECT_EQ(error_of("radius", -1.0), "a.toml:12: grain.one.radius = -1.0; must be > 0 m");
  EXPECT_EQ(
      error_of("radius", std::string("3 kg")),
      "a.toml:12: grain.one.radius = \"3 kg\"; kg is a mass, must be a length; write a number with a unit such as m");
  EXPECT_EQ(error_of("radius", true),
            "a.toml:12: grain.one.radius = true; must be a number; bare (SI) or with a unit, such as \"1 m\"");
  EXPECT_EQ(error_of("radus", 1.0), "a.toml:12: grain.one.radus = 1.0; unknown key; did you mean \"radius\"?");
  EXPECT_EQ(error_of("colour", 1.0),
            "a.toml:12: grain.one.colour = 1.0; unknown key; known keys: name, radius, poisson_ratio, seed, rotations, "
            "axis, velocity, mesh_parameters, stiffness");
  EXPECT_EQ(error_of("seed", 1.5), "a.toml:12: grain.one.seed = 1.5; must be a whole number");
  EXPECT_EQ(error_of("seed", std::int64_t{-1}), "a.toml:12: grain.one.seed = -1; must be >= 0");
  EXPECT_EQ(error_of("rotations", std::int64_t{1}), "a.toml:12: grain.one.rotations = 1; must be true or false");
  EXPECT_EQ(error_of("axis", std::string("w")), "a.toml:12: grain.one.axis = \"w\"; must be one of: x, y, z");
  EXPECT_EQ(error_of("velocity", Value::List{Value(1.0)}),
            "a.toml:12: grain.one.velocity = [1.0]; must have three components");
  EXPECT_EQ(error_of("mesh_parameters", Value::Table{{"a", at_line(std::string("b"), 13)}}),
            "a.toml:13: grain.one.mesh_parameters.a = \"b\"; not a number; write a number");
  EXPECT_EQ(error_of("name", std::string("a b")),
            "a.toml:12: grain.one.name = \"a b\"; a name is made of letters, digits, - and _; rename it");
}

TEST(Parameter, MissingKeyIsNamedWithItsMeaning) {
  Value table = raw();
  table.table().erase("radius");
  try {
    check(table, grain());
    FAIL();
  } catch (const base::UserError& error) {
    EXPECT_STREQ(error.what(), "a.toml:1: grain.one; \"radius\" is missing; add radius: of the sphere [m]");
  }
}

TEST(Parameter, TextFormHoldsEveryValueOnce) {
  const std::string toml =
      to_toml(check(raw({{"mesh_parameters", at_line(Value::Table{{"a", Value(0.1)}}, 4)}}), grain()), grain());
  EXPECT_EQ(toml,
            "name = \"one\"\nradius = 0.012  # m\npoisson_ratio = 0.2\nseed = 1\nrotations = true\naxis = \"z\"\n"
            "velocity = [0.0, 0.0, 0.0]  # m/s\nmesh_parameters = { a = 0.1 }\n");
}

TEST(Parameter, DescriptionComesFromTheDeclaration) {
  const std::string text = describe(grain());
  for (const char* part :
       {"radius", "of the sphere", "> 0", "required", "in (-1, 0.5]", "x | y | z", "(the grains' own)"}) {
    EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
  }
}

TEST(Text, NearestNameByEditDistance) {
  EXPECT_EQ(base::edit_distance("friction", "frction"), 1);
  EXPECT_EQ(base::edit_distance("friction", "firction"), 1);  // neighbours swapped
  EXPECT_EQ(base::edit_distance("abc", ""), 3);
  EXPECT_EQ(base::nearest("frction", {"friction", "restitution"}), "friction");
  EXPECT_EQ(base::nearest("colour", {"friction", "restitution"}), "");
  EXPECT_EQ(base::nearest("w", {"x", "y"}), "");
}

}  // namespace
