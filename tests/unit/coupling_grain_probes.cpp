// Probes of grains in a region: what a scene may say, what it is told when wrong, what they measure; the tables that a
// run writes of its grains.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "coupling/grain_files.hpp"
#include "coupling/grain_probes.hpp"
#include "coupling/measure.hpp"
#include "tests/unit/coupling_scene_file.hpp"

namespace {

using namespace scene_tests;
using coupling::GrainCopies;
using coupling::Probe;
using coupling::ProbeKind;
using coupling::StressPart;
using coupling::Vec3;

std::string probe(const std::string& kind, const std::string& rest) {
  return "[[probe]]\nname = \"p\"\nkind = \"" + kind + "\"\n" + rest + "\n";
}
const std::string box = "box = { lower = [0.0, 0.0, 0.0], upper = [1.0, 2.0, 3.0] }";
const std::string ball = "centre = [0.0, 0.0, 1.0]\nradius = \"134 mm\"";

class GrainProbes : public SceneFile {
 protected:
  static Probe read_probe(const std::string& kind, const std::string& rest) {
    return read(grains + one_grain + stage + probe(kind, rest)).probes.at(0);
  }
  static std::string error(const std::string& kind, const std::string& rest) {
    return error_of(grains + one_grain + stage + probe(kind, rest));
  }
};

TEST_F(GrainProbes, BoxesAndMeasurementSpheres) {
  for (const char* kind : {"porosity", "coordination", "rattlers", "mechanical_coordination", "contact_force_mean",
                           "contact_force_quantile", "strong_contacts", "stress"}) {
    const auto in_box = read_probe(kind, box).look.region;
    ASSERT_TRUE(in_box) << kind;
    EXPECT_DOUBLE_EQ(dem::volume(*in_box), 6) << kind;
    const auto in_ball = read_probe(kind, ball).look.region;
    ASSERT_TRUE(in_ball) << kind;
    EXPECT_DOUBLE_EQ(std::get<dem::BallRegion>(*in_ball).radius, 0.134) << kind;
  }
  EXPECT_FALSE(read_probe("contact_force_mean", "").look.region);  // all contacts
  EXPECT_FALSE(read_probe("passing", "size = \"40 mm\"").look.region);
}

TEST_F(GrainProbes, Parameters) {
  EXPECT_EQ(read_probe("rattlers", box).look.fewest, 2);
  EXPECT_EQ(read_probe("rattlers", box + "\nfewest = 4").look.fewest, 4);
  EXPECT_EQ(read_probe("contact_force_quantile", "share = 0.5\nwalls = true").look.share, 0.5);
  EXPECT_TRUE(read_probe("contact_force_quantile", "share = 0.5\nwalls = true").look.walls);
  EXPECT_EQ(read_probe("stress", box).look.stress, StressPart::zz);
  EXPECT_EQ(read_probe("stress", box + "\ncomponent = \"von_mises\"").look.stress, StressPart::von_mises);
  EXPECT_EQ(read_probe("stress", box).unit, "Pa");
  const auto heap = read_probe("heap_angle", "axis = \"x\"\nfloor = \"10 mm\"\nvalue = \"scatter\"").look;
  EXPECT_EQ(heap.heap.axis, dem::HeapView::x);
  EXPECT_DOUBLE_EQ(*heap.heap.floor, 0.01);
  EXPECT_FALSE(heap.heap.centre);
  EXPECT_TRUE(heap.scatter);
  EXPECT_EQ(read_probe("passing", "size = \"40 mm\"").look.sieve, 0.04);
  const auto near = read_probe("grain_displacement", "point = [0.0, 0.0, 1.0]");
  EXPECT_EQ(near.point->z, 1);
  EXPECT_EQ(near.unit, "m");
}

TEST_F(GrainProbes, Messages) {
  EXPECT_EQ(error("porosity", ""),
            "a.toml:11: probe.p; \"box\" or \"centre\" is missing; add box, or centre and radius");
  EXPECT_EQ(error("stress", "radius = 1.0"),
            "a.toml:11: probe.p; \"centre\" is missing; add centre, or give a box instead");
  EXPECT_EQ(error("rattlers", "centre = [0.0, 0.0, 0.0]"),
            "a.toml:11: probe.p; \"radius\" is missing; add radius, or give a box instead");
  EXPECT_EQ(error("porosity", box + "\n" + ball),
            "a.toml:15: probe.p.centre = [0.0, 0.0, 1.0]; stands beside box; give one of the two");
  EXPECT_EQ(
      error("stress", box + "\ncomponent = \"xz\""),
      "a.toml:15: probe.p.component = \"xz\"; must be one of: xx, yy, zz, xy, yz, zx, pressure, von_mises; did you "
      "mean \"xx\"?");
  EXPECT_EQ(error("grain_position", ""), "a.toml:11: probe.p; \"grain\" or \"point\" is missing; add grain or point");
  EXPECT_EQ(error("grain_position", "grain = 0\npoint = [0.0, 0.0, 0.0]"),
            "a.toml:15: probe.p.point = [0.0, 0.0, 0.0]; stands beside grain; give one of the two");
  EXPECT_EQ(error("rattlers", box + "\nfewest = 0"), "a.toml:15: probe.p.fewest = 0; must be >= 1");
}

TEST_F(GrainProbes, ResolvedSceneReadsBack) {
  const std::string text = grains + one_grain + stage + probe("stress", ball + "\ncomponent = \"pressure\"");
  const std::string resolved = read(text).resolved_toml;
  const Probe again = read(resolved).probes.at(0);
  EXPECT_EQ(again.look.stress, StressPart::pressure);
  EXPECT_DOUBLE_EQ(std::get<dem::BallRegion>(*again.look.region).radius, 0.134);
}

TEST_F(GrainProbes, NamedGradings) {
  const std::string scene =
      grains + stage + "[[wall]]\nname = \"floor\"\nplane = { point = [0,0,0], normal = [0,0,1] }\n";
  const auto graded = [&](const std::string& grading) {
    return scene + "[packing]\ngrading = " + grading +
           "\n[[packing.layer]]\nbox = { lower = [0.0, 0.0, 0.0], upper = [1.0, 1.0, 0.3] }\n";
  };
  const Scene named = read(graded("\"en13450_a\""));
  const auto& rows = named.grains->packing->grading;
  ASSERT_EQ(rows.size(), 5u);
  EXPECT_DOUBLE_EQ(rows[2].size, 0.040);
  EXPECT_DOUBLE_EQ(rows[2].passing, 0.475);
  // By name or by its pairs it is the same packing.
  const Scene spelled = read(graded("[[0.0224, 0.015], [0.0315, 0.125], [0.04, 0.475], [0.05, 0.85], [0.063, 1.0]]"));
  EXPECT_EQ(named.packing_hash, spelled.packing_hash);
  EXPECT_EQ(read(named.resolved_toml).packing_hash, named.packing_hash);
  EXPECT_EQ(
      error_of(graded("\"en13450\"")),
      "a.toml:12: packing.grading = \"en13450\"; must be one of: en13450_a, en13450_a_fine, en13450_a_coarse; did "
      "you mean \"en13450_a\"?");
  EXPECT_NE(coupling::list_family("gradings").find("en13450_a_coarse: "), std::string::npos);
}

/// Two spheres of 10 mm radius, one on the other, both dented: r = 10 mm, overlap 1 % of it.
class TwoGrains {
 public:
  TwoGrains() {
    dem::Setup setup;
    setup.materials = {{"stone", 1e9, 0.2, 2700}};
    setup.interactions = {{0.5, 0.5, 0}};
    simulation_ = dem::Simulation::create(setup, dem::Backend::omp);
    std::vector<dem::Grain> both(2);
    for (int k = 0; k < 2; ++k) {
      both[static_cast<std::size_t>(k)].id = k;
      both[static_cast<std::size_t>(k)].radius = radius;
      both[static_cast<std::size_t>(k)].position = {0, 0, radius - dent + k * (2 * radius - dent)};
    }
    simulation_->add_grains(both);
    simulation_->add_plane({{0, 0, 0}, {0, 0, 1}}, 0);
    simulation_->advance(0, 1e-7);
  }
  double measure(ProbeKind kind, const coupling::GrainProbe& look) const {
    Probe probe;
    probe.kind = kind;
    probe.look = look;
    GrainCopies copies(simulation_.get());
    return coupling::measure_grains(probe, copies, {});
  }
  static constexpr double radius = 0.01, dent = 1e-4;

