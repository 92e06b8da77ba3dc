#pragma once
// Linear parallel bond: a disc of cement of radius R_b between two grains, beside a linear contact (linear.hpp), until
// it breaks.
//
//   A = pi R_b^2,  I = pi R_b^4 / 4,  J = 2 I
//   N = k_n A (overlap - overlap at bonding)            > 0 compressed
//   dV = -k_s A d(tangential displacement),  dM = -k_n I d(bending angle),  dT = -k_s J d(twist angle)
//   breaks where  -N / A + |M| R_b / I > tensile strength  or  |V| / A + |T| R_b / J > shear strength
// Source: Potyondy, Cundall 2004 (doi:10.1016/j.ijrmms.2004.09.011), section 2.2: the bond of the parallel-bond
// simulation (Chen et al. 2015) that Talebiahooie2021 compares with; its Table 3 prints N/m and N for the Pa/m and Pa
// that these equations need.
// Where we differ: N is taken from the overlap, not summed up, so it cannot drift.
//
// Bonded pairs are made at the start: bond() on the pair's history. Other pairs of the same materials only touch. A
// bond pulls, so `press` must be called for bonded pairs also where overlap <= 0: the caller keeps them listed while
// bonded(). History: shear and bending follow the tilt of the normal and the spin of the pair about it.
// Energy: what a bond stores is elastic; what it stored when it breaks is lost. Bonds have no dashpot of their own.
#include "dem/kernels/linear.hpp"
#include "dem/kernels/turning.hpp"

namespace dem::kernels {

template <class Real>
struct BondReaction {
  Reaction<Real> reaction;  // contact and bond; its energies are those of the contact alone
  Moment<Real> bond;        // its energies are those of the bond, its force included
};

struct ParallelBond {
  static constexpr bool bonds = true;
  // Bond radius [m] (0: none), overlap at bonding [m], shear force [N], bending moment [N m], twist moment [N m], the
  // last three half a step ahead; then as Linear.
  static constexpr int contact_history = 9;
  static constexpr int history = contact_history + Linear::history;

  /// Bonds a pair as it is now, free of stress in the bond. Clears what the contact carried.
  TRACKBED_HD static void bond(double overlap, double bond_radius, double* history) {
    for (int k = 0; k < ParallelBond::history; ++k) history[k] = 0;
    history[0] = bond_radius;
    history[1] = overlap;
  }
  TRACKBED_HD static bool bonded(const double* history) { return history[0] > 0; }

  template <bool Ledger, class Real>
  TRACKBED_HD TRACKBED_LANES static BondReaction<Real> press(const PairParameters& pair, const Touch<Real>& touch,
                                                             const Turning<Real>& turning, const Interval& time,
                                                             Real* history) {
    BondReaction<Real> result;
    result.reaction = Linear::press<Ledger>(pair, touch, time, history + contact_history);
    const Section<Real> section(pair, history[0]);
    const Vector3<Real>& n = touch.normal;
    const Real separation = dot(touch.velocity, n), twisting = dot(turning.angular_velocity, n);
    const Vector3<Real> sliding = touch.velocity - separation * n;
    const Vector3<Real> bending = turning.angular_velocity - twisting * n;

    const Real angle = turning.spin * all<Real>(2 * time.before);
    Load<Real> load{Real{}, turned(Vector3<Real>{history[2], history[3], history[4]}, n, angle),
                    turned(Vector3<Real>{history[5], history[6], history[7]}, n, angle), history[8]};
    if constexpr (Ledger) {  // at the middle of the step that ends: what a bond that breaks now has taken in
      load.normal = section.normal_stiffness * (touch.overlap + separation * all<Real>(time.before) - history[1]);
      result.bond.loss = section.stored(load);
    }
    const Real before = all<Real>(time.before), ahead = all<Real>(time.ahead);
    load.normal = section.normal_stiffness * (touch.overlap - history[1]);
    load.shear -= (section.shear_stiffness * before) * sliding;
    load.bending -= (section.bending_stiffness * before) * bending;
    load.twist -= section.twist_stiffness * before * twisting;

    const Real kept = section.kept(pair, load);
    const auto holds = kept > Real{};
    result.reaction.normal_force += kept * load.normal;
    result.reaction.force += kept * (load.normal * n + load.shear);
    result.bond.moment = kept * (load.bending + load.twist * n);
    if constexpr (Ledger) {
      result.bond.elastic = kept * section.stored(load);
      result.bond.loss = choose(holds, Real{}, choose(section.exists, result.bond.loss, Real{}));
    }
    load.shear -= (section.shear_stiffness * ahead) * sliding;
    load.bending -= (section.bending_stiffness * ahead) * bending;
    load.twist -= section.twist_stiffness * ahead * twisting;
    const Real after[] = {history[0],     history[1],     load.shear.x,   load.shear.y, load.shear.z,
                          load.bending.x, load.bending.y, load.bending.z, load.twist};
    for (int k = 0; k < contact_history; ++k) history[k] = choose(holds, after[k], Real{});
    return result;
  }

