// What every contact law must keep (dem/laws.hpp): restitution, Coulomb limit, no attraction, no energy from nowhere,
// frame indifference, action = reaction, nothing where apart, and the same in every lane of a SIMD pack.
#if defined(__GNUC__)  // packs wider than this build's registers: their functions are inlined, no call passes one
#pragma GCC diagnostic ignored "-Wpsabi"
#endif
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "tests/dem_law_rows.hpp"

using namespace dem_test;
using namespace dem_test::law_rows;

namespace {

template <class Row>
class Laws : public testing::Test {
 protected:
  using Law = typename Row::Law;
  static constexpr int numbers = Law::history + 1;

  static Pair<Law> spheres(const PairParameters& parameters) {
    return {parameters, {0.01, mass_i, {0.025, 0, 0}, {}}, {0.015, mass_j, {}, {}}};
  }
  /// 1000 steps per contact at 1 m/s; the spring's half period, or Hertz's.
  static double time_step(const PairParameters& p) {
    const HertzImpact hertz{p.effective_young_modulus, reduced_radius, reduced_mass, 1};
    return (p.normal_stiffness > 0 ? std::numbers::pi * std::sqrt(reduced_mass / p.normal_stiffness)
                                   : hertz.duration()) /
           1000;
  }
  static Touch<double> touch(double overlap, const Vec3& normal, const Vec3& velocity) {
    return {overlap, reduced_radius, reduced_mass, normal, velocity};
  }
};
TYPED_TEST_SUITE(Laws, Rows);

}  // namespace

// A law without a row here is an untested law.
template <class Tested>
struct Covers;
template <class... Row>
struct Covers<testing::Types<Row...>> {
  template <class Law>
  static constexpr bool law = (std::is_same_v<typename Row::Law, Law> || ...);
};
TEST(LawTable, EveryLawIsTested) {
  std::vector<std::string> names;
  dem::for_each_law(dem::laws, [&]<class Law>(const dem::LawRow<Law>& row) {
    EXPECT_TRUE(Covers<Rows>::law<Law>) << row.name;
    EXPECT_EQ(row.history, Law::history);
    EXPECT_FALSE(row.text.empty() || row.source.empty() || row.parameters[0].empty()) << row.name;
    names.emplace_back(row.name);
    bool found = false;
    EXPECT_TRUE(dem::with_law(dem::laws, row.name,
                              [&]<class Found>(const dem::LawRow<Found>&) { found = std::is_same_v<Found, Law>; }));
    EXPECT_TRUE(found) << row.name;
  });
  std::sort(names.begin(), names.end());
  EXPECT_EQ(std::adjacent_find(names.begin(), names.end()), names.end());
  EXPECT_FALSE(dem::with_law(dem::laws, "hertz", [](const auto&) {}));
}

// A dashpot coefficient wrong by a constant factor, the wrong mass or an attraction at the end show at every e but 1.
TYPED_TEST(Laws, RestitutionRecovered) {
  for (double e : {0.2, 0.4, 0.6, 0.8, 1.0}) {
    auto run = this->spheres(TypeParam::parameters({e, 0.3}));
    run.i.velocity = {-1, 0, 0};
    run.i.position.x += e * this->time_step(run.parameters);  // the touch comes anywhere within the first step
    run.collide(this->time_step(run.parameters));
    EXPECT_NEAR(run.i.velocity.x - run.j.velocity.x, TypeParam::restitution(e), 2e-4) << e;
  }
}

TYPED_TEST(Laws, CoulombLimitAndNoAttraction) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  const PairParameters pair = TypeParam::parameters({0.2, 0.4});
  double history[TestFixture::numbers] = {};
  int clamped = 0, sliding = 0;
  for (int n = 0; n < 2000; ++n) {
    const Vec3 velocity{10 * unit(random), 10 * unit(random), unit(random)};
    const auto touch = this->touch(1e-5 * (1.1 + unit(random)), {0, 0, 1}, velocity);
    Reaction<double> on_i;
    press<typename TestFixture::Law, true>(pair, touch, {1e-7, 1e-7}, history, on_i);
    const double tangential = std::hypot(on_i.force.x, on_i.force.y);
    EXPECT_GE(on_i.force.z, 0);
    EXPECT_EQ(on_i.force.z, on_i.normal_force);
    EXPECT_LE(tangential, pair.friction * on_i.normal_force * (1 + 1e-12));
    EXPECT_GE(on_i.loss_damping, 0);
    clamped += on_i.normal_force == 0;
    sliding += tangential > 0.8 * pair.friction * on_i.normal_force;
  }
  const bool never_pulls = std::is_same_v<typename TestFixture::Law, Hysteretic> && pair.hysteretic_damping < 1;
  EXPECT_TRUE(clamped > 10 || never_pulls) << clamped;
  EXPECT_GT(sliding, 10);
}

