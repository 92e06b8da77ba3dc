#pragma once
// A contact that forms within a step: what it had of that step.
//
//   displacement := g_s / (g_s - g_s(last)) displacement       where the gap g_s has turned negative in this step
// Source: Talebiahooie, Thiery, Meng, Mattsson, Nordlund, Rantatalo 2021 (Sustainability 13, 12247), eq. 3.
//
// Where we differ: the gap before the step is not kept. g_s(last) - g_s is what the approach speed covers in the step,
// the same to second order. A pair that has not come that far was in contact all the time (a run starts overlapped).
//
// Shear: shear.hpp moves the spring by half the step that ends (velocity Verlet), right on average over the places of
// the touch within the step. shear_onset() sets the spring of a new contact so that after that half it has taken
// exactly its part. Dashpots that jump to c v at the touch (linear ones): velocity Verlet counts the first force for a
// whole step, half before and half after it, whereas the contact had only part of the half before. Onset::weight makes
// the impulse right; without it the restitution is off by half a step's damping, depending on the place of the touch.
#include "dem/kernels/normal_force.hpp"

namespace dem::kernels {

/// Share of the step that ends that the two were in contact, and 1 for those that were in contact before.
template <class Real>
struct Onset {
  Real part, weight;  // [-] share; weight of a dashpot: share + 1/2 in the first step, 1 later
};

template <class Real>
TRACKBED_HD TRACKBED_LANES Onset<Real> onset(const Touch<Real>& touch, Real separation, const Interval& time) {
  const Real one = all<Real>(1), travel = all<Real>(-time.ended) * separation;
  const auto forms = both(touch.overlap > Real{}, travel > touch.overlap);
  const Real part = choose(forms, touch.overlap, one) / choose(forms, travel, one);
  return {part, choose(forms, part + all<Real>(0.5), one)};
}

/// To be called before sheared(), on the same history.
template <class Real>
TRACKBED_HD TRACKBED_LANES void shear_onset(const NormalForce<Real>& normal, const Touch<Real>& touch,
                                            const Onset<Real>& onset, const Interval& time, Real* history) {
  const auto is_new = both(touch.overlap > Real{}, history[3] == Real{});
  const Real missing = onset.part * all<Real>(time.ended) - all<Real>(time.before);
  const Real loaded = choose(is_new, normal.shear_stiffness * missing, Real{});
  const Vector3<Real> velocity = touch.velocity - normal.separation * touch.normal;
  history[0] -= loaded * velocity.x;
  history[1] -= loaded * velocity.y;
  history[2] -= loaded * velocity.z;
}

}  // namespace dem::kernels
