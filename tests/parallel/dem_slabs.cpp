// Grains cut into slabs are the same grains: positions, energies, forces on walls and what contacts remember agree with
// the whole, however many parts there are, where grains go from part to part and where space is a ring. The parts run
// on threads of this program; each hands its letters over in memory.
#include <gtest/gtest.h>

#include <barrier>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <string>
#include <thread>

#include "base/error.hpp"
#include "dem/clump.hpp"
#include "dem/dem.hpp"
#include "dem/slab_cuts.hpp"
#include "tests/dem_backend.hpp"

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
  bool late = false;  // the upper layers come later: then all the work is at one end
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

struct Track {
  std::unique_ptr<dem::Simulation> sim;
  int floor = -1, plate = -1;
};

/// Without grains.
Track track(const Case& c, Company* company) {
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
  Track made{dem_test::create(setup)};
  auto& sim = *made.sim;
  if (c.clumps) sim.add_shape(pair_of_spheres());
  made.floor = sim.add_plane({{0, 0, 0}, {0, 0, 1}}, 1);
  sim.set_wall_velocity(made.floor, {c.drift, 0, 0});
  if (!c.across) {
    sim.add_plane({{0, 0, 0}, {0, 1, 0}}, 1);
    sim.add_plane({{0, width, 0}, {0, -1, 0}}, 1);
  }
  if (!c.ring) {
    sim.add_plane({{0, 0, 0}, {1, 0, 0}}, 1);
    sim.add_plane({{length, 0, 0}, {-1, 0, 0}}, 1);
  }
  if (!c.body) return made;
  base::Skin mesh;
  mesh.nodes = {{-1, -1, 0.2}, {3, -1, 0.2}, {3, 1, 0.2}, {-1, 1, 0.2}};
  mesh.facets = {{0, 1, 2, 3}};
  made.plate = sim.add_mesh(mesh, 1, true);
  sim.set_wall_body(
      made.plate,
      {.centre = {0.8, 0, 0.2}, .mass = 20, .inertia = {1, 1, 1}, .moves = {false, false, true}, .damping = 1});
  sim.set_wall_load(made.plate, {0, 0, -100}, {});
  return made;
}

Outcome look(const Track& of) {
  Outcome outcome;
  outcome.grains = of.sim->grains();
  outcome.energy = of.sim->energy();
  for (const auto& contact : of.sim->grain_contacts()) {
    outcome.contacts += 1;
    outcome.force += base::norm(contact.force);
  }
  outcome.on_floor = of.sim->wall_impulse_on_grains(of.floor);
  if (of.plate >= 0) outcome.body = of.sim->wall_body(of.plate).centre;
  return outcome;
}

constexpr double dt = 5e-5;

Outcome run(const Case& c, Company* company, const std::vector<int>& windows, bool broken = false) {
  const Track made = track(c, company);
  auto grains = bed(c);
  if (broken) grains[grains.size() / 5].velocity.x = std::nan("");
  std::vector<dem::Grain> later;
  if (c.late) std::erase_if(grains, [&](const dem::Grain& g) { return g.id < 760 && (later.push_back(g), true); });
  made.sim->add_grains(grains);
  try {
    for (std::size_t k = 0; k < windows.size(); ++k) {
      if (k == 10) made.sim->add_grains(later);
      made.sim->advance(windows[k], dt);
    }
  } catch (const base::UnstableError& error) {
    Outcome failed;
    failed.error = error.what();
    return failed;
  }
  return look(made);
}

/// Runs `work` in each part, which gets its company; null for one part.
void in_parts(int parts, const Case& c, const std::function<void(int, Company*)>& work) {
  if (parts == 1) return work(0, nullptr);
  Desk desk(parts, c.ring);
  std::vector<std::thread> threads;
  for (int p = 0; p < parts; ++p)
    threads.emplace_back([&, p] {
      ThreadCompany company(desk, p);
      work(p, &company);
    });
  for (auto& thread : threads) thread.join();
}

std::vector<Outcome> run_in(int parts, const Case& c, const std::vector<int>& windows, bool broken = false) {
  std::vector<Outcome> outcomes(parts);
  in_parts(parts, c, [&](int part, Company* company) { outcomes[part] = run(c, company, windows, broken); });
  return outcomes;
}

/// Against the whole: what the parts have come to together.
void expect_whole(const Case& c, const Outcome& whole, const std::vector<Outcome>& outcomes, double rounding) {
  Outcome all;
  double moved = 0, fastest = 0, differs = 0, turns = 0;
  for (const auto& part : outcomes) {
    ASSERT_EQ(part.error, "");
    EXPECT_GT(part.grains.size(), whole.grains.size() / outcomes.size() / 3);
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
                          &E::loss_contact_damping, &E::loss_rolling, &E::loss_damping, &E::work_walls, &E::work_loads})
    EXPECT_NEAR(total(term), whole.energy.*term, 1e3 * rounding * whole.energy.kinetic + 1e-12);
}

