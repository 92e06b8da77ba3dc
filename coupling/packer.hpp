#pragma once
// Gravity packing (Irazabal2017 5.2.3, after Tran): grains of low friction are poured, come to rest and are struck off
// layer by layer; a plate presses each layer level. Then the slope is cut, what stands in for missing walls is taken
// away, and the grains settle with the scene's real friction and rolling resistance.
// Where we differ: the slope is cut out of a full box (a grain goes when its centre stands above the cut) instead of
// being held by auxiliary surfaces, so nothing has to flow under an overhang; and bodies that arrive on a finished
// layer are set down slowly from where they touch nothing, because an overlap of 1 mm at 0.24 GPa would throw grains at
// metres per second. A layer may be grown instead of poured (packing_growth.cpp), shaken (packing_vibration.cpp), and
// parts of the finished bed loosened or eroded (packing_regions.cpp). Measured (EN 13450 A grading, 0.30 m layer, E
// 0.24 GPa): packing friction 0.1, 0.2, 0.3 gives an interior porosity of 0.37, 0.38, 0.39, and 4.6, 4.4, 4.2 contacts
// per grain.
#include <chrono>
#include <functional>
#include <limits>
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
  Packer(const Scene&, const std::vector<base::Skin>& skins, dem::Backend, const MakeGrains&);
  /// The packed grains at rest, by id; fills porosity and coordination. Once per object.
  std::vector<dem::Grain> run(PackingReport&);

 private:
  void add_walls();
  void bring_bodies(std::size_t layer);
  /// Least height [m] above its place at which a body touches no grain; takes grains out where that is too much.
  double clearing_lift(const Obstacle&);
  void pour(std::size_t layer);
  void grow(std::size_t layer);
  void vibrate(std::size_t layer);
  /// Grains for this much solid volume [m3], without places.
  std::vector<dem::Grain> draw(std::size_t layer, double solid) const;
  /// Puts them at random, none touching another, between the layer's floor and `top` [m], above it when there is no
  /// room; returns the height [m] that they reach.
  double insert(std::size_t layer, std::vector<dem::Grain>& grains, double top);
  /// Grows grains by stages from `size` (share of their own) to their own. Returns the overlap over radius left.
  double enlarge(const std::vector<dem::Grain>&, const PackingLayer&);
  /// Largest overlap over the radius of the smallest sphere of the two grains that touch; `radii` by id.
  double largest_overlap(const std::vector<double>& radii) const;
  void lower_gravity(const Growth&);
  void strike_off(double level);
  void press(const PackingLayer&);
  void cut_free();
  void loosen();
  void erode();
  void drop_lost();
  /// Material of a grain that comes to rest here: one of its own in a loosened region with a friction.
  int material_at(const Vec3&) const;
  /// Porosity of a layer up to its surface, away from walls.
  double porosity_of(std::size_t layer) const;

  /// Advances by at most `duration` [s], but stops once the grains are calm after `earliest` [s].
  void settle(double earliest, double duration);
  void advance(double duration);
  std::size_t remove_if(const std::function<bool(const dem::Grain&)>&);
  /// The fraction of the Rayleigh limit that the scene asks for [s].
  double asked_step() const;
  /// That, or less where the live contacts allow less. Looks at them when `chunk` has gone by since the last look.
  double step();
  /// Says how far contacts have shortened the steps since it was said last.
  void tell_shortest();
  enum class Friction { none, of_packing, of_scene };
  void use_interactions(Friction);
  [[noreturn]] void refuse(const PackingLayer&, const std::string& why) const;
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
  std::vector<PackingStep> steps_;    // done so far
  double median_ = 0;                 // [m] diameter that half of the mass passes
  std::int64_t next_id_ = 0;
  double contact_limit_ = std::numeric_limits<double>::infinity();  // [s] that the live contacts allow
  double next_look_ = 0;                                            // [s] at them
  double shortest_ = std::numeric_limits<double>::infinity();       // [s] step that they have asked for in this phase
  std::string shortest_by_;
  std::string phase_;  // for the progress line
  bool terminal_ = false;
  std::chrono::steady_clock::time_point shown_;
};

}  // namespace coupling
