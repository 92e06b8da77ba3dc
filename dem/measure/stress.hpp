#pragma once
// Mean stress of the grains in a region, as of a continuum.
//
// Equation (Love 1927, Weber 1966), static part, tension positive:
//   sigma_ab = 1/V * sum over contacts of w (f_a l_b + l_a f_b) / 2
//   f force on grain i, l branch from the centre of i to that of its partner j, or to the contact point with a wall;
//   w share of the branch that lies in the region, V volume of the region, pores included.
// A force that presses points against its branch, so that compression counts negative, as in the solids.
// Source: Christoffersen, Mehrabadi, Nemat-Nasser 1981, J. Appl. Mech. 48:339, eq. 2.11 (doi:10.1115/1.3157619); the
// share of the branch: Laetzel, Luding, Herrmann 2000, Granular Matter 2:123 (doi:10.1007/s100350000048).
// Where we differ: the symmetric part is taken. Grains at rest without rolling moments have no other.
// Validity: quasi-static; the motion of the grains against their mean (kinetic part) is left out. Weight acts at the
// centres of the grains, so that a branch carries what lies above it. A region that reaches beyond the bed counts the
// empty space as material without stress.
#include <array>
#include <span>

#include "dem/dem.hpp"
#include "dem/measure/region.hpp"

namespace dem {

struct RegionStress {
  double xx = 0, yy = 0, zz = 0, xy = 0, yz = 0, zx = 0;   // [Pa] tension positive
  double pressure() const { return -(xx + yy + zz) / 3; }  // [Pa] mean, compression positive
  /// sqrt(3/2 s:s), s the deviator [Pa]; in a triaxial state the difference of axial and radial stress.
  double von_mises() const;
};

/// `grains`: sorted by id, all that touch; their centres are the ends of the branches. Contacts of others are left out.
RegionStress region_stress(const Region&, std::span<const Grain> grains, std::span<const GrainContact>,
                           std::span<const WallContact>);

}  // namespace dem
