// The table [fem]: what it reads, and what it refuses together with the rest of the scene.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "coupling/modal_run.hpp"
#include "tests/unit/coupling_scene_file.hpp"

namespace {

using namespace scene_tests;

const std::string beam = R"([[body]]
name = "beam"
mesh = "box.geo"
[[body.material]]
young_modulus = "45 GPa"
poisson_ratio = 0.167
density = 2350
)";
const std::string pull = R"([[body.load]]
name = "pull"
group = "x_max"
kind = "nodal_total"
direction = [1, 0, 0]
history = { kind = "constant", value = "1 N" }
)";
const std::string while_ = "[[stage]]\nname = \"while\"\nduration = 1\n";
std::string solver(const std::string& keys) { return "[fem]\n" + keys + "\n"; }

TEST_F(SceneFile, ExplicitUnlessToldOtherwise) {
  EXPECT_EQ(read(while_ + beam).solver.kind, fem::Solver::explicit_steps);
  EXPECT_TRUE(read(solver("start = \"equilibrium\"") + while_ + beam).solver.start_in_equilibrium);
  EXPECT_EQ(read(while_ + beam).solver.step_bound, fem::StepBound::mesh);
  EXPECT_EQ(read(solver("step_bound = \"elements\"") + while_ + beam).solver.step_bound, fem::StepBound::elements);
}

TEST_F(SceneFile, SolverKeysAreRead) {
  const auto scene = read(solver("solver = \"newmark\"\nbeta = 0.3\ngamma = 0.6\nlinear_solver = \"iterative\"") +
                          "[time]\nfem_step = \"1 ms\"\n" + while_ + beam);
  EXPECT_EQ(scene.solver.kind, fem::Solver::newmark);
  EXPECT_EQ(scene.solver.beta, 0.3);
  EXPECT_EQ(scene.solver.gamma, 0.6);
  EXPECT_EQ(scene.solver.linear_solver, fem::LinearSolver::iterative);
  const auto modal = read(solver("solver = \"modal\"\nmodes = 9") + beam +
                          "[[probe]]\nname = \"f\"\nkind = \"mode_frequency\"\nbody = \"beam\"\nmode = 9\n" +
                          "[[result]]\nname = \"f\"\nprobe = \"f\"\n");
  EXPECT_TRUE(modal.is_modal());
  EXPECT_EQ(modal.modes, 9);
  EXPECT_TRUE(modal.stages.empty());
  EXPECT_EQ(modal.probes.at(0).mode, 9);
  EXPECT_EQ(modal.results.at(0).unit, "Hz");
}

TEST_F(SceneFile, ResolvedSolverReadsBack) {
  const auto scene = read(solver("solver = \"static\"") + while_ + beam);
  EXPECT_EQ(read(scene.resolved_toml).solver.kind, fem::Solver::statics);
  const auto modal = read(solver("solver = \"modal\"") + beam);
  EXPECT_TRUE(read(modal.resolved_toml).is_modal());
}

TEST_F(SceneFile, CouplingIsRead) {
  EXPECT_EQ(read(grains + one_grain + while_ + beam).coupling.scheme, coupling::Scheme::sequential);
  const auto scene = read("[coupling]\nscheme = \"concurrent\"\nskin_motion = \"quadratic\"\nn_dem = 40\nn_fem = 2\n" +
                          grains + one_grain + while_ + beam);
  EXPECT_EQ(scene.coupling.scheme, coupling::Scheme::concurrent);
  EXPECT_EQ(scene.coupling.skin_motion, coupling::SkinMotion::quadratic);
  EXPECT_EQ(scene.coupling.n_dem, 40);
  EXPECT_EQ(scene.coupling.n_fem, 2);
  EXPECT_EQ(error_of("[coupling]\nn_dem = 4\n" + while_ + beam),
            "a.toml:1: coupling; there is nothing to couple; remove [coupling], or add [grains] and [[body]]");
}

