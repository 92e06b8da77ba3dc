// Scene files: what is read, and every message a wrong scene gives, by its text.
#include <gtest/gtest.h>

#include <regex>

#include "tests/unit/coupling_scene_file.hpp"

namespace {

using namespace scene_tests;

const std::string wait = R"([[stage]]
name = "wait"
duration = "20 ms"
measure = false
)";

TEST_F(SceneFile, OneGrainWithDefaults) {
  const Scene scene = read(grains + one_grain + stage);
  ASSERT_TRUE(scene.has_grains());
  EXPECT_FALSE(scene.has_bodies());
  EXPECT_EQ(scene.grains->materials.at(0).young_modulus, 16.8e9);
  EXPECT_EQ(scene.grains->interactions.at(0).friction, 0.6);
  EXPECT_EQ(scene.grains->interactions.at(0).rolling_friction, 0);
  EXPECT_EQ(scene.grains->list.at(0).position.z, 1);
  EXPECT_EQ(scene.grains->list.at(0).radius, 0.02);
  EXPECT_EQ(scene.gravity.z, -9.81);
  EXPECT_EQ(scene.time.fem_fraction, 0.9);
  EXPECT_EQ(scene.stages.at(0).duration, 0.01);
  EXPECT_TRUE(scene.stages.at(0).measure);  // the first, as none is named
  EXPECT_EQ(scene.packing_hash, "");
}

TEST_F(SceneFile, GrainsOnAGrid) {
  const auto grid = [](const std::string& rest) { return grains + one_grain + rest + stage; };
  const auto list = read(grid("repeat = [3.0, 1.0, 2.0]\nspacing = [0.5, 0.0, 0.25]\n")).grains->list;
  ASSERT_EQ(list.size(), 6u);
  for (int k = 0; k < 6; ++k) {
    EXPECT_EQ(list[k].id, k);
    EXPECT_EQ(list[k].position.x, 0.5 * (k % 3));
    EXPECT_EQ(list[k].position.y, 0);
    EXPECT_EQ(list[k].position.z, 1 + 0.25 * (k / 3));
    EXPECT_EQ(list[k].radius, 0.02);
  }
  const std::string head = "a.toml:8: grain.repeat = ";
  EXPECT_EQ(error_of(grid("repeat = [2.5, 1.0, 1.0]\nspacing = [0.5, 0.0, 0.0]\n")),
            head + "[2.5, 1.0, 1.0]; is no number of grains; give whole numbers from 1 on for x, y, z");
  EXPECT_EQ(error_of(grid("repeat = [2.0, 1.0, 3.0]\nspacing = [0.5, 0.0, 0.0]\n")),
            head +
                "[2.0, 1.0, 3.0]; and spacing do not fit along z; give a spacing where there is more than one grain, "
                "and 0 elsewhere");
}

TEST_F(SceneFile, SkinsAndWallsMeetGrainsAsGrainsDoUnlessToldOtherwise) {
  const Scene scene =
      read(grains + one_grain + stage + body + "[body.contact]\nfriction = 0.3\n" +
           "[[wall]]\nname = \"floor\"\nplane = { point = [0,0,0], normal = [0,0,2] }\nrestitution = 1.0\n");
  const auto& part = *scene.grains;
  ASSERT_EQ(part.materials.size(), 3u);
  const int floor = part.walls.at(0).material, beam = part.body_material.at("beam");
  EXPECT_EQ(part.materials.at(floor).young_modulus, 16.8e9);
  EXPECT_EQ(part.materials.at(beam).young_modulus, 45e9);  // the body's own
  EXPECT_EQ(part.walls[0].plane->normal.z, 1);
  for (const int order : {0, 1}) {  // symmetric
    const auto with = [&](int other) { return part.interactions.at(order ? other * 3 : other); };
    EXPECT_EQ(with(floor).restitution, 1);
    EXPECT_EQ(with(floor).friction, 0.6);
    EXPECT_EQ(with(beam).friction, 0.3);
    EXPECT_EQ(with(beam).restitution, 0.4);
  }
}

TEST_F(SceneFile, HistoryBeginsWithItsStage) {  // 20 ms of waiting, then the step 1 ms into the stage
  const Scene scene = read(wait + stage + body);
  const auto& load = scene.bodies.at(0).loads.at(0);
  EXPECT_EQ(load.kind, fem::LoadKind::nodal_total);
  EXPECT_EQ(load.history->value(0.0209), 0);
  EXPECT_EQ(load.history->value(0.0211), 200);
  EXPECT_EQ(scene.bodies[0].supports.at(0).fixed, (std::array<bool, 3>{true, false, true}));
}

