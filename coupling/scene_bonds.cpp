// Bonds of a scene: [grains.bond] and [[bond]].
#include <fmt/format.h>

#include <map>

#include "coupling/scene_parts.hpp"
#include "coupling/scene_tables.hpp"

namespace coupling {

using base::fail;
using base::Parameter;
using base::Table;
using base::Value;

namespace {

struct Constant {
  Parameter declaration;
  double dem::kernels::BondParameters::*member;
};

const std::vector<Constant>& constants() {
  using Of = dem::kernels::BondParameters;
  static const std::vector<Constant> all{
      {base::real("normal_stiffness", "Pa/m", "along the bond and against bending, per area of the bond").above(0),
       &Of::normal_stiffness},
      {base::real("shear_stiffness", "Pa/m", "across the bond and against twist, per area of the bond").at_least(0),
       &Of::shear_stiffness},
      {base::real("tensile_strength", "Pa", "largest tension and bending stress; beyond, the bond breaks").above(0),
       &Of::tensile_strength},
      {base::real("shear_strength", "Pa", "largest shear and twist stress; beyond, the bond breaks").above(0),
       &Of::shear_strength}};
  return all;
}
Parameter radius_ratio() {
  return base::real("radius_ratio", "", "radius of the bond over that of the smaller grain").above(0);
}

Cement read_cement(const Value& table) {
  Cement cement;
  for (const auto& [declaration, member] : constants()) cement.is.*member = table.at(declaration.name).real();
  cement.radius_ratio = table.at("radius_ratio").real();
  return cement;
}

std::int64_t read_end(const Value& number, const GrainsScene& grains) {
  const auto listed = static_cast<std::int64_t>(grains.list.size());
  if (number.integer() >= listed)
    fail(number, fmt::format("there are {} grains given by [[grain]]", listed), "numbers start from 0");
  if (grains.list[static_cast<std::size_t>(number.integer())].shape >= 0)
    fail(number, "this grain is a clump", "bonds join spheres; give the [[grain]] a radius instead of a shape");
  return number.integer();
}

ListedBond read_bond(Value& row, const Value* shared, const GrainsScene& grains) {
  for (const auto& [declaration, member] : constants()) {
    const std::string& name = declaration.name;
    if (row.has(name)) continue;
    if (!shared)
      fail(row, fmt::format("\"{}\" is missing", name),
           fmt::format("add {}: {} [{}], or [grains.bond]", name, declaration.meaning, declaration.unit));
    row.set(name, shared->at(name).data);
  }
  if (!row.has("radius_ratio")) row.set("radius_ratio", shared ? shared->at("radius_ratio").data : Value::Data(1.0));
  const ListedBond bond{read_end(row.at("first"), grains), read_end(row.at("second"), grains), read_cement(row)};
  if (bond.i == bond.j) fail(row.at("second"), "a grain cannot be bonded to itself", "name another grain");
  return bond;
}

}  // namespace

const Table& bonds_table() {
  static const Table table = [] {
    Table all{"grains.bond",
              "cement between grains: linear parallel bonds (Potyondy, Cundall 2004), beside their contact",
              {}};
    for (const auto& constant : constants()) all.parameters.push_back(constant.declaration);
    all.parameters.push_back(radius_ratio().otherwise(1.0));
    all.parameters.push_back(base::real("gap", "m", "every two spheres not farther apart at the start are bonded")
                                 .at_least(0)
                                 .optional("only [[bond]]"));
    return all;
  }();
  return table;
}

const Table& bond_table() {
  static const Table table = [] {
    Table all{"bond",
              "a bond between two grains given one by one",
              {base::integer("first", "number of the [[grain]], from 0").at_least(0),
               base::integer("second", "number of the other [[grain]]").at_least(0)}};
    for (const auto& constant : constants())
      all.parameters.push_back(Parameter(constant.declaration).optional("as in [grains.bond]"));
    all.parameters.push_back(radius_ratio().optional("as in [grains.bond], or 1"));
    return all;
  }();
  return table;
}

void build_bonds(Value& root, Scene& scene) {
  auto& rows = root.at("bond").list();
  if (!scene.grains) {
    if (!rows.empty()) fail(rows.front(), "there are no [grains] that it could join", "add [grains], or remove it");
    return;
  }
  GrainsScene& grains = *scene.grains;
  const Value* shared = root.at("grains").find("bond");
  if (shared) {
    grains.bonding.cement = read_cement(*shared);
    if (const Value* gap = shared->find("gap")) grains.bonding.gap = gap->real();
    if (!grains.bonding.gap && rows.empty())
      fail(*shared, "nothing is bonded", "add gap, or [[bond]] with the numbers of two grains");
    if (grains.bonding.gap && !grains.shapes.empty())
      fail(shared->at("gap"), "bonds join spheres, and [grains] has shapes", "leave gap out and list [[bond]]s");
  }
  std::map<std::pair<std::int64_t, std::int64_t>, std::string> known;
  for (auto& row : rows) {
    const ListedBond bond = read_bond(row, shared, grains);
    const auto [first, added] = known.emplace(std::minmax({bond.i, bond.j}), row.origin());
    if (!added) fail(row, fmt::format("these grains are bonded at {} already", first->second), "remove one of the two");
    grains.bonding.list.push_back(bond);
  }
}

}  // namespace coupling