// Closed paths of overlap and tangential place that begin and end apart: the work put in may not be negative, and at no
// time may friction give energy back. A spring that keeps its force while its stiffness falls does.
TYPED_TEST(Laws, NoEnergyGainOverClosedCycles) {
  const int steps = 1000;
  for (double friction : {0.05, 0.5, 100.0})
    for (double phase : {0.0, 0.7, 1.6, 2.5, 3.1, 4.0, 5.5})
      for (double period : {1e-4, 1e-2}) {  // dashpots strong and weak, [s]
        const PairParameters pair = TypeParam::parameters({0.6, friction});
        const double dt = period / steps, rate = 2 * std::numbers::pi / period;
        double history[TestFixture::numbers] = {};
        double work = 0, losses = 0, most = 0, rubbed = 0, most_rubbed = 0, most_shear = 0, given_back = 0;
        for (int n = 0; n < 2 * steps; ++n) {
          const double angle = rate * (n + 0.5) * dt;
          const Vec3 velocity{rate * 1e-6 * std::cos(angle + phase), rate * 0.8e-6 * std::cos(2 * angle),
                              -rate * 1e-5 * std::sin(angle)};
          Reaction<double> on_i;
          const auto touch = this->touch(1e-5 * (0.98 - std::cos(angle)), {0, 0, 1}, velocity);
          press<typename TestFixture::Law, true>(pair, touch, {0.5 * dt, 0.5 * dt}, history, on_i);
          work -= dot(on_i.force, velocity) * dt;
          losses += on_i.loss_friction + on_i.loss_damping;
          most = std::max(most, on_i.elastic_normal + on_i.elastic_shear);
          most_shear = std::max(most_shear, on_i.elastic_shear);
          rubbed += on_i.loss_friction;
          most_rubbed = std::max(most_rubbed, rubbed);
          given_back = std::max(given_back, most_rubbed - rubbed);
        }
        EXPECT_LE(given_back, 0.01 * most_shear) << friction << " " << phase << " " << period;
        EXPECT_GE(work, -1e-5 * most) << friction << " " << phase << " " << period;
        EXPECT_NEAR(work, losses, 2e-3 * work + 1e-5 * most) << friction << " " << phase << " " << period;
        EXPECT_EQ(history[TestFixture::numbers - 1], 0);
      }
}

// Stick, slip and reversal in one impact: kinetic energy before = after + losses.
TYPED_TEST(Laws, EnergyClosesInObliqueImpact) {
  for (double e : {0.3, 0.8, 1.0})
    for (double sideways : {0.1, 0.5, 2.0}) {
      auto run = this->spheres(TypeParam::parameters({e, 0.3}));
      run.i.velocity = {-1, sideways, 0.2};
      run.i.spin = {5, -20, 30};
      const double before = run.energy();
      run.collide(this->time_step(run.parameters));
      EXPECT_NEAR(run.energy() / before, 1, 2e-5) << e << " " << sideways;
      EXPECT_GT(run.loss_friction, -1e-6 * before);
      EXPECT_EQ(run.stored(), 0);
    }
}

