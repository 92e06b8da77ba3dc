// Clumps: mass properties of the union against closed forms, their frame, messages. What a wrong code gives stands with
// each test.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <numbers>

#include "base/error.hpp"
#include "dem/clump.hpp"
#include "dem/sphere_union.hpp"

namespace {

using base::Vec3;
using dem::Sphere;
using std::numbers::pi;

std::string message_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const base::UserError& error) {
    return error.what();
  }
  return "";
}

/// Ten spheres of different sizes on an angular stone's scale.
std::vector<Sphere> ten_spheres() {
  return {{{-0.000271885, 0.000069164, -0.000586472}, 0.017},  {{0.012728115, 0.004069164, 0.002413528}, 0.015},
          {{-0.013271885, -0.002930836, 0.001413528}, 0.0155}, {{0.003728115, 0.011069164, -0.003586472}, 0.012},
          {{-0.005271885, -0.010930836, 0.002413528}, 0.012},  {{0.018728115, -0.003930836, -0.004586472}, 0.011},
          {{-0.019271885, 0.005069164, -0.003586472}, 0.0105}, {{0.001728115, -0.003930836, 0.008413528}, 0.0105},
          {{-0.003271885, 0.004069164, -0.009586472}, 0.011},  {{0.009728115, -0.008930836, 0.004413528}, 0.0095}};
}

/// Union of spheres by rays along z: the union of intervals on each ray is exact, the grid of rays is not.
dem::MassProperties by_rays(const std::vector<Sphere>& spheres, double half_width, int rays) {
  const double step = 2 * half_width / rays;
  dem::VolumeMoments m;
  std::vector<std::pair<double, double>> pieces;
  for (int i = 0; i < rays * rays; ++i) {
    const double x = -half_width + (i / rays + 0.5) * step, y = -half_width + (i % rays + 0.5) * step;
    pieces.clear();
    for (const Sphere& s : spheres) {
      const double dx = x - s.position.x, dy = y - s.position.y, half2 = s.radius * s.radius - dx * dx - dy * dy;
      if (half2 > 0) pieces.push_back({s.position.z - std::sqrt(half2), s.position.z + std::sqrt(half2)});
    }
    std::sort(pieces.begin(), pieces.end());
    double reached = -HUGE_VAL;
    for (const auto& [from, to] : pieces) {
      const double a = std::max(from, reached), area = step * step;
      if (to <= a) continue;
      const double length = area * (to - a), z = area * (to * to - a * a) / 2;
      m.volume += length;
      m.first += Vec3{x * length, y * length, z};
      m.second.xx += x * x * length;
      m.second.yy += y * y * length;
      m.second.zz += area * (to * to * to - a * a * a) / 3;
      m.second.xy += x * y * length;
      m.second.xz += x * z;
      m.second.yz += y * z;
      reached = to;
    }
  }
  return dem::mass_properties(m, {});
}

// 4/3 pi r^3 and 2/5 r^2, away from the origin.
TEST(Clump, OneSphere) {
  const double r = 0.02;
  const dem::Clump clump = dem::make_clump(std::vector<Sphere>{{{1, -2, 3}, r}});
  EXPECT_NEAR(clump.volume, 4.0 / 3.0 * pi * r * r * r, 1e-12 * clump.volume);
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(clump.inertia[axis], 0.4 * r * r, 1e-12 * 0.4 * r * r);
  EXPECT_EQ(clump.orientation.w, 1);
  EXPECT_NEAR(norm(clump.spheres[0].position), 0, 1e-15);
  EXPECT_NEAR(clump.reach, r, 1e-15);
  EXPECT_NEAR(clump.bounding.radius, r, 1e-15);
}

