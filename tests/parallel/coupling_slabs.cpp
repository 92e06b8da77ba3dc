// Several DEM ranks without grains: what travels between the parts, and what the first rank makes of it. The parts are
// recorders: each notes what it is asked, and answers by its number. A call whose arguments lose a member, come in
// another order or reach one part only shows as another record; a lost failure hangs or passes.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <mpi.h>

#include <cmath>
#include <limits>
#include <new>

#include "base/error.hpp"
#include "coupling/agree.hpp"
#include "coupling/slab_company.hpp"
#include "coupling/slab_mail.hpp"
#include "coupling/slab_server.hpp"
#include "coupling/slab_simulation.hpp"

namespace {

using coupling::SlabCompany;
using coupling::SlabMail;
using dem::Vec3;

int rank() {
  int number = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &number);
  return number;
}
int ranks() {
  int number = 1;
  MPI_Comm_size(MPI_COMM_WORLD, &number);
  return number;
}

// ---- the company

TEST(SlabCompany, LargestAndSumAreTheSameOnAllParts) {
  SlabMail mail(MPI_COMM_WORLD);
  SlabCompany company(mail, false);
  constexpr double infinity = std::numeric_limits<double>::infinity();
  std::vector<double> values{1.0 * rank(), -1.0 - rank(), rank() == 0 ? infinity : 2.0, -infinity};
  company.largest(values);
  EXPECT_EQ(values, (std::vector<double>{ranks() - 1.0, -1, infinity, -infinity}));
  std::vector<double> sums{0.1 * (rank() + 1), 1e17 * (rank() % 2), 1};
  company.sum(sums);
  EXPECT_NEAR(sums[0], 0.05 * ranks() * (ranks() + 1), 1e-15);
  EXPECT_EQ(sums[2], ranks());
  std::vector<double> others = sums;
  MPI_Bcast(others.data(), static_cast<int>(others.size()), MPI_DOUBLE, 0, MPI_COMM_WORLD);
  EXPECT_EQ(sums, others);
}

/// A letter that says who sent it where; its length too depends on that.
SlabCompany::Letter letter(int from, int side, std::size_t base_size) {
  return SlabCompany::Letter(base_size + 10 * static_cast<std::size_t>(from) + static_cast<std::size_t>(side),
                             static_cast<std::byte>(16 * from + side));
}

void swap_letters(bool ring, std::size_t size, bool known) {
  SlabMail mail(MPI_COMM_WORLD);
  SlabCompany company(mail, ring);
  std::array<SlabCompany::Letter, 2> out, in, expected;
  for (const auto side : {SlabCompany::below, SlabCompany::above}) {
    if (!company.has(side)) continue;
    out[side] = letter(rank(), side, size);
    const int neighbour = (rank() + (side == SlabCompany::above ? 1 : ranks() - 1)) % ranks();
    expected[side] = letter(neighbour, 1 - side, size);
    in[side].resize(known ? expected[side].size() : 3);
  }
  if (known)
    company.swap_known(out, in);
  else
    company.swap(out, in);
  EXPECT_EQ(in, expected) << "ring " << ring << ", size " << size;
}

TEST(SlabCompany, LettersReachTheNeighbours) {
  for (const bool ring : {false, true})
    for (const std::size_t size : {0u, 100u, 2000000u})
      for (const bool known : {false, true}) swap_letters(ring, size, known);
}

TEST(SlabCompany, EndsHaveNoNeighbourWithoutARing) {
  SlabMail mail(MPI_COMM_WORLD);
  const SlabCompany line(mail, false), ring(mail, true);
  EXPECT_EQ(line.has(SlabCompany::below), rank() > 0);
  EXPECT_EQ(line.has(SlabCompany::above), rank() + 1 < ranks());
  EXPECT_EQ(ring.has(SlabCompany::below), ranks() > 1);
}

