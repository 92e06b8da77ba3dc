#include "coupling/wall_tables.hpp"

#include "base/histories.hpp"

namespace coupling {

using base::Family;
using base::Table;
using base::Vec3;

const Table& wall_body_table() {
  static const Table table{
      "wall.body",
      "the wall moves as one rigid body under the grains' forces, its weight and its loads: a sleeper, a loading plate",
      {base::real("mass", "kg",
                  "mass; of a loading plate a numerical choice: the grains' forces over it are its "
                  "accelerations")
           .above(0),
       base::vector("centre", "m", "centre of mass").optional("mean of the mesh's nodes"),
       base::vector("inertia", "kg m2", "principal moments, about axes along x, y, z").optional("only if it turns"),
       base::texts("moves", "directions in which it is free; in the others it goes with the velocity of the wall")
           .among({"x", "y", "z"})
           .otherwise_empty(),
       base::texts("turns", "axes about which it is free").among({"x", "y", "z"}).otherwise_empty(),
       base::boolean("weighs", "feels gravity").otherwise(true),
       base::real("damping", "1/s", "force -damping m v, torque likewise").at_least(0).otherwise(0.0)}};
  return table;
}

const Family& wall_load_family() {
  const auto row = [](const char* kind, const char* meaning, const char* unit) {
    return Table{
        kind,
        meaning,
        {base::text("kind", "how the history's value acts").among({kind}),
         base::vector("direction", "", "multiplied by the history's value"),
         base::table("history", base::history_family(unit), "value over time, see `trackbed list histories`")}};
  };
  static const Family family = [&] {
    Family all{
        "kind", "loads of walls", {row("force", "force at the centre", "N"), row("stress", "stress on an area", "Pa")}};
    all.rows.back().parameters.push_back(base::real("area", "m2", "multiplies the stress").above(0));
    return all;
  }();
  return family;
}

const Table& wall_motion_table() {
  static const Table table{
      "wall.motion",
      "a velocity from the start of a stage on, until the next of these",
      {base::text("stage", "name of the stage"), base::vector("velocity", "m/s", "rigid translation")}};
  return table;
}

std::vector<base::Parameter> wall_motion_parameters() {
  return {base::vector("velocity", "m/s", "rigid translation from the start of the run on").otherwise(Vec3{}),
          base::tables("motion", wall_motion_table(), "other velocities, by stages").otherwise_empty(),
          base::table("body", wall_body_table(), "it moves as a rigid body (meshes)").optional("it does not"),
          base::tables("load", wall_load_family(), "what pulls on such a body").otherwise_empty(),
          base::text("removed_at", "name of the stage at whose start it is taken away").optional("stays"),
          base::boolean("packing_only", "taken away when the packing is done").otherwise(false),
          base::boolean("run_only", "comes when the packing is done").otherwise(false)};
}

}  // namespace coupling
