#pragma once
// Linear parallel bond: a disc of cement of radius R_b between two grains, beside whatever contact law they touch by,
// until it breaks.
//
//   A = pi R_b^2,  I = pi R_b^4 / 4,  J = 2 I
//   N = k_n A (overlap - overlap at bonding)            > 0 compressed
//   dV = -k_s A d(tangential displacement),  dM = -k_n I d(bending angle),  dT = -k_s J d(twist angle)
//   breaks where  -N / A + |M| R_b / I > tensile strength  or  |V| / A + |T| R_b / J > shear strength
// Source: Potyondy, Cundall 2004 (doi:10.1016/j.ijrmms.2004.09.011), section 2.2: the bond of the parallel-bond
// simulation (Chen et al. 2015) that Talebiahooie2021 compares with; its Table 3 prints N/m and N for the Pa/m and Pa
// that these equations need.
// Where we differ:
// - N is taken from the overlap, not summed up, so it cannot drift;
// - a step's displacements are those that the grains really made (the velocities that moved them, times the step), not
//   velocities of instants: extrapolated to an instant, these would feed energy into an undamped spring in every step;
// - shear and bending follow the tilt of the normal, and the spin of the pair about it.
//
// Energy: what a bond stores is elastic; what it has stored when it breaks is lost. Bonds have no dashpot of their own.
// A chain of spheres h apart is a beam with E = k_n h, G times the shear factor = k_s h, and the section above.
#include "base/vec3.hpp"

namespace dem::kernels {
using base::Vec3;

struct BondParameters {
  double radius = 0;            // [m] R_b
  double normal_stiffness = 0;  // [Pa/m] k_n, per area of the bond
  double shear_stiffness = 0;   // [Pa/m] k_s
  double tensile_strength = 0;  // [Pa]
  double shear_strength = 0;    // [Pa]
};

/// Normal, shear, bending and twist of a bond: loads [N], [N], [N m], [N m], or stiffnesses.
struct BondSection {
  double area, radius_by_inertia;             // [m2], [1/m3] R_b / I
  double normal_stiffness, shear_stiffness;   // [N/m]
  double bending_stiffness, twist_stiffness;  // [N m]
  TRACKBED_HD explicit BondSection(const BondParameters& bond) {
    const double squared = bond.radius * bond.radius;
    area = 3.14159265358979323846 * squared;
    const double inertia = 0.25 * area * squared;
    radius_by_inertia = bond.radius / inertia;
    normal_stiffness = bond.normal_stiffness * area;
    shear_stiffness = bond.shear_stiffness * area;
    bending_stiffness = bond.normal_stiffness * inertia;
    twist_stiffness = 2 * bond.shear_stiffness * inertia;
  }
};

/// On i; j gets the opposite.
struct BondLoad {
  double normal = 0;    // [N] > 0 compressed
  Vec3 shear, bending;  // [N], [N m] across the normal
  double twist = 0;     // [N m] about the normal
};

/// What a bond keeps from step to step.
struct BondState {
  double overlap = 0;  // [m] at bonding
  Vec3 normal;         // [-] unit vector from j to i, last seen
  BondLoad load;       // there
};

/// Where i and j are now, and how they came there in the step that ends; all displacements zero where none does.
struct BondMotion {
  double overlap = 0;           // [m]
  Vec3 normal;                  // [-]
  double arm_i = 0, arm_j = 0;  // [m] from the centres to the bond
  Vec3 displacement;            // [m] of i's centre relative to j's
  Vec3 turn_i, turn_j;          // [rad]
};

struct BondReaction {
  Vec3 force, moment;  // [N], [N m] on i at the bond; j gets the opposite
  double elastic = 0;  // [J] stored now
  double loss = 0;     // [J] with which it broke
  bool holds = true;
};

struct ParallelBond {
  TRACKBED_HD static BondReaction press(const BondParameters& bond, const BondMotion& motion, BondState& state) {
    const BondSection section(bond);
    const Vec3& n = motion.normal;
    const Vec3 both = state.normal + n;
    const double length = norm(both);
    const Vec3 middle = length > 0 ? (1 / length) * both : n;
    const Vec3 turning = motion.turn_i - motion.turn_j;
    const double twisting = dot(turning, middle);
    const Vec3 bending = across(turning - twisting * middle, n);
    const Vec3 rolled = motion.arm_i * motion.turn_i + motion.arm_j * motion.turn_j;
    const Vec3 slip = motion.displacement - cross(rolled, middle);
    const Vec3 sliding = across(slip - dot(slip, middle) * middle, n);

    const double spin = 0.5 * dot(motion.turn_i + motion.turn_j, middle);
    const BondLoad last{state.load.normal, turned(state.load.shear, state.normal, n, spin),
                        turned(state.load.bending, state.normal, n, spin), state.load.twist};
    const BondLoad now{
        section.normal_stiffness * (motion.overlap - state.overlap), last.shear - section.shear_stiffness * sliding,
        last.bending - section.bending_stiffness * bending, last.twist - section.twist_stiffness * twisting};
    BondReaction result;
    result.holds = holds(bond, section, now);
    if (result.holds) {
      result.force = now.normal * n + now.shear;
      result.moment = now.bending + now.twist * n;
      result.elastic = stored(section, now, now);
      state = {state.overlap, n, now};
    } else {
      // Velocity Verlet has let the last force work over half the step that it gave way in.
      result.loss = stored(section, last, now);
      state = {};
    }
    return result;
  }

 private:
  TRACKBED_HD static Vec3 across(const Vec3& v, const Vec3& n) { return v - dot(v, n) * n; }

  /// Carried from the plane across `from` to that across `to` by the turn that takes one to the other, then by `spin`
  /// about it.
  TRACKBED_HD static Vec3 turned(const Vec3& v, const Vec3& from, const Vec3& to, double spin) {
    const Vec3 axis = cross(from, to);
    const double cosine = dot(from, to), share = cosine > -0.5 ? 1 / (1 + cosine) : 0;
    const Vec3 tilt = cross(axis, v);
    const Vec3 tilted = across(v + tilt + share * cross(axis, tilt), to);
    return std::cos(spin) * tilted + std::sin(spin) * cross(to, tilted);
  }

  TRACKBED_HD static bool holds(const BondParameters& bond, const BondSection& section, const BondLoad& load) {
    const double tension = norm(load.bending) * section.radius_by_inertia - load.normal / section.area;
    const double shear = norm(load.shear) / section.area + 0.5 * std::fabs(load.twist) * section.radius_by_inertia;
    return tension <= bond.tensile_strength && shear <= bond.shear_strength;
  }

  /// Half the products of two loads over the stiffnesses [J]: of one with itself, what it stores.
  TRACKBED_HD static double stored(const BondSection& section, const BondLoad& a, const BondLoad& b) {
    return 0.5 *
           (per(a.normal * b.normal, section.normal_stiffness) + per(dot(a.shear, b.shear), section.shear_stiffness) +
            per(dot(a.bending, b.bending), section.bending_stiffness) +
            per(a.twist * b.twist, section.twist_stiffness));
  }
  TRACKBED_HD static double per(double product, double stiffness) { return stiffness > 0 ? product / stiffness : 0; }
};

}  // namespace dem::kernels