// One part gives up before any of these, with large letters of its neighbours on their way; all others are released,
// whatever they wait for, and afterwards the same company works as if nothing had been.
TEST(SlabCompany, NobodyWaitsForAPartThatHasGivenUp) {
  SlabMail mail(MPI_COMM_WORLD);
  for (int lost = 0; lost < ranks(); ++lost)
    for (int before = 0; before < 5; ++before) {
      SlabCompany company(mail, true);
      std::vector<double> values{1.0};
      int done = 0;
      const auto failure = coupling::caught([&] {
        std::array<SlabCompany::Letter, 2> out{SlabCompany::Letter(3000000), SlabCompany::Letter(70)}, in;
        const std::array<std::function<void()>, 5> calls{
            [&] { company.largest(values); }, [&] { company.sum(values); }, [&] { company.swap(out, in); },
            [&] { company.swap_known(out, in); }, [&] { company.largest(values); }};
        for (; done < 5; ++done) {
          if (rank() == lost && done == before) throw std::bad_alloc();
          // Sizes are known from the swap before.
          calls[static_cast<std::size_t>(done)]();
        }
      });
      if (ranks() == 1) continue;
      mail.give_up();
      // A part may go on until it needs the one that is lost, or one that has given up for it.
      EXPECT_GE(done, before);
      EXPECT_EQ(failure.kind, rank() == lost ? coupling::Failure::machine : coupling::Failure::unstable);
      mail.clear();
      values = {1.0 * rank()};
      company.largest(values);
      EXPECT_EQ(values[0], ranks() - 1.0);
      company.sum(values);
      EXPECT_EQ(values[0], ranks() * (ranks() - 1.0));
    }
}

// ---- parts that record

std::string text(const dem::Grain&);
std::string text(const dem::Material&);
std::string text(const dem::Interaction&);
std::string text(const dem::Period&);
template <class T, std::size_t N>
std::string text(const std::array<T, N>&);
std::string text(const Vec3& v) { return fmt::format("({} {} {})", v.x, v.y, v.z); }
std::string text(const dem::Sphere& s) { return text(s.position) + fmt::format("{}", s.radius); }
std::string text(const dem::kernels::Quaternion& q) { return fmt::format("<{} {} {} {}>", q.w, q.x, q.y, q.z); }
template <class T>
std::string text(std::span<const T> list) {
  std::string all = fmt::format("[{}:", list.size());
  for (const T& each : list) {
    if constexpr (std::is_arithmetic_v<T>)
      all += fmt::format(" {}", each);
    else
      all += " " + text(each);
  }
  return all + "]";
}
template <class T, std::size_t N>
std::string text(const std::array<T, N>& list) {
  return text(std::span<const T>(list));
}
template <class T>
std::string text(const std::vector<T>& list) {
  return text(std::span<const T>(list));
}
std::string text(const dem::Grain& g) {
  return text(g.position) + text(g.velocity) + text(g.angular_velocity) + text(g.orientation) +
         fmt::format("{} {} {} {}", g.radius, g.material, g.id, g.shape);
}
std::string text(const dem::Material& m) {
  return fmt::format("{} {} {} {}", m.name, m.young_modulus, m.poisson_ratio, m.density);
}
std::string text(const dem::Interaction& i) {
  return fmt::format("{} {} {} {} {} {} {} {} {} {} {} {} {} {}", i.friction, i.restitution, i.rolling_friction, i.law,
                     i.rolling, i.normal_stiffness, i.shear_stiffness, i.normal_viscosity, i.shear_viscosity,
                     i.dissipative_coefficient, i.damping_mode, i.critical_stress, i.friction_exponent,
                     i.rolling_damping);
}
std::string text(const dem::Clump& c) {
  return text(c.spheres) + fmt::format("{} {}", c.volume, c.reach) + text(c.inertia) + text(c.bounding) +
         text(c.centroid) + text(c.orientation);
}
std::string text(const base::Skin& s) {
  return s.body + text(s.nodes) + text(s.facets) + text(s.faces) + text(s.face_of);
}
std::string text(const dem::WallBody& b) {
  return text(b.centre) + text(b.inertia) + text(b.moves) + text(b.turns) +
         fmt::format("{} {} {}", b.mass, b.weighs, b.damping);
}
std::string text(const dem::Period& p) { return fmt::format("{}+{}", p.lower, p.length); }
std::string text(const dem::Setup& s) {
  return text(s.materials) + text(s.interactions) + text(s.gravity) + text(s.periods) +
         fmt::format("{} {} {} {} {} {} {} {}", s.skin, s.maximum_overlap, s.track_energy, s.rotations,
                     static_cast<int>(s.time_scheme), static_cast<int>(s.rotation_scheme), s.lanes,
                     static_cast<int>(s.precision));
}

