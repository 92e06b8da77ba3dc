// A GPU does what the processor does. Three ways to take contacts: the sweep over several at once and one by one, both
// on the processor, and one by one on a GPU. One by one against the sweep runs everywhere (OneByOne.*): it is the same
// source as the GPU's. A GPU against one by one (Gpu.*) needs a device, and is skipped by name where there is none.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <map>
#include <numbers>
#include <random>
#include <string>

#include "dem/clump.hpp"
#include "dem/dem.hpp"
#include "dem/measure/contact_numbers.hpp"
#include "dem/measure/heap.hpp"

namespace {

using dem::Precision;
using dem::Simulation;
using dem::Vec3;

struct Way {
  dem::Backend backend;
  int lanes;
};
constexpr Way sweep{dem::Backend::omp, 0}, one_by_one{dem::Backend::omp, 1}, gpu{dem::Backend::cuda, 1};

class Gpu : public testing::Test {
  void SetUp() override {
    std::string why_not;
    if (!dem::cuda_available(&why_not)) GTEST_SKIP() << "no GPU to compare with: " << why_not;
  }
};

constexpr double step = 2e-5, radius = 0.02;  // [s], [m]

struct Case {
  std::string law = "hertz_mindlin", rolling = "type_c";
  Precision precision = Precision::full;
  bool clumps = false, periodic = false, bonds = false;
};

/// 6 x 6 x 5 grains that overlap a little, fly at each other and spin.
std::vector<dem::Grain> crowd(const Case& c) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> shift(-0.0004, 0.0004), size(0.0196, 0.0204), speed(-0.5, 0.5);
  std::vector<dem::Grain> grains;
  for (int k = 0; k < 180; ++k) {
    dem::Grain g{.position = Vec3{0.04 * (k % 6 + 0.5), 0.04 * (k / 6 % 6 + 0.5), 0.0396 * (k / 36) + 0.0198} +
                             Vec3{shift(random), shift(random), shift(random)},
                 .radius = size(random),
                 .velocity = {speed(random), speed(random), speed(random)},
                 .angular_velocity = {20 * speed(random), 20 * speed(random), 20 * speed(random)},
                 .id = 1000 - 3 * k};
    if (c.clumps && k % 2) {
      g.shape = 0;
      g.orientation = dem::kernels::normalised({0.3 + speed(random), 0.5, speed(random), 0.7});
    }
    grains.push_back(g);
  }
  return grains;
}

struct Scene {
  std::unique_ptr<Simulation> sim;
  int floor = 0;
  std::size_t nodes = 0;
};

/// The crowd on a floor of facets that moves, between planes or periodic faces.
Scene scene(const Case& c, const Way& way) {
  dem::set_threads(2);
  dem::Setup setup;
  setup.materials = {{"stone", 1e7, 0.2, 2700}, {"wall", 1e8, 0.2, 0}};
  setup.interactions.assign(4, {.friction = 0.6,
                                .restitution = 0.5,
                                .rolling_friction = 0.1,
                                .law = c.law,
                                .rolling = c.rolling,
                                .normal_stiffness = 5e4,
                                .shear_stiffness = 3e4,
                                .normal_viscosity = 5,
                                .shear_viscosity = 5,
                                .dissipative_coefficient = 1e-4,
                                .damping_mode = 1,
                                .critical_stress = 1e5,
                                .friction_exponent = -0.1,
                                .rolling_damping = 0.3});
  setup.gravity = {0, 0, -9.81};
  setup.lanes = way.lanes;
  setup.precision = c.precision;
  const double width = 0.24;
  if (c.periodic) setup.periods[0] = {0, width};
  Scene made{Simulation::create(setup, way.backend), 0, 0};
  Simulation& sim = *made.sim;
  const std::vector<dem::Sphere> pair{{{-0.4, 0, 0}, 0.6}, {{0.4, 0, 0}, 0.6}};
  if (c.clumps) sim.add_shape(dem::make_clump(pair));
  const auto grains = crowd(c);
  sim.add_grains(grains);
  std::vector<dem::Bond> bonds;
  if (c.bonds)
    for (const auto& [i, j] : dem::pairs_within(grains, 0)) bonds.push_back({i, j, {0.01, 1e9, 5e8, 3e5, 3e5}});
  sim.add_bonds(bonds);
  base::Skin mesh;
  for (int i = 0; i <= 4; ++i)
    for (int j = 0; j <= 4; ++j) mesh.nodes.push_back({-0.08 + 0.1 * i, -0.08 + 0.1 * j, 0});
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) mesh.facets.push_back({5 * i + j, 5 * i + 5 + j, 5 * i + 6 + j, 5 * i + j + 1});
  made.nodes = mesh.nodes.size();
  made.floor = sim.add_mesh(mesh, 1, false);
  for (int axis = c.periodic ? 1 : 0; axis < 2; ++axis)
    for (const bool upper : {false, true}) {
      dem::Plane wall{};
      wall.point[axis] = upper ? width : 0;
      wall.normal[axis] = upper ? -1 : 1;
      sim.add_plane(wall, 1);
    }
  for (Vec3& p : mesh.nodes) p.z = 1e-4 * p.x;
  sim.set_mesh_target(made.floor, mesh.nodes, std::vector<Vec3>(made.nodes));
  return made;
}

