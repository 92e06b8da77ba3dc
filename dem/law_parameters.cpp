#include "dem/law_parameters.hpp"

#include <cmath>
#include <cstdio>
#include <limits>
#include <string>

#include "base/error.hpp"
#include "dem/damping_ratio.hpp"
#include "dem/laws.hpp"
#include "dem/pair_parameters.hpp"

namespace dem {

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

/// "NAME = VALUE; must be RULE".
void require(bool right, const std::string& name, double value, const std::string& rule) {
  char number[32];
  std::snprintf(number, sizeof number, "%.6g", value);
  base::require_user(right, name + " = " + number + "; must be " + rule);
}
bool positive(double value) { return value > 0 && value < infinite; }
bool not_negative(double value) { return value >= 0 && value < infinite; }

void require_elastic(const Material& m) {
  const std::string of = m.name.empty() ? "" : "material " + m.name + ": ";
  require(positive(m.young_modulus), of + "young_modulus", m.young_modulus, "> 0 and finite [Pa]");
  require(m.poisson_ratio > -1 && m.poisson_ratio <= 0.5, of + "poisson_ratio", m.poisson_ratio, "in (-1, 0.5]");
}

void require_restitution(double e, bool zero_allowed = false) {
  require((e > 0 || (zero_allowed && e == 0)) && e <= 1, "restitution", e,
          zero_allowed ? "in [0, 1]" : "in (0, 1]; 1 for no damping");
}

void require_friction(const std::string& name, double value) {
  require(not_negative(value), name, value, ">= 0 and finite; 0 for none");
}

void require_interaction(const Interaction& interaction) {
  require_restitution(interaction.restitution);
  require_friction("friction", interaction.friction);
  require_friction("rolling_friction", interaction.rolling_friction);
}

/// Hertz contacts take gamma = zeta / sqrt(6/5), see damping_ratio.hpp; zeta is the damping ratio of a linear contact.
const double linear_to_hertz = std::sqrt(1.2);

}  // namespace

namespace {
template <class Table>
std::vector<LawText> texts(const Table& table) {
  std::vector<LawText> all;
  for_each_law(table, [&](const auto& row) {
    all.push_back({row.name, row.text, row.source, {}});
    for (const auto& name : row.parameters)
      if (!name.empty()) all.back().parameters.push_back(name);
  });
  return all;
}
}  // namespace

std::vector<LawText> contact_law_texts() { return texts(laws); }
std::vector<LawText> rolling_model_texts() { return texts(rolling_models); }

kernels::PairParameters hertz_pair(const Material& a, const Material& b, const Interaction& interaction) {
  require_elastic(a);
  require_elastic(b);
  require_interaction(interaction);
  return pair_parameters(a, b, interaction);
}

kernels::PairParameters hertz_wall(const Material& grain, const Material& wall, const Interaction& interaction) {
  require_elastic(grain);
  require_elastic(wall);
  require_interaction(interaction);
  return wall_parameters(grain, wall, interaction);
}

kernels::PairParameters linear_pair(const LinearContact& contact) {
  require(positive(contact.normal_stiffness), "normal_stiffness", contact.normal_stiffness, "> 0 and finite [N/m]");
  require(not_negative(contact.shear_stiffness), "shear_stiffness", contact.shear_stiffness, ">= 0 and finite [N/m]");
  require_friction("friction", contact.friction);
  return {.damping_ratio = linear_damping_ratio(contact.restitution),
          .friction = contact.friction,
          .normal_stiffness = contact.normal_stiffness,
          .shear_stiffness = contact.shear_stiffness};
}

double linear_damping_ratio(double restitution) {
  require_restitution(restitution);
  return linear_to_hertz * damping_ratio(restitution);
}

double linear_restitution(double damping_ratio) {
  require(not_negative(damping_ratio), "damping_ratio", damping_ratio, ">= 0 and finite");
  return restitution_of(damping_ratio / linear_to_hertz);
}

kernels::PairParameters voigt_pair(const VoigtContact& contact) {
  require(not_negative(contact.normal_viscosity), "normal_viscosity", contact.normal_viscosity, ">= 0 [N s/m]");
  require(not_negative(contact.shear_viscosity), "shear_viscosity", contact.shear_viscosity, ">= 0 [N s/m]");
  kernels::PairParameters pair = linear_pair({.normal_stiffness = contact.normal_stiffness,
                                              .shear_stiffness = contact.shear_stiffness,
                                              .friction = contact.friction});
  pair.normal_viscosity = contact.normal_viscosity;
  pair.shear_viscosity = contact.shear_viscosity;
  return pair;
}

double voigt_shear_stiffness(double normal_stiffness, double poisson_ratio) {
  require(positive(normal_stiffness), "normal_stiffness", normal_stiffness, "> 0 and finite [N/m]");
  require(poisson_ratio > -1 && poisson_ratio <= 0.5, "poisson_ratio", poisson_ratio, "in (-1, 0.5]");
  return normal_stiffness / (2 * (1 + poisson_ratio));
}

double hysteretic_damping(int mode, double restitution) {
  require(mode >= 0 && mode <= 2, "damping_mode", mode, "0 (Gonthier), 1 (Lankarani) or 2 (Zhiying)");
  require_restitution(restitution, mode != 0);
  const double lost = 1 - restitution * restitution;
  if (mode == 0) return lost / restitution;
  return 0.75 * lost * (mode == 1 ? 1 : std::exp(2 * (1 - restitution)));
}

