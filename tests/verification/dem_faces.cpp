// Spheres on skins of the second order through the façade (dem/kernels/face_geometry.hpp): found by the plane parts,
// touched on the face, carried by its nodes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <random>

#include "dem/dem.hpp"
#include "tests/dem_backend.hpp"

namespace {

using base::Skin;
using base::Vec3;

enum class Kind { quadrilaterals, triangles };
const Kind both[2] = {Kind::quadrilaterals, Kind::triangles};

/// nx x ny quadrilaterals of eight nodes, or twice as many triangles of six, over [x0, x1] x [y0, y1]; the nodes lie
/// where `place` puts those of the flat grid. With their plane parts as fem cuts them.
Skin second_order(Kind kind, int nx, int ny, const std::function<Vec3(double, double)>& place) {
  Skin skin;
  std::map<std::pair<int, int>, int> numbers;  // on the grid of half cells
  const auto node = [&](int i, int j) {
    const auto [at, fresh] = numbers.try_emplace({i, j}, static_cast<int>(skin.nodes.size()));
    if (fresh) skin.nodes.push_back(place(0.5 * i / nx, 0.5 * j / ny));
    return at->second;
  };
  const auto add = [&](const std::vector<std::pair<int, int>>& corners) {
    const int n = static_cast<int>(corners.size());
    std::array<int, 8> face{-1, -1, -1, -1, -1, -1, -1, -1};
    for (int a = 0; a < n; ++a) {
      const auto [i, j] = corners[a];
      const auto [k, l] = corners[(a + 1) % n];
      face[a] = node(i, j);
      face[n + a] = node((i + k) / 2, (j + l) / 2);
    }
    for (int a = 0; a < n; ++a) skin.facets.push_back({face[a], face[n + a], face[n + (a + n - 1) % n], -1});
    skin.facets.push_back({face[n], face[n + 1], face[n + 2], n == 4 ? face[7] : -1});
    skin.face_of.resize(skin.facets.size(), static_cast<int>(skin.faces.size()));
    skin.faces.push_back(face);
  };
  for (int i = 0; i < 2 * nx; i += 2)
    for (int j = 0; j < 2 * ny; j += 2) {
      if (kind == Kind::quadrilaterals) {
        add({{i, j}, {i + 2, j}, {i + 2, j + 2}, {i, j + 2}});
      } else {
        add({{i, j}, {i + 2, j}, {i + 2, j + 2}});
        add({{i, j}, {i + 2, j + 2}, {i, j + 2}});
      }
    }
  return skin;
}

Skin parts_alone(Skin skin) {
  skin.faces.clear();
  skin.face_of.clear();
  return skin;
}

dem::Setup smooth_setup() {
  dem::set_threads(1);
  dem::Setup setup;
  setup.materials = {{"stone", 1e9, 0.2, 2700}};
  setup.interactions = {{0, 1, 0}};
  return setup;
}

/// Force [N] of the skin on a sphere held at a place after another, with friction off.
class Feeler {
 public:
  Feeler(const Skin& skin, double radius) : radius_(radius) {
    simulation_ = dem_test::create(smooth_setup());
    simulation_->add_mesh(skin, 0, false);
    const dem::Grain grain{.position = {0, 0, 1e3}, .radius = radius_};
    simulation_->add_grains({&grain, 1});
  }
  Vec3 force(const Vec3& centre) {
    const dem::Grain grain{.position = centre, .radius = radius_};
    simulation_->set_grains({&grain, 1});
    simulation_->advance(1, 1e-12);
    Vec3 sum;
    for (const auto& contact : simulation_->wall_contacts()) sum += contact.force;
    return sum;
  }

