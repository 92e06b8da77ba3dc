#pragma once
// The loop behind sweep.hpp, compiled once per vector width (sweep_portable.cpp, sweep_avx2.cpp). Nothing of plain
// double may be instantiated here: a function that both files emit would be linked with either's instructions.
#include "dem/kernels/rolling_models.hpp"
#include "dem/sweep.hpp"

namespace dem {
namespace sweeping {

using kernels::all;
using kernels::choose;
using kernels::Pack;
using kernels::Vector3;

template <int W>
using Real = Pack<double, W>;
using Four = Pack<double, 4>;
using Two = Pack<double, 2>;
typedef long long Order4 __attribute__((vector_size(32)));
typedef long long Order2 __attribute__((vector_size(16)));

template <class V>
TRACKBED_LANES V load(const double* from) {
  V value;
  __builtin_memcpy(&value, __builtin_assume_aligned(from, sizeof value), sizeof value);
  return value;
}
template <class V>
TRACKBED_LANES void store(double* to, V value) {
  __builtin_memcpy(__builtin_assume_aligned(to, sizeof value), &value, sizeof value);
}

#if defined(__AVX2__)
/// Rows of four numbers <-> four packs of one number each. (Its own inverse.)
TRACKBED_LANES void transpose(const Four* rows, Four* columns) {
  const Order4 low{0, 4, 2, 6}, high{1, 5, 3, 7}, left{0, 1, 4, 5}, right{2, 3, 6, 7};
  const Four a = __builtin_shuffle(rows[0], rows[1], low), b = __builtin_shuffle(rows[0], rows[1], high);
  const Four c = __builtin_shuffle(rows[2], rows[3], low), d = __builtin_shuffle(rows[2], rows[3], high);
  columns[0] = __builtin_shuffle(a, c, left);
  columns[1] = __builtin_shuffle(b, d, left);
  columns[2] = __builtin_shuffle(a, c, right);
  columns[3] = __builtin_shuffle(b, d, right);
}

/// Four numbers of the rows index[0 … W): from `base`, rows `stride` apart.
TRACKBED_LANES void gather(const double* base, int stride, const int* index, Real<4>* columns) {
  Four rows[4];
  for (int k = 0; k < 4; ++k) rows[k] = load<Four>(base + static_cast<long>(stride) * index[k]);
  transpose(rows, columns);
}
/// Adds four numbers to each of the rows first[k], and four to second[k].
TRACKBED_LANES void scatter(double* base, int stride, const int* first, const int* second, const Real<4>* columns_i,
                            const Real<4>* columns_j) {
  Four rows_i[4], rows_j[4];
  transpose(columns_i, rows_i);
  transpose(columns_j, rows_j);
  for (int k = 0; k < 4; ++k) {
    double* i = base + static_cast<long>(stride) * first[k];
    store(i, load<Four>(i) + rows_i[k]);
    double* j = base + static_cast<long>(stride) * second[k];
    store(j, load<Four>(j) + rows_j[k]);
  }
}
#endif
TRACKBED_LANES void gather(const double* base, int stride, const int* index, Real<2>* columns) {
  const double *a = base + static_cast<long>(stride) * index[0], *b = base + static_cast<long>(stride) * index[1];
  for (int k = 0; k < 4; k += 2) {
    const Two upper = load<Two>(a + k), lower = load<Two>(b + k);
    columns[k] = __builtin_shuffle(upper, lower, Order2{0, 2});
    columns[k + 1] = __builtin_shuffle(upper, lower, Order2{1, 3});
  }
}

TRACKBED_LANES void scatter(double* base, int stride, const int* first, const int* second, const Real<2>* columns_i,
                            const Real<2>* columns_j) {
  for (int lane = 0; lane < 2; ++lane) {
    double* i = base + static_cast<long>(stride) * first[lane];
    double* j = base + static_cast<long>(stride) * second[lane];
    const Order2 order{lane, lane + 2};
    for (int k = 0; k < 4; k += 2) {
      store(i + k, load<Two>(i + k) + __builtin_shuffle(columns_i[k], columns_i[k + 1], order));
      store(j + k, load<Two>(j + k) + __builtin_shuffle(columns_j[k], columns_j[k + 1], order));
    }
  }
}

template <class Law, class Model, int W, bool Ledger, bool Turns>
void sweep(const SweepInput& in, SweepSums& sums) {
  using R = Real<W>;
  constexpr bool braked = std::is_same_v<Model, kernels::BoundedRolling>;
  constexpr bool rolls = !braked && !std::is_same_v<Model, kernels::NoRolling>;
  constexpr int stride = Turns ? 8 : 4, law_numbers = Law::history + (Ledger ? 1 : 0);
  constexpr int numbers = law_numbers + (Model::history > 0 ? Model::history + (Ledger ? 1 : 0) : 0);
  R elastic_normal{}, elastic_shear{}, loss_friction{}, loss_damping{}, loss_rolling{};
  auto too_large = R{} > R{};
  for (int block = 0; block < in.blocks; ++block) {
    const int *i = in.first + block * W, *j = in.second + block * W;
    for (int k = 0; k < W; ++k) {  // rows of the partners some blocks ahead; the lists end with blocks to spare
      __builtin_prefetch(in.place + 4L * j[k + 4 * W]);
      __builtin_prefetch(in.motion + static_cast<long>(stride) * j[k + 4 * W]);
    }
    R a[4], b[4], u[4], v[4];
    gather(in.place, 4, i, a);
    gather(in.place, 4, j, b);
    gather(in.motion, stride, i, u);
    gather(in.motion, stride, j, v);

    kernels::Touch<R> touch;
    const Vector3<R> between{a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    // The divisions do not wait for the root.
    const R squared = norm2(between), reach = a[3] + b[3], mass = u[3] + v[3];
    const auto apart = squared > R{};
    const R distance = kernels::square_root(squared), square_inverse = all<R>(1) / choose(apart, squared, all<R>(1));
    const R inverse = all<R>(1) / (reach * mass);
    touch.overlap = reach - distance;
    touch.effective_radius = a[3] * b[3] * (inverse * mass);
    touch.effective_mass = u[3] * v[3] * (inverse * reach);
    touch.normal = (distance * square_inverse) * between;
    touch.normal.z = choose(apart, touch.normal.z, all<R>(1));
    touch.velocity = {u[0] - v[0], u[1] - v[1], u[2] - v[2]};
    const R half = all<R>(0.5) * touch.overlap, arm_i = a[3] - half, arm_j = b[3] - half;
    Vector3<R> turning;
    if constexpr (Turns) {
      R p[4], q[4];
      gather(in.motion + 4, stride, i, p);
      gather(in.motion + 4, stride, j, q);
      const Vector3<R> spin{arm_i * p[0] + arm_j * q[0], arm_i * p[1] + arm_j * q[1], arm_i * p[2] + arm_j * q[2]};
      touch.velocity -= cross(spin, touch.normal);
      turning = {p[0] - q[0], p[1] - q[1], p[2] - q[2]};
    }
    const R smaller = kernels::smaller(a[3], b[3]);
    too_large |= (touch.overlap > all<R>(in.maximum_overlap) * smaller) & (smaller > R{});

    R history[numbers > 0 ? numbers : 1];
    double* kept = in.history + static_cast<long>(block) * numbers * W;
    for (int k = 0; k < numbers; ++k) history[k] = load<R>(kept + k * W);
    const auto contact = Law::template press<Ledger>(*in.parameters, touch, in.time, history);
    kernels::Moment<R> couple;
    if constexpr (rolls) {
      kernels::RollingContact<R> rolling{turning, contact.normal_force, R{}, R{}};
      if constexpr (Law::history > 0) rolling.shear_stiffness = history[Law::history - 1];
      rolling.inertia = kernels::rolling_inertia(u[3], a[3], v[3], b[3]);
      couple = Model::template resist<Ledger>(*in.parameters, touch, rolling, in.time, history + law_numbers);
    }
    for (int k = 0; k < numbers; ++k) store(kept + k * W, history[k]);

    const Vector3<R>& f = contact.force;
    R braking{};
    if constexpr (braked)
      braking = all<R>(in.parameters->rolling_friction) * touch.effective_radius * contact.normal_force;
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
  for (int k = 0; k < W; ++k) {
    sums.elastic_normal += elastic_normal[k];
    sums.elastic_shear += elastic_shear[k];
    sums.loss_friction += loss_friction[k];
    sums.loss_damping += loss_damping[k];
    sums.loss_rolling += loss_rolling[k];
  }
  sums.overlap_too_large = sums.overlap_too_large || kernels::any(too_large);
}

template <class Law, int W>
Sweep pick(const SweepChoice& c) {
  using kernels::NoRolling;
  if (!c.turns) return c.ledger ? sweep<Law, NoRolling, W, true, false> : sweep<Law, NoRolling, W, false, false>;
  constexpr Sweep table[2][4] = {
      {sweep<Law, NoRolling, W, false, true>, sweep<Law, kernels::RollingA, W, false, true>,
       sweep<Law, kernels::RollingC, W, false, true>, sweep<Law, kernels::BoundedRolling, W, false, true>},
      {sweep<Law, NoRolling, W, true, true>, sweep<Law, kernels::RollingA, W, true, true>,
       sweep<Law, kernels::RollingC, W, true, true>, sweep<Law, kernels::BoundedRolling, W, true, true>}};
  return table[c.ledger][c.rolling];
}

}  // namespace sweeping
}  // namespace dem
