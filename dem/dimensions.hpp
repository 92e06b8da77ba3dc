#pragma once
// How large a stone or clump is: tangent planes, smallest box, and the sieve it passes.
//
// Definitions, for the convex hull of the body:
//   longest, thinnest  greatest and least distance of two parallel tangent planes (length L and thickness E of EN
//   933-4) box                edges of the bounding box of least volume: length >= width >= thickness sieve side of the
//   smallest square hole that the body passes when it is turned well: least over all
//                      directions of the smallest square around the body's shadow
// EN 933-4: a grain is non-cubical when L / E > 3. EN 933-3: a grain of the fraction d/D is flaky when it passes a bar
// sieve of slot D/2. EN 13450 limits the mass share of flaky grains; Irazabal2017 2.2.1 quotes 35 %, and 4 % for grains
// of 100 mm length or more.
//
// Method: each extreme is searched over the turns of a frame, from 120 starts, the best followed until the turn is
// known to 1e-6 rad. Seeded: the same on every machine up to rounding. Accuracy: 1e-6 for blocks (unit test); between
// turned frames of 40 angular stones the sieve size differed by up to 1.4e-4 of itself, the rest by 2e-5 or less. About
// 10 ms for each of the four.
#include <span>

#include "dem/insertion.hpp"

namespace dem {

struct Dimensions {
  double longest = 0, thinnest = 0;             // [m] between parallel tangent planes
  double length = 0, width = 0, thickness = 0;  // [m] edges of the smallest box
  double sieve = 0;                             // [m] side of the square hole
};

/// Of the hull of these spheres; a corner of a stone is a sphere of radius 0. One or more.
Dimensions dimensions(std::span<const Sphere> corners);
/// Dimensions::sieve alone.
double sieve_size(std::span<const Sphere> corners);

/// Upper sieve D [m] of the fraction d/D of EN 933-3 that holds a grain of this sieve size: d < sieve <= D; a grain of
/// more than 100 mm or at most 4 mm has none: 0.
double fraction_top(double sieve);
/// EN 933-3: passes the bar sieve of its fraction.
bool is_flaky(const Dimensions&);
/// EN 933-4: longest / thinnest > 3.
bool is_elongated(const Dimensions&);

}  // namespace dem