// Two equal spheres whose centres are 2h apart: each half is a sphere of radius r cut at h beyond its centre. With
// t = z - centre: V = 2 int_{-r}^{h} pi (r^2 - t^2) dt, axial int pi/2 (r^2 - t^2)^2, transverse adds (t - h)^2.
// The sum instead of the union would count the lens twice.
TEST(Clump, TwoSpheresClosedForm) {
  const double r = 1.3, h = 0.55;
  const auto half = [&](double (*primitive)(double, double, double)) {
    return primitive(h, r, h) - primitive(-r, r, h);
  };
  const auto area = [](double t, double R, double) { return pi * (R * R * t - t * t * t / 3); };
  const auto axial = [](double t, double R, double) {
    return pi / 2 * (R * R * R * R * t - 2 * R * R * t * t * t / 3 + std::pow(t, 5) / 5);
  };
  const auto along = [](double t, double R, double H) {  // pi (R^2 - t^2) (t - H)^2
    return pi * (R * R * (t * t * t / 3 - H * t * t + H * H * t) - std::pow(t, 5) / 5 + H * std::pow(t, 4) / 2 -
                 H * H * t * t * t / 3);
  };
  const double volume = 2 * half(area);
  const double about_axis = 2 * half(axial) / volume;
  const double across = about_axis / 2 + 2 * half(along) / volume;
  const Vec3 direction = (1 / std::sqrt(14.0)) * Vec3{1, 2, 3}, middle{5, -1, 0.3};
  const dem::Clump clump =
      dem::make_clump(std::vector<Sphere>{{middle + h * direction, r}, {middle - h * direction, r}});
  EXPECT_NEAR(clump.volume, volume, 1e-12 * volume);
  EXPECT_NEAR(clump.inertia.x, about_axis, 1e-12 * about_axis);
  EXPECT_NEAR(clump.inertia.y, across, 1e-12 * across);
  EXPECT_NEAR(clump.inertia.z, across, 1e-12 * across);
  EXPECT_NEAR(norm(clump.centroid - middle), 0, 1e-12);
  EXPECT_NEAR(std::fabs(dot(dem::kernels::to_space(clump.orientation, {1, 0, 0}), direction)), 1, 1e-12);
  EXPECT_NEAR(clump.bounding.radius, r + h, 1e-12);
}

/// Spheres turned and moved as one.
std::vector<Sphere> moved(std::vector<Sphere> spheres, const Vec3& turn, const Vec3& shift) {
  const auto q = dem::kernels::turn_by(turn);
  for (Sphere& s : spheres) s.position = shift + dem::kernels::to_space(q, s.position);
  return spheres;
}

// Three in a row: the outer two do not touch, so that V = 3 spheres - 2 lenses (lens: two caps, pi h^2 (r - h/3) each).
TEST(Clump, ThreeInARow) {
  const double r = 1, spacing = 1.4, height = r - spacing / 2;
  const std::vector<Sphere> row{{{0, 0, 0}, r}, {{spacing, 0, 0}, r}, {{2 * spacing, 0, 0}, r}};
  const double volume = 3 * 4.0 / 3.0 * pi - 2 * 2 * pi * height * height * (r - height / 3);
  EXPECT_NEAR(dem::make_clump(row).volume, volume, 1e-12 * volume);
}

// An independent integration; its grid is good to 5e-5. Wrong signs in the moments show as 1e-2 and more.
TEST(Clump, TenSpheresAgainstRays) {
  const auto spheres = ten_spheres();
  const auto exact = dem::union_properties(spheres), rays = by_rays(spheres, 0.031, 300);
  EXPECT_NEAR(exact.volume, rays.volume, 5e-5 * exact.volume);
  EXPECT_NEAR(norm(exact.centroid - rays.centroid), 0, 5e-5 * 0.02);
  const double scale = 5e-5 * exact.inertia.zz;
  EXPECT_NEAR(exact.inertia.xx, rays.inertia.xx, scale);
  EXPECT_NEAR(exact.inertia.yy, rays.inertia.yy, scale);
  EXPECT_NEAR(exact.inertia.zz, rays.inertia.zz, scale);
  EXPECT_NEAR(exact.inertia.xy, rays.inertia.xy, scale);
  EXPECT_NEAR(exact.inertia.xz, rays.inertia.xz, scale);
  EXPECT_NEAR(exact.inertia.yz, rays.inertia.yz, scale);
}

