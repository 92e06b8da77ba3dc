#pragma once
// Fills a stone with spheres: a clump that follows its surface.
//
// Method: candidates are inscribed spheres grown to the surface. From points spread over every triangle a sphere that
// touches there grows inwards until it touches the surface a second time (shrinking ball, Ma et al. 2012,
// doi:10.1007/s00371-012-0681-8). Of these the one that covers most of what is not yet covered is taken, again and
// again, measured on a grid of points; each must overlap those before it.
// Differs from Irazabal2017 5.3.4, which uses the reduced Hubbard method of a sphere-tree toolkit; numbers of spheres
// are its own: 7-16 and 29-45. Validity: closed surfaces (stone.hpp), any shape. All spheres lie inside the stone (to
// 1e-6 of its size), so that the clump is always smaller than the stone; sharp edges stay rounded. Work grows with
// triangles^2: some seconds for 5000.
#include <vector>

#include "dem/stone.hpp"

namespace dem {

struct Filling {
  std::vector<Sphere> spheres;  // in the stone's frame, in the order in which they were taken
  double error_volume = 0;      // volume of the symmetric difference of stone and clump / stone's volume
};

/// The same stone and number give the same spheres. Throws base::UserError: spheres not in [1, 1000], or the surface
/// offers fewer.
Filling fill_with_spheres(const Stone&, int spheres);

}  // namespace dem
