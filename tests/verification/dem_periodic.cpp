// Periodic directions (dem/core/periodic.hpp): what happens across a face is what happens anywhere else.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "base/error.hpp"
#include "dem/clump.hpp"
#include "dem/dem.hpp"
#include "dem/measure/stress.hpp"
#include "tests/dem_backend.hpp"

using base::Vec3;
using dem::Grain;

namespace {

constexpr double density = 2500;          // [kg/m3]
constexpr double low = -0.3, side = 0.5;  // [m] the domain: low ... low + side

struct Choice {
  int lanes = 0, threads = 1;
  std::array<bool, 3> periodic{true, true, true};
  dem::Precision precision = dem::Precision::full;
  double restitution = 0.8;
  std::string rolling = "type_c";
  Vec3 gravity{};
};
std::unique_ptr<dem::Simulation> simulation(const Choice& choice = {}) {
  dem::set_threads(choice.threads);
  dem::Setup setup;
  setup.materials = {{"stone", 1e7, 0.25, density}};
  dem::Interaction between{0.5, choice.restitution, 0.1};
  between.rolling = choice.rolling;
  setup.interactions = {between};
  setup.lanes = choice.lanes;
  setup.precision = choice.precision;
  setup.gravity = choice.gravity;
  for (int axis = 0; axis < 3; ++axis)
    if (choice.periodic[axis]) setup.periods[axis] = {low, side};
  return dem_test::create(setup);
}

/// The nearest image of a difference of places.
Vec3 shortest(Vec3 d) {
  for (int axis = 0; axis < 3; ++axis) d[axis] -= side * std::round(d[axis] / side);
  return d;
}
Vec3 within(Vec3 p) {
  for (int axis = 0; axis < 3; ++axis) p[axis] -= side * std::floor((p[axis] - low) / side);
  return p;
}
double mass_of(double radius) { return 4.0 / 3.0 * std::numbers::pi * radius * radius * radius * density; }

/// A cloud of fast grains, a quarter of the space filled, and no two nearer than they are wide.
std::vector<Grain> cloud(int count, int shape = -1) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<Grain> grains;
  while (static_cast<int>(grains.size()) < count) {
    Grain g{.radius = 0.03 + 0.01 * unit(random), .id = static_cast<int>(grains.size()), .shape = shape};
    for (int axis = 0; axis < 3; ++axis) {
      g.position[axis] = low + side * unit(random);
      g.velocity[axis] = 4 * unit(random) - 2;
      g.angular_velocity[axis] = 20 * unit(random) - 10;
    }
    if (std::all_of(grains.begin(), grains.end(), [&](const Grain& other) {
          return norm(shortest(g.position - other.position)) > g.radius + other.radius;
        }))
      grains.push_back(g);
  }
  return grains;
}

Vec3 momentum(const std::vector<Grain>& grains) {
  Vec3 sum;
  for (const Grain& g : grains) sum += mass_of(g.radius) * g.velocity;
  return sum;
}

dem::Clump dumbbell() {
  const dem::Sphere two[] = {{{-0.4, 0, 0}, 0.6}, {{0.4, 0, 0}, 0.6}};
  return dem::make_clump(two);
}

}  // namespace

// Space has no place of its own: the same cloud shifted by any vector has the same life. 400 steps of collisions, at
// the first of which different lists differ only by rounding.
TEST(Periodic, AnywhereTheSame) {
  for (const Choice& choice : {Choice{.lanes = 1}, Choice{.lanes = 2}, Choice{}, Choice{.threads = 2}}) {
    const auto first = simulation(), second = simulation(choice);
    auto grains = cloud(120);
    first->add_grains(grains);
    const Vec3 shift{0.217, -0.431, 0.108};
    for (Grain& g : grains) g.position = within(g.position + shift);
    second->add_grains(grains);
    first->advance(400, 2e-5);
    second->advance(400, 2e-5);
    EXPECT_GT(first->counts().contacts, 10);
    EXPECT_EQ(first->counts().contacts, second->counts().contacts);
    const auto a = first->grains(), b = second->grains();
    for (std::size_t g = 0; g < a.size(); ++g) {
      EXPECT_LT(norm(shortest(b[g].position - a[g].position - shift)), 1e-12) << g << " lanes " << choice.lanes;
      EXPECT_LT(norm(b[g].velocity - a[g].velocity), 1e-9) << g;
      EXPECT_LT(norm(b[g].angular_velocity - a[g].angular_velocity), 1e-7) << g;
    }
  }
}