/// Contact forces by their grains, on the one with the lower number.
std::map<std::pair<std::int64_t, std::int64_t>, Vec3> forces(const Simulation& sim) {
  std::map<std::pair<std::int64_t, std::int64_t>, Vec3> sums;  // clumps touch at several spheres
  for (const auto& c : sim.grain_contacts())
    sums[{std::min(c.id_i, c.id_j), std::max(c.id_i, c.id_j)}] += c.id_i < c.id_j ? c.force : -c.force;
  return sums;
}

/// Largest differences, each of the largest value there is.
struct Apart {
  double place = 0, velocity = 0, spin = 0, force = 0, impulse = 0, energy = 0;
};

Apart apart(const Scene& a, const Scene& b) {
  Apart most;
  double fastest = 0, strongest = 0, hardest = 0;
  const auto x = a.sim->grains(), y = b.sim->grains();
  EXPECT_EQ(x.size(), y.size());
  for (std::size_t k = 0; k < x.size(); ++k) {
    EXPECT_EQ(x[k].id, y[k].id);
    most.place = std::max(most.place, norm(x[k].position - y[k].position) / radius);
    most.velocity = std::max(most.velocity, norm(x[k].velocity - y[k].velocity));
    most.spin = std::max(most.spin, radius * norm(x[k].angular_velocity - y[k].angular_velocity));
    fastest = std::max(fastest, norm(x[k].velocity));
  }
  const auto f = forces(*a.sim), g = forces(*b.sim);
  EXPECT_EQ(f.size(), g.size());
  EXPECT_GT(f.size(), 80u);
  for (const auto& [pair, force] : f) {
    const auto other = g.find(pair);
    most.force = std::max(most.force, other == g.end() ? HUGE_VAL : norm(force - other->second));
    strongest = std::max(strongest, norm(force));
  }
  std::vector<Vec3> i(a.nodes), j(b.nodes);
  a.sim->nodal_impulse(a.floor, i);
  b.sim->nodal_impulse(b.floor, j);
  for (std::size_t n = 0; n < i.size(); ++n) {
    most.impulse = std::max(most.impulse, norm(i[n] - j[n]));
    hardest = std::max(hardest, norm(i[n]));
  }
  EXPECT_GT(hardest, 0);
  using E = base::Energy;
  const E e = a.sim->energy(), o = b.sim->energy();
  for (double E::*term : {&E::kinetic, &E::elastic_normal, &E::elastic_shear, &E::work_gravity, &E::work_walls,
                          &E::loss_friction, &E::loss_contact_damping, &E::loss_rolling})
    most.energy = std::max(most.energy, std::fabs(e.*term - o.*term) / e.kinetic);
  most.velocity /= fastest;
  most.spin /= fastest;
  most.force /= strongest;
  most.impulse /= hardest;
  return most;
}