std::vector<std::string> record;  // of all recorders on this rank

class Recorder : public dem::Simulation {
 public:
  explicit Recorder(const dem::Setup& setup)
      : company_(setup.company),
        part_(setup.company ? setup.company->part() : 0),
        parts_(setup.company ? setup.company->parts() : 1) {
    record.push_back("create " + text(setup));
    if (setup.skin < 0 && part_ == parts_ - 1) throw base::UserError("skin: must not be negative");
  }
  ~Recorder() override { record.emplace_back("destroy"); }

  int add_shape(const dem::Clump& shape) override { return note("add_shape", text(shape)), 5; }
  void add_grains(std::span<const dem::Grain> list) override { note("add_grains", text(list)); }
  void remove_grains(std::span<const std::int64_t> ids) override { note("remove_grains", text(ids)); }
  std::vector<dem::Grain> grains() const override {
    std::vector<dem::Grain> list;
    for (int k = 0; k < 100; ++k) list.push_back({.position = {0.1 * k, 0, 0}, .id = part_ + k * parts_});
    return list;
  }
  std::vector<dem::GrainSphere> spheres() const override {
    std::vector<dem::GrainSphere> list;
    for (int k = 0; k < 3; ++k)
      for (const double radius : {0.2, 0.1}) list.push_back({{}, radius, 2 * parts_ - part_ + k * 2 * parts_});
    return list;
  }
  void set_grains(std::span<const dem::Grain> list) override { note("set_grains", text(list)); }
  void scale_grains(std::span<const std::int64_t> ids, double factor) override {
    note("scale_grains", text(ids), factor);
  }
  void set_material(int number, const dem::Material& material) override {
    note("set_material", number, text(material));
  }
  void set_interaction(int a, int b, const dem::Interaction& pair) override {
    note("set_interaction", a, b, text(pair));
  }
  void set_gravity(Vec3 gravity) override { note("set_gravity", text(gravity)); }
  void set_grain_damping(double alpha) override { note("set_grain_damping", alpha); }

  void add_bonds(std::span<const dem::Bond>) override {}
  std::vector<dem::BondNow> bonds() const override { return {}; }
  std::int64_t broken_bonds() const override { return 0; }

  int add_plane(const dem::Plane& plane, int material) override {
    return note("add_plane", text(plane.point), text(plane.normal), material), 7;
  }
  int add_mesh(const base::Skin& skin, int material, bool two_sided) override {
    return note("add_mesh", text(skin), material, two_sided), 8;
  }
  void remove_wall(int wall) override { note("remove_wall", wall); }
  void set_wall_velocity(int wall, Vec3 velocity) override { note("set_wall_velocity", wall, text(velocity)); }
  void set_wall_body(int wall, const dem::WallBody& body) override { note("set_wall_body", wall, text(body)); }
  void set_wall_load(int wall, Vec3 force, Vec3 torque) override {
    note("set_wall_load", wall, text(force), text(torque));
  }
  dem::WallBodyState wall_body(int wall) const override {
    dem::WallBodyState state;
    state.centre = {1.0 * part_, 1.0 * wall, 0};
    return state;
  }
  Vec3 wall_displacement(int wall) const override { return {1.0 * part_, 2.0 * wall, 0}; }
  Vec3 wall_velocity(int wall) const override { return {1.0 * part_, 3.0 * wall, 0}; }
  void set_mesh_target(int wall, std::span<const Vec3> positions, std::span<const Vec3> velocities,
                       dem::MeshWay way) override {
    note("set_mesh_target", wall, text(positions), text(velocities), static_cast<int>(way));
  }
  void know_mesh_nodes(int wall, std::span<const int> nodes, std::span<const int> fresh,
                       std::span<const Vec3> positions, std::span<const Vec3> velocities) override {
    note("know_mesh_nodes", wall, text(nodes), text(fresh), text(positions), text(velocities));
  }
  void keep_within(double low, double high) override { note("keep_within", low, high); }
  dem::Reach reach() const override { return {1.0 * part_, 2.0 + part_, 0.1 * (1 + part_), 5.0 - part_}; }
  void nodal_impulse(int wall, std::span<Vec3> impulse) const override {
    for (std::size_t k = 0; k < impulse.size(); ++k) impulse[k] = {1.0 * wall, static_cast<double>(k), 1.0 + part_};
  }
  std::vector<dem::NodeSpring> node_springs(int wall) const override { return {{1.0 * wall, 2}, {1.0 + part_, 3}}; }
  Vec3 wall_impulse_on_grains(int wall) const override { return {1.0 * wall, 1, 1.0 + part_}; }

