// Stones: mass properties and sizes of bodies known in closed form, surfaces that are wrong, the generator and the
// filling with spheres, and the committed library.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>

#include "base/error.hpp"
#include "dem/clump.hpp"
#include "dem/clump_builder.hpp"
#include "dem/dimensions.hpp"
#include "dem/sphere_union.hpp"
#include "dem/stone.hpp"
#include "dem/stone_generator.hpp"
#include "dem/stone_library.hpp"

namespace {

using base::Vec3;
using dem::Sphere;
using dem::Stone;

std::string message_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const base::UserError& error) {
    return error.what();
  }
  return "";
}

/// A block from `low` with these edges, turned.
Stone block(const Vec3& edges, const Vec3& low = {}, const Vec3& turn = {}) {
  Stone stone;
  const auto q = dem::kernels::turn_by(turn);
  for (int i = 0; i < 8; ++i) {
    const Vec3 share{double(i % 2), double(i / 2 % 2), double(i / 4)};
    stone.corners.push_back(dem::kernels::to_space(q, low + dem::kernels::times(share, edges)));
  }
  stone.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                     {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return stone;
}

std::string file_text(const std::filesystem::path& path) {
  std::stringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

const std::filesystem::path library = std::filesystem::path(TRACKBED_SOURCE_FOLDER) / "meshes" / "ballast";

// V = abc, I_x / m = (b^2 + c^2) / 12.
TEST(Stone, BlockMassProperties) {
  const Vec3 edges{3, 2, 0.5}, turn{0.4, -0.8, 1.1};
  const auto properties = dem::mass_properties(block(edges, {5, 6, 7}, turn));
  EXPECT_NEAR(properties.volume, 3, 1e-12);
  EXPECT_NEAR(norm(properties.centroid - dem::kernels::to_space(dem::kernels::turn_by(turn), {6.5, 7, 7.25})), 0,
              1e-12);
  const auto axes = dem::principal_axes(properties.inertia);
  EXPECT_NEAR(axes.inertia.x, (4 + 0.25) / 12, 1e-12);
  EXPECT_NEAR(axes.inertia.y, (9 + 0.25) / 12, 1e-12);
  EXPECT_NEAR(axes.inertia.z, (9 + 4) / 12.0, 1e-12);
}

// A block a > b > c passes a square hole along its length: side b, or turned by 45 degrees (b + c) / sqrt(2).
TEST(Stone, BlockDimensions) {
  for (const Vec3& edges : {Vec3{3, 2, 1}, Vec3{3, 2, 0.5}}) {
    const auto d = dem::dimensions(dem::corner_spheres(block(edges, {}, {0.3, 0.5, -0.8})));
    EXPECT_NEAR(d.longest, norm(edges), 1e-5);
    EXPECT_NEAR(d.thinnest, edges.z, 1e-5);
    EXPECT_NEAR(d.length, edges.x, 1e-5);
    EXPECT_NEAR(d.width, edges.y, 1e-5);
    EXPECT_NEAR(d.thickness, edges.z, 1e-5);
    EXPECT_NEAR(d.sieve, std::min(edges.y, (edges.y + edges.z) / std::sqrt(2.0)), 1e-5);
  }
}

// Two balls: every size from the radii and the distance.
TEST(Stone, TwoSphereDimensions) {
  const auto d = dem::dimensions(std::vector<Sphere>{{{0, 0, 0}, 1}, {{0.6, 0.8, 0}, 1}});
  EXPECT_NEAR(d.longest, 3, 1e-5);
  EXPECT_NEAR(d.thinnest, 2, 1e-5);
  EXPECT_NEAR(d.sieve, 2, 1e-5);
  EXPECT_NEAR(d.length, 3, 1e-4);
}

// EN 933-3: the fraction 40/50 has the slot 25 mm. EN 933-4: L / E > 3.
TEST(Stone, FlakyAndElongated) {
  EXPECT_EQ(dem::fraction_top(0.045), 0.050);
  EXPECT_EQ(dem::fraction_top(0.050), 0.050);
  EXPECT_EQ(dem::fraction_top(0.0501), 0.063);
  EXPECT_EQ(dem::fraction_top(0.2), 0);
  dem::Dimensions d;
  d.sieve = 0.045;
  d.longest = 0.070;
  d.thinnest = 0.0251;
  EXPECT_FALSE(is_flaky(d));
  EXPECT_FALSE(is_elongated(d));
  d.thinnest = 0.0249;
  EXPECT_TRUE(is_flaky(d));
  d.longest = 0.0750;
  EXPECT_TRUE(is_elongated(d));
}

TEST(Stone, StlGoesRound) {
  const auto path = std::filesystem::temp_directory_path() / "trackbed_unit_stone.stl";
  std::ofstream(path) << dem::stl_text(block({0.03, 0.02, 0.01}), "block");
  const Stone stone = dem::read_stl(path);
  EXPECT_EQ(stone.corners.size(), 8u);
  EXPECT_EQ(stone.triangles.size(), 12u);
  EXPECT_NEAR(dem::mass_properties(stone).volume, 6e-6, 1e-12);
  // In millimetres, and inside out: turned.
  Stone inside_out = block({30, 20, 10});
  for (auto& t : inside_out.triangles) std::swap(t[0], t[1]);
  std::ofstream(path) << dem::stl_text(inside_out, "block");
  EXPECT_NEAR(dem::mass_properties(dem::read_stl(path, 1e-3)).volume, 6e-6, 1e-12);
  std::filesystem::remove(path);
}

TEST(Stone, Messages) {
  const auto closed = [](const Stone& stone) { return message_of([&] { dem::check_closed(stone); }); };
  EXPECT_EQ(closed(block({1, 1, 1})), "");
  Stone open = block({1, 1, 1});
  open.triangles.pop_back();
  EXPECT_EQ(closed(open),
            "the surface is not closed: 3 edges belong to one triangle only, the first from (1, 1, 0) to (1, 0, 1) m; "
            "close the holes and let neighbouring triangles share their corners exactly");
  Stone turned = block({1, 1, 1});
  std::swap(turned.triangles[0][0], turned.triangles[0][1]);
  EXPECT_EQ(closed(turned).substr(0, 73), "the surface bounds no body: 3 edges have two triangles that run along the");
  Stone two = block({1, 1, 1});
  const Stone other = block({1, 1, 1}, {5, 0, 0});
  two.corners.insert(two.corners.end(), other.corners.begin(), other.corners.end());
  for (const auto& t : other.triangles) two.triangles.push_back({t[0] + 8, t[1] + 8, t[2] + 8});
  EXPECT_EQ(closed(two), "the surface is in several pieces; give one stone per file");

  const auto path = std::filesystem::temp_directory_path() / "trackbed_unit_stone_bad.stl";
  const auto read = [&] { return message_of([&] { dem::read_stl(path); }); };
  EXPECT_EQ(read(), path.string() + ": cannot be read; must be an STL file");
  std::ofstream(path) << "what is this\n";
  EXPECT_EQ(read(), path.string() + ": no triangles found; must be an STL file (text or binary)");
  std::ofstream(path) << dem::stl_text(open, "open");
  EXPECT_EQ(read().substr(0, path.string().size() + 28), path.string() + ": the surface is not closed:");
  std::filesystem::remove(path);
  EXPECT_EQ(message_of([] { dem::make_stone({.thickness_to_width = 0}); }),
            "a stone's thickness_to_width must be in (0, 1]");
  EXPECT_EQ(message_of([] {
              dem::fill_with_spheres(block({1, 1, 1}), 0);
            }),
            "a clump of 0 spheres was asked for; must be in [1, 1000]");
}

// A block of 3 x 2 x 2 holds spheres of radius 1 and no larger; a sphere inside is inside.
TEST(Stone, FillingLiesInside) {
  const dem::Filling filling = dem::fill_with_spheres(block({3, 2, 2}), 9);
  ASSERT_EQ(filling.spheres.size(), 9u);
  EXPECT_GE(filling.spheres[0].radius, 0.97);
  EXPECT_LE(filling.spheres[0].radius, 1 + 1e-6);
  for (const Sphere& s : filling.spheres) {
    EXPECT_GE(s.position.x - s.radius, -1e-6);
    EXPECT_LE(s.position.x + s.radius, 3 + 1e-6);
    for (const double c : {s.position.y, s.position.z}) {
      EXPECT_GE(c - s.radius, -1e-6);
      EXPECT_LE(c + s.radius, 2 + 1e-6);
    }
  }
  EXPECT_NEAR(filling.error_volume, 1 - dem::make_clump(filling.spheres).volume / 12, 1e-12);
  EXPECT_LE(filling.error_volume, 0.35);  // one sphere alone: 0.65; two at the ends: 0.41
}

// Euler's V - E + F = 2, sieve and centroid as asked, another seed another stone.
TEST(Stone, GeneratedStone) {
  const Stone stone = dem::make_stone({.seed = 77, .sieve = 0.040});
  EXPECT_EQ(2 * stone.corners.size() - stone.triangles.size(), 4u);
  EXPECT_NEAR(dem::sieve_size(dem::corner_spheres(stone)), 0.040, 1e-5);
  EXPECT_NEAR(norm(dem::mass_properties(stone).centroid), 0, 1e-6);
  EXPECT_NE(dem::stl_text(stone, "a"), dem::stl_text(dem::make_stone({.seed = 78, .sieve = 0.040}), "a"));
}

// The committed files are what the generator makes.
TEST(Stone, FirstOfTheLibraryIsRegenerated) {
  const Stone stone = dem::make_stone(dem::ballast_stones()[0]);
  EXPECT_EQ(dem::stl_text(stone, "stone1"), file_text(library / "stone1.stl"));
  const dem::Filling filling = dem::fill_with_spheres(stone, dem::few_spheres);
  EXPECT_EQ(dem::spheres_text(filling.spheres, dem::filling_origin("stone1.stl", filling)),
            file_text(library / "stone1.clump10.csv"));
}

// Every stone is closed, and its clumps are clumps within it: the finer one is the larger.
TEST(Stone, LibraryIsSound) {
  for (std::size_t i = 1; i <= dem::ballast_stones().size(); ++i) {
    const std::string name = "stone" + std::to_string(i);
    const double volume = dem::mass_properties(dem::read_stl(library / (name + ".stl"))).volume;
    const auto few = dem::make_clump(dem::read_spheres(library / (name + ".clump10.csv")));
    const auto many = dem::make_clump(dem::read_spheres(library / (name + ".clump36.csv")));
    EXPECT_EQ(few.spheres.size(), 10u);
    EXPECT_EQ(many.spheres.size(), 36u);
    EXPECT_LT(few.volume, many.volume) << name;
    EXPECT_LT(many.volume, volume) << name;
    EXPECT_GT(many.volume, 0.8 * volume) << name;
  }
}

// The volume of the ball of 18.5 mm radius that it replaces.
TEST(Stone, TwoSphereClump) {
  const auto clump = dem::make_clump(dem::read_spheres(library / "two_sphere.csv"));
  EXPECT_EQ(clump.spheres.size(), 2u);
  EXPECT_NEAR(clump.volume, 4.0 / 3.0 * std::acos(-1.0) * std::pow(0.0185, 3), 1e-5 * clump.volume);
}

}  // namespace
