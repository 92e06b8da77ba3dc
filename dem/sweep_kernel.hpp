#pragma once
// The loop behind sweep.hpp, compiled once per vector width (sweep_portable.cpp, sweep_avx2.cpp). Nothing of plain
// double may be instantiated here: a function that both files emit would be linked with either's instructions.
#include "dem/kernels/rolling_models.hpp"
#include "dem/sweep_access.hpp"

namespace dem {
namespace sweeping {

using kernels::choose;

/// Real: the pack that the law is computed in.
template <class Law, class Model, class R, bool Ledger, bool Turns>
void sweep(const SweepInput& input, SweepSums& sums) {
  // Copies, which what is stored in the loop can't change: numbers are spread over the lanes once.
  const SweepInput in = input;
  const kernels::PairParameters parameters = *input.parameters;
  using Number = typename kernels::LanesOf<R>::Number;
  constexpr int W = kernels::LanesOf<R>::width;
  constexpr bool braked = std::is_same_v<Model, kernels::BoundedRolling>;
  constexpr bool rolls = !braked && !std::is_same_v<Model, kernels::NoRolling>;
  constexpr int stride = Turns ? 8 : 4, law_numbers = Law::history + (Ledger ? 1 : 0);
  constexpr int numbers = law_numbers + (Model::history > 0 ? Model::history + (Ledger ? 1 : 0) : 0);
  Total<R> elastic_normal, elastic_shear, loss_friction, loss_damping, loss_rolling;
  auto too_large = R{} > R{};
  for (int block = 0; block < in.blocks; ++block) {
    const int *i = in.first + block * W, *j = in.second + block * W;
    for (int k = 0; k < W; ++k) {  // rows of the partners some blocks ahead
      const long next = j[k + sweep_looks_ahead];
      __builtin_prefetch(in.place + 4 * next);
      __builtin_prefetch(in.motion + stride * next);
      __builtin_prefetch(in.pull + stride * next, 1);
    }
    Partners<R> pair;
    read<Turns, W>(in, i, j, pair);

    kernels::Touch<R> touch;
    // The divisions do not wait for the root.
    const R squared = norm2(pair.between), reach = pair.radius_i + pair.radius_j, mass = pair.mass_i + pair.mass_j;
    const auto apart = squared > R{};
    const R distance = kernels::square_root(squared), square_inverse = all<R>(1) / choose(apart, squared, all<R>(1));
    const R inverse = all<R>(1) / (reach * mass);
    if constexpr (std::is_same_v<Number, float>)
      touch.overlap = pair.gap / (reach + distance);
    else
      touch.overlap = reach - distance;
    touch.effective_radius = pair.radius_i * pair.radius_j * (inverse * mass);
    touch.effective_mass = pair.mass_i * pair.mass_j * (inverse * reach);
    touch.normal = (distance * square_inverse) * pair.between;
    touch.normal.z = choose(apart, touch.normal.z, all<R>(1));
    touch.velocity = pair.velocity;
    const R half = all<R>(0.5) * touch.overlap, arm_i = pair.radius_i - half, arm_j = pair.radius_j - half;
    if constexpr (Turns) touch.velocity -= cross(arm_i * pair.spin_i + arm_j * pair.spin_j, touch.normal);
    const R smaller = kernels::smaller(pair.radius_i, pair.radius_j);
    too_large |= (touch.overlap > all<R>(in.maximum_overlap) * smaller) & (smaller > R{});

    R history[numbers > 0 ? numbers : 1];
    Number* kept = static_cast<Number*>(in.history) + static_cast<long>(block) * numbers * W;
    for (int k = 0; k < numbers; ++k) history[k] = load<R>(kept + k * W);
    const auto contact = Law::template press<Ledger>(parameters, touch, in.time, history);
    kernels::Moment<R> couple;
    if constexpr (rolls) {
      kernels::RollingContact<R> rolling{pair.spin_i - pair.spin_j, contact.normal_force, R{}, R{}};
      if constexpr (Law::history > 0) rolling.shear_stiffness = history[Law::history - 1];
      rolling.inertia = kernels::rolling_inertia(pair.mass_i, pair.radius_i, pair.mass_j, pair.radius_j);
      couple = Model::template resist<Ledger>(parameters, touch, rolling, in.time, history + law_numbers);
    }
    for (int k = 0; k < numbers; ++k) store(kept + k * W, history[k]);

    const Vector3<R>& f = contact.force;
    R braking{};
    if constexpr (braked) braking = all<R>(parameters.rolling_friction) * smaller * contact.normal_force;
    const R on_i[4] = {f.x, f.y, f.z, braking}, on_j[4] = {-f.x, -f.y, -f.z, braking};
    scatter(in.pull, stride, in.to_first + block * W, in.to_second + block * W, on_i, on_j);
    if constexpr (Turns) {
      const Vector3<R> moment = cross(f, touch.normal);
      R turn_i[4] = {arm_i * moment.x, arm_i * moment.y, arm_i * moment.z, R{}};
      R turn_j[4] = {arm_j * moment.x, arm_j * moment.y, arm_j * moment.z, R{}};
      if constexpr (rolls)
        for (int k = 0; k < 3; ++k) {
          turn_i[k] += couple.moment[k];
          turn_j[k] -= couple.moment[k];
        }
      scatter(in.pull + 4, stride, in.to_first + block * W, in.to_second + block * W, turn_i, turn_j);
    }
    if constexpr (Ledger) {
      elastic_normal += contact.elastic_normal;
      elastic_shear += contact.elastic_shear;
      loss_friction += contact.loss_friction;
      loss_damping += contact.loss_damping;
      if constexpr (rolls) {
        elastic_shear += couple.elastic;
        loss_rolling += couple.loss;
      }
    }
  }
  sums.elastic_normal += sum(elastic_normal);
  sums.elastic_shear += sum(elastic_shear);
  sums.loss_friction += sum(loss_friction);
  sums.loss_damping += sum(loss_damping);
  sums.loss_rolling += sum(loss_rolling);
  sums.overlap_too_large = sums.overlap_too_large || kernels::any(too_large);
}

template <class Law, class R>
Sweep pick(const SweepChoice& c) {
  using kernels::NoRolling;
  if (!c.turns) return c.ledger ? sweep<Law, NoRolling, R, true, false> : sweep<Law, NoRolling, R, false, false>;
  constexpr Sweep table[2][4] = {
      {sweep<Law, NoRolling, R, false, true>, sweep<Law, kernels::RollingA, R, false, true>,
       sweep<Law, kernels::RollingC, R, false, true>, sweep<Law, kernels::BoundedRolling, R, false, true>},
      {sweep<Law, NoRolling, R, true, true>, sweep<Law, kernels::RollingA, R, true, true>,
       sweep<Law, kernels::RollingC, R, true, true>, sweep<Law, kernels::BoundedRolling, R, true, true>}};
  return table[c.ledger][c.rolling];
}

}  // namespace sweeping
}  // namespace dem