// Every circle of the eight passes through common points, and a void stays in the middle (r < sqrt(3)/2).
TEST(Clump, EightOnACubeWithAVoid) {
  std::vector<Sphere> cube;
  for (int i = 0; i < 8; ++i) cube.push_back({{i % 2 - 0.5, i / 2 % 2 - 0.5, i / 4 - 0.5}, 0.8});
  const auto exact = dem::union_properties(cube), rays = by_rays(cube, 1.3, 300);
  EXPECT_NEAR(exact.volume, rays.volume, 5e-5 * exact.volume);
  EXPECT_NEAR(exact.inertia.xx, rays.inertia.xx, 5e-5 * exact.inertia.xx);
  EXPECT_NEAR(exact.inertia.xx, exact.inertia.zz, 1e-13);
  EXPECT_NEAR(exact.inertia.xy, 0, 1e-13);
}

TEST(Clump, WhatLiesInsideCountsOnce) {
  auto spheres = ten_spheres();
  const double volume = dem::make_clump(spheres).volume;
  spheres.push_back(spheres[3]);                    // the same again
  spheres.push_back({spheres[0].position, 0.004});  // inside another
  spheres.insert(spheres.begin(), spheres.back());  // and before it
  EXPECT_NEAR(dem::make_clump(spheres).volume, volume, 1e-13 * volume);
}

// Another frame meets other poles, arcs and signs; the body is the same to rounding.
TEST(Clump, FrameDoesNotMatter) {
  const dem::Clump here = dem::make_clump(ten_spheres());
  for (const Vec3& turn : {Vec3{0.3, -1.1, 0.7}, Vec3{2, 1, -1}, Vec3{-0.2, 0, 3}}) {
    const dem::Clump there = dem::make_clump(moved(ten_spheres(), turn, {0.4, -0.2, 0.1}));
    EXPECT_NEAR(there.volume, here.volume, 1e-12 * here.volume);
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(there.inertia[axis], here.inertia[axis], 1e-12 * here.inertia.z);
  }
}

TEST(Clump, BodyFrameIsCentroidAndPrincipal) {
  const auto given = moved(ten_spheres(), {0.4, 0.5, -0.6}, {1, 2, 3});
  const dem::Clump clump = dem::make_clump(given);
  const auto body = dem::union_properties(clump.spheres);
  EXPECT_NEAR(norm(body.centroid), 0, 1e-15);
  EXPECT_NEAR(body.inertia.xx, clump.inertia.x, 1e-12 * clump.inertia.z);
  EXPECT_NEAR(body.inertia.zz, clump.inertia.z, 1e-12 * clump.inertia.z);
  for (const double product : {body.inertia.xy, body.inertia.xz, body.inertia.yz}) {
    EXPECT_NEAR(product, 0, 1e-12 * clump.inertia.z);
  }
  EXPECT_LE(clump.inertia.x, clump.inertia.y);
  EXPECT_LE(clump.inertia.y, clump.inertia.z);
  for (std::size_t i = 0; i < given.size(); ++i) {
    const Vec3 back = clump.centroid + dem::kernels::to_space(clump.orientation, clump.spheres[i].position);
    EXPECT_NEAR(norm(back - given[i].position), 0, 1e-14);
  }
}