void expect_the_same(const Case& c, const std::vector<int>& windows, double rounding = 1e-9,
                     const std::vector<int>& numbers = {2, 3, 4}) {
  const Outcome whole = run(c, nullptr, windows);
  ASSERT_EQ(whole.error, "");
  for (const int parts : numbers) {
    SCOPED_TRACE(std::to_string(parts) + " parts");
    expect_whole(c, whole, run_in(parts, c, windows), rounding);
  }
}

const std::vector<int> two_hundred_windows(200, 3);

TEST(Slabs, OfSpheres) { expect_the_same({}, two_hundred_windows); }
TEST(Slabs, OneByOneAsOnAGpu) { expect_the_same({.lanes = 1}, two_hundred_windows); }
// A pair that lies in two slabs may be taken the other way round in each: the same to the rounding of floats, 6e-8,
// which grows as any difference does while the bed falls together.
TEST(Slabs, OneByOneInMixedPrecision) {
  expect_the_same({.lanes = 1, .precision = dem::Precision::mixed}, std::vector<int>(20, 3), 1e-6);
}
TEST(Slabs, OfClumps) { expect_the_same({.clumps = true}, two_hundred_windows); }
TEST(Slabs, UnderAPlateThatMoves) { expect_the_same({.body = true}, two_hundred_windows); }
TEST(Slabs, InARing) { expect_the_same({.ring = true, .rolling = "type_c"}, two_hundred_windows); }
TEST(Slabs, PeriodicAcrossToo) { expect_the_same({.ring = true, .across = true}, two_hundred_windows); }

// All grains and the floor go along at 4 m/s: through every slab and round the ring. What contacts remember goes with
// them, or friction would start anew at every border.
TEST(Slabs, GoOnWhereGrainsMigrate) {
  expect_the_same({.ring = true, .drift = 4, .rolling = "type_c"}, {800, 800, 800}, 1e-7, {3});
}
TEST(Slabs, GoOnWhereClumpsMigrate) {
  expect_the_same({.ring = true, .clumps = true, .drift = 4}, {800, 800}, 1e-7, {3});
}
TEST(Slabs, GoOnWhereGrainsMigrateOneByOne) {
  expect_the_same({.ring = true, .drift = 4, .lanes = 1, .rolling = "type_c"}, {800, 800}, 1e-7, {2});
}

TEST(Slabs, AreCutAnewWhereWorkComesLater) {
  const Case late{.late = true};
  std::size_t most = 0, least = 1000000;
  for (const auto& part : run_in(3, late, std::vector<int>(300, 5))) {
    most = std::max(most, part.grains.size());
    least = std::min(least, part.grains.size());
  }
  EXPECT_LT(static_cast<double>(most), 1.2 * static_cast<double>(least));
}

// A clump glides under another one that lies just above the cut and falls on it: its spheres reach over the cut, past
// the middle of all that its neighbour holds.
TEST(Slabs, OfClumpsThatReachOverTheCut) {
  const auto spheres = dem::read_spheres(std::string(TRACKBED_SOURCE_FOLDER) + "/meshes/ballast/stone1.clump36.csv");
  const dem::Clump stone = dem::make_clump(spheres);
  for (const double x : {0.2, 0.21, 0.22, 0.23}) {
    const auto fall = [&](Company* company) {
      dem::set_threads(1);
      dem::Setup setup;
      setup.company = company;
      setup.materials = {{"stone", 2e7, 0.2, 2700}};
      setup.interactions = {{0.6, 0.4, 0.0}};
      const auto sim = dem_test::create(setup);
      sim->add_shape(stone);
      const double angle = -std::numbers::pi / 12;
      const std::vector<dem::Grain> grains{
          {.position = {0, 0, 0}, .radius = 0.035, .velocity = {x / 0.29, 0, 0}, .id = 0, .shape = 0},
          {.position = {x, 0, 0.4},
           .radius = 0.035,
           .velocity = {0, 0, -1.2},
           .id = 1,
           .shape = 0,
           .orientation = {std::cos(angle), 0, std::sin(angle), 0}},
          {.position = {0.6, 1, 0}, .radius = 0.02, .id = 2}};
      sim->add_grains(grains);
      for (int window = 0; window < 20; ++window) sim->advance(500, dt);  // new cuts hold from the next one on
      return sim->grains();
    };
    const auto whole = fall(nullptr);
    EXPECT_GT(std::abs(whole[0].velocity.z), 0.05) << "they miss each other";
    std::vector<dem::Grain> all;
    std::array<std::vector<dem::Grain>, 2> held;
    in_parts(2, {}, [&](int part, Company* company) { held[part] = fall(company); });
    for (const auto& part : held) all.insert(all.end(), part.begin(), part.end());
    std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
    ASSERT_EQ(all.size(), 3u);
    EXPECT_FALSE(held[0].empty() || held[1].empty());
    for (std::size_t g = 0; g < 3; ++g)
      EXPECT_LE(base::norm(all[g].velocity - whole[g].velocity), 1e-9) << x << ", grain " << g;
  }
}