 private:
  std::unique_ptr<dem::Simulation> simulation_;
};

// Hertz: F = 4/3 E* sqrt(R*) d^1.5 between the two, E* = E / (2 (1 - nu^2)), R* = r/2. Compressed, so the stress is
// negative; over 20 mm x 20 mm the middle contact alone gives -F / area.
TEST_F(GrainProbes, ForcesAndStressOfTwoGrains) {
  const TwoGrains two;
  const double force = 4.0 / 3.0 * 1e9 / (2 * 0.96) * std::sqrt(0.5 * two.radius) * std::pow(two.dent, 1.5);
  const double middle = two.radius - two.dent + 0.5 * (2 * two.radius - two.dent);
  coupling::GrainProbe look;
  EXPECT_NEAR(two.measure(ProbeKind::contact_force_mean, look) / force, 1, 1e-9);
  look.region = dem::BoxRegion{{-0.01, -0.01, middle - 0.002}, {0.01, 0.01, middle + 0.002}};
  EXPECT_NEAR(two.measure(ProbeKind::stress, look) / (-force / 4e-4), 1, 1e-9);
  look.stress = StressPart::pressure;
  EXPECT_NEAR(two.measure(ProbeKind::stress, look) / (force / 4e-4 / 3), 1, 1e-9);
  look.region = dem::BoxRegion{{-1, -1, -1}, {1, 1, 1}};
  EXPECT_EQ(two.measure(ProbeKind::rattlers, look), 0.5);  // the upper has one contact, the lower also the floor
  EXPECT_EQ(two.measure(ProbeKind::mechanical_coordination, look), 1);
  EXPECT_EQ(two.measure(ProbeKind::coordination, look), 1);
  look.sieve = 0.0199;
  EXPECT_EQ(two.measure(ProbeKind::passing, look), 0);
  look.sieve = 0.0201;
  EXPECT_EQ(two.measure(ProbeKind::passing, look), 1);
}

// A sphere of radius a in the middle of a measurement sphere of radius b leaves 1 - (a/b)^3.
TEST_F(GrainProbes, PorosityOfAMeasurementSphere) {
  const std::vector<dem::GrainSphere> one{{{0, 0, 0}, 0.5, 1}, {{0, 0, 0}, 0.5, 1}};  // the same place counts once
  EXPECT_NEAR(coupling::porosity(one, dem::Region(dem::BallRegion{{0, 0, 0}, 1}), 0.02), 1 - 0.125, 1e-3);
  // Equal balls a distance a apart share the lens 5/12 pi a^3: 5/16 of each.
  EXPECT_NEAR(coupling::porosity(one, dem::Region(dem::BallRegion{{0.5, 0, 0}, 0.5}), 0.01), 1 - 5.0 / 16, 2e-3);
}

TEST_F(GrainProbes, NearestGrain) {
  std::vector<dem::Grain> list(3);
  for (int k = 0; k < 3; ++k) {
    list[static_cast<std::size_t>(k)].id = 10 + k;
    list[static_cast<std::size_t>(k)].position = {1.0 * k, 0, 0};
  }
  Probe probe;
  probe.grain = 12;
  EXPECT_EQ(coupling::mark_grain(probe, list).id, 12);
  probe.point = Vec3{0.8, 0.3, 0};
  EXPECT_EQ(coupling::mark_grain(probe, list).id, 11);
  EXPECT_EQ(coupling::mark_grain(probe, list).start.x, 1);
}

TEST_F(GrainProbes, SieveCurveFile) {
  Scene scene = read(grains + one_grain + stage + "[output]\nsieves = [\"30 mm\", \"40 mm\"]\n");
  EXPECT_EQ(coupling::sieve_curve_text(scene, scene.grains->list), "size [m],passing [-]\n0.03,0\n0.04,1\n");
  scene.output.sieves.clear();
  EXPECT_EQ(coupling::sieve_curve_text(scene, scene.grains->list), "");  // nobody asked
  scene.grains->packing.emplace().grading = {{0.02, 0}, {0.06, 1}};
  EXPECT_EQ(coupling::sieve_curve_text(scene, scene.grains->list),
            "size [m],passing [-],asked [-]\n0.02,0,0\n0.06,1,1\n");
}

TEST_F(GrainProbes, ContactForcesFile) {
  std::vector<dem::GrainContact> contacts(2, {1, 2, {0, 0, 0}, {0, 0, 1}, {0, 0, -3}, 0});
  contacts[1].force.z = -1;
  const std::string text = coupling::contact_forces_text(contacts, {});
  EXPECT_EQ(text.substr(0, text.find('\n')),
            "force_over_mean_from [-],force_over_mean_to [-],normal_density [-],shear_density [-]");
  EXPECT_NE(text.find("\n0.5,0.6,5,0\n"), std::string::npos) << text;  // half of the contacts: 0.5 / 0.1
  EXPECT_NE(text.find("\n1.5,1.6,5,0\n"), std::string::npos) << text;
}

}  // namespace
