// Grains cut into slabs are the same grains: positions, energies, forces on walls and what contacts remember agree with
// the whole, however many parts there are, where grains go from part to part and where space is a ring. The parts run
// on threads of this program; each hands its letters over in memory.
#include <gtest/gtest.h>

#include <barrier>
#include <cmath>
#include <mutex>
#include <random>
#include <string>
#include <thread>

#include "base/error.hpp"
#include "dem/clump.hpp"
#include "dem/dem.hpp"
#include "dem/slab_cuts.hpp"

namespace {

using dem::Company;
using dem::Vec3;

/// What the parts share.
struct Desk {
  explicit Desk(int parts_, bool ring_) : parts(parts_), ring(ring_), meet(parts_), numbers(parts_), letters(parts_) {}
  int parts;
  bool ring;
  std::barrier<> meet;
  std::vector<std::vector<double>> numbers;
  std::vector<std::array<Company::Letter, 2>> letters;
};

class ThreadCompany final : public Company {
 public:
  ThreadCompany(Desk& desk, int part) : desk_(desk), part_(part) {}
  int part() const override { return part_; }
  int parts() const override { return desk_.parts; }
  bool ring() const override { return desk_.ring; }
  void largest(std::span<double> values) override {
    join(values, [](double a, double b) { return std::max(a, b); });
  }
  void sum(std::span<double> values) override {
    join(values, [](double a, double b) { return a + b; });
  }
  void swap(const std::array<Letter, 2>& out, std::array<Letter, 2>& in) override {
    desk_.letters[part_] = out;
    desk_.meet.arrive_and_wait();
    const int n = desk_.parts;
    in = {};
    if (has(below)) in[below] = desk_.letters[(part_ + n - 1) % n][above];
    if (has(above)) in[above] = desk_.letters[(part_ + 1) % n][below];
    desk_.meet.arrive_and_wait();
  }
  void swap_known(const std::array<Letter, 2>& out, std::array<Letter, 2>& in) override {
    const std::array<std::size_t, 2> sizes{in[0].size(), in[1].size()};
    swap(out, in);
    for (int side : {0, 1})
      if (in[side].size() != sizes[side]) std::terminate();
  }

 private:
  template <class Operation>
  void join(std::span<double> values, Operation operation) {
    desk_.numbers[part_].assign(values.begin(), values.end());
    desk_.meet.arrive_and_wait();
    for (std::size_t k = 0; k < values.size(); ++k) {
      double all = desk_.numbers[0][k];
      for (int p = 1; p < desk_.parts; ++p) all = operation(all, desk_.numbers[p][k]);
      values[k] = all;
    }
    desk_.meet.arrive_and_wait();
  }
  Desk& desk_;
  int part_;
};

struct Case {
  bool ring = false, clumps = false, body = false;
  double drift = 0;  // [m/s] of everything along x
  int lanes = 0;
  std::string rolling = "brof";
  bool across = false;  // periodic across too
  dem::Precision precision = dem::Precision::full;
};

constexpr double length = 1.6, width = 0.24;

std::vector<dem::Grain> bed(const Case& c) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> shift(-0.002, 0.002), radius(0.017, 0.021);
  std::vector<dem::Grain> grains;
  for (int k = 0; k < 40 * 6 * 4; ++k) {
    const Vec3 p{0.04 * (k % 40 + 0.5) + shift(random), 0.04 * (k / 40 % 6 + 0.5) + shift(random),
                 0.04 * (k / 240 + 0.5) + shift(random)};
    // More work at one end: the upper layers are there only.
    if (k / 240 > 1 && p.x > 0.6 * length) continue;
    dem::Grain g{.position = p,
                 .radius = radius(random),
                 .velocity = {c.drift + 0.1 * (k % 3 - 1), 0.05 * (k % 5 - 2), -0.3},
                 .angular_velocity = {3.0 * (k % 3 - 1), 5, 2},
                 .id = 1000 - k};
    if (c.clumps && k % 2) {
      g.shape = 0;
      g.orientation = dem::kernels::normalised({0.3 + 0.1 * (k % 4), 0.5, 0.2 * (k % 3), 0.7});
    }
    grains.push_back(g);
  }
  return grains;
}

dem::Clump pair_of_spheres() {
  const std::vector<dem::Sphere> spheres{{{-0.4, 0, 0}, 0.6}, {{0.4, 0, 0}, 0.6}};
  return dem::make_clump(spheres);
}

/// What one part, or the whole, has come to.
struct Outcome {
  std::vector<dem::Grain> grains;
  base::Energy energy;
  double contacts = 0, force = 0;  // number, sum of |force| [N]
  Vec3 body, on_floor;
  std::string error;
};