TEST_F(SceneFile, SolversThatDoNotFitAreRefused) {
  EXPECT_EQ(error_of(solver("solver = \"implicit\"") + while_ + beam)
                .find("a.toml:2: fem.solver = \"implicit\"; must be one of"),
            0u);
  EXPECT_EQ(error_of(solver("") + while_ + grains + one_grain),
            "a.toml:1: fem; there is no body to solve for; remove [fem], or add [[body]]");
  EXPECT_EQ(error_of(solver("beta = 0.3") + while_ + beam),
            "a.toml:2: fem.beta = 0.3; solver = \"explicit\" does not read it; remove it, or set solver = \"newmark\"");
  EXPECT_EQ(error_of(solver("solver = \"static\"\nstart = \"equilibrium\"") + while_ + beam),
            "a.toml:3: fem.start = \"equilibrium\"; solver = \"static\" does not read it; remove it, or set solver = "
            "\"explicit\" or \"newmark\"");
  EXPECT_EQ(error_of(solver("solver = \"newmark\"") + while_ + beam),
            "a.toml:2: fem.solver = \"newmark\"; the step is missing; add time.fem_step; a thirtieth of the shortest "
            "period that matters is accurate to half a per cent");
  EXPECT_EQ(error_of(solver("solver = \"static\"") + while_ + beam + grains + one_grain),
            "a.toml:13: grains; fem.solver = \"static\" goes without grains, which need bodies that move; remove "
            "the grains, or set fem.solver = \"explicit\" or \"newmark\"");
  EXPECT_EQ(error_of(solver("solver = \"modal\"") + while_ + beam),
            "a.toml:3: stage.while; fem.solver = \"modal\" goes through no time; remove the stages");
  EXPECT_EQ(error_of(solver("solver = \"modal\"") + beam + pull),
            "a.toml:10: body.beam.load.pull; free vibrations have no loads; remove it");
  EXPECT_EQ(error_of(solver("solver = \"modal\"") + beam +
                     "[[probe]]\nname = \"f\"\nkind = \"mode_frequency\"\nbody = \"beam\"\nmode = 7\n"),
            "a.toml:14: probe.f.mode = 7; fem.modes = 6; ask for more modes, or for a lower one");
  EXPECT_EQ(
      error_of(while_ + beam + "[[probe]]\nname = \"f\"\nkind = \"mode_frequency\"\nbody = \"beam\"\nmode = 1\n"),
      "a.toml:13: probe.f.kind = \"mode_frequency\"; only fem.solver = \"modal\" finds modes; remove the probe, or "
      "choose that solver");
  EXPECT_EQ(
      error_of(solver("solver = \"static\"") + while_ + "hold = [\"beam\"]\n" + beam),
      "a.toml:6: stage.while.hold = [\"beam\"]; only fem.solver = \"explicit\" holds bodies in place; remove it, or "
      "support the body");
}

TEST_F(SceneFile, DampingBelongsToSolversThatHaveIt) {
  const std::string damped = R"([[body]]
name = "beam"
mesh = "box.geo"
KEY = 1e-3
[[body.material]]
young_modulus = "45 GPa"
poisson_ratio = 0.167
density = 2350
)";
  const auto with = [&](const std::string& key) {
    std::string text = damped;
    return text.replace(text.find("KEY"), 3, key);
  };
  for (const char* key : {"damping", "stiffness_damping"}) {
    EXPECT_EQ(error_of(solver("solver = \"static\"") + while_ + with(key)),
              fmt::format("a.toml:9: body.beam.{} = 0.001; fem.solver = \"static\" knows no damping; remove it", key));
    EXPECT_EQ(error_of(while_ + with(key)), "no error");
  }
  EXPECT_EQ(error_of(solver("solver = \"static\"") + while_ + beam + "law = \"kelvin_voigt\"\nshear_viscosity = 5\n"),
            "a.toml:14: body.beam.material.shear_viscosity = 5.0; fem.solver = \"static\" knows no damping; remove it");
  EXPECT_EQ(read(solver("solver = \"newmark\"") + "[time]\nfem_step = \"1 ms\"\n" + while_ + with("stiffness_damping"))
                .bodies.at(0)
                .stiffness_damping,
            1e-3);
}

TEST(ModesTable, SaysFrequenciesAndMovingMass) {
  const fem::BodyModes modes{"beam", 3, {{26.9, {0, 0, 50}}}};
  fem::BodyCounts counts;
  counts.mass = 200;
  EXPECT_EQ(coupling::modes_table(std::span(&modes, 1), std::span(&counts, 1)),
            "body beam: 1 elastic modes, 3 rigid motions; mass moving along x, y, z in per cent\n"
            "    1         26.9 Hz     0.00     0.00    25.00\n");
}

}  // namespace
