#include "dem/stone_library.hpp"

#include <array>
#include <cmath>
#include <cstdio>

#include "dem/clump.hpp"

namespace dem {

std::span<const AngularStone> ballast_stones() {
  // From compact to elongated (6) and flaky (7), so that the library holds what a good ballast holds.
  static constexpr std::array<AngularStone, 8> stones{{
      {.seed = 1, .width_to_length = 0.80, .thickness_to_width = 0.80},
      {.seed = 2, .width_to_length = 0.70, .thickness_to_width = 0.75},
      {.seed = 3, .width_to_length = 0.90, .thickness_to_width = 0.70},
      {.seed = 4, .width_to_length = 0.65, .thickness_to_width = 0.65},
      {.seed = 5, .width_to_length = 0.75, .thickness_to_width = 0.95},
      {.seed = 6, .width_to_length = 0.58, .thickness_to_width = 0.85},
      {.seed = 7, .width_to_length = 0.85, .thickness_to_width = 0.38},
      {.seed = 8, .width_to_length = 0.70, .thickness_to_width = 0.60},
  }};
  return stones;
}

std::vector<Sphere> two_sphere_clump() {
  const double radius = 0.0185 * std::cbrt(16.0 / 27.0);
  return {{{-radius / 2, 0, 0}, radius}, {{radius / 2, 0, 0}, radius}};
}

std::string filling_origin(const std::string& stone, const Filling& filling) {
  std::array<char, 200> text{};
  std::snprintf(text.data(), text.size(), "%s filled with %zu inscribed spheres, error volume %.1f %% of the stone",
                stone.c_str(), filling.spheres.size(), 100 * filling.error_volume);
  return text.data();
}

std::string spheres_text(std::span<const Sphere> spheres, const std::string& origin) {
  // As the file will say them, so that the properties are those of the file. + 0.0: no "-0.0000000".
  const auto rounded = [](double x) { return std::round(1e7 * x) / 1e7 + 0.0; };
  std::vector<Sphere> written;
  for (const Sphere& s : spheres) {
    written.push_back({{rounded(s.position.x), rounded(s.position.y), rounded(s.position.z)}, rounded(s.radius)});
  }
  const Clump clump = make_clump(written);
  std::array<char, 400> line{};
  std::snprintf(
      line.data(), line.size(),
      "# union: volume %.6e m3; principal moments / mass %.6e %.6e %.6e m2; from the centroid to the farthest "
      "point %.6f m\n",
      clump.volume, clump.inertia.x, clump.inertia.y, clump.inertia.z, clump.reach);
  std::string text = "# " + origin + "\n" + line.data() + "x_m,y_m,z_m,radius_m\n";
  for (const Sphere& s : written) {
    std::snprintf(line.data(), line.size(), "%.7f,%.7f,%.7f,%.7f\n", s.position.x, s.position.y, s.position.z,
                  s.radius);
    text += line.data();
  }
  return text;
}

}  // namespace dem