  void advance(int n, double dt) override {
    note("advance", n, dt);
    const bool last = part_ == parts_ - 1;
    if (n == 101 && last) throw base::UserError("the last part's own");
    if (n == 102) throw base::UnstableError(last ? "grain 7 at (1, 2, 3) m" : "stopped with another part");
    if (n == 103 && part_ == 0) throw base::MachineError("the first part's own");
    if (n == 104 && last) throw std::bad_alloc();
    if (n == 105) throw base::UnstableError("stopped with another part");
    if (n < 106 || n > 108 || parts_ == 1) return;
    // One part alone fails, while the others wait for it.
    if (part_ == (n == 106 ? 0 : parts_ - 1)) throw std::bad_alloc();
    std::vector<double> values{1};
    std::array<dem::Company::Letter, 2> out, in;
    if (n == 108) company_->swap(out, in);
    company_->largest(values);
  }
  double time() const override { return 0.5 + part_; }
  dem::StableStep stable_step() const override { return {1.0 / (1 + part_), fmt::format("part {}", part_)}; }
  dem::StableStep contact_stable_step() const override {
    return {part_ == 0 ? 2.0 : std::numeric_limits<double>::infinity(), fmt::format("contact of {}", part_)};
  }

  base::Columns save() const override {
    return {{"doubles", std::vector<double>(1000, part_)},
            {"floats", std::vector<float>{0.5f}},
            {"group/ints", std::vector<int>{part_, -1}},
            {"longs", std::vector<std::int64_t>{std::int64_t{1} << 40}},
            {"text", fmt::format("part {}", part_)}};
  }
  void restore(const base::Columns& columns) override { EXPECT_EQ(columns, save()); }
  void restore_parts(std::span<const base::Columns> parts) override {
    ASSERT_EQ(parts.size(), 5u);
    for (int part = 0; part < 5; ++part)
      EXPECT_EQ(parts[static_cast<std::size_t>(part)].at("doubles"),
                base::Column(std::vector<double>(1000, part < ranks() ? part : 0)));
  }

  base::Energy energy() const override {
    base::Energy energy;
    energy.kinetic = 1.0 + part_;
    energy.loss_plastic = 2;
    energy.interface_angular_impulse = {0, 3, 0};
    return energy;
  }
  void reset_energy() override { note("reset_energy"); }
  std::vector<dem::GrainContact> grain_contacts() const override {
    return std::vector<dem::GrainContact>(static_cast<std::size_t>(part_ + 1));
  }
  std::vector<dem::WallContact> wall_contacts() const override {
    return {{.id = part_, .wall = 3, .grain_position = {}, .point = {}, .force = {}, .overlap = 0.5}};
  }
  dem::Counts counts() const override {
    return {.grains = 1 + part_, .contacts = 10, .rebuilds = 3 + part_, .steps = 4 + part_, .bytes = 100};
  }
  dem::Backend backend() const override { return dem::Backend::omp; }

 private:
  template <class... A>
  void note(const char* call, const A&... arguments) {
    std::string line = call;
    ((line += fmt::format(" {}", arguments)), ...);
    record.push_back(line);
  }
  dem::Company* company_;
  int part_, parts_;
};

std::unique_ptr<dem::Simulation> make_recorder(const dem::Setup& setup, dem::Backend) {
  return std::make_unique<Recorder>(setup);
}