TEST_F(SceneFile, ResultsAreShownInTheirUnit) {
  const std::string probes = R"([[probe]]
name = "w"
kind = "displacement"
body = "beam"
group = "x_max"
scale = -1.0
[[probe]]
name = "q"
kind = "load"
load = "tip"
)";
  const Scene scene =
      read(stage + body + probes +
           "[[result]]\nname = \"peak\"\nprobe = \"w\"\ntake = \"max\"\nunit = \"um\"\nexpected = \"176 um\"\n" +
           "[[result]]\nname = \"k\"\nprobe = \"q\"\ntake = \"ratio\"\nover = \"w\"\n"
           "expected_range = [\"50 kN/mm\", 1.5e8]\n");
  EXPECT_DOUBLE_EQ(*scene.results.at(0).expected, 176e-6);
  EXPECT_EQ(scene.results[0].unit, "um");
  EXPECT_EQ(scene.results.at(1).unit, "N/m");
  EXPECT_EQ((*scene.results[1].expected_range)[0], 50e6);
  EXPECT_EQ(error_of(stage + body + probes + "[[result]]\nname = \"k\"\nprobe = \"w\"\nunit = \"kN\"\n"),
            "a.toml:35: result.k.unit = \"kN\"; is a force, the value is a length; use a unit such as m");
}

TEST_F(SceneFile, EveryMistakeHasItsLineItsRuleAndItsRemedy) {
  const auto replaced = [](std::string text, const std::string& from, const std::string& to) {
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
  };
  const std::string scene = grains + one_grain + stage;
  EXPECT_EQ(error_of(scene), "no error");
  EXPECT_EQ(error_of(replaced(scene, "friction", "frction")),
            "a.toml:3: grains.frction = 0.6; unknown key; did you mean \"friction\"?");
  EXPECT_EQ(error_of(replaced(scene, "[grains]", "[grians]")),
            "a.toml:1: grians; unknown key; did you mean \"grains\"?");
  EXPECT_EQ(error_of(replaced(scene, "\"16.8 GPa\"", "\"16.8 mm\"")),
            "a.toml:2: grains.material.young_modulus = \"16.8 mm\"; mm is a length, must be a pressure; write a number "
            "with a unit such as Pa");
  EXPECT_EQ(error_of(replaced(scene, "poisson_ratio = 0.2", "poisson_ratio = 2.0")),
            "a.toml:2: grains.material.poisson_ratio = 2.0; must be in (-1, 0.5]");
  EXPECT_EQ(error_of(replaced(scene, "radius = \"20 mm\"", "radius = 0")), "a.toml:7: grain.radius = 0; must be > 0 m");
  EXPECT_EQ(error_of(replaced(scene, "friction = 0.6\n", "")),
            "a.toml:1: grains; \"friction\" is missing; add friction: Coulomb coefficient");
  EXPECT_EQ(error_of(grains + stage),
            "a.toml:1: grains; there are no grains; add [packing] or [[grain]], or remove [grains]");
  EXPECT_EQ(error_of(one_grain + stage),
            "a.toml:1: grain; there are no [grains] that it could belong to; add [grains], or remove it");
  EXPECT_EQ(error_of(grains + one_grain), "a.toml: \"stage\" is missing; add stage: what happens, in order");
  EXPECT_EQ(error_of(stage), "a.toml: nothing to simulate; add [grains] or [[body]]");
  EXPECT_EQ(error_of(scene + stage),
            "a.toml:12: stage.fall.name = \"fall\"; a stage of this name stands at a.toml:9; rename one");
  EXPECT_EQ(error_of(scene + "hold = [\"sleeper\"]\n"),
            "a.toml:11: stage.fall.hold = \"sleeper\"; no such body; known bodies: none");
  EXPECT_EQ(error_of(scene + "ramp_stiffness = true\n"),
            "a.toml:11: stage.fall.ramp_stiffness = true; there is no packing whose modulus could be ramped; remove "
            "it, or add "
            "[packing]");
  EXPECT_EQ(error_of(replaced(wait, "false", "true") + scene + "measure = true\n"),
            "a.toml:15: stage.fall.measure = true; the measuring starts already at a.toml:4; set measure in one stage "
            "only");
}

