#pragma once
// How grains touch, as keys of a scene: the contact law, the rolling model, and the constants that they read. Names,
// texts, sources and which law reads what come from the tables of the DEM; here every constant has its unit and range,
// once. A law that reads a new constant: one row of contact_constants(), named as in dem::Interaction.
#include <string>
#include <variant>
#include <vector>

#include "base/parameter.hpp"
#include "dem/dem.hpp"

namespace coupling {

struct ContactConstant {
  base::Parameter declaration;
  std::variant<double dem::Interaction::*, int dem::Interaction::*> member;
};
const std::vector<ContactConstant>& contact_constants();

/// Elastic constants of a material, for laws that read them.
base::Parameter young_modulus(const std::string& of);
base::Parameter poisson_ratio(const std::string& of);

/// The keys of a contact between grains: `law`, `rolling`, constants.
std::vector<base::Parameter> grain_contact_parameters();
/// The same for a partner of the grains; what is absent is as between grains.
std::vector<base::Parameter> partner_contact_parameters();

/// The row of this name; it is one of them.
const dem::LawText& contact_law(const std::string& name);
const dem::LawText& rolling_model(const std::string& name);
bool reads(const dem::LawText&, const std::string& constant);

/// `trackbed list`: the laws and rolling models with their parameters.
std::vector<base::Table> contact_law_tables();
std::vector<base::Table> rolling_model_tables();

}  // namespace coupling