TEST(Clump, ScaledIsTheClumpOfScaledSpheres) {
  auto spheres = ten_spheres();
  const dem::Clump twice = dem::scaled(dem::make_clump(spheres), 2);
  for (Sphere& s : spheres) s = {2.0 * s.position, 2 * s.radius};
  const dem::Clump expected = dem::make_clump(spheres);
  EXPECT_NEAR(twice.volume, expected.volume, 1e-12 * expected.volume);
  EXPECT_NEAR(twice.inertia.y, expected.inertia.y, 1e-12 * expected.inertia.y);
  EXPECT_NEAR(twice.reach, expected.reach, 1e-14);
  EXPECT_NEAR(twice.bounding.radius, expected.bounding.radius, 1e-14);
  EXPECT_THROW(dem::scaled(expected, 0), base::UserError);
}

// Everything inside; at least half the largest extent; not larger than the sphere about the centroid.
TEST(Clump, BoundingSphere) {
  const dem::Clump clump = dem::make_clump(ten_spheres());
  double extent = 0;
  for (const Sphere& a : clump.spheres) {
    EXPECT_LE(norm(a.position - clump.bounding.position) + a.radius, clump.bounding.radius * (1 + 1e-12));
    EXPECT_LE(norm(a.position) + a.radius, clump.reach * (1 + 1e-12));
    for (const Sphere& b : clump.spheres)
      extent = std::max(extent, norm(a.position - b.position) + a.radius + b.radius);
  }
  EXPECT_GE(clump.bounding.radius, extent / 2 * (1 - 1e-12));
  EXPECT_LE(clump.bounding.radius, 1.05 * extent / 2);
  // Four equal spheres on a regular tetrahedron of edge 1: circumradius sqrt(3/8) + r.
  const std::vector<Sphere> four{{{0, 0, 0}, 0.6},
                                 {{1, 0, 0}, 0.6},
                                 {{0.5, std::sqrt(0.75), 0}, 0.6},
                                 {{0.5, std::sqrt(1.0 / 12), std::sqrt(2.0 / 3)}, 0.6}};
  EXPECT_NEAR(dem::bounding_sphere(four).radius, std::sqrt(3.0 / 8) + 0.6, 0.02);
}

TEST(Clump, Messages) {
  const auto make = [](std::vector<Sphere> spheres) { return message_of([&] { dem::make_clump(spheres); }); };
  EXPECT_EQ(make({}), "a clump needs one sphere or more; none found");
  EXPECT_EQ(make({{{0, 0, 0}, 1}, {{1, 0, 0}, -0.5}}), "sphere 2 of the clump: radius = -0.5 m; must be > 0");
  EXPECT_EQ(make({{{NAN, 0, 0}, 1}}), "sphere 1 of the clump: position is not a finite number");
  EXPECT_EQ(
      make({{{0, 0, 0}, 1}, {{5, 0, 0}, 1}, {{1, 0, 0}, 1}}),
      "sphere 2 of the clump overlaps no sphere that leads to sphere 1; a clump is one piece: move or enlarge it, "
      "or leave it out");
}

TEST(Clump, ReadsSpheres) {
  const auto path = std::filesystem::temp_directory_path() / "trackbed_unit_clump.csv";
  const auto write = [&](const char* text) { std::ofstream(path) << text; };
  write("# two spheres\nx_m,y_m,z_m,radius_m\n1,2,3,0.5\n1.5, 2, -3e-1, 0.25\r\n");
  const auto spheres = dem::read_spheres(path);
  ASSERT_EQ(spheres.size(), 2u);
  EXPECT_EQ(spheres[1].position.z, -0.3);
  EXPECT_EQ(spheres[1].radius, 0.25);
  const auto message = [&] { return message_of([&] { dem::read_spheres(path); }); };
  write("1,2,3,0.5\n1,2,3\n");
  EXPECT_EQ(message(), path.string() + ":2: \"1,2,3\"; must be four numbers x,y,z,radius in metres");
  write("# nothing\n");
  EXPECT_EQ(message(), path.string() + ": no sphere found; must hold lines x,y,z,radius");
  std::filesystem::remove(path);
  EXPECT_EQ(message(), path.string() + ": cannot be read; must be a file of lines x,y,z,radius");
}

}  // namespace