TEST_F(SceneFile, BrokenSyntaxAndMissingFiles) {
  EXPECT_EQ(error_of("[grains\nfriction = 1\n").substr(0, 26), "a.toml:1: not valid TOML: ");
  try {
    coupling::read_scene("b.toml");
    FAIL();
  } catch (const base::UserError& error) {
    EXPECT_STREQ(error.what(), "b.toml: no such scene file; give the path of a .toml file");
  }
  write("c.toml", "include = \"nowhere.toml\"\n");
  EXPECT_THROW(coupling::read_scene("c.toml"), base::UserError);
  write("c.toml", "include = \"c.toml\"\n");
  try {
    coupling::read_scene("c.toml");
    FAIL();
  } catch (const base::UserError& error) {
    EXPECT_STREQ(error.what(), "c.toml: the file includes itself; break the circle of includes");
  }
}

TEST_F(SceneFile, BodyMistakes) {
  const auto with = [](const std::string& from, const std::string& to) {
    std::string text = stage + body;
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return error_of(text.replace(at, from.size(), to));
  };
  EXPECT_EQ(with("\"box.geo\"", "\"bx.geo\""),
            "a.toml:6: body.beam.mesh = \"bx.geo\"; no such file: " + fs::absolute("bx.geo").string() +
                "; give a path relative to the folder of a.toml");
  EXPECT_EQ(with("length = 2.0", "lenght = 2.0"),
            "a.toml:7: body.beam.mesh_parameters.lenght = 2.0; no such parameter in " +
                fs::absolute("box.geo").string() + "; did you mean \"length\"?");
  EXPECT_EQ(with("poisson_ratio = 0.167", "poisson_ratio = 0.5"),
            "a.toml:11: body.beam.material.poisson_ratio = 0.5; must be in (-1, 0.5)");
  EXPECT_EQ(with("fix = [\"x\", \"z\"]", "fix = [\"w\"]"),
            "a.toml:15: body.beam.support.fix = \"w\"; must be one of: x, y, z");
  EXPECT_EQ(
      with("nodal_total", "nodal"),
      "a.toml:19: body.beam.load.tip.kind = \"nodal\"; must be one of: face_total, nodal_total, traction, pressure");
  EXPECT_EQ(with("\"200 N\"", "\"200 Pa\""),
            "a.toml:21: body.beam.load.tip.history.value = \"200 Pa\"; Pa is a pressure, must be a force; write a "
            "number with "
            "a unit such as N");
  EXPECT_EQ(with("start_stage = \"fall\"", "start_stage = \"fal\""),
            "a.toml:21: body.beam.load.tip.history.start_stage = \"fal\"; no such stage; did you mean \"fall\"?");
  EXPECT_EQ(with("[0.0, 0.0, -1.0]", "[0.0, 0.0, 0.0]"),
            "a.toml:20: body.beam.load.tip.direction = [0.0, 0.0, 0.0]; must not be zero; give a direction");
  EXPECT_EQ(with("name = \"beam\"", "name = \"beam\"\nelement = \"hex9\"").substr(0, 64),
            "a.toml:6: body.beam.element = \"hex9\"; must be one of: hex8, hex8");
}

const std::string soil = R"([[body]]
name = "soil"
mesh = "box.geo"
element = "hex20_reduced"
stiffness_damping = "2 us"
[[body.material]]
law = "drucker_prager"
young_modulus = "60 MPa"
poisson_ratio = 0.3
density = "2000 kg/m3"
cohesion = "20 kPa"
friction_angle = "30 deg"
fit = "inner"
shear_viscosity = "3 kPa s"
[[body.motion]]
name = "shake"
group = "x_min"
kind = "velocity"
along = ["x", "z"]
history = { kind = "constant", value = "2 mm/s" }
[[body.absorbing]]
group = "x_max"
[[body.load]]
name = "foot"
group = "z_max"
kind = "pressure"
history = { kind = "constant", value = "5 kPa" }
[[body.periodic]]
first = "y_min"
second = "y_max"
)";

