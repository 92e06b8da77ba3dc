#pragma once
// Mass properties of a union of spheres: what overlaps counts once.
//
// Method: exact up to rounding, without slices or meshes. By the divergence theorem
//   V = 1/3 oint x.n dA,   int x_a = 1/4 oint (x.n) x_a dA,   int x_a x_b = 1/5 oint (x.n) x_a x_b dA,
// and the surface is, on each sphere x = c + R n, the unit sphere without the caps that the other spheres cut away.
// What is left, W, is bounded by arcs of circles (s: arc length, nu: outward conormal, |n| = 1), and
//   int_W n_a           = -1/2 oint nu_a ds
//   int_W n_a n_b       =  1/3 (delta_ab int_W 1 - oint n_b nu_a ds)
//   int_W n_a n_b n_c   =  1/4 (delta_ab int_W n_c + delta_ac int_W n_b - oint n_b n_c nu_a ds)
// from the surface divergence theorem int_W div F = oint F.nu ds + 2 int_W F.n. int_W 1 comes from the area form
// -(1 + cos t) dphi about a pole q, plus 4 pi where q lies in W, in closed form on each arc. Source: own derivation;
// the idea of area by arcs is Connolly 1983, doi:10.1107/S0021889883010985. Differs from Irazabal2017 5.3.4, which
// meshes the union with tetrahedra.
//
// Validity: any overlaps, holes, spheres inside others, equal spheres, circles that coincide. Where circles nearly
// coincide (separation e of the radius, not zero) the crossing points lose accuracy: relative error about 1e-16 / e.
#include <span>

#include "dem/insertion.hpp"
#include "dem/mass_properties.hpp"

namespace dem {

/// `spheres`: one or more, radii > 0.
MassProperties union_properties(std::span<const Sphere> spheres);

}  // namespace dem