 private:
  std::unique_ptr<dem::Simulation> simulation_;
  double radius_;
};

struct Crossing {
  double jump = 0;                 // largest change of the force from step to step, over the force of a smooth cylinder
  double least = 1e300, most = 0;  // of the force, over the same
};

constexpr double ball = 0.03, overlap = 3e-4, step = 2e-5;  // [m], [m], [rad] from place to place

/// A sphere with an overlap of 1 % slides around the inside of a cylinder of 1 m whose skin has nodes every `angle`,
/// over a middle and over the edge between two faces.
Crossing cross_valley(Kind kind, bool faces, double angle) {
  const Skin skin = second_order(kind, 4, 1, [&](double u, double v) {
    const double at = angle * (8 * u - 4);
    return Vec3{std::sin(at), 0.2 * (v - 0.5), 1 - std::cos(at)};
  });
  Feeler feeler(faces ? skin : parts_alone(skin), ball);
  Feeler flat(second_order(Kind::quadrilaterals, 1, 1,
                           [](double u, double v) {
                             return Vec3{u - 0.5, v - 0.5, 0};
                           }),
              ball);
  const double smooth = norm(flat.force({0.01, 0.02, ball - overlap}));
  const double at_radius = 1 - ball + overlap;
  Crossing crossing;
  for (const double line : {0.0, angle}) {  // an edge, and middles
    Vec3 before;
    for (int k = -250; k <= 250; ++k) {
      const double at = line + (k + 0.5) * step;
      const Vec3 force = feeler.force({at_radius * std::sin(at), 0.013, 1 - at_radius * std::cos(at)});
      if (k > -250) crossing.jump = std::max(crossing.jump, norm(force - before) / smooth);
      crossing.least = std::min(crossing.least, norm(force) / smooth);
      crossing.most = std::max(crossing.most, norm(force) / smooth);
      before = force;
    }
  }
  return crossing;
}

// Springs of a contact at the middle of a face of eight nodes: N is -1/4 at the corners and 1/2 at the middles, so that
// |N_a| sum |N_b| is 3/4 and 3/2; of its parts the middle quadrilateral alone carries, a quarter per node.
TEST(DemFaces, SpringsAtNodesFollowTheShapeFunctions) {
  const Skin skin = second_order(Kind::quadrilaterals, 1, 1, [](double u, double v) {
    return Vec3{0.1 * u, 0.1 * v, 0};
  });
  const auto springs = [](const Skin& of) {
    const auto simulation = dem_test::create(smooth_setup());
    const int wall = simulation->add_mesh(of, 0, false);
    const dem::Grain grain{.position = {0.05, 0.05, ball - overlap}, .radius = ball};
    simulation->add_grains({&grain, 1});
    simulation->advance(1, 1e-12);
    return simulation->node_springs(wall);
  };
  const auto face = springs(skin), parts = springs(parts_alone(skin));
  double quarter = 0;
  for (const auto& node : parts) quarter = std::max(quarter, node.stiffness);
  ASSERT_GT(quarter, 0);
  for (std::size_t n = 0; n < skin.nodes.size(); ++n) {
    const bool corner = skin.nodes[n].x != 0.05 && skin.nodes[n].y != 0.05;
    EXPECT_NEAR(face[n].stiffness, (corner ? 3 : 6) * quarter, 1e-9 * quarter) << n;
  }
}

}  // namespace

// Irazabal2017 4.4.1, 4.4.2: a sphere that crosses an edge of a bent skin. With nodes every angle t on a circle:
// Plane parts of triangles fold by t at every row of nodes (those of quadrilaterals also along their diagonals). A fold
// below 0.81 degrees counts once: the force turns at once, a jump of t. A larger one brings the second part in, when
// the centre comes over it, with the overlap that it has already: a jump of the second overlap over the first to the
// power 3/2 (Hertz).
// The parabola through three nodes ends with slope 2 tan(t/2) against its chord where the circle's is t: between two
// faces the skin folds by 2 (t - atan(2 tan(t/2))), about t^3/2, and within a face not at all. Beside that the force
// turns by `step` from place to place, and its overlap changes by at most half the fold times the way.
// Measured for t = 0.01: triangles 0.0100 on parts, 2.1e-5 on faces; quadrilaterals 0.248, 2.1e-5; for t = 0.1: 0.82 on
// parts and 5.3e-4 on faces of either kind.
TEST(DemFaces, ForceAcrossEdgesOfABentSkin) {
  for (const Kind kind : both)
    for (const double angle : {0.01, 0.1}) {
      const double fold = 2 * (angle - std::atan(2 * std::tan(angle / 2)));
      const double centre = 1 - ball + overlap;  // [m] from the axis
      const double entry = std::asin(std::sin(angle / 2) / centre) - angle / 2;
      const double second = ball - centre * std::sin(entry) / std::sin(angle / 2);
      const double jump = angle < 0.014 ? angle : std::pow(second / overlap, 1.5);
      const Crossing parts = cross_valley(kind, false, angle), faces = cross_valley(kind, true, angle);
      EXPECT_GT(parts.jump, 0.99 * jump) << angle;
      EXPECT_LT(parts.jump, kind == Kind::triangles ? 1.02 * jump : 1) << angle;
      EXPECT_LT(faces.jump, 1.01 * fold + 1.1 * step + 0.75 * fold * step / overlap) << angle;
      EXPECT_GT(faces.jump, 0.9 * step) << angle;
      EXPECT_LT(std::abs(faces.most - 1), 0.01) << angle;
      EXPECT_LT(std::abs(faces.least - 1), 0.01) << angle;
    }
}

