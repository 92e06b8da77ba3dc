#pragma once
// The part of space that something is measured in: an upright box or a sphere. Closed: faces belong to it.
#include <variant>

#include "base/vec3.hpp"

namespace dem {

using base::Vec3;

struct BoxRegion {
  Vec3 lower, upper;  // [m]
};
struct BallRegion {
  Vec3 centre;        // [m]
  double radius = 0;  // [m]
};
using Region = std::variant<BoxRegion, BallRegion>;

bool contains(const Region&, const Vec3& point);
double volume(const Region&);  // [m3]
/// Smallest upright box around it.
BoxRegion box_around(const Region&);
/// Share of the straight line between two points that lies inside; of two equal points: 1 inside, 0 outside.
double share_inside(const Region&, const Vec3& from, const Vec3& to);

}  // namespace dem