/// From one state, step by step: places, velocities 1e-12 after one step, more by as much with each (roundings grow
/// slowly in so short a time); forces, whose overlaps are differences of places, 1e-10. A law that differs, a history
/// that is lost or a contact that is missed changes forces by per cents.
void expect_step_by_step(const Case& c, const Way& one, const Way& other, int steps) {
  const Scene a = scene(c, one), b = scene(c, other);
  for (int k = 1; k <= steps; ++k) {
    a.sim->advance(1, step);
    b.sim->advance(1, step);
    const Apart most = apart(a, b);
    ASSERT_LT(most.place, 1e-12 * k) << "step " << k;
    ASSERT_LT(most.velocity, 1e-12 * k) << "step " << k;
    ASSERT_LT(most.spin, 1e-12 * k) << "step " << k;
    ASSERT_LT(most.force, 1e-10) << "step " << k;
    ASSERT_LT(most.impulse, 1e-10) << "step " << k;
    ASSERT_LT(most.energy, 1e-11 * k) << "step " << k;
  }
}

void every_law(const Way& one, const Way& other) {
  for (const dem::LawText& row : dem::contact_law_texts()) {
    SCOPED_TRACE(row.name);
    expect_step_by_step({.law = std::string(row.name)}, one, other, 10);
  }
}
void every_rolling_model(const Way& one, const Way& other) {
  for (const dem::LawText& row : dem::rolling_model_texts()) {
    SCOPED_TRACE(row.name);
    expect_step_by_step({.rolling = std::string(row.name)}, one, other, 10);
  }
}
void every_kind_of_scene(const Way& one, const Way& other) {
  expect_step_by_step({.clumps = true}, one, other, 10);
  expect_step_by_step({.periodic = true}, one, other, 10);
  expect_step_by_step({.bonds = true}, one, other, 10);
}

TEST(OneByOne, EveryLawStepByStep) { every_law(sweep, one_by_one); }
TEST(OneByOne, EveryRollingModelStepByStep) { every_rolling_model(sweep, one_by_one); }
TEST(OneByOne, ClumpsPeriodsAndBondsStepByStep) { every_kind_of_scene(sweep, one_by_one); }
TEST_F(Gpu, EveryLawStepByStep) { every_law(one_by_one, gpu); }
TEST_F(Gpu, EveryRollingModelStepByStep) { every_rolling_model(one_by_one, gpu); }
TEST_F(Gpu, ClumpsPeriodsAndBondsStepByStep) { every_kind_of_scene(one_by_one, gpu); }

// Mixed precision: contacts to the rounding of floats, 6e-8 in each of some ten operations.
void mixed_precision(const Way& one, const Way& other) {
  for (const dem::LawText& row : dem::contact_law_texts()) {
    SCOPED_TRACE(row.name);
    const Case c{.law = std::string(row.name), .precision = Precision::mixed};
    const Scene a = scene(c, one), b = scene(c, other);
    a.sim->advance(10, step);
    b.sim->advance(10, step);
    const Apart most = apart(a, b);
    EXPECT_LT(most.place, 1e-7);
    EXPECT_LT(most.velocity, 1e-6);
    EXPECT_LT(most.spin, 1e-6);
    EXPECT_LT(most.force, 1e-5);
    EXPECT_LT(most.impulse, 1e-5);
  }
}
TEST(OneByOne, MixedPrecision) { mixed_precision(sweep, one_by_one); }
TEST_F(Gpu, MixedPrecision) { mixed_precision(one_by_one, gpu); }

/// Twice the same run, to the last bit. (Going on from a checkpoint: DemState.GoesOnBitForBit.)
void expect_the_same_again(const Way& way) {
  for (const Case& c : {Case{}, Case{.precision = Precision::mixed}, Case{.clumps = true}, Case{.periodic = true}}) {
    const Scene once = scene(c, way), again = scene(c, way);
    once.sim->advance(300, step);
    again.sim->advance(300, step);
    EXPECT_EQ(once.sim->save(), again.sim->save());
    EXPECT_GT(once.sim->counts().rebuilds, 1);
    once.sim->advance(200, step);
    again.sim->advance(200, step);
    EXPECT_EQ(once.sim->save(), again.sim->save());
    const auto energy = once.sim->energy();
    const auto other = again.sim->energy();
    EXPECT_EQ(std::memcmp(&energy, &other, sizeof energy), 0);
  }
}
TEST(OneByOne, TheSameAgainToTheLastBit) { expect_the_same_again(one_by_one); }
TEST_F(Gpu, TheSameAgainToTheLastBit) { expect_the_same_again(gpu); }

// ---- after chaos has set in: what can be compared are means
/// A steep cone of spheres slumps on a rough floor.
struct Heap {
  double angle = 0, coordination = 0, porosity = 0;  // [rad], contacts per grain, of the core
};