// A flat skin whose nodes, middles too, are shifted within its plane: a sphere slides, then rolls over it (Irazabal2017
// 4.5.4) as over one quadrilateral. A history lost between parts or faces, or a part counted beside its face, shows.
TEST(DemFaces, SlidingToRollingOnADistortedFlatSkin) {
  const auto slide = [](const Skin& skin) {
    dem::Setup setup = smooth_setup();
    setup.interactions = {{0.3, 0.4, 0}};
    setup.gravity = {0, 0, -9.81};
    const auto simulation = dem_test::create(setup);
    simulation->add_mesh(skin, 0, false);
    const dem::Grain grain{.position = {0, 0.1, 0.3 - 2e-5}, .radius = 0.3, .velocity = {5, 0, 0}};
    simulation->add_grains({&grain, 1});
    simulation->advance(40000, 2e-5);
    return simulation->grains()[0];
  };
  const auto flat = [](double u, double v) { return Vec3{6.2 * u - 1, 2 * v - 1, 0}; };
  Skin plain{"plain", {{-1, -1, 0}, {5.2, -1, 0}, {5.2, 1, 0}, {-1, 1, 0}}, {{0, 1, 2, 3}}};
  const dem::Grain expected = slide(plain);
  EXPECT_NEAR(expected.velocity.x, 5.0 / 7.0 * 5, 5e-3);
  for (const Kind kind : both) {
    const dem::Grain grain = slide(second_order(kind, 12, 4, [&](double u, double v) {
      return flat(u + 0.006 * std::sin(50 * v + 30 * u), v + 0.015 * std::sin(70 * u + 20 * v));
    }));
    EXPECT_LT(norm(grain.position - expected.position), 1e-9);
    EXPECT_LT(norm(grain.velocity - expected.velocity), 1e-9);
    EXPECT_LT(norm(grain.angular_velocity - expected.angular_velocity), 1e-9);
  }
}

// Ridges and troughs of plane faces: a sphere falls on the fold, beside it, where four faces meet, and over the skin's
// end, and goes the way that it goes on the plane parts as facets. A side that counts twice, is lost between two faces,
// or goes as redundant although it is not, doubles or misses a force.
TEST(DemFaces, FoldsOfPlaneFacesAsThoseOfFacets) {
  const auto fall = [](const Skin& skin, const Vec3& start) {
    dem::Setup setup = smooth_setup();
    setup.interactions = {{0.3, 0.6, 0}};
    setup.gravity = {0, 0, -9.81};
    const auto simulation = dem_test::create(setup);
    simulation->add_mesh(skin, 0, false);
    const dem::Grain grain{.position = start, .radius = 0.2, .velocity = {0.1, 0.05, -1}};
    simulation->add_grains({&grain, 1});
    simulation->advance(6000, 2e-5);
    EXPECT_GT(simulation->energy().loss_contact_damping, 0);
    return simulation->grains()[0];
  };
  for (const Kind kind : both)
    for (const double slope : {0.5, 0.02, -0.05, -0.5}) {  // a ridge where positive
      const Skin skin = second_order(kind, 4, 2, [&](double u, double v) {
        return Vec3{2 * u - 1, 2 * v - 1, -slope * std::abs(2 * u - 1)};
      });
      for (const Vec3& at :
           {Vec3{0, 0.4, 0}, {0.03, 0.2, 0}, {-0.3, -0.3, 0}, {0, 0, 0}, {0.02, 1.05, 0}, {0.5, 1, 0}}) {
        const Vec3 start = at + Vec3{0, 0, 0.24 - slope * std::abs(at.x)};
        const dem::Grain on_faces = fall(skin, start), on_parts = fall(parts_alone(skin), start);
        EXPECT_LT(norm(on_faces.position - on_parts.position), 1e-9) << slope << ' ' << at.x << ' ' << at.y;
        EXPECT_LT(norm(on_faces.velocity - on_parts.velocity), 1e-8) << slope << ' ' << at.x << ' ' << at.y;
      }
    }
}