TEST_F(SceneFile, LawsMotionsAndAbsorbingSides) {
  const Scene scene = read(stage + soil);
  const auto& read_body = scene.bodies.at(0);
  EXPECT_EQ(read_body.stiffness_damping, 2e-6);
  const auto& material = read_body.materials.at(0);
  EXPECT_EQ(material.law, "drucker_prager");
  EXPECT_EQ(material.cohesion, 20e3);
  EXPECT_NEAR(material.friction_angle, 0.5235987755982988, 1e-15);
  EXPECT_EQ(material.dilation_angle, 0);
  EXPECT_EQ(material.fit, "inner");
  EXPECT_EQ(material.shear_viscosity, 3e3);
  EXPECT_EQ(material.bulk_viscosity, 0);
  const auto& motion = read_body.motions.at(0);
  EXPECT_EQ(motion.kind, fem::PrescribedMotion::Kind::velocity);
  EXPECT_EQ(motion.along, (std::array<bool, 3>{true, false, true}));
  EXPECT_EQ(motion.history->value(1), 2e-3);
  EXPECT_EQ(read_body.absorbing.at(0).group, "x_max");
  EXPECT_EQ(read_body.absorbing.at(0).origin, "a.toml:24");
  EXPECT_EQ(read_body.loads.at(0).kind, fem::LoadKind::pressure);
  EXPECT_EQ(read_body.periodic.at(0).first, "y_min");
  EXPECT_EQ(read_body.periodic.at(0).second, "y_max");
}

TEST_F(SceneFile, LawAndMotionMistakes) {
  const auto with = [](const std::string& from, const std::string& to) {
    std::string text = stage + soil;
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return error_of(text.replace(at, from.size(), to));
  };
  EXPECT_EQ(with("\"drucker_prager\"", "\"druker_prager\""),
            "a.toml:10: body.soil.material.law = \"druker_prager\"; must be one of: linear_elastic, kelvin_voigt, "
            "left_cauchy_green, drucker_prager; did you mean \"drucker_prager\"?");
  EXPECT_EQ(with("\"drucker_prager\"", "\"kelvin_voigt\"").substr(0, 33), "a.toml:14: body.soil.material.coh");
  EXPECT_EQ(with("[\"x\", \"z\"]", "[]"),
            "a.toml:22: body.soil.motion.shake.along = []; leads nowhere; give some of \"x\", \"y\", \"z\"");
  EXPECT_EQ(with("\"2 mm/s\"", "\"2 mm\""),
            "a.toml:23: body.soil.motion.shake.history.value = \"2 mm\"; mm is a length, must be a speed; write a "
            "number with "
            "a unit such as m/s");
  EXPECT_EQ(with("\"3 kPa s\"", "\"3 kPa\""),
            "a.toml:17: body.soil.material.shear_viscosity = \"3 kPa\"; kPa is a pressure, must be a viscosity; write "
            "a number "
            "with a unit such as Pa s");
  EXPECT_EQ(with("name = \"foot\"", "name = \"shake\"").substr(0, 10), "a.toml:27:");  // one name for both
}

TEST_F(SceneFile, PackingMistakes) {
  const auto with = [](const std::string& from, const std::string& to) {
    std::string text = grains + stage + packing;
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return error_of(text.replace(at, from.size(), to));
  };
  EXPECT_EQ(with("[1.0, 1.0, 0.3]", "[1.0, 1.0, 0.0]"),
            "a.toml:12: packing.layer.box; has no thickness along z: 0 .. 0 m; make upper larger than lower along "
            "every axis");
  EXPECT_EQ(with("[\"63 mm\", 1.0]", "[\"20 mm\", 1.0]"),
            "a.toml:9: packing.grading[2] = [0.02, 1.0]; sizes must rise: 0.02 m follows 0.0224 m");
  EXPECT_EQ(with("[\"63 mm\", 1.0]", "[\"63 mm\", 0.9]").substr(0, 30), "a.toml:9: packing.grading = [[");
  EXPECT_EQ(error_of(grains + stage + packing + "bodies = [\"sleeper\"]\n"),
            "a.toml:13: packing.layer.bodies = \"sleeper\"; no such body; known bodies and mesh walls: none");
}

TEST_F(SceneFile, ProbeMistakes) {
  const auto with = [](const std::string& probe) {
    return error_of(stage + body + "[[probe]]\nname = \"p\"\n" + probe);
  };
  EXPECT_EQ(with("kind = \"displacement\"\nbody = \"baem\"\ngroup = \"x_max\"\n"),
            "a.toml:25: probe.p.body = \"baem\"; no such body; did you mean \"beam\"?");
  EXPECT_EQ(with("kind = \"displacement\"\nbody = \"beam\"\n"),
            "a.toml:22: probe.p; \"group\" or \"point\" is missing; add group or point");
  EXPECT_EQ(with("kind = \"load\"\nload = \"seat\"\n"),
            "a.toml:25: probe.p.load = \"seat\"; no such load; known loads: tip");
  EXPECT_EQ(with("kind = \"porosity\"\nbox = { lower = [0,0,0], upper = [1,1,1] }\n"),
            "a.toml:24: probe.p.kind = \"porosity\"; there are no grains to measure; remove the probe");
  EXPECT_EQ(with("kind = \"displacment\"\n").substr(0, 66),
            "a.toml:24: probe.p.kind = \"displacment\"; must be one of: displacem");
  EXPECT_EQ(error_of(stage + body + "[[result]]\nname = \"r\"\nprobe = \"w\"\n"),
            "a.toml:24: result.r.probe = \"w\"; no such probe; known probes: none");
}

