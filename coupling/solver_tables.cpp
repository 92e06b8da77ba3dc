// How the bodies are solved, and how the grains are coupled to them: the tables [fem] and [coupling].
#include "coupling/scene_tables.hpp"

namespace coupling {

const base::Table& fem_table() {
  static const base::Table table{
      "fem",
      "how the bodies are solved",
      {base::text("solver",
                  "explicit: central difference; newmark: implicit steps of time.fem_step; static: every step of "
                  "time.fem_step ends in equilibrium; modal: free vibrations, no stages")
           .among({"explicit", "newmark", "static", "modal"})
           .otherwise("explicit"),
       base::real("beta", "", "of newmark; stable at any step for 2 beta >= gamma").above(0).optional("0.25"),
       base::real("gamma", "", "of newmark; above 0.5 it damps high modes").at_least(0.5).optional("0.5"),
       base::text("linear_solver",
                  "direct: factorisation; iterative: conjugate gradients with multigrid; auto: direct up to 150000 "
                  "unknowns. Not of a purely explicit run; modal factorises")
           .among({"auto", "direct", "iterative"})
           .optional("auto"),
       base::text("step_bound",
                  "of explicit: its stable step from the mesh's largest eigenvalue, or from the elements' one by one, "
                  "which is found sooner and gives a shorter step")
           .among({"mesh", "elements"})
           .optional("mesh"),
       base::text("start", "equilibrium: at rest under the loads of time 0; of explicit and newmark")
           .among({"rest", "equilibrium"})
           .optional("rest"),
       base::integer("modes", "of modal: how many of every body, without rigid motions").at_least(1).optional("6")}};
  return table;
}

const base::Table& coupling_table() {
  static const base::Table table{
      "coupling",
      "what passes between grains and bodies; in one window both make a whole number of steps",
      {base::text("scheme",
                  "sequential: bodies take the contact forces of the same window; concurrent: those of the window "
                  "before, so that both sides work at once on ranks of their own; less accurate (coupling/window.hpp)")
           .among({"sequential", "concurrent"})
           .otherwise("sequential"),
       base::text("skin_motion",
                  "of a body's surface within a window; linear: evenly; quadratic: from its velocity at the start on")
           .among({"linear", "quadratic"})
           .otherwise("linear"),
       base::integer("n_dem", "steps of the grains in a window").at_least(1).at_most(100).optional("chosen"),
       base::integer("n_fem", "steps of the bodies in a window").at_least(1).at_most(100).optional("chosen")}};
  return table;
}

}  // namespace coupling