// Nothing pushes from outside: momentum stays to rounding, energy and what has become of it adds up, and every grain is
// between the faces again.
TEST(Periodic, CloudKeepsMomentumAndEnergy) {
  for (const Choice& choice : {Choice{.lanes = 1}, Choice{.threads = 2}, Choice{.precision = dem::Precision::mixed}}) {
    const auto sim = simulation(choice);
    const auto grains = cloud(120);
    sim->add_grains(grains);
    sim->advance(0, 1e-5);
    const double before = sim->energy().kinetic;
    sim->advance(6000, 1e-5);
    const base::Energy e = sim->energy();
    const double sum =
        e.kinetic + e.elastic_normal + e.elastic_shear + e.loss_friction + e.loss_contact_damping + e.loss_rolling;
    EXPECT_LT(e.kinetic, 0.8 * before) << "the grains have not met";
    EXPECT_NEAR(sum, before, (choice.precision == dem::Precision::mixed ? 2e-3 : 1e-3) * before);
    const auto now = sim->grains();
    EXPECT_LT(norm(momentum(now) - momentum(grains)), 1e-12 * 120 * mass_of(0.035) * 2);
    double jumped = 0;
    for (std::size_t g = 0; g < now.size(); ++g) {
      jumped = std::max(jumped, norm(now[g].position - grains[g].position));
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_GT(now[g].position[axis], low - 0.01);
        EXPECT_LT(now[g].position[axis], low + side + 0.01);
      }
    }
    EXPECT_GT(jumped, 0.9 * side) << "no grain has come in at the other face";
  }
}

// A clump that lies across a face collides as one inside does.
TEST(Periodic, Clumps) {
  const Choice along_x{.periodic = {true, false, false}, .restitution = 1, .rolling = "none"};
  std::vector<std::vector<Grain>> ends;
  for (const double x : {-0.05, low + side}) {
    const auto sim = simulation(along_x);
    const int shape = sim->add_shape(dumbbell());
    const Grain clumps[] = {
        {.position = {x - 0.09, 0.013, 0}, .radius = 0.05, .velocity = {2, 0, 0}, .id = 0, .shape = shape},
        {.position = {x + 0.03, 0, 0.01}, .radius = 0.05, .velocity = {-1, 0, 0.3}, .id = 1, .shape = shape}};
    sim->add_grains(clumps);
    sim->advance(3000, 1e-5);
    ends.push_back(sim->grains());
  }
  for (int g = 0; g < 2; ++g) {
    EXPECT_LT(norm(ends[0][g].velocity - ends[1][g].velocity), 1e-10);
    EXPECT_LT(norm(ends[0][g].angular_velocity - ends[1][g].angular_velocity), 1e-8);
    EXPECT_GT(norm(ends[0][g].angular_velocity), 1) << "they have not met";
    EXPECT_LT(norm(shortest(ends[1][g].position - ends[0][g].position - Vec3{low + side + 0.05, 0, 0})), 1e-12);
  }
}

// A bond across a face stretches and bends as one inside does.
TEST(Periodic, Bonds) {
  std::vector<double> forces;
  for (const double x : {0.0, low + side}) {
    const auto sim = simulation();
    const Grain grains[] = {{.position = {x - 0.0205, 0, 0}, .radius = 0.02, .id = 1},
                            {.position = {x + 0.0205, 0, 0}, .radius = 0.02, .velocity = {0.1, 0.05, 0}, .id = 2}};
    sim->add_grains(grains);
    const dem::Bond bond{1, 2, {0.01, 2e8, 1e8, 1e12, 1e12}};
    sim->add_bonds({&bond, 1});
    sim->advance(200, 1e-5);
    forces.push_back(norm(sim->bonds().at(0).force));
    EXPECT_EQ(sim->broken_bonds(), 0);
  }
  EXPECT_GT(forces[0], 1);
  EXPECT_NEAR(forces[1], forces[0], 1e-9 * forces[0]);
}