 private:
  template <class Real>
  struct Load {
    Real normal;                   // [N] > 0 compressed
    Vector3<Real> shear, bending;  // [N], [N m]
    Real twist;                    // [N m]
  };

  /// Turned into the plane normal to n, and with the pair about n; `angle` is small.
  template <class Real>
  TRACKBED_HD TRACKBED_LANES static Vector3<Real> turned(const Vector3<Real>& kept, const Vector3<Real>& n,
                                                         Real angle) {
    const Real along = dot(kept, n);
    const Real shrink = magnitude_kept(along * along, norm2(kept)) / square_root(all<Real>(1) + angle * angle);
    const Vector3<Real> tilted = kept - along * n;
    return shrink * (tilted + angle * cross(n, tilted));
  }

  /// Stiffnesses of a whole bond; where there is none, zeros.
  template <class Real>
  struct Section {
    decltype(Real{} > Real{}) exists;
    Real area, radius_by_inertia;  // [m2], [1/m3] R_b / I
    Real normal_stiffness, shear_stiffness, bending_stiffness, twist_stiffness;

    TRACKBED_HD TRACKBED_LANES Section(const PairParameters& pair, Real bond_radius) : exists(bond_radius > Real{}) {
      const double pi = 3.14159265358979323846;
      const Real radius = choose(exists, bond_radius, all<Real>(1)), squared = radius * radius;
      area = all<Real>(pi) * squared;
      const Real inertia = all<Real>(0.25) * area * squared;
      radius_by_inertia = radius / inertia;
      const Real k_n = choose(exists, all<Real>(pair.bond_normal_stiffness), Real{});
      const Real k_s = choose(exists, all<Real>(pair.bond_shear_stiffness), Real{});
      normal_stiffness = k_n * area;
      shear_stiffness = k_s * area;
      bending_stiffness = k_n * inertia;
      twist_stiffness = k_s * (inertia + inertia);
    }

    /// 1 where the bond is and stays, 0 elsewhere.
    TRACKBED_HD TRACKBED_LANES Real kept(const PairParameters& pair, const Load<Real>& load) const {
      const Real twist = larger(load.twist, -load.twist);
      const Real tension = square_root(norm2(load.bending)) * radius_by_inertia - load.normal / area;
      const Real shear = square_root(norm2(load.shear)) / area + all<Real>(0.5) * twist * radius_by_inertia;
      const auto holds =
          both(tension <= all<Real>(pair.bond_tensile_strength), shear <= all<Real>(pair.bond_shear_strength));
      return choose(both(exists, holds), all<Real>(1), Real{});
    }

    TRACKBED_HD TRACKBED_LANES Real stored(const Load<Real>& load) const {
      return all<Real>(0.5) *
             (per(load.normal * load.normal, normal_stiffness) + per(norm2(load.shear), shear_stiffness) +
              per(norm2(load.bending), bending_stiffness) + per(load.twist * load.twist, twist_stiffness));
    }
    TRACKBED_HD TRACKBED_LANES static Real per(Real squared, Real stiffness) {
      const auto stiff = stiffness > Real{};
      return choose(stiff, squared, Real{}) / choose(stiff, stiffness, all<Real>(1));
    }
  };
};

}  // namespace dem::kernels

namespace dem {

/// True for laws that pull and need the turning of the pair.
template <class Law>
concept Bonding = requires {
  Law::bonds;
};

}  // namespace dem
