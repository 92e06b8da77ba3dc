#pragma once
// How the sweep reads the rows of grains into lanes and adds what comes out: double throughout, or mixed, where what
// two grains are to each other is a difference of doubles and the rest is single precision. Compiled once per vector
// width (sweep_kernel.hpp says what that forbids).
//
// Mixed: positions and velocities are subtracted, and forces added to rows, in double. The overlap is formed without
// loss from (r_i + r_j)^2 - distance^2 in double, divided by r_i + r_j + distance in single precision: its relative
// error is that of single precision, wherever the pair is and however small the overlap (above 1e-9 of the radii).
//
// What it costs, against double (tests/verification/dem_precision.cpp):
// - forces, and energies in the ledger: 1e-7 of themselves;
// - linear momentum: kept as in double (the same numbers are added to i and taken from j); angular: to 1e-7;
// - slow creep under load: a shear spring at the force F takes the displacement of one step to within 1.2e-7 F / k_t,
//   and nothing of less than half that. With F / k_t = 10 um and steps of 5 us: 0.24 um/s, at worst steadily in one
//   direction. Contacts that creep so slowly for long want double;
// - forces below 1e-9 N: their squares' squares leave the range of a float where a contact slips.
//
// Measured there: what all contacts do to the grains of a bed at rest in one step, 8e-8 of the largest; the same bed
// 100 m along the track, 1e-9 (the coordinate's rounding over an overlap). An oblique impact at 1 m/s of turning
// spheres, every law and rolling model: 4e-7 m/s. One by one (core/contact_pass.hpp, as on a GPU) against the sweep:
// 3e-7 m/s. One by one, histories and results of pairs are floats too, so that they take half the memory.
#include "dem/kernels/lanes.hpp"
#include "dem/sweep.hpp"