dem::Setup sample_setup() {
  dem::Setup setup;
  setup.materials = {{"stone", 1e9, 0.2, 2700}, {"steel", 2e11, 0.3, 0}};
  dem::Interaction pair{0.5, 0.6, 0.1, "law of some length, longer than any text in place", "rolling"};
  pair.normal_stiffness = 1;
  pair.shear_stiffness = 2;
  pair.normal_viscosity = 3;
  pair.shear_viscosity = 4;
  pair.dissipative_coefficient = 5;
  pair.damping_mode = 6;
  pair.critical_stress = 7;
  pair.friction_exponent = 8;
  pair.rolling_damping = 9;
  setup.interactions.assign(4, pair);
  setup.gravity = {0, 1, -9.81};
  setup.skin = 0.001;
  setup.maximum_overlap = 0.25;
  setup.track_energy = false;
  setup.rotations = false;
  setup.time_scheme = dem::TimeScheme::symplectic_euler;
  setup.lanes = 2;
  setup.precision = dem::Precision::mixed;
  setup.periods = {{{-1, 4}, {0, 0}, {2, 3}}};
  return setup;
}

std::vector<dem::Grain> sample_grains(int count) {
  std::vector<dem::Grain> grains;
  for (int k = 0; k < count; ++k)
    grains.push_back({{0.1 * k, 1, 2}, 0.01 * k, {3, 4, 5}, {6, 7, 8}, k % 2, k, k % 3 - 1, {0.5, 0.5, 0.5, -0.5}});
  return grains;
}