// A bed shaken by a skin of the second order that waves as no plane part can: what its nodes receive is what the grains
// give, force and moment, in every step; the ledger of energy closes, interface work included. On plane parts with the
// face's nodes the moment would miss by the force times their distance, 3e-4 m here.
TEST(DemFaces, ShakingSkinGivesWhatItsNodesReceive) {
  for (const Kind kind : both) {
    dem::Setup setup = smooth_setup();
    setup.materials[0].young_modulus = 5e6;
    setup.interactions = {{0.5, 0.5, 0.1}};
    setup.gravity = {0, 0, -9.81};
    const double side = 0.25, dt = 4e-5;
    const auto simulation = dem_test::create(setup);
    std::mt19937 random(11);
    std::uniform_real_distribution<double> shift(-0.003, 0.003), radius(0.015, 0.021);
    std::vector<dem::Grain> grains;
    for (int k = 0; k < 75; ++k) {
      const Vec3 p{0.05 * (k % 5 + 0.5) + shift(random), 0.05 * (k / 5 % 5 + 0.5) + shift(random),
                   0.05 * (k / 25 + 0.5) + 0.01 + shift(random)};
      grains.push_back({.position = p, .radius = radius(random), .velocity = {0.3, 0.1, 0}, .id = k});
    }
    simulation->add_grains(grains);
    for (const double x : {0.0, side}) {
      simulation->add_plane({{x, 0, 0}, {x > 0 ? -1.0 : 1.0, 0, 0}}, 0);
      simulation->add_plane({{0, x, 0}, {0, x > 0 ? -1.0 : 1.0, 0}}, 0);
    }
    const auto wave = [](double x, double y) { return 2e-3 * std::sin(60 * x + 20 * y); };
    const Skin skin = second_order(kind, 3, 3, [&](double u, double v) {
      return Vec3{side * u, side * v, wave(side * u, side * v)};
    });
    const int wall = simulation->add_mesh(skin, 0, false);
    auto target = skin.nodes;
    std::vector<Vec3> velocity(target.size()), impulse(target.size());
    const double start = simulation->energy().stored();
    double force_error = 0, moment_error = 0, passed = 0;
    for (int k = 1; k <= 4000; ++k) {
      const double omega = 2 * std::numbers::pi * 20;
      for (std::size_t n = 0; n < target.size(); ++n) {
        const double height = wave(skin.nodes[n].x, skin.nodes[n].y);
        target[n].z = height * std::cos(omega * dt * k);
        velocity[n].z = -height * omega * std::sin(omega * dt * k);
      }
      simulation->set_mesh_target(wall, target, velocity);
      simulation->advance(1, dt);
      simulation->nodal_impulse(wall, impulse);
      Vec3 total = simulation->wall_impulse_on_grains(wall), moment;
      passed = std::max(passed, norm(total));
      for (std::size_t n = 0; n < target.size(); ++n) {
        total += impulse[n];
        moment += cross(target[n], impulse[n]);
      }
      for (const auto& contact : simulation->wall_contacts())
        if (contact.wall == wall) moment += cross(contact.point, dt * contact.force);
      force_error = std::max(force_error, norm(total));
      moment_error = std::max(moment_error, norm(moment));
    }
    const base::Energy e = simulation->energy();
    EXPECT_LE(force_error, 1e-13 * passed);
    EXPECT_LE(moment_error, 1e-13 * passed * side);
    EXPECT_GT(std::abs(e.work_interface), 0.01 * e.work_gravity);
    EXPECT_LT(std::abs(e.stored() - start + e.losses() - e.works()), 1e-3 * std::abs(e.work_gravity));
  }
}
