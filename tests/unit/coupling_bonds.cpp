// Bonds, integrators and rotation schemes in scenes: read, listed, resolved, refused, and in the simulation.
#include "coupling/bonding.hpp"
#include "coupling/check.hpp"
#include "tests/unit/coupling_scene_file.hpp"

namespace {

using namespace scene_tests;

const std::string cement = R"([grains.bond]
normal_stiffness = "4 GPa/m"
shear_stiffness = "1 GPa/m"
tensile_strength = "30 MPa"
shear_strength = "20 MPa"
)";
const std::string row = R"([[grain]]
position = [0.0, 0.0, "1 m"]
radius = "20 mm"
[[grain]]
position = [0.041, 0.0, "1 m"]
radius = "20 mm"
[[grain]]
position = [0.072, 0.0, "1 m"]
radius = "10 mm"
)";
const std::string listed = "[[bond]]\nfirst = 0\nsecond = 2\ntensile_strength = \"1 MPa\"\nradius_ratio = 0.5\n";

class Bonds : public SceneFile {};

TEST_F(Bonds, ByGapAndOneByOne) {
  const Scene scene = read(grains + cement + "gap = \"1.5 mm\"\n" + row + listed + stage);
  const auto bonds = coupling::make_bonds(scene.grains->bonding, scene.grains->list);
  ASSERT_EQ(bonds.size(), 3u);
  EXPECT_EQ(bonds[0].j, 2);
  EXPECT_EQ(bonds[0].is.tensile_strength, 1e6);
  EXPECT_EQ(bonds[0].is.shear_strength, 20e6);
  EXPECT_DOUBLE_EQ(bonds[0].is.radius, 0.005);
  EXPECT_EQ(bonds[1].i, 0);
  EXPECT_EQ(bonds[1].j, 1);
  EXPECT_EQ(bonds[1].is.normal_stiffness, 4e9);
  EXPECT_DOUBLE_EQ(bonds[1].is.radius, 0.02);
  EXPECT_DOUBLE_EQ(bonds[2].is.radius, 0.01);
  // The listed bond instead of the gap's, not beside it.
  const auto near = read(grains + cement + "gap = \"20 mm\"\n" + row + listed + stage);
  EXPECT_EQ(coupling::make_bonds(near.grains->bonding, near.grains->list).size(), 3u);
  write("resolved.toml", scene.resolved_toml);
  const auto again = coupling::read_scene("resolved.toml");
  EXPECT_EQ(coupling::make_bonds(again.grains->bonding, again.grains->list).size(), 3u);
  EXPECT_NE(coupling::list_family("scene").find("cement between grains"), std::string::npos);
}

TEST_F(Bonds, MistakesHaveTheirLine) {
  EXPECT_EQ(error_of(grains + cement + row + stage),
            "a.toml:5: grains.bond; nothing is bonded; add gap, or [[bond]] with the numbers of two grains");
  EXPECT_EQ(error_of(grains + row + "[[bond]]\nfirst = 0\nsecond = 1\n" + stage),
            "a.toml:14: bond; \"normal_stiffness\" is missing; add normal_stiffness: along the bond and against "
            "bending, per area of the bond [Pa/m], or [grains.bond]");
  const auto with = [](const std::string& lines) { return error_of(grains + cement + row + lines + stage); };
  EXPECT_EQ(with("[[bond]]\nfirst = 0\nsecond = 3\n"),
            "a.toml:21: bond.second = 3; there are 3 grains given by [[grain]]; numbers start from 0");
  EXPECT_EQ(with("[[bond]]\nfirst = 1\nsecond = 1\n"),
            "a.toml:21: bond.second = 1; a grain cannot be bonded to itself; name another grain");
  EXPECT_EQ(with("[[bond]]\nfirst = 0\nsecond = 1\n[[bond]]\nfirst = 1\nsecond = 0\n"),
            "a.toml:22: bond[2]; these grains are bonded at a.toml:19 already; remove one of the two");
  EXPECT_EQ(with("[[bond]]\nfirst = 0\nsecond = 1\nshear_strength = \"2 MN\"\n"),
            "a.toml:22: bond.shear_strength = \"2 MN\"; MN is a force, must be a pressure; write a number with a unit "
            "such as Pa");
  EXPECT_EQ(
      error_of(grains + row + stage + "[[probe]]\nname = \"b\"\nkind = \"broken_bonds\"\n"),
      "a.toml:19: probe.b.kind = \"broken_bonds\"; no grains are bonded; add [grains.bond] or [[bond]], or remove "
      "the probe");
  EXPECT_EQ(error_of("[[bond]]\nfirst = 0\nsecond = 1\n" + stage + body),
            "a.toml:1: bond; there are no [grains] that it could join; add [grains], or remove it");
}

TEST_F(Bonds, PackingDoesNotKnowThem) {
  const std::string text = grains + stage + packing;
  const std::string hash = read(text).packing_hash;
  EXPECT_EQ(read(grains + cement + "gap = 0.001\n" + stage + packing).packing_hash, hash);
  EXPECT_EQ(read(text, {{"time.integrator", "symplectic_euler"}}).packing_hash, hash);
  EXPECT_EQ(read(text, {{"grains.rotation_scheme", "direct"}}).packing_hash, hash);
}

TEST_F(Bonds, CheckCountsThemAndTheirStep) {
  const auto check = [](const std::string& text) {
    write("a.toml", text);
    coupling::RunOptions options;
    options.scene = "a.toml";
    options.backend = "omp";
    return coupling::check(options);
  };
  const std::string plain = check(grains + row + stage);
  EXPECT_EQ(plain.find("bonds"), std::string::npos) << plain;
  EXPECT_EQ(plain.find("integrator"), std::string::npos) << plain;
  const std::string text =
      check(grains + cement + "gap = \"1.5 mm\"\n" + row + stage + "[time]\nintegrator = \"symplectic_euler\"\n");
  EXPECT_NE(text.find("  bonds: 2\n"), std::string::npos) << text;
  EXPECT_NE(text.find("bonds of grain 2 (1 bonds)"), std::string::npos) << text;
  EXPECT_NE(text.find("  integrator: symplectic Euler\n"), std::string::npos) << text;
}

TEST_F(Bonds, IntegratorsAndRotationSchemes) {
  const std::string text = grains + row + stage;
  const Scene plain = read(text);
  EXPECT_EQ(plain.time.integrator, dem::TimeScheme::velocity_verlet);
  EXPECT_EQ(plain.grains->rotation_scheme, dem::kernels::RotationScheme::quaternion);
  EXPECT_NE(plain.resolved_toml.find("integrator = \"velocity_verlet\""), std::string::npos);
  EXPECT_NE(plain.resolved_toml.find("rotation_scheme = \"quaternion\""), std::string::npos);
  EXPECT_EQ(read(text, {{"time.integrator", "symplectic_euler"}}).time.integrator, dem::TimeScheme::symplectic_euler);
  EXPECT_EQ(read(text, {{"grains.rotation_scheme", "runge_kutta"}}).grains->rotation_scheme,
            dem::kernels::RotationScheme::runge_kutta);
  EXPECT_EQ(read(text, {{"grains.rotation_scheme", "direct"}}).grains->rotation_scheme,
            dem::kernels::RotationScheme::direct);
  EXPECT_EQ(error_of(text, {{"time.integrator", "verlet"}}),
            "--set: time.integrator = \"verlet\"; must be one of: velocity_verlet, symplectic_euler");
}

}  // namespace