/// Every call that changes something.
void call_all(dem::Simulation& simulation) {
  const auto grains = sample_grains(300);
  const std::vector<std::int64_t> ids{1, 5, std::int64_t{1} << 40};
  const std::vector<Vec3> nodes{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, velocities(4, {0, 0, 1});
  EXPECT_EQ(simulation.add_shape({{{{1, 2, 3}, 4}, {{5, 6, 7}, 8}},
                                  9,
                                  {10, 11, 12},
                                  13,
                                  {{14, 15, 16}, 17},
                                  {18, 19, 20},
                                  {0.5, 0.5, 0.5, 0.5}}),
            5);
  simulation.add_grains(grains);
  simulation.add_grains({});
  simulation.remove_grains(ids);
  simulation.set_grains(std::span(grains).first(2));
  simulation.scale_grains(ids, 1.25);
  simulation.set_material(1, {"iron", 1, 2, 3});
  simulation.set_interaction(0, 1, sample_setup().interactions[0]);
  simulation.set_gravity({1, 2, 3});
  simulation.set_grain_damping(0.75);
  EXPECT_EQ(simulation.add_plane({{1, 2, 3}, {0, 0, 1}}, 1), 7);
  EXPECT_EQ(simulation.add_mesh({"sleeper", nodes, {{0, 1, 2, 3}}, {{0, 1, 2, 3, 0, 1, -1, -1}}, {0}}, 1, true), 8);
  simulation.remove_wall(3);
  simulation.set_wall_velocity(4, {4, 5, 6});
  simulation.set_wall_body(5, {{1, 2, 3}, 4, {5, 6, 7}, {true, false, true}, {false, true, false}, false, 8});
  simulation.set_wall_load(6, {1, 2, 3}, {4, 5, 6});
  simulation.set_mesh_target(8, nodes, velocities, dem::MeshWay::parabola);
  simulation.know_mesh_nodes(8, std::vector<int>{0, 2, 3}, std::vector<int>{2}, std::span(nodes).first(1),
                             std::span(velocities).first(1));
  simulation.keep_within(-0.5, 2.5);
  simulation.add_bonds({});
  simulation.advance(3, 1e-5);
  simulation.reset_energy();
}

std::string gathered_records() {
  std::string mine, all;
  for (const auto& line : record) mine += line + "\n";
  for (int r = 0; r < ranks(); ++r) {
    std::string one = mine;
    int size = static_cast<int>(one.size());
    MPI_Bcast(&size, 1, MPI_INT, r, MPI_COMM_WORLD);
    one.resize(static_cast<std::size_t>(size));
    MPI_Bcast(one.data(), size, MPI_CHAR, r, MPI_COMM_WORLD);
    all += one;
  }
  return all;
}

/// The first rank leads, the others serve, until it is done, however it ends.
void lead(const std::function<void(coupling::SlabCrew&)>& leader) {
  record.clear();
  if (rank() > 0) return coupling::serve_slabs(MPI_COMM_WORLD, make_recorder);
  coupling::SlabCrew crew(MPI_COMM_WORLD, make_recorder);
  leader(crew);
}

TEST(SlabServer, EveryCallReachesAllPartsAsItWasMade) {
  std::string expected;
  record.clear();
  call_all(*make_recorder(sample_setup(), dem::Backend::omp));
  for (const auto& line : record) expected += line + "\n";
  lead([](coupling::SlabCrew& crew) {
    const auto simulation = crew.make(sample_setup(), dem::Backend::omp);
    call_all(*simulation);
  });
  std::string all;
  for (int r = 0; r < ranks(); ++r) all += expected;
  EXPECT_EQ(gathered_records(), all);
}

TEST(SlabServer, AnswersArePutTogether) {
  lead([](coupling::SlabCrew& crew) {
    const auto owned = crew.make(sample_setup(), dem::Backend::omp);
    dem::Simulation& simulation = *owned;
    const auto grains = simulation.grains();
    ASSERT_EQ(grains.size(), 100u * static_cast<std::size_t>(ranks()));
    for (std::size_t k = 0; k < grains.size(); ++k) EXPECT_EQ(grains[k].id, static_cast<std::int64_t>(k));
    const auto spheres = simulation.spheres();
    ASSERT_EQ(spheres.size(), 6u * static_cast<std::size_t>(ranks()));
    for (std::size_t k = 0; k < spheres.size(); k += 2) {
      EXPECT_EQ(spheres[k].id, spheres[k + 1].id);
      EXPECT_GT(spheres[k].radius, spheres[k + 1].radius) << "the order within a grain";
      EXPECT_TRUE(k == 0 || spheres[k].id > spheres[k - 1].id);
    }
    const double n = ranks(), sum = n * (n + 1) / 2;  // of 1 + part
    EXPECT_EQ(text(simulation.wall_impulse_on_grains(4)), text(Vec3{4 * n, n, sum}));
    std::vector<Vec3> impulse(100, {9, 9, 9});
    simulation.set_mesh_target(4, impulse, impulse, dem::MeshWay::line);
    simulation.advance(1, 1e-5);
    simulation.nodal_impulse(4, impulse);
    EXPECT_EQ(text(simulation.wall_impulse_on_grains(4)), text(Vec3{4 * n, n, sum}));
    EXPECT_EQ(text(impulse[99]), text(Vec3{4 * n, 99 * n, sum}));
    const auto springs = simulation.node_springs(6);
    ASSERT_EQ(springs.size(), 2u);
    EXPECT_EQ(springs[0].stiffness, 6 * n);
    EXPECT_EQ(springs[1].stiffness, sum);
    EXPECT_EQ(springs[1].damping, 3 * n);
    EXPECT_EQ(text(simulation.wall_impulse_on_grains(2)), text(Vec3{2 * n, n, sum}));
    EXPECT_EQ(simulation.reach().low, 0);
    EXPECT_EQ(simulation.reach().high, 1 + n);
    EXPECT_EQ(simulation.reach().grain, 0.1 * n);
    EXPECT_EQ(simulation.reach().speed, 5);
    EXPECT_EQ(simulation.stable_step().limit, 1 / n);
    EXPECT_EQ(simulation.stable_step().limiter, fmt::format("part {}", ranks() - 1));
    EXPECT_EQ(simulation.contact_stable_step().limiter, "contact of 0");
    EXPECT_EQ(simulation.energy().kinetic, sum);
    EXPECT_EQ(simulation.energy().loss_plastic, 2 * n);
    EXPECT_EQ(simulation.energy().interface_angular_impulse.y, 3 * n);
    EXPECT_EQ(static_cast<double>(simulation.grain_contacts().size()), sum);
    EXPECT_EQ(simulation.wall_contacts().back().id, ranks() - 1);
    const auto counts = simulation.counts();
    EXPECT_EQ(static_cast<double>(counts.grains), sum);
    EXPECT_EQ(counts.rebuilds, 3);
    EXPECT_EQ(counts.steps, 4);
    EXPECT_EQ(counts.bytes, 100u * static_cast<std::size_t>(ranks()));
    EXPECT_EQ(simulation.time(), 0.5);
    EXPECT_EQ(simulation.wall_body(2).centre.y, 2);
    EXPECT_EQ(simulation.wall_displacement(2).y, 4);
    EXPECT_EQ(simulation.wall_velocity(2).y, 6);
    EXPECT_EQ(simulation.broken_bonds(), 0);
  });
}

/// What happens to be thrown, as "kind: text".
template <class Work>
std::string thrown(const Work& work) {
  const coupling::FailureText failure = coupling::caught(work);
  return fmt::format("{}: {}", static_cast<int>(failure.kind), failure.text);
}

TEST(SlabServer, FailureOfAnyPartIsThrownAndTheCrewGoesOn) {
  lead([](coupling::SlabCrew& crew) {
    const auto simulation = crew.make(sample_setup(), dem::Backend::omp);
    EXPECT_EQ(thrown([&] { simulation->advance(101, 1); }), "2: the last part's own");
    EXPECT_EQ(thrown([&] { simulation->advance(102, 1); }), "3: grain 7 at (1, 2, 3) m");
    EXPECT_EQ(thrown([&] { simulation->advance(103, 1); }), "4: the first part's own");
    EXPECT_EQ(thrown([&] { simulation->advance(104, 1); }).substr(0, 16), "4: out of memory");
    EXPECT_EQ(thrown([&] { simulation->advance(105, 1); }), "3: stopped with another part");
    for (const int alone : {106, 107, 108})
      EXPECT_EQ(thrown([&] { simulation->advance(alone, 1); }).substr(0, 16), ranks() > 1 ? "4: out of memory" : "0: ");
    EXPECT_EQ(thrown([&] { simulation->add_bonds(std::vector<dem::Bond>(1)); }),
              "2: bonds need one DEM rank; start with --dem-ranks 1");
    EXPECT_EQ(simulation->grains().size(), 100u * static_cast<std::size_t>(ranks()));
  });
}

TEST(SlabServer, SimulationsAreToldApartAndGoOneByOne) {
  lead([](coupling::SlabCrew& crew) {
    auto setup = sample_setup();
    const auto first = crew.make(setup, dem::Backend::omp);
    setup.skin = -1;
    EXPECT_EQ(thrown([&] { crew.make(setup, dem::Backend::omp); }), "2: skin: must not be negative");
    setup.skin = 2;
    auto second = crew.make(setup, dem::Backend::omp);
    second->set_grain_damping(1);
    second.reset();
    first->set_grain_damping(2);
    EXPECT_EQ(first->time(), 0.5);
  });
  const std::size_t last = record.size() - 1;
  ASSERT_GE(record.size(), 6u);
  EXPECT_EQ(record[last], "destroy");
  EXPECT_EQ(record[last - 1], "set_grain_damping 2");
  EXPECT_EQ(record[last - 2], "destroy");
  EXPECT_EQ(record[last - 3], "set_grain_damping 1");
}

TEST(SlabServer, WorkersAreLetGoWhenTheLeaderFails) {
  const std::string failure = thrown([] {
    lead([](coupling::SlabCrew& crew) {
      const auto simulation = crew.make(sample_setup(), dem::Backend::omp);
      throw base::UserError("the leader's own");
    });
  });
  EXPECT_EQ(failure, rank() == 0 ? "2: the leader's own" : "0: ");
}

TEST(SlabServer, CheckpointGoesBackToItsPartsOrAsAWholeToOthers) {
  lead([](coupling::SlabCrew& crew) {
    const auto simulation = crew.make(sample_setup(), dem::Backend::omp);
    auto columns = simulation->save();
    EXPECT_EQ(columns.size(), 1 + 5 * static_cast<std::size_t>(ranks()));
    EXPECT_EQ(std::get<std::string>(columns.at(fmt::format("part_{}/text", ranks() - 1))),
              fmt::format("part {}", ranks() - 1));
    simulation->restore(columns);  // each part compares with its own
    for (int part = ranks(); part < 5; ++part)
      for (const char* name : {"doubles", "floats", "group/ints", "longs"})
        columns[fmt::format("part_{}/{}", part, name)] = columns[fmt::format("part_0/{}", name)];
    columns["parts"] = std::vector<int>{5};
    EXPECT_EQ(coupling::saved_parts(columns).size(), 5u);
    simulation->restore(columns);  // restore_parts(), which compares with what all have saved
  });
}

TEST(SlabServer, ThreadsAreSetOnEveryRank) {
  lead([](coupling::SlabCrew& crew) { crew.set_threads(1); });
}

}  // namespace
