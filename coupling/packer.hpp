#pragma once
// Gravity packing (Irazabal2017 5.2.3, after Tran): grains of low friction are poured, come to rest and are struck off
// layer by layer; a plate presses each layer level. Then the slope is cut, what stands in for missing walls is taken
// away, and the grains settle with the scene's real friction and rolling resistance.
// Where we differ: the slope is cut out of a full box (a grain goes when its centre stands above the cut) instead of
// being held by auxiliary surfaces, so nothing has to flow under an overhang; and bodies that arrive on a finished
// layer are set down slowly from where they touch nothing, because an overlap of 1 mm at 0.24 GPa would throw grains at
// metres per second. Measured (EN 13450 A grading, 0.30 m layer, E 0.24 GPa): packing friction 0.1, 0.2, 0.3 gives an
// interior porosity of 0.37, 0.38, 0.39, and 4.6, 4.4, 4.2 contacts per grain.
#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "coupling/packing.hpp"
#include "coupling/packing_region.hpp"

namespace coupling {

class Packer {
 public:
  /// Throws base::UserError when the scene cannot be packed.
  /// `skins`: of arriving_surfaces().
  Packer(const Scene&, const std::vector<base::Skin>& skins, dem::Backend);
  /// The packed grains at rest, by id; fills porosity and coordination. Once per object.
  std::vector<dem::Grain> run(PackingReport&);

 private:
  void add_walls();
  void bring_bodies(std::size_t layer);
  /// Least height [m] above its place at which a body touches no grain; takes grains out where that is too much.
  double clearing_lift(const Obstacle&);
  void pour(std::size_t layer);
  void strike_off(double level);
  void press(const PackingLayer&);
  void cut_free();

  /// Advances by at most `duration` [s], but stops once the grains are calm after `earliest` [s].
  void settle(double earliest, double duration);
  void advance(double duration);
  template <typename Condition>
  std::size_t remove_if(Condition);
  double step() const;
  void use_interactions(bool real);
  [[noreturn]] void refuse_plate(const PackingLayer&, double level, const std::string& what) const;
  void show(double kinetic);  // one line on a terminal; kinetic energy over m g r

  const Scene& scene_;
  const Packing& packing_;
  const std::vector<base::Skin>& skins_;
  PackingRegion region_;
  ShapeMix mix_;
  std::vector<dem::Clump> clumps_;
  std::unique_ptr<dem::Simulation> simulation_;
  std::vector<int> temporary_walls_;  // taken away when the packing is done
  std::int64_t next_id_ = 0;
  std::string phase_;  // for the progress line
  bool terminal_ = false;
  std::chrono::steady_clock::time_point shown_;
};

}  // namespace coupling