// The same impact seen from a frame that is turned and flies past.
TYPED_TEST(Laws, FrameIndifferent) {
  const Vec3 axis{1 / 3.0, 2 / 3.0, -2 / 3.0}, boost{0.7, -0.3, 0.4};
  const auto turn = [&](const Vec3& v) { return rotated(v, axis, 1.1); };
  auto plain = this->spheres(TypeParam::parameters({0.6, 0.3}));
  plain.i.velocity = {-1, 0.5, 0.2};
  plain.i.spin = {5, -20, 30};
  auto moved = plain;
  for (Body* body : {&moved.i, &moved.j}) {
    body->position = turn(body->position);
    body->velocity = turn(body->velocity) + boost;
    body->spin = turn(body->spin);
  }
  const double dt = this->time_step(plain.parameters);
  for (int n = 0; n < 800; ++n) {
    plain.step(dt);
    moved.step(dt);
    ASSERT_LT(norm(turn(plain.reaction.force) - moved.reaction.force), 1e-7 * norm(plain.reaction.force) + 1e-8) << n;
  }
  EXPECT_LT(norm(turn(plain.i.velocity) + boost - moved.i.velocity), 1e-9);
  EXPECT_LT(norm(turn(plain.i.spin) - moved.i.spin), 1e-7);
  EXPECT_NEAR(plain.loss_friction, moved.loss_friction, 1e-9 * plain.energy());
}

// Exchanging i and j must turn every force round, step after step.
TYPED_TEST(Laws, ActionEqualsReaction) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(-1, 1);
  const PairParameters pair = TypeParam::parameters({0.5, 0.4});
  double history[TestFixture::numbers] = {}, mirrored[TestFixture::numbers] = {};
  for (int n = 0; n < 100; ++n) {
    const Vec3 normal = rotated({0.6, 0, 0.8}, {0, 1, 0}, 0.001 * n);
    const Vec3 velocity{unit(random), unit(random), unit(random)};
    const double overlap = 2e-5 + 1e-5 * unit(random);
    Reaction<double> on_i, on_j;
    press<typename TestFixture::Law, true>(pair, this->touch(overlap, normal, velocity), {1e-7, 1e-7}, history, on_i);
    press<typename TestFixture::Law, true>(pair, this->touch(overlap, -normal, -velocity), {1e-7, 1e-7}, mirrored,
                                           on_j);
    EXPECT_LE(norm(on_i.force + on_j.force), 1e-15 * norm(on_i.force));
    EXPECT_DOUBLE_EQ(on_i.normal_force, on_j.normal_force);
  }
}

// A sticking pair that tilts as one body carries its force along: plain projection would lose 1 - cos of every tilt.
TYPED_TEST(Laws, HistoryTiltsWithTheContact) {
  const PairParameters pair = TypeParam::parameters({1, 10});
  double history[TestFixture::numbers] = {};
  Reaction<double> first, last;
  press<typename TestFixture::Law, true>(pair, this->touch(1e-5, {0, 0, 1}, {1, 0, 0}), {1e-7, 0}, history, first);
  for (int n = 1; n <= 100; ++n) {
    const Vec3 normal = rotated({0, 0, 1}, {0, 1, 0}, 0.005 * std::numbers::pi * n);
    press<typename TestFixture::Law, true>(pair, this->touch(1e-5, normal, {}), {1e-7, 1e-7}, history, last);
  }
  const auto tangential = [](const Reaction<double>& r, const Vec3& normal) {
    return r.force - r.normal_force * normal;
  };
  const Vec3 before = tangential(first, {0, 0, 1}), after = tangential(last, {1, 0, 0});
  EXPECT_GT(norm(before), 0);
  EXPECT_NEAR(after.z / norm(before), 1, 1e-9);  // from -x to z
}

TYPED_TEST(Laws, NothingWhereApart) {
  const PairParameters pair = TypeParam::parameters({0.5, 0.4});
  for (double overlap : {0.0, -1e-3}) {
    double history[TestFixture::numbers] = {};
    Reaction<double> held, apart;
    press<typename TestFixture::Law, true>(pair, this->touch(1e-5, {0, 0, 1}, {0.1, 0, -1}), {1e-7, 1e-7}, history,
                                           held);
    press<typename TestFixture::Law, true>(pair, this->touch(overlap, {0, 0, 1}, {1, 1, -1}), {1e-7, 1e-7}, history,
                                           apart);
    EXPECT_EQ(norm(apart.force), 0);
    EXPECT_EQ(apart.normal_force, 0);
    EXPECT_EQ(apart.elastic_normal + apart.elastic_shear + apart.loss_damping, 0);
    EXPECT_GT(held.elastic_shear, 0);
    EXPECT_DOUBLE_EQ(apart.loss_friction, held.elastic_shear);  // what the spring still held is gone
    for (double number : history) EXPECT_EQ(number, 0);
  }
}

