// Contact laws in scenes: every row of the DEM's tables can be chosen, with the constants it reads and no others.
#include "coupling/contact_tables.hpp"
#include "tests/unit/coupling_scene_file.hpp"

namespace {

using namespace scene_tests;

const std::string elastic = R"([grains]
material = { young_modulus = "16.8 GPa", poisson_ratio = 0.2, density = "2700 kg/m3" }
friction = 0.6
)";
const std::string floor_wall = R"([[wall]]
name = "floor"
plane = { point = [0,0,0], normal = [0,0,1] }
)";
const std::string springs = "normal_stiffness = \"2 MN/m\"\nshear_stiffness = \"1 kN/mm\"\n";

/// Values inside every constant's range.
const std::map<std::string, std::string> some_value{
    {"restitution", "0.4"},      {"normal_stiffness", "2e6"}, {"shear_stiffness", "1e6"},
    {"normal_viscosity", "30"},  {"shear_viscosity", "20"},   {"dissipative_coefficient", "1e-6"},
    {"damping_mode", "2"},       {"critical_stress", "1e6"},  {"friction_exponent", "-0.05"},
    {"rolling_friction", "0.2"}, {"rolling_damping", "0.3"}};

class Contacts : public SceneFile {};

TEST_F(Contacts, EveryLawWithEveryRollingModelReadsIsListedAndMakesASimulation) {
  for (const auto& law : dem::contact_law_texts()) {
    EXPECT_NE(coupling::list_family("laws").find(std::string(law.text)), std::string::npos) << law.name;
    for (const auto& rolling : dem::rolling_model_texts()) {
      std::string text =
          elastic + "law = \"" + std::string(law.name) + "\"\nrolling = \"" + std::string(rolling.name) + "\"\n";
      for (const auto& [name, value] : some_value)
        if (coupling::reads(law, name) || coupling::reads(rolling, name)) text += name + " = " + value + "\n";
      const Scene scene = read(text + one_grain + floor_wall + stage);
      ASSERT_EQ(scene.grains->interactions.size(), 4u);
      const dem::Interaction& contact = scene.grains->interactions[0];
      EXPECT_EQ(contact.law, law.name);
      EXPECT_EQ(contact.rolling, rolling.name);
      EXPECT_EQ(contact.damping_mode, coupling::reads(law, "damping_mode") ? 2 : 0);
      EXPECT_EQ(contact.normal_stiffness, coupling::reads(law, "normal_stiffness") ? 2e6 : 0);
      EXPECT_EQ(contact.rolling_damping, coupling::reads(rolling, "rolling_damping") ? 0.3 : 0);
      EXPECT_EQ(scene.grains->interactions[1], contact) << "a wall is as the grains are";
      dem::Setup setup;
      setup.materials = scene.grains->materials;
      setup.interactions = scene.grains->interactions;
      EXPECT_NO_THROW(dem::Simulation::create(setup, dem::Backend::omp)) << text;
      write("resolved.toml", scene.resolved_toml);  // no constant is written that the law would refuse
      EXPECT_EQ(coupling::read_scene("resolved.toml").grains->interactions, scene.grains->interactions);
    }
  }
}

TEST_F(Contacts, MissingConstantsAreNamed) {
  const std::string rest = one_grain + stage;
  EXPECT_EQ(error_of(elastic + rest),
            "a.toml:1: grains; \"restitution\" is missing: law = \"hertz_mindlin\" reads it; add restitution: normal "
            "coefficient of restitution; 1: no damping");
  EXPECT_EQ(
      error_of(elastic + "law = \"linear\"\nrestitution = 1\n" + rest),
      "a.toml:1: grains; \"normal_stiffness\" is missing: law = \"linear\" reads it; add normal_stiffness: spring "
      "along the normal [N/m]");
  EXPECT_EQ(error_of(grains + "rolling = \"type_a\"\n" + rest),
            "a.toml:1: grains; \"rolling_friction\" is missing: rolling = \"type_a\" reads it; add rolling_friction: "
            "rolling friction, Irazabal2017 5.3; 0: none");
  EXPECT_EQ(error_of(grains + rest + floor_wall + "law = \"viscoelastic\"\n"),
            "a.toml:11: wall.floor; \"dissipative_coefficient\" is missing: law = \"viscoelastic\" reads it; add "
            "dissipative_coefficient: A of viscoelastic spheres [s]");
}

