#pragma once
// Where ballast is to be: the layers' boxes less bodies, less what lies behind walls and cuts. Geometry only.
#include <span>
#include <vector>

#include "coupling/obstacle.hpp"
#include "coupling/scene.hpp"

namespace coupling {

/// Surfaces that are brought in place layer by layer: the bodies' skins, then the mesh walls that layers name.
std::vector<base::Skin> arriving_surfaces(const Scene&, const std::vector<base::Skin>& skins);
/// Contact material of such a surface.
int surface_material(const Scene&, const std::string& name);
/// True for walls that stand from the first: neither brought by a layer nor by the run.
bool stands_while_packing(const Scene&, const WallScene&);

class PackingRegion {
 public:
  /// `skins`: of arriving_surfaces(). Reads the files of mesh walls. Throws base::UserError when the packing
  /// cannot make sense in this scene.
  PackingRegion(const Scene&, const std::vector<base::Skin>& skins);

  const Box& all() const { return all_; }                          // [m] smallest box round all layers
  const std::vector<dem::Plane>& sides() const { return sides_; }  // faces of all() that no wall bounds
  /// Bodies (indices into skins) first in place in this layer; those that no layer names are there from the first.
  const std::vector<int>& arriving(std::size_t layer) const { return arriving_[layer]; }
  const Obstacle& obstacle(int body) const { return obstacles_[static_cast<std::size_t>(body)]; }
  /// Collar above the body's open top, if it has one: in place while grains are poured.
  const base::Skin& rim(int body) const { return rims_[static_cast<std::size_t>(body)]; }
  /// Surface of a scene wall that is a mesh; empty for a plane.
  const base::Skin& wall_surface(std::size_t wall) const { return wall_surfaces_[wall]; }

  /// True when a sphere keeps clear of walls, of sides and of the bodies in place in this layer.
  bool room(std::size_t layer, const Vec3& centre, double radius) const;
  /// Volume [m3] of the layer's box that bodies and walls leave free.
  double volume(std::size_t layer) const;
  /// Porosity [-] of the interior: points of the layers farther than `margin` [m] from walls, sides, cuts, bodies and
  /// the layers' free tops; with less margin when nothing would be left.
  /// Loosened and eroded regions do not count.
  double porosity(std::span<const dem::GrainSphere>, double margin) const;
  /// The same of a box, while this layer is packed.
  double porosity(std::span<const dem::GrainSphere>, const Box&, std::size_t layer, double margin) const;
  /// Porosity [-] of a box of the finished bed: outside bodies and walls, below the cuts.
  double porosity_in(const Box&, std::span<const dem::GrainSphere>) const;
  /// Volume [m3] of a box, `margin` [m] away from the bodies and walls that are there in this layer.
  double volume(const Box&, std::size_t layer, double margin) const;

 private:
  bool interior(const Vec3&, double margin) const;
  void find_sides();
  void check_floor() const;

  const Scene& scene_;
  const Packing& packing_;
  Box all_;
  std::vector<dem::Plane> planes_;  // of the scene's walls, unit normals
  std::vector<dem::Plane> sides_;
  std::vector<Obstacle> obstacles_;
  std::vector<base::Skin> rims_;
  std::vector<Obstacle> rim_obstacles_;
  std::vector<std::vector<int>> arriving_;
  std::vector<base::Skin> wall_surfaces_;  // one per scene wall
  std::vector<Obstacle> wall_obstacles_;   // one per scene wall
};

/// Unit normal; the plane is a user's, so a zero normal must have been refused before.
Vec3 unit(const Vec3&);
/// Distance [m] of a point from a plane, positive where the normal points to.
double height_above(const dem::Plane&, const Vec3&);

}  // namespace coupling