Outcome run(const Case& c, Company* company, const std::vector<int>& windows, bool broken = false) {
  dem::set_threads(1);
  dem::Setup setup;
  setup.company = company;
  setup.materials = {{"stone", 1e7, 0.2, 2700}, {"wall", 1e8, 0.2, 0}};
  dem::Interaction pair{0.6, 0.5, 0.1};
  pair.rolling = c.rolling;
  pair.rolling_damping = 0.3;
  setup.interactions.assign(4, pair);
  setup.gravity = {0, 0, -9.81};
  setup.lanes = c.lanes;
  setup.precision = c.precision;
  if (c.ring) setup.periods[0] = {0, length};
  if (c.across) setup.periods[1] = {0, width};
  const auto sim = dem::Simulation::create(setup, dem::Backend::omp);
  if (c.clumps) sim->add_shape(pair_of_spheres());
  auto grains = bed(c);
  if (broken) grains[grains.size() / 5].velocity.x = std::nan("");
  sim->add_grains(grains);
  const int floor = sim->add_plane({{0, 0, 0}, {0, 0, 1}}, 1);
  sim->set_wall_velocity(floor, {c.drift, 0, 0});
  if (!c.across) {
    sim->add_plane({{0, 0, 0}, {0, 1, 0}}, 1);
    sim->add_plane({{0, width, 0}, {0, -1, 0}}, 1);
  }
  if (!c.ring) {
    sim->add_plane({{0, 0, 0}, {1, 0, 0}}, 1);
    sim->add_plane({{length, 0, 0}, {-1, 0, 0}}, 1);
  }
  int plate = -1;
  if (c.body) {
    base::Skin mesh;
    mesh.nodes = {{-1, -1, 0.2}, {3, -1, 0.2}, {3, 1, 0.2}, {-1, 1, 0.2}};
    mesh.facets = {{0, 1, 2, 3}};
    plate = sim->add_mesh(mesh, 1, true);
    sim->set_wall_body(plate, {.centre = {0.8, 0, 0.2}, .mass = 20, .inertia = {1, 1, 1}, .moves = {false, false, true},
                               .damping = 1});
    sim->set_wall_load(plate, {0, 0, -100}, {});
  }
  Outcome outcome;
  try {
    for (const int steps : windows) sim->advance(steps, 5e-5);
  } catch (const base::UnstableError& error) {
    outcome.error = error.what();
    return outcome;
  }
  outcome.grains = sim->grains();
  outcome.energy = sim->energy();
  for (const auto& contact : sim->grain_contacts()) {
    outcome.contacts += 1;
    outcome.force += base::norm(contact.force);
  }
  outcome.on_floor = sim->wall_impulse_on_grains(floor);
  if (plate >= 0) outcome.body = sim->wall_body(plate).centre;
  return outcome;
}

std::vector<Outcome> run_in(int parts, const Case& c, const std::vector<int>& windows, bool broken = false) {
  Desk desk(parts, c.ring);
  std::vector<Outcome> outcomes(parts);
  std::vector<std::thread> threads;
  for (int p = 0; p < parts; ++p)
    threads.emplace_back([&, p] {
      ThreadCompany company(desk, p);
      outcomes[p] = run(c, &company, windows, broken);
    });
  for (auto& thread : threads) thread.join();
  return outcomes;
}

