// Parameters of a packing's methods and regions.
#include "coupling/scene_tables.hpp"

namespace coupling {

using base::Table;
using base::Vec3;

const Table& growth_table() {
  static const Table table{
      "packing.layer.growth",
      "grains put small into the closed box of the layer and grown without friction",
      {base::real("start", "", "share of their size at which grains are put in").above(0).below(1).otherwise(0.625),
       base::real("overlap", "", "of the smaller radius: added by one stage at most, and left at most")
           .above(0)
           .at_most(0.1)
           .otherwise(0.02),
       base::real("damping", "1/s", "artificial damping -alpha m v while they grow").at_least(0).otherwise(100.0),
       base::real("gravity_factor", "", "of the raised gravity that presses the bed once the lid is gone")
           .at_least(1)
           .at_most(1000)
           .otherwise(30.0),
       base::real("lowering", "s", "in which the raised gravity becomes the scene's own").at_least(0).otherwise(0.1)}};
  return table;
}

const Table& vibration_table() {
  static const Table table{
      "packing.layer.vibration",
      "the whole container shaken: walls, floor and bodies move alike",
      {base::real("amplitude", "m", "of the motion, half of its range").above(0),
       base::real("frequency", "Hz", "of the motion").above(0), base::real("time", "s", "how long").above(0),
       base::vector("direction", "", "of the motion, of any length").otherwise(Vec3{0, 0, 1})}};
  return table;
}

const Table& loosen_table() {
  static const Table table{
      "packing.loosen",
      "a box in which the bed is less dense",
      {base::table("box", box_table(), "where"),
       base::real("friction", "", "between its grains while packing, where it is lower than the scene's own")
           .at_least(0)
           .optional("the packing's"),
       base::real("share", "", "of its grains, taken out at random once the bed is packed; the bed settles again")
           .above(0)
           .below(1)
           .optional("none is taken out")}};
  return table;
}

const Table& erode_table() {
  static const Table table{
      "packing.erode",
      "a box out of which grains fall until none comes any more, as through a hole",
      {base::table("box", box_table(),
                   "grains whose centre is in it are taken out; a hole in the floor is a box as "
                   "high as a grain"),
       base::table("above", plane_table(), "only grains on the side of this plane that its normal points to")
           .optional("the whole box"),
       base::real("settle", "s", "longest time for grains to come into the box").above(0).otherwise(1.0)}};
  return table;
}

}  // namespace coupling
