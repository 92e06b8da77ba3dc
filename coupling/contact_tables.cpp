#include "coupling/contact_tables.hpp"

#include <algorithm>

#include "base/error.hpp"

namespace coupling {

using base::Parameter;
using dem::Interaction;

const std::vector<ContactConstant>& contact_constants() {
  static const std::vector<ContactConstant> constants{
      {base::real("friction", "", "Coulomb coefficient").at_least(0), &Interaction::friction},
      {base::real("restitution", "", "normal coefficient of restitution; 1: no damping").above(0).at_most(1),
       &Interaction::restitution},
      {base::real("normal_stiffness", "N/m", "spring along the normal").above(0), &Interaction::normal_stiffness},
      {base::real("shear_stiffness", "N/m", "spring against sliding").at_least(0), &Interaction::shear_stiffness},
      {base::real("normal_viscosity", "N s/m", "dashpot along the normal").at_least(0), &Interaction::normal_viscosity},
      {base::real("shear_viscosity", "N s/m", "dashpot against sliding").at_least(0), &Interaction::shear_viscosity},
      {base::real("dissipative_coefficient", "s", "A of viscoelastic spheres").at_least(0),
       &Interaction::dissipative_coefficient},
      {base::integer("damping_mode", "0: Gonthier, 1: Lankarani-Nikravesh, 2: Zhiying-Qishao").at_least(0).at_most(2),
       &Interaction::damping_mode},
      {base::real("critical_stress", "Pa", "peak stress of a contact beyond which friction falls").above(0),
       &Interaction::critical_stress},
      {base::real("friction_exponent", "", "power of stress / critical_stress in the friction").at_most(0),
       &Interaction::friction_exponent},
      {base::real("rolling_friction", "", "rolling friction, Irazabal2017 5.3; 0: none").at_least(0),
       &Interaction::rolling_friction},
      {base::real("rolling_damping", "", "dashpot of rolling, share of the critical one").at_least(0),
       &Interaction::rolling_damping}};
  return constants;
}

Parameter young_modulus(const std::string& of) {
  return base::real("young_modulus", "Pa", "Young's modulus of " + of).above(0);
}
Parameter poisson_ratio(const std::string& of) {
  return base::real("poisson_ratio", "", "Poisson ratio of " + of).above(-1).at_most(0.5);
}

namespace {

const std::vector<dem::LawText>& laws() {
  static const std::vector<dem::LawText> rows = dem::contact_law_texts();
  return rows;
}
const std::vector<dem::LawText>& models() {
  static const std::vector<dem::LawText> rows = dem::rolling_model_texts();
  return rows;
}

std::vector<std::string> names(const std::vector<dem::LawText>& rows) {
  std::vector<std::string> all;
  for (const auto& row : rows) all.emplace_back(row.name);
  return all;
}

const dem::LawText& find(const std::vector<dem::LawText>& rows, const std::string& name) {
  const auto found = std::find_if(rows.begin(), rows.end(), [&](const auto& row) { return row.name == name; });
  base::require_internal(found != rows.end(), "a contact law of no name");
  return *found;
}

Parameter law() { return base::text("law", "contact law, see `trackbed list laws`").among(names(laws())); }
Parameter rolling() {
  return base::text("rolling", "rolling model, see `trackbed list rolling`").among(names(models()));
}

Parameter declared(std::string_view name) {
  for (const auto& constant : contact_constants())
    if (constant.declaration.name == name) return constant.declaration;
  if (name == "young_modulus") return young_modulus("the material");
  if (name == "poisson_ratio") return poisson_ratio("the material");
  throw base::InternalError("a contact law reads " + std::string(name) + ", which is not declared");
}

std::vector<base::Table> tables(const std::vector<dem::LawText>& rows) {
  std::vector<base::Table> all;
  for (const auto& row : rows) {
    const std::string source = row.source.empty() ? "" : " (" + std::string(row.source) + ")";
    base::Table table{std::string(row.name), std::string(row.text) + source, {}};
    for (const auto& name : row.parameters) table.parameters.push_back(declared(name));
    if (row.name == Interaction{}.rolling) table.parameters.back() = table.parameters.back().otherwise(0.0);
    all.push_back(std::move(table));
  }
  return all;
}

}  // namespace

std::vector<Parameter> grain_contact_parameters() {
  const Interaction defaults;
  std::vector<Parameter> all{law().otherwise(defaults.law.c_str()), rolling().otherwise(defaults.rolling.c_str())};
  for (const auto& [declaration, member] : contact_constants()) {
    Parameter constant = declaration;
    if (constant.name != "friction")  // that every law reads
      constant = constant.optional(constant.name == "rolling_friction" ? "0 with rolling = \"" + defaults.rolling + "\""
                                                                       : "required where the law reads it");
    all.push_back(constant);
  }
  return all;
}

std::vector<Parameter> partner_contact_parameters() {
  constexpr const char* own = "the grains' own";
  std::vector<Parameter> all{law().optional(own), rolling().optional(own)};
  for (const auto& [declaration, member] : contact_constants()) all.push_back(declaration.optional(own));
  return all;
}

const dem::LawText& contact_law(const std::string& name) { return find(laws(), name); }
const dem::LawText& rolling_model(const std::string& name) { return find(models(), name); }

bool reads(const dem::LawText& row, const std::string& constant) {
  return std::find(row.parameters.begin(), row.parameters.end(), constant) != row.parameters.end();
}

std::vector<base::Table> contact_law_tables() { return tables(laws()); }
std::vector<base::Table> rolling_model_tables() { return tables(models()); }

}  // namespace coupling