// A cubic array without end, each grain pressed by its neighbours along x with F = 4/3 E* sqrt(R*) d^(3/2): the stress
// is -F over the area that a column has. Branches across the faces count once.
TEST(Periodic, StressOfAnEndlessArray) {
  for (const int lanes : {0, 1}) {
    const auto sim = simulation({.lanes = lanes});
    constexpr int count = 8;
    const double pitch = side / count, overlap = 1e-4, radius = 0.5 * (pitch + overlap);
    std::vector<Grain> grains;
    for (int x = 0; x < count; ++x)
      for (int y = 0; y < count; ++y)
        for (int z = 0; z < count; ++z)
          grains.push_back({.position = Vec3{low, low, low} + pitch * Vec3{x + 0.25, y + 0.5, z + 0.99},
                            .radius = radius,
                            .id = static_cast<int>(grains.size())});
    sim->add_grains(grains);
    sim->advance(0, 1e-6);
    const double modulus = 1e7 / (2 * (1 - 0.25 * 0.25));
    const double force = 4.0 / 3.0 * modulus * std::sqrt(0.5 * radius) * std::pow(overlap, 1.5);
    EXPECT_EQ(sim->counts().contacts, 3 * count * count * count);
    const dem::BoxRegion all{{low, low, low}, {low + side, low + side, low + side}};
    const auto stress = dem::region_stress(all, sim->grains(), sim->grain_contacts(), sim->wall_contacts());
    for (const double s : {stress.xx, stress.yy, stress.zz})
      EXPECT_NEAR(s, -force / (pitch * pitch), 1e-9 * force / (pitch * pitch)) << "lanes " << lanes;
    for (const double s : {stress.xy, stress.yz, stress.zx}) EXPECT_NEAR(s, 0, 1e-9 * force / (pitch * pitch));
    for (const Grain& g : sim->grains()) EXPECT_LT(norm(g.velocity), 1e-12);
  }
}

// A grain rolls down a plane through face after face: gravity has done the work of the whole way.
TEST(Periodic, WorkOfGravityAlongTheWay) {
  const double slope = 0.2;
  const auto sim = simulation({.periodic = {true, false, false},
                               .restitution = 0.5,
                               .rolling = "none",
                               .gravity = {9.81 * std::sin(slope), 0, -9.81 * std::cos(slope)}});
  const double radius = 0.03, modulus = 1e7 / (2 * (1 - 0.25 * 0.25));  // plane and grain are alike
  const double press = mass_of(radius) * 9.81 * std::cos(slope);
  const double overlap = std::pow(press / (4.0 / 3.0 * modulus * std::sqrt(radius)), 2.0 / 3.0), arm = radius - overlap;
  sim->add_plane({{0, 0, 0}, {0, 0, 1}}, 0);
  const Grain ball{.position = {0, 0, arm}, .radius = radius, .id = 0};
  sim->add_grains({&ball, 1});
  sim->advance(40000, 5e-5);
  const base::Energy e = sim->energy();
  const double acceleration = 9.81 * std::sin(slope) / (1 + 0.4 * radius * radius / (arm * arm));  // rolling sphere
  const double way = 0.5 * acceleration * 4;                                                       // in 2 s
  EXPECT_GT(way, 4 * side);
  EXPECT_NEAR(e.work_gravity, mass_of(radius) * 9.81 * std::sin(slope) * way, 3e-4 * e.work_gravity);
  EXPECT_NEAR(e.kinetic, e.work_gravity, 3e-4 * e.work_gravity);
  EXPECT_NEAR(sim->grains().at(0).velocity.x, 2 * acceleration, 3e-4 * acceleration);
}

TEST(Periodic, TooShort) {
  dem::Setup setup;
  setup.materials = {{"stone", 1e7, 0.25, density}};
  setup.interactions = {{0.5, 0.8, 0}};
  setup.periods[1] = {0, 0.11};
  const auto sim = dem_test::create(setup);
  const Grain grain{.position = {0, 0.05, 0}, .radius = 0.03, .id = 0};
  sim->add_grains({&grain, 1});
  try {
    sim->advance(1, 1e-6);
    FAIL() << "it ran";
  } catch (const base::UserError& error) {
    EXPECT_NE(std::string(error.what()).find("period of 0.11 m along y is too short"), std::string::npos)
        << error.what();
  }
}
