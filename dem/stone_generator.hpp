#pragma once
// Makes angular stones: a block cut by planes all round, as crushing leaves it - convex, flat faces, sharp edges.
//
// Model: a block of length : width : thickness is cut by `cuts` planes. Their normals are spread evenly over the
// ellipsoid that fills the block (golden spiral, then each moved at random); each plane stands at 0.80-1.08 of the
// distance of the ellipsoid's tangent plane. The stone is then scaled to its sieve size, moved to its centroid and
// turned into its principal axes, and its corners are rounded to 1 um. Source: none; shapes are judged by their
// measured flakiness and elongation (dimensions.hpp). Validity: convex stones only. Re-entrant faces of real ballast
// are missing.
#include <cstdint>

#include "dem/stone.hpp"

namespace dem {

struct AngularStone {
  std::uint64_t seed = 1;
  double sieve = 0.045;              // [m] square hole that the stone just passes
  double width_to_length = 0.75;     // of the block, in (0, 1]
  double thickness_to_width = 0.75;  // of the block, in (0, 1]
  int cuts = 14;                     // 4 to 100
};

/// Closed, centroid at the origin to 1 um, x its longest axis. The same seed gives the same stone on every machine.
/// Throws base::UserError for a parameter out of its range.
Stone make_stone(const AngularStone&);

}  // namespace dem
