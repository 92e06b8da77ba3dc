// How grains touch each other, walls and skins: the law chosen, and exactly the constants that it reads.
#include <fmt/format.h>

#include "base/text.hpp"
#include "coupling/contact_tables.hpp"
#include "coupling/scene_parts.hpp"

namespace coupling {

using base::fail;
using base::Value;

namespace {

/// Laws, or rolling models, that read the constant.
std::vector<std::string> readers(const std::string& constant, const std::vector<dem::LawText>& rows) {
  std::vector<std::string> names;
  for (const auto& row : rows)
    if (reads(row, constant)) names.emplace_back(row.name);
  return names;
}

struct Choice {
  const dem::LawText& law;
  const dem::LawText& rolling;

  bool read(const std::string& constant) const { return reads(law, constant) || reads(rolling, constant); }
};

[[noreturn]] void refuse_unread(const Value& value, const std::string& name, const Choice& choice) {
  const auto laws = readers(name, dem::contact_law_texts());
  const auto models = readers(name, dem::rolling_model_texts());
  const bool of_rolling = laws.empty();
  fail(value,
       fmt::format("{} = \"{}\" does not read it", of_rolling ? "rolling" : "law",
                   of_rolling ? choice.rolling.name : choice.law.name),
       fmt::format("remove it, or choose one of: {}", base::join(of_rolling ? models : laws)));
}

[[noreturn]] void refuse_missing(const Value& table, const base::Parameter& constant, const Choice& choice) {
  const bool of_law = reads(choice.law, constant.name);
  fail(table,
       fmt::format("\"{}\" is missing: {} = \"{}\" reads it", constant.name, of_law ? "law" : "rolling",
                   of_law ? choice.law.name : choice.rolling.name),
       fmt::format("add {}: {}{}", constant.name, constant.meaning,
                   constant.unit.empty() ? "" : " [" + constant.unit + "]"));
}

}  // namespace

dem::Interaction read_contact(Value& table, const Value* grains) {
  for (const char* name : {"law", "rolling"})
    if (!table.has(name)) table.set(name, grains->at(name).data);
  dem::Interaction contact;
  contact.law = table.at("law").text();
  contact.rolling = table.at("rolling").text();
  const Choice choice{contact_law(contact.law), rolling_model(contact.rolling)};
  for (const auto& [declaration, member] : contact_constants()) {
    const std::string& name = declaration.name;
    if (!choice.read(name)) {
      if (const Value* value = table.find(name)) refuse_unread(*value, name, choice);
      continue;
    }
    if (!table.has(name)) {
      if (grains && grains->has(name))
        table.set(name, grains->at(name).data);
      else if (name == "rolling_friction" && contact.rolling == dem::Interaction{}.rolling)
        table.set(name, 0.0);
      else
        refuse_missing(table, declaration, choice);
    }
    const Value& value = table.at(name);
    if (const auto* real = std::get_if<double dem::Interaction::*>(&member))
      contact.** real = value.real();
    else
      contact.*std::get<int dem::Interaction::*>(member) = static_cast<int>(value.integer());
  }
  const bool rolls_on_shear = contact.rolling == "type_c" && contact.rolling_friction > 0;
  if (rolls_on_shear && choice.read("shear_stiffness") && contact.shear_stiffness == 0)
    fail(table.at("shear_stiffness"), "rolling = \"type_c\" needs it > 0 N/m", "raise it, or choose another rolling");
  return contact;
}

bool reads_elastic_constants(const dem::Interaction& contact) {
  return reads(contact_law(contact.law), "young_modulus");
}

void refuse_elastic_constants(const Value& value, const dem::Interaction& contact) {
  if (reads_elastic_constants(contact)) return;
  const std::string remedy = base::join(readers("young_modulus", dem::contact_law_texts()));
  fail(value, fmt::format("law = \"{}\" reads no elastic constants", contact.law),
       fmt::format("remove it, or choose one of: {}", remedy));
}

}  // namespace coupling