Heap heap_of(const Way& way, Precision precision, unsigned seed) {
  dem::set_threads(1);
  dem::Setup setup;
  setup.materials = {{"stone", 1e7, 0.2, 2700}};
  setup.interactions = {{.friction = 0.5, .restitution = 0.3, .rolling_friction = 0.1}};
  setup.gravity = {0, 0, -9.81};
  setup.lanes = way.lanes;
  setup.precision = precision;
  setup.track_energy = false;
  const auto sim = Simulation::create(setup, way.backend);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> shift(-0.001, 0.001), size(0.017, 0.0195);
  std::vector<dem::Grain> grains;
  const double height = 0.6, foot = 0.34, spacing = 0.041;
  for (int layer = 0; (layer + 0.5) * spacing < height; ++layer) {
    const double z = (layer + 0.5) * spacing, aside = layer % 2 ? 0.5 * spacing : 0;  // no stacks, which could stand
    for (int i = -9; i <= 9; ++i)
      for (int j = -9; j <= 9; ++j) {
        const double x = i * spacing + aside, y = j * spacing + aside;
        if (std::hypot(x, y) > foot * (1 - z / height)) continue;
        grains.push_back({.position = Vec3{x + shift(random), y + shift(random), z + shift(random)},
                          .radius = size(random),
                          .id = static_cast<std::int64_t>(grains.size())});
      }
  }
  sim->add_grains(grains);
  sim->add_plane({{0, 0, 0}, {0, 0, 1}}, 0);
  sim->advance(3000, 3e-4);
  Heap heap;
  const auto spheres = sim->spheres();
  heap.angle = dem::heap_angle(spheres).angle;
  const dem::BallRegion core{{0, 0, 0.1}, 0.1};
  const auto rested = sim->grains();
  heap.coordination = dem::contact_numbers(core, rested, sim->grain_contacts(), sim->wall_contacts()).coordination;
  double solid = 0;
  for (const auto& s : spheres)
    if (norm(s.position - core.centre) < core.radius) solid += std::pow(s.radius / core.radius, 3);
  heap.porosity = 1 - solid;
  return heap;
}

/// Means of three heaps each way. What a mean of three may be off by is the scatter of single heaps, measured on the
/// processor, and at least what three cannot show: 1 degree, 0.2 contacts, 0.02.
void expect_alike(const Way& one, const Way& other, Precision precision) {
  Heap mean[2], squares;
  for (unsigned seed = 1; seed <= 3; ++seed)
    for (int k : {0, 1}) {
      const Heap heap = heap_of(k ? other : one, k ? precision : Precision::full, seed);
      mean[k].angle += heap.angle / 3;
      mean[k].coordination += heap.coordination / 3;
      mean[k].porosity += heap.porosity / 3;
      if (k) continue;
      squares.angle += heap.angle * heap.angle / 3;
      squares.coordination += heap.coordination * heap.coordination / 3;
      squares.porosity += heap.porosity * heap.porosity / 3;
    }
  const auto scatter = [](double square, double middle) { return std::sqrt(std::fmax(0, square - middle * middle)); };
  const double degree = std::numbers::pi / 180;
  EXPECT_GT(mean[0].angle, 12 * degree);
  EXPECT_LT(mean[0].angle, 45 * degree);  // it has slumped
  EXPECT_GT(mean[0].coordination, 2.5);
  EXPECT_NEAR(mean[0].angle, mean[1].angle, 2 * scatter(squares.angle, mean[0].angle) + degree);
  EXPECT_NEAR(mean[0].coordination, mean[1].coordination,
              2 * scatter(squares.coordination, mean[0].coordination) + 0.2);
  EXPECT_NEAR(mean[0].porosity, mean[1].porosity, 2 * scatter(squares.porosity, mean[0].porosity) + 0.02);
}
TEST(OneByOne, HeapsAreAlike) { expect_alike(sweep, one_by_one, Precision::mixed); }
TEST_F(Gpu, HeapsAreAlike) { expect_alike(sweep, gpu, Precision::full); }
TEST_F(Gpu, HeapsAreAlikeInMixedPrecision) { expect_alike(sweep, gpu, Precision::mixed); }

}  // namespace
