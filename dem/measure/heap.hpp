#pragma once
// Angle of repose of a heap, from the places of its spheres.
//
// Method: the heap is looked at from above in cells of about two grain diameters: annular sectors about its axis
// (cone), or bins along the slope times lanes across it (slope). The highest sphere top of a cell is a point of the
// surface, at the place of that sphere. In each of several flanks - 8 azimuths of a cone; lanes on either side of the
// crest of a slope - a straight line is fitted to the points of those rings whose median height lies between 20 % and
// 80 % of the heap's, so that neither the rounded top nor the thinning foot counts. The angle is the mean over the
// flanks, the scatter their standard deviation. The cells of a cone are nearly equal in area, so that the gap between
// the highest grain of a cell and the surface is the same near the axis and far from it.
// Source: the quantity is that of Irazabal2017 6.2 (slope of a pile laid up on the ground), whose figures are read by
// eye; the procedure is ours.
//
// Robustness: a stone that rolled away lies beyond the first ring below 20 % and is never looked at; one that flies or
// stands out is one point of a flank, and the line is the median of the slopes between all pairs of points (Theil 1950,
// Sen 1968, doi:10.1080/01621459.1968.10480934), which stands 29 % of wild points. Heights are medians over a ring,
// the axis is the median of the grains' places, the floor the level that 1 % of the spheres' bottoms lie below. An axis
// that is off by e turns the slope of a flank by the order of (e / distance)^2 only.
//
// Validity: z is up; three rings per flank are needed. Measured on spheres filling cones of 25 to 45 degrees at random
// (ten seeds each), root mean square error at most: 0.08 degrees at a height of 30 grains, 0.31 at 20, 0.53 at 15, 2.4
// at 10; slopes of 20 grains are too flat by 0.3 at most, of 15 grains by 0.7. The error is on the flat side, since a
// random filling leaves larger gaps where it is deeper.
#include <optional>
#include <span>

#include "dem/dem.hpp"

namespace dem {

struct HeapView {
  enum Axis { vertical, x, y };
  Axis axis = vertical;         // vertical: cone; x, y: a slope that falls along this axis, alike across it
  std::optional<Vec3> centre;   // [m] a point of the cone's axis, of the slope's crest; absent: found
  std::optional<double> floor;  // [m] level z that the heap stands on; absent: found
};

struct HeapAngle {
  double angle = 0;    // [rad] mean over flanks, > 0 where the heap falls away from its axis; 0 without flanks
  double scatter = 0;  // [rad] standard deviation over flanks; 0 with fewer than two
  double height = 0;   // [m] of the heap above its floor
  int flanks = 0;      // that had a slope to fit; 0: this is no heap
};

/// Spheres of one grain stand together, as in Simulation::spheres().
HeapAngle heap_angle(std::span<const GrainSphere>, const HeapView& = {});

}  // namespace dem