TEST_F(SceneFile, OverridesReachEveryValue) {
  const Scene scene = read(grains + one_grain + wait + stage + body, {{"grains.friction", "0.5"},
                                                                      {"stage.fall.duration", "20 ms"},
                                                                      {"body.beam.element", "tet4"},
                                                                      {"body.beam.material.density", "1 t/m3"},
                                                                      {"stage.2.grain_damping", "3 1/s"},
                                                                      {"gravity", "[0, 0, -1]"},
                                                                      {"time.dem_fraction", "0.1"}});
  EXPECT_EQ(scene.grains->interactions[0].friction, 0.5);
  EXPECT_EQ(scene.stages.at(1).duration, 0.02);
  EXPECT_EQ(scene.stages.at(1).grain_damping, 3);
  EXPECT_EQ(scene.bodies.at(0).element, "tet4");
  EXPECT_EQ(scene.bodies[0].materials.at(0).density, 1000);
  EXPECT_EQ(scene.gravity.z, -1);
  EXPECT_EQ(scene.time.dem_fraction, 0.1);
}

TEST_F(SceneFile, OverrideMistakesAreReportedAsSet) {
  const std::string scene = grains + one_grain + wait + stage;
  EXPECT_EQ(error_of(scene, {{"grains.frction", "0.5"}}),
            "--set: grains.frction = 0.5; unknown key; did you mean \"friction\"?");
  EXPECT_EQ(error_of(scene, {{"grains.friction", "-1"}}), "--set: grains.friction = -1; must be >= 0");
  EXPECT_EQ(error_of(scene, {{"stage.fal.duration", "1 s"}}),
            "--set stage.fal.duration=1 s: no row \"fal\"; did you mean \"fall\"?");
  EXPECT_EQ(error_of(scene, {{"grains.friction.x", "1"}}),
            "--set grains.friction.x=1: friction holds a value, not a table; remove .x");
  EXPECT_EQ(error_of(scene, {{"grains..x", "1"}}),
            "--set grains..x=1: the key has an empty part; write --set table.key=value");
}

TEST_F(SceneFile, OverlayMergesByNameAndKeepsLines) {
  fs::create_directories("quick");
  write("base.toml", grains + one_grain + wait + stage + body);
  const std::string overlay = "include = \"../base.toml\"\n[grains]\nfriction = 0.1\n[[stage]]\nname = \"fall\"\n";
  write("quick/q.toml", overlay + "duration = \"1 ms\"\n[[stage]]\nname = \"more\"\nduration = 2\n");
  const Scene scene = coupling::read_scene("quick/q.toml");
  EXPECT_EQ(scene.grains->interactions[0].friction, 0.1);
  EXPECT_EQ(scene.grains->interactions[0].restitution, 0.4);
  ASSERT_EQ(scene.stages.size(), 3u);
  EXPECT_EQ(scene.stages[0].duration, 0.02);
  EXPECT_EQ(scene.stages[1].duration, 0.001);
  EXPECT_EQ(scene.stages[2].name, "more");
  EXPECT_EQ(scene.bodies.at(0).mesh_file, fs::absolute("box.geo").string());  // relative to the file that names it
  write("quick/q.toml", overlay + "duration = \"1 m\"\n");
  try {
    coupling::read_scene("quick/q.toml");
    FAIL();
  } catch (const base::UserError& error) {
    EXPECT_EQ(std::string(error.what()).substr(0, 45), "quick/q.toml:6: stage.fall.duration = \"1 m\"; ");
  }
  write("quick/q.toml", "include = \"../base.toml\"\n[grains]\nfriction = 0.1\n");
  write("base.toml", grains + "restitution = 2\n" + one_grain + stage);
  EXPECT_THROW(coupling::read_scene("quick/q.toml"), base::UserError);  // a key twice
  write("base.toml", std::regex_replace(grains, std::regex("0\\.4"), "4") + one_grain + stage);
  try {
    coupling::read_scene("quick/q.toml");
    FAIL();
  } catch (const base::UserError& error) {
    EXPECT_STREQ(error.what(), "base.toml:4: grains.restitution = 4; must be in (0, 1]");
  }
}

