#pragma once
// How the contact forces are spread: few contacts carry much, many carry little.
//
//   f_n = f . n   normal force of a contact, n the unit vector from the partner's centre (or the wall) to the grain's;
//                 compression positive
//   f_t = |f - f_n n|   shear force
//   P(x)          probability density of x = f / <f>, each of f_n and f_t over its own mean
// Source: Radjai, Jean, Moreau, Roux 1996, Phys. Rev. Lett. 77:274 (doi:10.1103/PhysRevLett.77.274): below the mean
// P(f_n/<f_n>) is nearly level, above it falls exponentially; the contacts above the mean are the strong network.
#include <span>
#include <vector>

#include "dem/dem.hpp"
#include "dem/measure/region.hpp"

namespace dem {

struct ContactForce {
  double normal = 0;  // [N] compression positive
  double shear = 0;   // [N] magnitude
};

/// Of every contact between grains and, if asked, with walls, whose contact point lies in the region (null: all). The
/// point between two grains is taken half-way between the spheres that touch.
std::vector<ContactForce> contact_forces(const Region*, std::span<const GrainContact>,
                                         std::span<const WallContact> = {});

double mean_normal_force(std::span<const ContactForce>);  // [N] 0 without contacts
double share_above_mean(std::span<const ContactForce>);   // of the contacts, by normal force; 0 without contacts
/// Normal force [N] that this share of the contacts stays below, linear between contacts; 0 without contacts.
double normal_force_quantile(std::span<const ContactForce>, double share);

struct ForceHistogram {
  double width = 0;                   // of a class, in means
  std::vector<double> normal, shear;  // P(x) of the classes from 0 on; their sums times the width are 1
};
/// Classes up to the largest force, 1000 at most: what lies beyond is in the last. Empty without contacts.
ForceHistogram force_histogram(std::span<const ContactForce>, double width = 0.1);

}  // namespace dem