namespace dem::sweeping {

using kernels::all;
using kernels::Pack;
using kernels::Vector3;

template <int W>
using Doubles = Pack<double, W>;
template <int W>
using Floats = Pack<float, W>;
using Four = Doubles<4>;
using Two = Doubles<2>;
typedef long long Order4 __attribute__((vector_size(32)));
typedef long long Order2 __attribute__((vector_size(16)));

template <class V, class Number>
TRACKBED_LANES V load(const Number* from) {
  V value;
  __builtin_memcpy(&value, __builtin_assume_aligned(from, sizeof value), sizeof value);
  return value;
}
template <class V, class Number>
TRACKBED_LANES void store(Number* to, V value) {
  __builtin_memcpy(__builtin_assume_aligned(to, sizeof value), &value, sizeof value);
}
template <class V>
TRACKBED_LANES void add(double* to, V value) {
  store(to, load<V>(to) + value);
}

// ---- rows of four numbers <-> four packs of one number each
#if defined(__AVX2__)
/// Its own inverse.
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
TRACKBED_LANES void gather(const double* base, int stride, const int* index, Doubles<4>* columns) {
  Four rows[4];
  for (int k = 0; k < 4; ++k) rows[k] = load<Four>(base + static_cast<long>(stride) * index[k]);
  transpose(rows, columns);
}
/// Adds four numbers to each of the rows first[k], and four to second[k].
TRACKBED_LANES void scatter(double* base, int stride, const int* first, const int* second, const Doubles<4>* columns_i,
                            const Doubles<4>* columns_j) {
  Four rows_i[4], rows_j[4];
  transpose(columns_i, rows_i);
  transpose(columns_j, rows_j);
  for (int k = 0; k < 4; ++k) {
    add(base + static_cast<long>(stride) * first[k], rows_i[k]);
    add(base + static_cast<long>(stride) * second[k], rows_j[k]);
  }
}

TRACKBED_LANES Floats<8> narrow(const Four& low, const Four& high) {
  return __builtin_shufflevector(__builtin_convertvector(low, Floats<4>), __builtin_convertvector(high, Floats<4>), 0,
                                 1, 2, 3, 4, 5, 6, 7);
}
TRACKBED_LANES void widen(const Floats<8>& x, Four& low, Four& high) {
  low = __builtin_convertvector(__builtin_shufflevector(x, x, 0, 1, 2, 3), Four);
  high = __builtin_convertvector(__builtin_shufflevector(x, x, 4, 5, 6, 7), Four);
}
TRACKBED_LANES void scatter(double* base, int stride, const int* first, const int* second, const Floats<8>* columns_i,
                            const Floats<8>* columns_j) {
  Four low_i[4], high_i[4], low_j[4], high_j[4];
  const auto rows = [](const Floats<8>* c, Four* low, Four* high) {
    const Floats<8> a = __builtin_shufflevector(c[0], c[1], 0, 8, 1, 9, 4, 12, 5, 13);
    const Floats<8> b = __builtin_shufflevector(c[0], c[1], 2, 10, 3, 11, 6, 14, 7, 15);
    const Floats<8> d = __builtin_shufflevector(c[2], c[3], 0, 8, 1, 9, 4, 12, 5, 13);
    const Floats<8> e = __builtin_shufflevector(c[2], c[3], 2, 10, 3, 11, 6, 14, 7, 15);
    widen(__builtin_shufflevector(a, d, 0, 1, 8, 9, 4, 5, 12, 13), low[0], high[0]);
    widen(__builtin_shufflevector(a, d, 2, 3, 10, 11, 6, 7, 14, 15), low[1], high[1]);
    widen(__builtin_shufflevector(b, e, 0, 1, 8, 9, 4, 5, 12, 13), low[2], high[2]);
    widen(__builtin_shufflevector(b, e, 2, 3, 10, 11, 6, 7, 14, 15), low[3], high[3]);
  };
  rows(columns_i, low_i, high_i);
  rows(columns_j, low_j, high_j);
  for (int k = 0; k < 8; ++k) {
    add(base + static_cast<long>(stride) * first[k], k < 4 ? low_i[k] : high_i[k - 4]);
    add(base + static_cast<long>(stride) * second[k], k < 4 ? low_j[k] : high_j[k - 4]);
  }
}
#else
TRACKBED_LANES Floats<4> narrow(const Two& low, const Two& high) {
  typedef float Half __attribute__((vector_size(8)));
  return __builtin_shufflevector(__builtin_convertvector(low, Half), __builtin_convertvector(high, Half), 0, 1, 2, 3);
}
TRACKBED_LANES void widen(const Floats<4>& x, Two& low, Two& high) {
  low = __builtin_convertvector(__builtin_shufflevector(x, x, 0, 1), Two);
  high = __builtin_convertvector(__builtin_shufflevector(x, x, 2, 3), Two);
}
TRACKBED_LANES void scatter(double* base, int stride, const int* first, const int* second, const Floats<4>* columns_i,
                            const Floats<4>* columns_j) {
  const auto rows = [](const Floats<4>* c, Floats<4>* row) {
    const Floats<4> a = __builtin_shufflevector(c[0], c[1], 0, 4, 1, 5);
    const Floats<4> b = __builtin_shufflevector(c[0], c[1], 2, 6, 3, 7);
    const Floats<4> d = __builtin_shufflevector(c[2], c[3], 0, 4, 1, 5);
    const Floats<4> e = __builtin_shufflevector(c[2], c[3], 2, 6, 3, 7);
    row[0] = __builtin_shufflevector(a, d, 0, 1, 4, 5);
    row[1] = __builtin_shufflevector(a, d, 2, 3, 6, 7);
    row[2] = __builtin_shufflevector(b, e, 0, 1, 4, 5);
    row[3] = __builtin_shufflevector(b, e, 2, 3, 6, 7);
  };
  Floats<4> rows_i[4], rows_j[4];
  rows(columns_i, rows_i);
  rows(columns_j, rows_j);
  for (int k = 0; k < 4; ++k) {
    Two low, high;
    double* i = base + static_cast<long>(stride) * first[k];
    widen(rows_i[k], low, high);
    add(i, low);
    add(i + 2, high);
    double* j = base + static_cast<long>(stride) * second[k];
    widen(rows_j[k], low, high);
    add(j, low);
    add(j + 2, high);
  }
}
#endif
TRACKBED_LANES void gather(const double* base, int stride, const int* index, Doubles<2>* columns) {
  const double *a = base + static_cast<long>(stride) * index[0], *b = base + static_cast<long>(stride) * index[1];
  for (int k = 0; k < 4; k += 2) {
    const Two upper = load<Two>(a + k), lower = load<Two>(b + k);
    columns[k] = __builtin_shuffle(upper, lower, Order2{0, 2});
    columns[k + 1] = __builtin_shuffle(upper, lower, Order2{1, 3});
  }
}

TRACKBED_LANES void scatter(double* base, int stride, const int* first, const int* second, const Doubles<2>* columns_i,
                            const Doubles<2>* columns_j) {
  for (int lane = 0; lane < 2; ++lane) {
    double* i = base + static_cast<long>(stride) * first[lane];
    double* j = base + static_cast<long>(stride) * second[lane];
    const Order2 order{lane, lane + 2};
    for (int k = 0; k < 4; k += 2) {
      add(i + k, __builtin_shuffle(columns_i[k], columns_i[k + 1], order));
      add(j + k, __builtin_shuffle(columns_j[k], columns_j[k + 1], order));
    }
  }
}

// ---- what the rows of W pairs are to each other
template <class R>
struct Partners {
  Vector3<R> between, velocity;          // [m], [m/s] of i relative to j
  R radius_i, radius_j, mass_i, mass_j;  // [m], [kg]
  R gap;                                 // [m2] (r_i + r_j)^2 - distance^2; mixed only
  Vector3<R> spin_i, spin_j;             // [rad/s], where grains turn
};

template <bool Turns, int W>
TRACKBED_LANES void read(const SweepInput& in, const int* i, const int* j, Partners<Doubles<W>>& p) {
  constexpr int stride = Turns ? 8 : 4;
  Doubles<W> a[4], b[4];
  gather(in.place, 4, i, a);
  gather(in.place, 4, j, b);
  p.between = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
  p.radius_i = a[3];
  p.radius_j = b[3];
  gather(in.motion, stride, i, a);
  gather(in.motion, stride, j, b);
  p.velocity = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
  p.mass_i = a[3];
  p.mass_j = b[3];
  if constexpr (Turns) {
    gather(in.motion + 4, stride, i, a);
    gather(in.motion + 4, stride, j, b);
    p.spin_i = {a[0], a[1], a[2]};
    p.spin_j = {b[0], b[1], b[2]};
  }
}

#if defined(__AVX2__)
/// Four rows as they are, in single precision.
TRACKBED_LANES void narrow_rows(const Four* low, const Four* high, Floats<8>* columns) {
  Floats<8> r[4];
  for (int k = 0; k < 4; ++k) r[k] = narrow(low[k], high[k]);
  const Floats<8> a = __builtin_shufflevector(r[0], r[1], 0, 8, 1, 9, 4, 12, 5, 13);
  const Floats<8> b = __builtin_shufflevector(r[0], r[1], 2, 10, 3, 11, 6, 14, 7, 15);
  const Floats<8> c = __builtin_shufflevector(r[2], r[3], 0, 8, 1, 9, 4, 12, 5, 13);
  const Floats<8> d = __builtin_shufflevector(r[2], r[3], 2, 10, 3, 11, 6, 14, 7, 15);
  columns[0] = __builtin_shufflevector(a, c, 0, 1, 8, 9, 4, 5, 12, 13);
  columns[1] = __builtin_shufflevector(a, c, 2, 3, 10, 11, 6, 7, 14, 15);
  columns[2] = __builtin_shufflevector(b, d, 0, 1, 8, 9, 4, 5, 12, 13);
  columns[3] = __builtin_shufflevector(b, d, 2, 3, 10, 11, 6, 7, 14, 15);
}
/// The last numbers of four rows.
TRACKBED_LANES Four last(const Four* rows) {
  const Order4 high{1, 5, 3, 7}, right{2, 3, 6, 7};
  return __builtin_shuffle(__builtin_shuffle(rows[0], rows[1], high), __builtin_shuffle(rows[2], rows[3], high), right);
}

/// Rows are subtracted as they lie, their last numbers added: half the shuffles.
template <bool Turns, int W>
TRACKBED_LANES void read(const SweepInput& in, const int* i, const int* j, Partners<Floats<8>>& p) {
  constexpr int stride = Turns ? 8 : 4;
  const auto row = [](const double* base, int rows, int index) {
    return load<Four>(base + static_cast<long>(rows) * index);
  };
  const auto part = [](const Four& a, const Four& b) {
    const Order4 signs{1LL << 63, 1LL << 63, 1LL << 63, 0};
    return a + reinterpret_cast<Four>(reinterpret_cast<Order4>(b) ^ signs);
  };
  Four between[2][4], radius_i[2], reach[2], gap[2];
  for (int h = 0; h < 2; ++h) {
    Four own[4], apart[4];
    for (int k = 0; k < 4; ++k) {
      own[k] = row(in.place, 4, i[4 * h + k]);
      apart[k] = part(own[k], row(in.place, 4, j[4 * h + k]));
    }
    transpose(apart, between[h]);
    radius_i[h] = last(own);
    const Four* d = between[h];
    reach[h] = d[3];
    gap[h] = d[3] * d[3] - (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
  }
  for (int k = 0; k < 3; ++k) p.between[k] = narrow(between[0][k], between[1][k]);
  p.radius_i = narrow(radius_i[0], radius_i[1]);
  p.radius_j = narrow(reach[0] - radius_i[0], reach[1] - radius_i[1]);
  p.gap = narrow(gap[0], gap[1]);

  Four moves[2][4], mass_i[2], mass_j[2];
  for (int h = 0; h < 2; ++h) {
    Four own[4], other[4];
    for (int k = 0; k < 4; ++k) {
      own[k] = row(in.motion, stride, i[4 * h + k]);
      other[k] = row(in.motion, stride, j[4 * h + k]);
      moves[h][k] = own[k] - other[k];
    }
    mass_i[h] = last(own);
    mass_j[h] = last(other);
  }
  Floats<8> columns[4];
  narrow_rows(moves[0], moves[1], columns);
  p.velocity = {columns[0], columns[1], columns[2]};
  p.mass_i = narrow(mass_i[0], mass_i[1]);
  p.mass_j = narrow(mass_j[0], mass_j[1]);
  if constexpr (Turns) {
    const auto spin = [&](const int* index) {
      Four rows[2][4];
      for (int k = 0; k < 8; ++k) rows[k / 4][k % 4] = row(in.motion + 4, stride, index[k]);
      narrow_rows(rows[0], rows[1], columns);
      return Vector3<Floats<8>>{columns[0], columns[1], columns[2]};
    };
    p.spin_i = spin(i);
    p.spin_j = spin(j);
  }
}
#else
template <bool Turns, int W>
TRACKBED_LANES void read(const SweepInput& in, const int* i, const int* j, Partners<Floats<W>>& p) {
  constexpr int H = W / 2;
  Partners<Doubles<H>> half[2];
  for (int h = 0; h < 2; ++h) {
    Partners<Doubles<H>>& q = half[h];
    read<Turns, H>(in, i + h * H, j + h * H, q);
    const Doubles<H> reach = q.radius_i + q.radius_j;
    q.gap = reach * reach - norm2(q.between);
  }
  const auto join = [&](auto member) { return narrow(half[0].*member, half[1].*member); };
  const auto join_vector = [&](auto member) {
    const auto &low = half[0].*member, &high = half[1].*member;
    return Vector3<Floats<W>>{narrow(low.x, high.x), narrow(low.y, high.y), narrow(low.z, high.z)};
  };
  using Q = Partners<Doubles<H>>;
  p.between = join_vector(&Q::between);
  p.velocity = join_vector(&Q::velocity);
  p.radius_i = join(&Q::radius_i);
  p.radius_j = join(&Q::radius_j);
  p.mass_i = join(&Q::mass_i);
  p.mass_j = join(&Q::mass_j);
  p.gap = join(&Q::gap);
  if constexpr (Turns) {
    p.spin_i = join_vector(&Q::spin_i);
    p.spin_j = join_vector(&Q::spin_j);
  }
}
#endif

// ---- sums over pairs, in double
template <class R>
struct Total;
template <class R>
requires(std::is_same_v<typename kernels::LanesOf<R>::Number, double>) struct Total<R> {
  R lanes{};
  TRACKBED_LANES void operator+=(const R& x) { lanes += x; }
};
template <class R>
requires(std::is_same_v<typename kernels::LanesOf<R>::Number, float>) struct Total<R> {
  Doubles<kernels::LanesOf<R>::width / 2> lanes{};
  TRACKBED_LANES void operator+=(const R& x) {
    decltype(lanes) low, high;
    widen(x, low, high);
    lanes += low + high;
  }
};
template <class R>
double sum(const Total<R>& total) {
  double result = 0;
  for (unsigned k = 0; k < sizeof total.lanes / sizeof(double); ++k) result += total.lanes[k];
  return result;
}

}  // namespace dem::sweeping