// Every lane of a pack goes the way of the plain number, with the ledger and without it (where the forces must not
// change).
TYPED_TEST(Laws, LanesAgreeWithPlainNumbers) {
  using Real = Pack<double, 4>;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(-1, 1);
  const PairParameters pair = TypeParam::parameters({0.4, 0.3});
  Real history[TestFixture::numbers] = {}, bare_history[TestFixture::numbers] = {};
  double plain_history[4][TestFixture::numbers] = {};
  const Interval time{1e-7, 1e-7};
  for (int n = 0; n < 500; ++n) {
    Touch<Real> pack{};
    Touch<double> plain[4];
    for (int k = 0; k < 4; ++k) {
      plain[k] = this->touch(1e-5 * (0.7 + unit(random)), rotated({0.6, 0, 0.8}, {0, 1, 0}, 0.001 * n),
                             {unit(random), unit(random), unit(random)});
      pack.overlap[k] = plain[k].overlap;
      pack.effective_radius[k] = plain[k].effective_radius;
      pack.effective_mass[k] = plain[k].effective_mass;
      for (auto [vector, number] : {std::pair{&pack.normal, plain[k].normal}, {&pack.velocity, plain[k].velocity}}) {
        vector->x[k] = number.x;
        vector->y[k] = number.y;
        vector->z[k] = number.z;
      }
    }
    Reaction<Real> packed, bare;
    press<typename TestFixture::Law, true>(pair, pack, time, history, packed);
    press<typename TestFixture::Law, false>(pair, pack, time, bare_history, bare);
    for (int k = 0; k < 4; ++k) {
      Reaction<double> one;
      press<typename TestFixture::Law, true>(pair, plain[k], time, plain_history[k], one);
      const double scale = norm(one.force) + 1e-3;  // [N]
      const Vec3 force{packed.force.x[k], packed.force.y[k], packed.force.z[k]};
      const Vec3 bare_force{bare.force.x[k], bare.force.y[k], bare.force.z[k]};
      ASSERT_LT(norm(force - one.force), 1e-11 * scale) << n;
      ASSERT_LT(norm(bare_force - one.force), 1e-11 * scale) << n;
      ASSERT_NEAR(packed.normal_force[k], one.normal_force, 1e-11 * scale);
      ASSERT_NEAR(packed.loss_friction[k], one.loss_friction, 1e-11 * scale * 1e-6);  // [J]: 1e-6 m of scale
      ASSERT_NEAR(packed.loss_damping[k], one.loss_damping, 1e-11 * scale * 1e-6);
      ASSERT_NEAR(packed.elastic_normal[k], one.elastic_normal, 1e-11 * scale * 1e-4);
    }
  }
}

// Single precision follows to its own rounding.
TYPED_TEST(Laws, FloatFollows) {
  const PairParameters pair = TypeParam::parameters({0.5, 0.4});
  float history[TestFixture::numbers] = {};
  double exact_history[TestFixture::numbers] = {};
  for (int n = 0; n < 100; ++n) {
    const double overlap = 1e-6 * n;
    Touch<float> touch{};
    touch.overlap = float(overlap);
    touch.effective_radius = float(reduced_radius);
    touch.effective_mass = float(reduced_mass);
    touch.normal.z = 1;
    touch.velocity = {0.05f, 0.01f, -0.5f};
    Reaction<float> single;
    Reaction<double> exact;
    press<typename TestFixture::Law, false>(pair, touch, {1e-6, 1e-6}, history, single);
    press<typename TestFixture::Law, false>(pair, this->touch(overlap, {0, 0, 1}, {0.05, 0.01, -0.5}), {1e-6, 1e-6},
                                            exact_history, exact);
    EXPECT_NEAR(single.normal_force, exact.normal_force, 1e-5 * exact.normal_force);
    EXPECT_NEAR(single.force.x, exact.force.x, 1e-4 * norm(exact.force));
  }
}
