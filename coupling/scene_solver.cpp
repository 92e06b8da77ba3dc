// How the bodies of a scene are solved, and what goes with it.
#include <fmt/format.h>

#include <initializer_list>

#include "base/text.hpp"
#include "coupling/scene_parts.hpp"

namespace coupling {

using base::fail;
using base::Value;

namespace {

fem::Solver solver_of(const std::string& name) {
  return name == "newmark"  ? fem::Solver::newmark
         : name == "static" ? fem::Solver::statics
         : name == "modal"  ? fem::Solver::modal
                            : fem::Solver::explicit_steps;
}

/// A key of [fem] that only some solvers read.
void require_reader(const Value& table, const char* key, std::initializer_list<const char*> readers) {
  const std::string& solver = table.at("solver").text();
  std::vector<std::string> names;
  for (const char* reader : readers) {
    if (table.has(key) && solver == reader) return;
    names.push_back(fmt::format("\"{}\"", reader));
  }
  if (table.has(key))
    fail(table.at(key), fmt::format("solver = \"{}\" does not read it", solver),
         fmt::format("remove it, or set solver = {}", base::join(names, " or ")));
}

/// Parts of a scene that a solver cannot or does not use.
void refuse_idle_parts(const Value& root, const Scene& scene, const std::string& solver) {
  const auto kind = scene.solver.kind;
  if (kind == fem::Solver::explicit_steps) return;
  if (root.has("grains") && kind != fem::Solver::newmark)
    fail(root.at("grains"), fmt::format("fem.solver = \"{}\" goes without grains, which need bodies that move", solver),
         "remove the grains, or set fem.solver = \"explicit\" or \"newmark\"");
  for (const auto& body : root.rows("body")) {
    if (kind == fem::Solver::newmark) continue;
    const auto refuse_damping = [&](const Value& table, std::initializer_list<const char*> keys) {
      for (const char* key : keys) {
        if (table.has(key) && table.at(key).real() > 0)
          fail(table.at(key), fmt::format("fem.solver = \"{}\" knows no damping", solver), "remove it");
      }
    };
    refuse_damping(body, {"damping", "stiffness_damping"});
    for (const auto& material : body.at("material").list())
      refuse_damping(material, {"shear_viscosity", "bulk_viscosity"});
    if (!body.at("absorbing").list().empty())
      fail(body.at("absorbing").list().front(), fmt::format("fem.solver = \"{}\" knows no waves", solver), "remove it");
    if (kind != fem::Solver::modal) continue;
    for (const char* part : {"load", "motion"}) {
      if (!body.at(part).list().empty())
        fail(body.at(part).list().front(), fmt::format("free vibrations have no {}s", part), "remove it");
    }
  }
  if (kind == fem::Solver::modal && !root.rows("stage").empty())
    fail(root.rows("stage").front(), "fem.solver = \"modal\" goes through no time", "remove the stages");
  if (kind == fem::Solver::modal && root.at("time").has("fem_step"))
    fail(root.at("time").at("fem_step"), "fem.solver = \"modal\" makes no steps", "remove it");
}

}  // namespace

const char* solver_name(fem::Solver solver) {
  constexpr const char* names[] = {"explicit", "newmark", "static", "modal"};
  return names[static_cast<int>(solver)];
}

void build_coupling(Value& root, Scene& scene) {
  if (!root.has("coupling")) return;
  const Value& table = root.at("coupling");
  if (!root.has("grains") || root.rows("body").empty())
    fail(table, "there is nothing to couple", "remove [coupling], or add [grains] and [[body]]");
  auto& coupling = scene.coupling;
  if (table.at("scheme").text() == "concurrent") coupling.scheme = Scheme::concurrent;
  if (table.at("skin_motion").text() == "quadratic") coupling.skin_motion = SkinMotion::quadratic;
  if (const Value* steps = table.find("n_dem")) coupling.n_dem = static_cast<int>(steps->integer());
  if (const Value* steps = table.find("n_fem")) coupling.n_fem = static_cast<int>(steps->integer());
}

void build_solver(Value& root, Scene& scene) {
  if (!root.has("fem")) return;
  const Value& table = root.at("fem");
  if (root.rows("body").empty()) fail(table, "there is no body to solve for", "remove [fem], or add [[body]]");
  const std::string& name = table.at("solver").text();
  auto& solver = scene.solver;
  solver.kind = solver_of(name);
  solver.origin = table.origin();
  require_reader(table, "beta", {"newmark"});
  require_reader(table, "gamma", {"newmark"});
  require_reader(table, "modes", {"modal"});
  require_reader(table, "start", {"explicit", "newmark"});
  require_reader(table, "step_bound", {"explicit"});
  if (const Value* bound = table.find("step_bound"); bound && bound->text() == "elements")
    solver.step_bound = fem::StepBound::elements;
  if (const Value* start = table.find("start")) solver.start_in_equilibrium = start->text() == "equilibrium";
  if (!solver.start_in_equilibrium) require_reader(table, "linear_solver", {"newmark", "static"});
  if (const Value* beta = table.find("beta")) solver.beta = beta->real();
  if (const Value* gamma = table.find("gamma")) solver.gamma = gamma->real();
  if (const Value* modes = table.find("modes")) scene.modes = static_cast<int>(modes->integer());
  if (const Value* linear = table.find("linear_solver"))
    solver.linear_solver = linear->text() == "direct"      ? fem::LinearSolver::direct
                           : linear->text() == "iterative" ? fem::LinearSolver::iterative
                                                           : fem::LinearSolver::automatic;
  refuse_idle_parts(root, scene, name);
  if (solver.kind == fem::Solver::newmark && !root.at("time").has("fem_step"))
    fail(table.at("solver"), "the step is missing",
         "add time.fem_step; a thirtieth of the shortest period that matters is accurate to half a per cent");
}

}  // namespace coupling