double hysteretic_restitution(double damping) {
  require(not_negative(damping), "hysteretic_damping", damping, ">= 0 and finite");
  if (damping < 1e-7) return 1 - 2.0 / 3.0 * damping;  // where the logarithms below cancel
  double low = 0, high = damping > 1 ? 1 / damping : 1;
  while (high - low > 1e-15 * high) {
    const double middle = 0.5 * (low + high);
    if (middle == low || middle == high) break;
    const double rest = damping * (1 + middle) - std::log1p(damping) + std::log1p(-damping * middle);
    (rest > 0 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

double critical_stress(const RestingStone& stone) {
  const double pi = std::acos(-1.0);
  require(positive(stone.weight), "weight", stone.weight, "> 0 and finite [N]");
  require(positive(stone.effective_radius), "effective_radius", stone.effective_radius, "> 0 and finite [m]");
  require(positive(stone.effective_young_modulus), "effective_young_modulus", stone.effective_young_modulus,
          "> 0 and finite [Pa]");
  const double overlap =
      std::pow(0.75 * stone.weight / (stone.effective_young_modulus * std::sqrt(stone.effective_radius)), 2.0 / 3.0);
  return 1.5 * stone.weight / (pi * stone.effective_radius * overlap);
}

double rolling_stiffness(double rolling_friction, double normal_to_shear_stiffness) {
  require_friction("rolling_friction", rolling_friction);
  require(positive(normal_to_shear_stiffness), "k_n / k_t", normal_to_shear_stiffness, "> 0 and finite");
  return 2.25 * rolling_friction * rolling_friction * normal_to_shear_stiffness;
}

double normal_to_shear_stiffness(const kernels::PairParameters& pair) {
  require(positive(pair.effective_shear_modulus), "effective_shear_modulus", pair.effective_shear_modulus,
          "> 0 and finite [Pa]");
  return 0.25 * pair.effective_young_modulus / pair.effective_shear_modulus;
}

kernels::PairParameters interaction_parameters(const Material& a, const Material& b, const Interaction& interaction,
                                               bool wall) {
  const int law = row_number(laws, interaction.law), rolling = row_number(rolling_models, interaction.rolling);
  base::require_user(law >= 0, "law = " + interaction.law + "; no such contact law");
  base::require_user(rolling >= 0, "rolling = " + interaction.rolling + "; no such rolling model");
  kernels::PairParameters pair;
  if (interaction.law == "linear") {
    pair = linear_pair(
        {interaction.normal_stiffness, interaction.shear_stiffness, interaction.friction, interaction.restitution});
  } else if (interaction.law == "voigt_slider") {
    pair = voigt_pair({interaction.normal_stiffness, interaction.shear_stiffness, interaction.normal_viscosity,
                       interaction.shear_viscosity, interaction.friction});
  } else {
    pair = wall ? hertz_wall(a, b, interaction) : hertz_pair(a, b, interaction);
  }
  if (interaction.law == "hysteretic") {
    pair.damping_ratio = pair.shear_damping = 0;
    pair.hysteretic_damping = hysteretic_damping(interaction.damping_mode, interaction.restitution);
  }
  if (interaction.law == "viscoelastic") {
    pair.damping_ratio = pair.shear_damping = 0;
    pair.dissipative_coefficient = interaction.dissipative_coefficient;
  }
  pair.critical_stress = interaction.critical_stress;
  pair.friction_exponent = interaction.friction_exponent;
  pair.law = interaction.law == "hertz_mindlin" && interaction.friction == 0 ? smooth_law : law;
  pair.rolling = interaction.rolling_friction > 0 ? rolling : no_rolling;
  pair.rolling_friction = interaction.rolling_friction;
  if (pair.rolling == rolling_c) {
    const bool springs = pair.normal_stiffness > 0;
    base::require_user(!springs || pair.shear_stiffness > 0, "rolling = type_c needs shear_stiffness > 0");
    const double ratio = springs ? pair.normal_stiffness / pair.shear_stiffness : normal_to_shear_stiffness(pair);
    pair.rolling_stiffness = rolling_stiffness(interaction.rolling_friction, ratio);
    pair.rolling_damping = interaction.rolling_damping;
  }
  check_parameters(pair);
  return pair;
}

void check_parameters(const kernels::PairParameters& p) {
  const struct {
    const char* name;
    double value;
  } numbers[] = {{"effective_young_modulus", p.effective_young_modulus},
                 {"effective_shear_modulus", p.effective_shear_modulus},
                 {"damping_ratio", p.damping_ratio},
                 {"shear_damping", p.shear_damping},
                 {"friction", p.friction},
                 {"rolling_friction", p.rolling_friction},
                 {"normal_stiffness", p.normal_stiffness},
                 {"shear_stiffness", p.shear_stiffness},
                 {"normal_viscosity", p.normal_viscosity},
                 {"shear_viscosity", p.shear_viscosity},
                 {"hysteretic_damping", p.hysteretic_damping},
                 {"dissipative_coefficient", p.dissipative_coefficient},
                 {"critical_stress", p.critical_stress},
                 {"rolling_stiffness", p.rolling_stiffness},
                 {"rolling_damping", p.rolling_damping}};
  for (const auto& number : numbers) require(not_negative(number.value), number.name, number.value, ">= 0 and finite");
  require(p.friction_exponent <= 0 && p.friction_exponent > -infinite, "friction_exponent", p.friction_exponent,
          "<= 0 and finite: friction falls with stress");
  require(p.friction_exponent == 0 || p.critical_stress > 0, "critical_stress", p.critical_stress,
          "> 0 where friction_exponent is not 0 [Pa]");
}

}  // namespace dem