void expect_the_same(const Case& c, const std::vector<int>& windows, double rounding = 1e-9) {
  const Outcome whole = run(c, nullptr, windows);
  ASSERT_EQ(whole.error, "");
  for (const int parts : {2, 3, 4}) {
    SCOPED_TRACE(std::to_string(parts) + " parts");
    Outcome all;
    double moved = 0, fastest = 0, differs = 0, turns = 0;
    const auto outcomes = run_in(parts, c, windows);
    for (const auto& part : outcomes) {
      ASSERT_EQ(part.error, "");
      EXPECT_GT(part.grains.size(), whole.grains.size() / parts / 3);
      all.grains.insert(all.grains.end(), part.grains.begin(), part.grains.end());
      all.contacts += part.contacts;
      all.force += part.force;
      all.on_floor += part.on_floor;
      EXPECT_LE(base::norm(part.body - whole.body), rounding * 0.02);
    }
    std::sort(all.grains.begin(), all.grains.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
    ASSERT_EQ(all.grains.size(), whole.grains.size());
    for (std::size_t g = 0; g < all.grains.size(); ++g) {
      const dem::Grain &a = all.grains[g], &b = whole.grains[g];
      ASSERT_EQ(a.id, b.id);
      EXPECT_EQ(a.radius, b.radius);
      Vec3 apart = a.position - b.position;
      if (c.ring) apart.x -= length * std::round(apart.x / length);
      moved = std::max(moved, base::norm(apart));
      fastest = std::max(fastest, base::norm(b.velocity));
      differs = std::max(differs, base::norm(a.velocity - b.velocity));
      turns = std::max(turns, base::norm(a.angular_velocity - b.angular_velocity));
    }
    EXPECT_LE(moved, rounding * 0.02);
    EXPECT_LE(differs, rounding * fastest);
    EXPECT_LE(turns, rounding * fastest / 0.02);
    EXPECT_EQ(all.contacts, whole.contacts);
    EXPECT_NEAR(all.force, whole.force, 1e3 * rounding * whole.force);
    EXPECT_LE(base::norm(all.on_floor - whole.on_floor), 1e3 * rounding * base::norm(whole.on_floor));
    const auto total = [&](double base::Energy::*term) {
      double sum = 0;
      for (const auto& part : outcomes) sum += part.energy.*term;
      return sum;
    };
    using E = base::Energy;
    for (double E::*term : {&E::kinetic, &E::elastic_normal, &E::elastic_shear, &E::work_gravity, &E::loss_friction,
                            &E::loss_contact_damping, &E::loss_rolling, &E::loss_damping, &E::work_walls,
                            &E::work_loads})
      EXPECT_NEAR(total(term), whole.energy.*term, 1e3 * rounding * whole.energy.kinetic + 1e-12);
  }
}

const std::vector<int> two_hundred_windows(200, 5);

TEST(Slabs, OfSpheres) { expect_the_same({}, two_hundred_windows); }
TEST(Slabs, OneByOneAsOnAGpu) { expect_the_same({.lanes = 1}, two_hundred_windows); }
TEST(Slabs, OfClumps) { expect_the_same({.clumps = true}, two_hundred_windows); }
TEST(Slabs, UnderAPlateThatMoves) { expect_the_same({.body = true}, two_hundred_windows); }
TEST(Slabs, InARing) { expect_the_same({.ring = true, .rolling = "type_c"}, two_hundred_windows); }
TEST(Slabs, PeriodicAcrossToo) { expect_the_same({.ring = true, .across = true}, two_hundred_windows); }

// All grains and the floor go along at 4 m/s: through every slab and round the ring. What contacts remember goes with
// them, or friction would start anew at every border.
TEST(Slabs, GoOnWhereGrainsMigrate) {
  expect_the_same({.ring = true, .drift = 4, .rolling = "type_c"}, {400, 400, 400, 400, 400, 400, 400, 400, 400}, 1e-7);
}
TEST(Slabs, GoOnWhereClumpsMigrate) {
  expect_the_same({.ring = true, .clumps = true, .drift = 4}, {600, 600, 600, 600}, 1e-7);
}
TEST(Slabs, GoOnWhereGrainsMigrateOneByOne) {
  expect_the_same({.ring = true, .drift = 4, .lanes = 1, .rolling = "type_c"}, {600, 600, 600, 600}, 1e-7);
}

TEST(Slabs, StopTogether) {
  int blamed = 0;
  for (const auto& part : run_in(3, {}, {10}, true)) {
    EXPECT_NE(part.error, "");
    blamed += part.error.find("not finite") != std::string::npos;
  }
  EXPECT_EQ(blamed, 1);
}

TEST(Slabs, TooThinAreRefused) {
  Desk desk(30, false);
  std::vector<std::string> errors(30);
  std::vector<std::thread> threads;
  for (int p = 0; p < 30; ++p)
    threads.emplace_back([&, p] {
      ThreadCompany company(desk, p);
      try {
        run({}, &company, {1});
      } catch (const base::UserError& error) {
        errors[p] = error.what();
      }
    });
  for (auto& thread : threads) thread.join();
  for (const auto& error : errors) EXPECT_NE(error.find("use fewer ranks for grains"), std::string::npos) << error;
}

TEST(SlabCuts, ShareTheWork) {
  dem::SlabWork work{.low = 0, .high = 10, .bins = std::vector<double>(100)};
  for (int k = 0; k < 1000; ++k) work.add(0.01 * (k + 0.5), k < 500 ? 3 : 1);
  const auto cuts = dem::slab_cuts(work, 4, 0.1);
  ASSERT_EQ(cuts.size(), 3u);
  // 2000 in all: 500 to 1.667 m, 1000 to 3.333 m, 1500 at 5 m.
  EXPECT_NEAR(cuts[0], 5.0 / 3, 1e-9);
  EXPECT_NEAR(cuts[1], 10.0 / 3, 1e-9);
  EXPECT_NEAR(cuts[2], 5, 1e-9);
  const auto wide = dem::slab_cuts(work, 4, 2.2);
  ASSERT_EQ(wide.size(), 3u);
  EXPECT_GE(wide[0], 2.2 - 1e-12);
  EXPECT_GE(wide[1] - wide[0], 2.2 - 1e-12);
  EXPECT_GE(wide[2] - wide[1], 2.2 - 1e-12);
  EXPECT_LE(wide[2], 10 - 2.2 + 1e-12);
  EXPECT_TRUE(dem::slab_cuts(work, 4, 2.6).empty());
}

}  // namespace