TEST_F(Contacts, ConstantsThatNothingReadsAreRefused) {
  const std::string rest = one_grain + stage;
  EXPECT_EQ(error_of(grains + "damping_mode = 1\n" + rest),
            "a.toml:5: grains.damping_mode = 1; law = \"hertz_mindlin\" does not read it; remove it, or choose one of: "
            "hysteretic");
  EXPECT_EQ(error_of(grains + "rolling_damping = 0.3\nrolling_friction = 0.2\n" + rest),
            "a.toml:5: grains.rolling_damping = 0.3; rolling = \"brof\" does not read it; remove it, or choose one of: "
            "type_c");
  EXPECT_EQ(
      error_of(grains + "rolling = \"none\"\nrolling_friction = 0.2\n" + rest),
      "a.toml:6: grains.rolling_friction = 0.2; rolling = \"none\" does not read it; remove it, or choose one of: "
      "type_a, type_c, brof");
  const std::string linear = grains + "law = \"linear\"\n" + springs;
  EXPECT_EQ(error_of(linear + rest + floor_wall + "material = { young_modulus = 1e9, poisson_ratio = 0.3 }\n"),
            "a.toml:17: wall.floor.material; law = \"linear\" reads no "
            "elastic constants; remove it, or choose one of: hertz_mindlin, stress_friction, hysteretic, viscoelastic");
  EXPECT_EQ(
      error_of(linear + stage + packing),
      "a.toml:13: packing.young_modulus = 240000000.0; law = \"linear\" reads no elastic constants; remove it, or "
      "choose one of: hertz_mindlin, stress_friction, hysteretic, viscoelastic");
  EXPECT_EQ(error_of(grains + "rolling = \"none\"\n" + stage + packing.substr(0, packing.find("[[")) +
                     "rolling_friction = 0.0\n" + packing.substr(packing.find("[["))),
            "a.toml:12: packing.rolling_friction = 0.0; grains.rolling = \"none\" has no rolling friction; remove it");
}

TEST_F(Contacts, UnknownLawsRangesAndUnits) {
  const auto with = [](const std::string& line) { return error_of(grains + line + "\n" + one_grain + stage); };
  EXPECT_EQ(with("law = \"hertz_mindlim\""),
            "a.toml:5: grains.law = \"hertz_mindlim\"; must be one of: hertz_mindlin, stress_friction, hysteretic, "
            "viscoelastic, linear, voigt_slider; did you mean \"hertz_mindlin\"?");
  EXPECT_EQ(
      with("rolling = \"typ_c\""),
      "a.toml:5: grains.rolling = \"typ_c\"; must be one of: none, type_a, type_c, brof; did you mean \"type_c\"?");
  EXPECT_EQ(
      with("law = \"linear\"\nnormal_stiffness = \"2 MN\""),
      "a.toml:6: grains.normal_stiffness = \"2 MN\"; MN is a force, must be a stiffness; write a number with a unit "
      "such as N/m");
  EXPECT_EQ(with("law = \"hysteretic\"\ndamping_mode = 3"), "a.toml:6: grains.damping_mode = 3; must be in [0, 2]");
  EXPECT_EQ(with("law = \"stress_friction\"\nfriction_exponent = 0.1"),
            "a.toml:6: grains.friction_exponent = 0.1; must be <= 0");
  EXPECT_EQ(
      with("law = \"linear\"\nnormal_stiffness = 1e6\nshear_stiffness = 0.0\nrolling = \"type_c\"\n"
           "rolling_friction = 0.1\nrolling_damping = 0.3"),
      "a.toml:7: grains.shear_stiffness = 0.0; rolling = \"type_c\" needs it > 0 N/m; raise it, or choose another "
      "rolling");
}

TEST_F(Contacts, AWallMayTouchByAnotherLaw) {
  const Scene scene = read(grains + one_grain + stage + floor_wall + "law = \"linear\"\n" + springs + body);
  const auto& part = *scene.grains;
  const auto with_grains = [&](int material) { return part.interactions.at(static_cast<std::size_t>(material)); };
  EXPECT_EQ(with_grains(0).law, "hertz_mindlin");
  EXPECT_EQ(with_grains(part.walls.at(0).material).law, "linear");
  EXPECT_EQ(with_grains(part.walls[0].material).shear_stiffness, 1e6);
  EXPECT_EQ(with_grains(part.walls[0].material).restitution, 0.4) << "what linear reads and the wall does not state";
  EXPECT_EQ(with_grains(part.body_material.at("beam")).law, "hertz_mindlin");
}

TEST_F(Contacts, PackingHashFollowsTheLaw) {
  const std::string text = grains + stage + packing;
  const std::string hash = read(text).packing_hash;
  EXPECT_NE(read(text, {{"grains.law", "hysteretic"}, {"grains.damping_mode", "1"}}).packing_hash, hash);
  EXPECT_NE(read(text, {{"grains.rolling", "type_a"}, {"grains.rolling_friction", "0.1"}}).packing_hash, hash);
}

}  // namespace
