#pragma once
// What ParaView sees of the grains: their state as points, their contacts as force chains.
//
// Stress of one grain (static part), tension positive:
//   sigma_ab = 1/(2 V) * sum over its contacts of (l_a f_b + f_a l_b)
//   V = 4/3 pi R^3 volume of the grain, l from its centre to the contact point, f the contact force on the grain.
//   With l counted from the contact to the centre the same sum carries a minus sign, as most papers print it.
// Source: Christoffersen, Mehrabadi, Nemat-Nasser 1981, J. Appl. Mech. 48:339, eq. 2.11 (DOI 10.1115/1.3157619), taken
// for one grain as in Bagi 1996, Mech. Mater. 22:165 (DOI 10.1016/0167-6636(95)00044-5). Where we differ: the volume is
// the grain's own, not its cell with the pores around it. The stress of the packing as a continuum is the volume mean
// times the solid fraction (1 - porosity). Validity: quasi-static; the inertia of the grain (m a ⊗ x) is left out.
#include <array>
#include <filesystem>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "base/pvd.hpp"
#include "dem/dem.hpp"

namespace dem {

/// xx, yy, zz, xy, yz, xz: the order VTK and ParaView give a symmetric tensor. [Pa], tension positive.
using SymmetricStress = std::array<double, 6>;

/// Volume [m3] of a grain's solid; `shapes`: as given to Simulation::add_shape(), in that order.
double volume(const Grain&, std::span<const Clump> shapes);

/// The spheres of a grain where it is.
std::vector<Sphere> placed_spheres(const Grain&, std::span<const Clump> shapes);

/// Stress of every grain, in the order of `grains`. Contacts of grains that are not among them are ignored. The contact
/// point of two grains lies in the middle of their overlap; that of a grain and a wall is the wall's.
std::vector<SymmetricStress> grain_stress(std::span<const Grain> grains, std::span<const GrainContact>,
                                          std::span<const WallContact>, std::span<const Clump> shapes = {});

/// Writes the grains of one run, time level after time level. Not for every step: it works on host copies.
/// Every member throws base::MachineError, naming the file, when the disk fails.
class Writer {
 public:
  /// Makes RUN/grains. `reference`: the grains whose positions are the zero of displacement.
  Writer(std::filesystem::path run_directory, std::span<const Grain> reference, std::vector<Clump> shapes = {},
         const std::array<Period, 3>& periods = {});

  /// RUN/grains/grains_NNNN.vtp and a line in RUN/grains.pvd. A point for every sphere of every grain, with the
  /// sphere's radius [m] and its grain's id, velocity [m/s], angular_velocity [rad/s], displacement [m] of the centre
  /// since the reference (zero for a grain it does not hold; to the nearest image), coordination [-] (grains and wall
  /// contacts it has), stress [Pa] and vertical_stress [Pa] (its zz component).
  void write(double time, std::span<const Grain>, std::span<const GrainContact>, std::span<const WallContact>);

  /// RUN/contacts/contacts_NNNN.vtp and a line in RUN/contacts.pvd: one segment per contact, centre to centre, or
  /// centre to wall point. Cell data: force [N] (magnitude), normal_force [N] (along the segment, compression
  /// positive), wall [-] (number of the wall; -1 between grains).
  void write_contacts(double time, std::span<const GrainContact>, std::span<const WallContact>);

  /// The zero of displacement and what has been written, for a checkpoint; restore() goes on after it.
  base::Columns save() const;
  void restore(const base::Columns&);

 private:
  template <class Self, class Walk>
  static void walk(Self&, Walk&&);

  std::filesystem::path run_directory_;
  std::vector<Clump> shapes_;
  std::array<Period, 3> periods_;
  std::unordered_map<std::int64_t, Vec3> reference_;  // [m] position by grain id
  base::Pvd grains_collection_, contacts_collection_;
  int grain_levels_ = 0, contact_levels_ = 0;
};

}  // namespace dem
