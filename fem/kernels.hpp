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
      const double* geometry = k.geometry + static_cast<long>(batch) * Element::geometry_size * W;
      T u[Element::nodes][3], v[Law::viscous ? Element::nodes : 1][3], f[Element::nodes][3], g[Element::geometry_size];
      T history[history_size > 0 ? history_size : 1];
      Loss<T> loss;
      gather(k.displacements, nodes, u);
      // a copy: read once in order, found in the nearest cache after
      for (int i = 0; i < Element::geometry_size; ++i) g[i] = load<T>(geometry + i * W);
      if constexpr (Law::viscous) {
        for (auto& node : v) node[0] = node[1] = node[2] = T{};
        if (k.velocities) gather(k.velocities, nodes, v);
      }
      const long first_history = static_cast<long>(batch) * history_size * W;
      for (int i = 0; i < history_size; ++i) history[i] = load<T>(k.history + first_history + i * W);
      Response<Element, Law, T>::forces(g, law, {u, v, history}, f, loss);
      if (history_size > 0 && k.new_history)
        std::memcpy(k.new_history + first_history, history, sizeof(T) * history_size);
      const int lanes = batch + 1 == k.batches ? k.elements - batch * W : W;  // the last batch may be part empty
      for (int a = 0; a < Element::nodes; ++a) {
        for (int l = 0; l < lanes; ++l) {
          double* to = k.forces + 3 * static_cast<long>(nodes[a * W + l]);
          for (int c = 0; c < 3; ++c) to[c] += lane_of(f[a][c], l);
        }
      }
      if constexpr (Law::viscous || Law::history > 0) {
        if (k.losses) {
          for (int l = 0; l < lanes; ++l) {
            k.losses[0] += lane_of(loss.viscous, l);
            k.losses[1] += lane_of(loss.plastic, l);
          }
        }
      }
    }
  }

 private:
  static inline __attribute__((always_inline)) void gather(const double* field, const int* nodes, T (*values)[3]) {
    for (int a = 0; a < Element::nodes; ++a) {
      for (int c = 0; c < 3; ++c) {
        double lane[W];
        for (int l = 0; l < W; ++l) lane[l] = field[3 * static_cast<long>(nodes[a * W + l]) + c];
        values[a][c] = load<T>(lane);
      }
    }
  }

  static inline __attribute__((always_inline)) double lane_of(const T& value, int l) {
    double lane[W];
    __builtin_memcpy(lane, &value, sizeof lane);
    return lane[l];
  }
};

}  // namespace fem
