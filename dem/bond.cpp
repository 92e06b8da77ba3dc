#include "dem/bond.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/error.hpp"
#include "dem/dem.hpp"

namespace dem {

void check_bond(const kernels::BondParameters& bond) {
  const auto require = [](bool right, const char* name, double value, const char* rule) {
    char number[32];
    std::snprintf(number, sizeof number, "%.6g", value);
    base::require_user(right, "bond: " + std::string(name) + " = " + number + "; must be " + rule);
  };
  const auto finite = [](double value) { return std::isfinite(value); };
  require(bond.radius > 0 && finite(bond.radius), "radius", bond.radius, "> 0 and finite [m]");
  require(bond.normal_stiffness > 0 && finite(bond.normal_stiffness), "normal_stiffness", bond.normal_stiffness,
          "> 0 and finite [Pa/m]");
  require(bond.shear_stiffness >= 0 && finite(bond.shear_stiffness), "shear_stiffness", bond.shear_stiffness,
          ">= 0 and finite [Pa/m]");
  require(bond.tensile_strength > 0, "tensile_strength", bond.tensile_strength, "> 0 [Pa]");
  require(bond.shear_strength > 0, "shear_strength", bond.shear_strength, "> 0 [Pa]");
}

std::vector<std::array<std::int64_t, 2>> pairs_within(std::span<const Grain> grains, double gap) {
  std::vector<const Grain*> along_x;
  double largest = 0;
  for (const Grain& g : grains) {
    base::require_user(g.shape < 0, "dem: bonds join spheres; grain " + std::to_string(g.id) + " is a clump");
    along_x.push_back(&g);
    largest = std::max(largest, g.radius);
  }
  std::sort(along_x.begin(), along_x.end(),
            [](const Grain* a, const Grain* b) { return a->position.x < b->position.x; });
  std::vector<std::array<std::int64_t, 2>> pairs;
  for (std::size_t k = 0; k < along_x.size(); ++k) {
    const Grain& a = *along_x[k];
    for (std::size_t l = k + 1; l < along_x.size(); ++l) {
      const Grain& b = *along_x[l];
      if (b.position.x - a.position.x > a.radius + largest + gap) break;
      const double reach = a.radius + b.radius + gap;
      if (norm2(a.position - b.position) <= reach * reach)
        pairs.push_back({std::min(a.id, b.id), std::max(a.id, b.id)});
    }
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace dem
