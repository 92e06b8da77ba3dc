#pragma once
// The loop over elements, W at a time: gather displacements, inner forces, scatter. Included only by the two files that
// instantiate it, one per instruction set (kernels_portable.cpp, kernels_avx2.cpp).
#include "fem/kernel_table.hpp"
#include "fem/pack.hpp"
#include "fem/response.hpp"

namespace fem {

template <class Element, class Law, int W>
struct Kernel {
  using T = Pack<W>;
  static constexpr int history_size = Element::points * Law::history;

  static void run(const KernelArguments& k) {
    const Law& law = *static_cast<const Law*>(k.law);
    for (int batch = k.first_batch; batch < k.last_batch; ++batch) {
      const int* nodes = k.nodes + static_cast<long>(batch) * Element::nodes * W;
      const T* geometry = reinterpret_cast<const T*>(k.geometry) + static_cast<long>(batch) * Element::geometry_size;
      prefetch(geometry + Element::geometry_size);
      T u[Element::nodes][3], v[Law::viscous ? Element::nodes : 1][3], f[Element::nodes][3];
      T history[history_size > 0 ? history_size : 1];
      Loss<T> loss;
      gather(k.displacements, nodes, u);
      if constexpr (Law::viscous) {
        for (auto& node : v) node[0] = node[1] = node[2] = T{};
        if (k.velocities) gather(k.velocities, nodes, v);
      }
      const long first_history = static_cast<long>(batch) * history_size * W;
      for (int i = 0; i < history_size; ++i) history[i] = load<T>(k.history + first_history + i * W);
      Response<Element, Law, T>::forces(geometry, law, {u, v, history}, f, loss);
      if (history_size > 0 && k.new_history)
        std::memcpy(k.new_history + first_history, history, sizeof(T) * history_size);
      const int lanes = batch + 1 == k.batches ? k.elements - batch * W : W;  // the last batch may be part empty
      for (int a = 0; a < Element::nodes; ++a) {
        if (lanes == W) {
          scatter(f[a], nodes + a * W, k.forces);
        } else {
          for (int l = 0; l < lanes; ++l) {
            double* to = k.forces + 3 * static_cast<long>(nodes[a * W + l]);
            for (int c = 0; c < 3; ++c) to[c] += f[a][c][l];
          }
        }
      }
      if constexpr (Law::viscous || Law::history > 0) {
        if (k.losses) {
          for (int l = 0; l < lanes; ++l) {
            k.losses[0] += loss.viscous[l];
            k.losses[1] += loss.plastic[l];
          }
        }
      }
    }
  }

 private:
  static_assert(W == 2 || W == 4);
  using Pair = Pack<2>;

  /// What the next batch reads: the processor's own prefetching stops at pages, of which a batch is nearly one.
  static inline __attribute__((always_inline)) void prefetch(const T* geometry) {
    constexpr int line = 64 / sizeof(T);
    for (int i = 0; i < Element::geometry_size; i += line) __builtin_prefetch(geometry + i);
  }

  static inline __attribute__((always_inline)) void gather(const double* field, const int* nodes, T (*values)[3]) {
    for (int a = 0; a < Element::nodes; ++a) {
      const double* from[W];
      for (int l = 0; l < W; ++l) from[l] = field + 3 * static_cast<long>(nodes[a * W + l]);
      T even, odd;  // of the lanes: x and y, then y and z
      pairs(from, 0, even, odd);
      if constexpr (W == 2) {
        values[a][0] = __builtin_shufflevector(even, odd, 0, 2);
        values[a][1] = __builtin_shufflevector(even, odd, 1, 3);
      } else {
        values[a][0] = __builtin_shufflevector(even, odd, 0, 4, 2, 6);
        values[a][1] = __builtin_shufflevector(even, odd, 1, 5, 3, 7);
      }
      pairs(from, 1, even, odd);
      if constexpr (W == 2) {
        values[a][2] = __builtin_shufflevector(even, odd, 1, 3);
      } else {
        values[a][2] = __builtin_shufflevector(even, odd, 1, 5, 3, 7);
      }
    }
  }

  /// Two numbers of each lane: of lanes 0 and 2 in `even`, of 1 and 3 in `odd`.
  static inline __attribute__((always_inline)) void pairs(const double* const* from, int offset, T& even, T& odd) {
    if constexpr (W == 2) {
      even = load<T>(from[0] + offset), odd = load<T>(from[1] + offset);
    } else {
      even = __builtin_shufflevector(load<Pair>(from[0] + offset), load<Pair>(from[2] + offset), 0, 1, 2, 3);
      odd = __builtin_shufflevector(load<Pair>(from[1] + offset), load<Pair>(from[3] + offset), 0, 1, 2, 3);
    }
  }

  /// One lane after the other: several may share a node.
  static inline __attribute__((always_inline)) void scatter(const T* force, const int* nodes, double* forces) {
    Pair xy[W];
    if constexpr (W == 2) {
      xy[0] = __builtin_shufflevector(force[0], force[1], 0, 2);
      xy[1] = __builtin_shufflevector(force[0], force[1], 1, 3);
    } else {
      const T even = __builtin_shufflevector(force[0], force[1], 0, 4, 2, 6);
      const T odd = __builtin_shufflevector(force[0], force[1], 1, 5, 3, 7);
      xy[0] = __builtin_shufflevector(even, even, 0, 1);
      xy[1] = __builtin_shufflevector(odd, odd, 0, 1);
      xy[2] = __builtin_shufflevector(even, even, 2, 3);
      xy[3] = __builtin_shufflevector(odd, odd, 2, 3);
    }
    for (int l = 0; l < W; ++l) {
      double* to = forces + 3 * static_cast<long>(nodes[l]);
      const Pair sum = load<Pair>(to) + xy[l];
      std::memcpy(to, &sum, sizeof sum);
      to[2] += force[2][l];
    }
  }
};

}  // namespace fem
