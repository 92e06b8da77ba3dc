#include "coupling/grain_files.hpp"

#include <fmt/format.h>

#include "coupling/scene.hpp"
#include "dem/measure/contact_forces.hpp"
#include "dem/output.hpp"

namespace coupling {

dem::SieveCurve sieve_grains(std::span<const dem::Grain> grains, std::span<const GrainShape> shapes,
                             std::span<const double> sizes) {
  const auto bodies = clumps(shapes);
  std::vector<dem::SizedGrain> sized;
  for (const auto& grain : grains) sized.push_back({sieve_size(grain, shapes), dem::volume(grain, bodies)});
  return dem::sieve(sized, sizes);
}

std::string sieve_curve_text(const Scene& scene, std::span<const dem::Grain> grains) {
  dem::SieveCurve asked;
  if (scene.grains->packing)
    for (const auto& [size, passing] : scene.grains->packing->grading) asked.push_back({size, passing});
  std::vector<double> sizes = scene.output.sieves;
  if (sizes.empty())
    for (const auto& sieve : asked) sizes.push_back(sieve.size);
  if (sizes.empty()) return "";
  std::string text = asked.empty() ? "size [m],passing [-]\n" : "size [m],passing [-],asked [-]\n";
  for (const auto& [size, passing] : sieve_grains(grains, scene.grains->shapes, sizes)) {
    text += fmt::format("{:.6g},{:.6g}", size, passing);
    if (!asked.empty()) text += fmt::format(",{:.6g}", dem::passing(asked, size));
    text += "\n";
  }
  return text;
}

std::string contact_forces_text(std::span<const dem::GrainContact> contacts,
                                std::span<const dem::WallContact> wall_contacts) {
  const auto histogram = dem::force_histogram(dem::contact_forces(nullptr, contacts, wall_contacts));
  std::string text = "force_over_mean_from [-],force_over_mean_to [-],normal_density [-],shear_density [-]\n";
  for (std::size_t i = 0; i < histogram.normal.size(); ++i) {
    const double from = histogram.width * static_cast<double>(i);
    text += fmt::format("{:.6g},{:.6g},{:.6g},{:.6g}\n", from, from + histogram.width, histogram.normal[i],
                        histogram.shear[i]);
  }
  return text;
}

}  // namespace coupling
