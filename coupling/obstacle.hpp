#pragma once
// The surface of a body as something that takes up room: what is inside it, what is near it. Host side, fixed in place.
#include <array>
#include <vector>

#include "base/skin.hpp"
#include "coupling/scene.hpp"

namespace coupling {

class Obstacle {
 public:
  explicit Obstacle(const base::Skin&);

  /// True inside the body. Skins may be open (a sleeper shows no top, the ground only its top): along the vertical
  /// through the point, the nearest facet below decides if there is one (inside above a facet that faces down), else
  /// the nearest above (inside below a facet that faces up). So an open top reaches up without end.
  bool inside(const Vec3&) const;
  /// True when a facet is nearer than this distance [m].
  bool closer_than(const Vec3&, double distance) const;
  /// True when a facet lies below (or around) some point of the box's footprint, up to the box's lower face +
  /// tolerance.
  bool carries(const Box&, double tolerance) const;

  const Box& bounds() const { return bounds_; }

 private:
  struct Triangle {
    Vec3 a, b, c, normal;  // normal: outward, unit
  };
  std::array<int, 4> columns(double x_lower, double y_lower, double x_upper, double y_upper) const;

  std::vector<Triangle> triangles_;
  Box bounds_;
  double cell_ = 1;  // [m] edge of the square columns that list the triangles above and below them
  int nx_ = 1, ny_ = 1;
  std::vector<std::vector<int>> columns_;
};

/// The open rim of the skin's sides at its highest level, carried straight up by `height` [m]: keeps grains that are
/// poured above an open-topped body out of it. Facets face outwards like the sides. No facets without such a rim.
base::Skin collar(const base::Skin&, double height);

}  // namespace coupling