TEST_F(SceneFile, ResolvedSceneIsTheSameScene) {
  const std::string rest = R"([[wall]]
name = "floor"
plane = { point = [0,0,0], normal = [0,0.1,1] }
velocity = [0, 0, "1 mm/s"]
[[probe]]
name = "w"
kind = "contact_stress"
body = "beam"
box = { lower = [0,0,0], upper = [1,1,1] }
area = "900 cm2"
[[result]]
name = "r"
probe = "w"
unit = "kPa"
expected_range = ["30 kPa", "100 kPa"]
source = "a \"quoted\" one"
[output]
interval = "1 ms"
)";
  const std::string text = grains + one_grain + wait + stage + packing + "bodies = [\"beam\"]\n" + body + rest;
  const Scene scene = read(text);
  fs::create_directories("elsewhere");
  write("elsewhere/resolved.toml", scene.resolved_toml);
  const Scene again = coupling::read_scene("elsewhere/resolved.toml");
  const auto values = [](const Scene& s) { return s.resolved_toml.substr(s.resolved_toml.find("\n\n")); };
  EXPECT_EQ(values(scene), values(again));  // the file holds every value that is not derived from names
  EXPECT_EQ(scene.packing_hash, again.packing_hash);
  EXPECT_EQ(again.grains->interactions.size(), scene.grains->interactions.size());
  EXPECT_EQ(again.grains->walls.at(0).plane->normal.z, scene.grains->walls.at(0).plane->normal.z);
  EXPECT_EQ(*again.results.at(0).expected_range, *scene.results.at(0).expected_range);
  EXPECT_EQ(again.bodies.at(0).loads.at(0).history->value(0.0211), 200);
  EXPECT_EQ(again.grains->packing->layers.at(0).bodies, scene.grains->packing->layers.at(0).bodies);
}

TEST_F(SceneFile, PackingHashFollowsWhatMakesThePacking) {
  const std::string text = grains + stage + packing + "bodies = [\"beam\"]\n" + body;
  const std::string hash = read(text).packing_hash;
  EXPECT_EQ(hash.size(), 32u);
  EXPECT_EQ(read(text).packing_hash, hash);
  const auto with = [&](const std::string& key, const std::string& value) {
    return read(text, {{key, value}}).packing_hash;
  };
  // These do not touch the packing …
  EXPECT_EQ(with("grains.material.young_modulus", "1 GPa"), hash);
  EXPECT_EQ(with("stage.fall.duration", "3 s"), hash);
  EXPECT_EQ(with("time.fem_fraction", "0.5"), hash);
  EXPECT_EQ(with("body.beam.load.tip.history.value", "1 N"), hash);
  // … and these do.
  EXPECT_NE(with("packing.seed", "2"), hash);
  EXPECT_NE(with("packing.young_modulus", "1 GPa"), hash);
  EXPECT_NE(with("grains.material.density", "2600"), hash);
  EXPECT_NE(with("body.beam.translation", "[0, 0, 1]"), hash);
  EXPECT_NE(with("gravity", "[0, 0, -1]"), hash);
  write("box.geo", "DefineConstant[ length = {2.5, Name \"length\"} ];\n");
  EXPECT_NE(read(text).packing_hash, hash);
}

TEST(Scenes, EveryShippedSceneReads) {
  for (const auto& entry : fs::recursive_directory_iterator(fs::path(TRACKBED_SOURCE_FOLDER) / "configs")) {
    if (entry.path().extension() != ".toml") continue;
    const Scene scene = coupling::read_scene(entry.path());
    EXPECT_FALSE(scene.title.empty()) << entry.path();
  }
}

TEST(List, EveryFamilyHasTextAndAnUnknownOneIsRefused) {
  for (const auto& family : coupling::families()) EXPECT_GT(coupling::list_family(family).size(), 100u) << family;
  EXPECT_NE(coupling::list_family("histories").find("eq. 7.13"), std::string::npos);
  EXPECT_NE(coupling::list_family("scene").find("target_porosity"), std::string::npos);
  try {
    coupling::list_family("histroies");
    FAIL();
  } catch (const base::UserError& error) {
    EXPECT_STREQ(error.what(),
                 "list histroies: no such family; did you mean \"histories\"? choose one of: laws, rolling, elements, "
                 "materials, histories, loads, motions, gradings, probes, results, scene");
  }
}

}  // namespace