TEST(Slabs, StopTogether) {
  int blamed = 0;
  for (const auto& part : run_in(3, {}, {10}, true)) {
    EXPECT_NE(part.error, "");
    blamed += part.error.find("not finite") != std::string::npos;
  }
  EXPECT_EQ(blamed, 1);
}

// ---- walls that a part knows near its grains only

constexpr double mesh_cell = 0.02;

/// A long floor in waves that runs along under the grains.
base::Skin long_floor() {
  base::Skin mesh;
  for (int k = -40; k <= 160; ++k)
    for (const double y : {-0.1, 0.5 * width, width + 0.1}) mesh.nodes.push_back({mesh_cell * k, y, 0});
  for (int k = 0; k + 3 < static_cast<int>(mesh.nodes.size()); ++k)
    if (k % 3 < 2) mesh.facets.push_back({k, k + 3, k + 4, k + 1});
  return mesh;
}
Vec3 floor_place(const Vec3& node, double time) {
  return {node.x + 0.5 * time, node.y, 0.001 * std::sin(20 * node.x + 300 * time)};
}
Vec3 floor_velocity(const Vec3& node, double time) { return {0.5, 0, 0.3 * std::cos(20 * node.x + 300 * time)}; }

/// What a part has been told of the floor: all of it, or the nodes of the cells that reach into an interval.
struct Knowledge {
  double low = -1e9, high = 1e9;
  std::vector<int> known = std::vector<int>(long_floor().nodes.size(), 1);
  int changes = 0;

  void renew(dem::Simulation& sim, int wall, const base::Skin& mesh, double time) {
    const dem::Reach reach = sim.reach();
    if (reach.low - low > 0.005 && high - reach.high > 0.005 && low > -1e8) return;
    ++changes;
    low = reach.low - 0.012;
    high = reach.high + 0.012;
    const auto before = known;
    std::vector<int> nodes, fresh;
    std::vector<Vec3> positions, velocities;
    for (int n = 0; n < static_cast<int>(known.size()); ++n) {
      const double x = floor_place(mesh.nodes[n], time).x;
      known[n] = x + mesh_cell > low && x - mesh_cell < high;
      if (!known[n]) continue;
      nodes.push_back(n);
      if (before[n]) continue;
      fresh.push_back(n);
      positions.push_back(floor_place(mesh.nodes[n], time));
      velocities.push_back(floor_velocity(mesh.nodes[n], time));
    }
    sim.know_mesh_nodes(wall, nodes, fresh, positions, velocities);
    sim.keep_within(low, high);
  }
};

/// `least`: how often the part must have been told of other nodes; 0: it knows all.
Outcome run_on_floor(const Case& c, Company* company, int least) {
  Track made;
  dem::set_threads(1);
  dem::Setup setup;
  setup.company = company;
  setup.materials = {{"stone", 1e7, 0.2, 2700}, {"wall", 1e8, 0.2, 0}};
  setup.interactions.assign(4, dem::Interaction{0.6, 0.5, 0.0});
  setup.gravity = {0, 0, -9.81};
  setup.lanes = c.lanes;
  made.sim = dem::Simulation::create(setup, dem::Backend::omp);
  auto& sim = *made.sim;
  sim.add_plane({{0, 0, 0}, {0, 1, 0}}, 1);
  sim.add_plane({{0, width, 0}, {0, -1, 0}}, 1);
  const base::Skin mesh = long_floor();
  made.floor = sim.add_mesh(mesh, 1, false);
  sim.add_grains(bed(c));
  Knowledge knowledge;
  constexpr int windows = 160, steps = 5;
  for (int w = 0; w < windows; ++w) {
    const double start = w * steps * dt, end = (w + 1) * steps * dt;
    if (least > 0 && w > 0) knowledge.renew(sim, made.floor, mesh, start);
    std::vector<Vec3> positions, velocities;
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
      const Vec3 nowhere{NAN, NAN, NAN};
      positions.push_back(knowledge.known[n] ? floor_place(mesh.nodes[n], end) : nowhere);
      velocities.push_back(knowledge.known[n] ? floor_velocity(mesh.nodes[n], end) : nowhere);
    }
    sim.set_mesh_target(made.floor, positions, velocities, dem::MeshWay::line);
    try {
      sim.advance(steps, dt);
    } catch (const base::UnstableError& error) {
      Outcome failed;
      failed.error = error.what();
      return failed;
    }
  }
  EXPECT_GE(knowledge.changes, least);
  return look(made);
}

