#pragma once
// The loop behind plane_sweep.hpp, compiled once per vector width; sweep_kernel.hpp says what that forbids.
#include "dem/kernels/hertz_mindlin.hpp"
#include "dem/plane_sweep.hpp"
#include "dem/sweep_access.hpp"

namespace dem {
namespace sweeping {

template <int W, bool Ledger, bool Turns>
bool press_planes(const PlaneInput& input, int begin, int end) {
  using R = Doubles<W>;
  using Law = kernels::HertzMindlin;
  constexpr int stride = Turns ? 8 : 4, numbers = Law::history + (Ledger ? 1 : 0);
  const PlaneInput in = input;
  const kernels::PairParameters parameters = *input.parameters;
  auto too_large = R{} > R{};
  for (int first = begin; first < end; first += W) {
    const int count = end - first < W ? end - first : W;
    int row[W], contact[W];
    for (int k = 0; k < W; ++k) {  // lanes beyond the end do what the last one does, and leave nothing
      contact[k] = first + (k < count ? k : count - 1);
      row[k] = in.row[contact[k]];
    }
    R a[4], plane[4];
    gather(in.place, 4, row, a);
    gather(in.plane, 4, contact, plane);
    const Vector3<R> normal{plane[0], plane[1], plane[2]};
    const R height = dot(Vector3<R>{a[0], a[1], a[2]}, normal) - plane[3], radius = a[3];
    const Vector3<R> arm = height * normal;
    gather(in.motion, stride, row, a);

    kernels::Touch<R> touch;
    touch.overlap = radius - height;
    touch.effective_radius = radius;
    touch.effective_mass = a[3];
    touch.normal = normal;
    touch.velocity = {a[0], a[1], a[2]};
    if constexpr (Turns) {
      gather(in.motion + 4, stride, row, a);
      touch.velocity -= cross(Vector3<R>{a[0], a[1], a[2]}, arm);
    }
    too_large |= touch.overlap > all<R>(in.maximum_overlap) * radius;
    R history[numbers];
    for (int n = 0; n < numbers; ++n)
      for (int k = 0; k < W; ++k) history[n][k] = in.history[static_cast<long>(in.candidate[contact[k]]) * numbers + n];
    const auto pressed = Law::template press<Ledger>(parameters, touch, in.time, history);
    const Vector3<R>& force = pressed.force;
    const Vector3<R> torque = cross(force, arm);
    const R rolling = all<R>(in.rolling) * radius * pressed.normal_force;

    for (int k = 0; k < count; ++k) {
      const long c = in.candidate[contact[k]];
      for (int n = 0; n < numbers; ++n) in.history[c * numbers + n] = history[n][k];
      double* sum = in.sum + 8L * in.slot[contact[k]];
      double* state = in.state + 11 * c;
      const bool touching = touch.overlap[k] > 0;
      for (int axis = 0; axis < 3; ++axis) {
        sum[axis] = state[axis] = force[axis][k];
        sum[4 + axis] = torque[axis][k];
        state[4 + axis] = touching ? normal[axis][k] : 0;
        in.impulse[3 * c + axis] += in.ended * force[axis][k];
      }
      sum[3] = rolling[k];
      state[3] = touching ? touch.overlap[k] : 0;
      state[7] = touching ? 1 : 0;
      if constexpr (Ledger) {
        double* ledger = in.ledger + 6 * c;
        ledger[0] += pressed.loss_friction[k];
        ledger[1] += pressed.loss_damping[k];
        ledger[2] = pressed.elastic_normal[k];
        ledger[3] = pressed.elastic_shear[k];
      }
    }
  }
  return kernels::any(too_large);
}

template <int W>
PlaneSweep pick_planes(bool ledger, bool turns) {
  if (ledger) return turns ? press_planes<W, true, true> : press_planes<W, true, false>;
  return turns ? press_planes<W, false, true> : press_planes<W, false, false>;
}

}  // namespace sweeping

PlaneSweep portable_plane_sweep(bool ledger, bool turns);
PlaneSweep avx2_plane_sweep(bool ledger, bool turns);

}  // namespace dem
