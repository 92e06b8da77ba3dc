// The sieve curve of what is poured is the one that was asked for: 5000 grains, within 2 % at every sieve. (After
// pouring, striking off and settling 5533 of 5914 spheres lay in a box of 0.8 x 0.8 x 0.36 m, within 0.4 % of
// en13450_a.)
#include <gtest/gtest.h>

#include <array>
#include <filesystem>

#include "coupling/grain_files.hpp"
#include "coupling/scene.hpp"
#include "dem/dimensions.hpp"
#include "dem/output.hpp"

namespace {

constexpr double count = 5000;
constexpr double tolerance = 0.02;  // of the mass, at every sieve
const std::vector<double> sieves{0.0224, 0.027, 0.0315, 0.036, 0.040, 0.045, 0.050, 0.056, 0.063};

coupling::Packing packing_of(const dem::SieveCurve& curve) {
  coupling::Packing packing;
  for (const auto& [size, passing] : curve) packing.grading.push_back({size, passing});
  return packing;
}

/// Grains as a packing pours them; `solid_volume`: of 5000 grains.
std::vector<dem::Grain> poured(const dem::SieveCurve& curve, const coupling::Packing& packing,
                               const std::vector<coupling::GrainShape>& shapes, std::uint64_t seed) {
  const coupling::ShapeMix mix(packing, shapes);
  return mix.grains(dem::sample_radii(curve, count * dem::mean_grain_volume(curve), seed), seed);
}

void expect_curve(const std::vector<dem::Grain>& grains, const std::vector<coupling::GrainShape>& shapes,
                  const dem::SieveCurve& asked) {
  EXPECT_NEAR(static_cast<double>(grains.size()), count, 0.02 * count);
  for (const auto& [size, share] : coupling::sieve_grains(grains, shapes, sieves))
    EXPECT_NEAR(share, dem::passing(asked, size), tolerance) << size;
}

TEST(Grading, SpheresFollowEveryNamedCurve) {
  for (const auto& grading : dem::named_gradings()) {
    SCOPED_TRACE(grading.name);
    std::string why;
    EXPECT_TRUE(dem::within_en13450_a(grading.curve, &why)) << why;
    dem::check_curve(grading.curve);
    for (const std::uint64_t seed : {1, 2, 3})
      expect_curve(poured(grading.curve, packing_of(grading.curve), {}, seed), {}, grading.curve);
  }
}

// All eight stones of the library, as clumps of ten spheres, in unequal shares. Sizes by the radius of a clump's reach
// instead of by its sieve would be some 40 % too large, masses by the sum of its spheres' volumes would be uneven.
TEST(Grading, StonesOfTheLibraryFollowIt) {
  std::vector<coupling::GrainShape> shapes;
  coupling::Packing packing = packing_of(dem::named_gradings().front().curve);
  for (int stone = 1; stone <= 8; ++stone) {
    const std::string name = "stone" + std::to_string(stone) + ".clump10";
    shapes.push_back(coupling::read_shape(
        name, std::filesystem::path(TRACKBED_SOURCE_FOLDER) / "meshes" / "ballast" / (name + ".csv")));
    packing.shapes.push_back(stone - 1);
    packing.shape_shares.push_back(stone / 36.0);
  }
  const dem::SieveCurve& curve = dem::named_gradings().front().curve;
  const auto grains = poured(curve, packing, shapes, 1);
  expect_curve(grains, shapes, curve);
  // What the sieve is told of a stone is what its spheres are: the smallest square hole, searched anew.
  const auto bodies = coupling::clumps(shapes);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_NEAR(dem::sieve_size(dem::placed_spheres(grains[i], bodies)) / coupling::sieve_size(grains[i], shapes), 1,
                1e-3);
}

}  // namespace