TEST(Slabs, KnowTheWallsNearThemOnly) {
  for (const int lanes : {0, 1}) {
    const Case c{.drift = 3, .lanes = lanes};
    const Outcome whole = run_on_floor(c, nullptr, 0);
    ASSERT_EQ(whole.error, "");
    EXPECT_GT(std::abs(whole.energy.work_interface), 1);  // [J]
    for (const int parts : {1, 2, 3}) {
      SCOPED_TRACE(std::to_string(parts) + " parts");
      std::vector<Outcome> outcomes(parts);
      // Parts at the ends follow their grains; all parts, where they are cut anew.
      in_parts(parts, c, [&](int part, Company* company) { outcomes[part] = run_on_floor(c, company, 2); });
      expect_whole(c, whole, outcomes, 1e-8);
    }
  }
}

TEST(Slabs, StopWhereGrainsComeBeyondTheWallsThatAreKnown) {
  for (const int parts : {1, 3}) {
    std::vector<std::string> errors(parts);
    const Case c{.drift = 3};
    in_parts(parts, c, [&](int part, Company* company) {
      const Track made = track(c, company);
      made.sim->add_grains(bed(c));
      made.sim->advance(1, dt);
      // The last part's grains have 5 mm left, which they go in 2 ms.
      const dem::Reach reach = made.sim->reach();
      made.sim->keep_within(-1, part == parts - 1 ? reach.high + 0.005 : 10);
      try {
        made.sim->advance(1000, dt);
      } catch (const base::UnstableError& error) {
        errors[part] = error.what();
      }
    });
    for (int part = 0; part < parts; ++part)
      EXPECT_NE(errors[part].find(part == parts - 1 ? "beyond the walls known here" : "stopped with another part"),
                std::string::npos)
          << errors[part];
  }
}

TEST(Slabs, TooThinAreRefused) {
  std::vector<std::string> errors(30);
  in_parts(30, {}, [&](int part, Company* company) {
    try {
      run({}, company, {1});
    } catch (const base::UserError& error) {
      errors[part] = error.what();
    }
  });
  for (const auto& error : errors) EXPECT_NE(error.find("use fewer ranks for grains"), std::string::npos) << error;
}

// Saved by so many parts, restored by as many: the same bits. By another number, and by the whole: the same to
// rounding, at once and later.
void expect_restart(const Case& c, double rounding = 1e-8) {
  constexpr int before = 600, after = 300;
  const Outcome whole = run(c, nullptr, {before, after}), there = run(c, nullptr, {before});
  for (const int parts : {1, 3}) {
    std::vector<base::Columns> saved(parts);
    std::vector<Outcome> straight(parts);
    in_parts(parts, c, [&](int part, Company* company) {
      const Track made = track(c, company);
      made.sim->add_grains(bed(c));
      made.sim->advance(before, dt);
      saved[part] = made.sim->save();
      made.sim->advance(after, dt);
      straight[part] = look(made);
    });
    for (const int others : {1, 2, 3}) {
      SCOPED_TRACE(std::to_string(parts) + " parts, then " + std::to_string(others));
      std::vector<Outcome> at_once(others), later(others);
      in_parts(others, c, [&](int part, Company* company) {
        const Track made = track(c, company);
        if (others == parts)
          made.sim->restore(saved[part]);
        else
          made.sim->restore_parts(saved);
        at_once[part] = look(made);
        at_once[part].on_floor = {};  // of an advance() that others have made
        made.sim->advance(after, dt);
        later[part] = look(made);
      });
      Outcome then = there;
      then.on_floor = {};
      expect_whole(c, then, at_once, rounding);
      expect_whole(c, whole, later, 10 * rounding);
      if (others != parts) continue;
      for (int part = 0; part < parts; ++part) {
        ASSERT_EQ(later[part].grains.size(), straight[part].grains.size());
        for (std::size_t g = 0; g < later[part].grains.size(); ++g) {
          const dem::Grain &a = later[part].grains[g], &b = straight[part].grains[g];
          EXPECT_EQ(a.id, b.id);
          EXPECT_EQ(base::norm(a.position - b.position) + base::norm(a.velocity - b.velocity), 0);
        }
      }
    }
  }
}
TEST(Slabs, GoOnFromACheckpoint) { expect_restart({.ring = true, .drift = 4, .rolling = "type_c"}); }
TEST(Slabs, OfClumpsGoOnFromACheckpoint) { expect_restart({.clumps = true, .body = true}); }
TEST(Slabs, GoOnFromACheckpointOneByOne) { expect_restart({.drift = 1, .lanes = 1}); }
TEST(Slabs, GoOnFromACheckpointInMixedPrecision) {
  expect_restart({.drift = 1, .lanes = 1, .precision = dem::Precision::mixed}, 1e-4);
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
