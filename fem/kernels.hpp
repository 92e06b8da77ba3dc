#pragma once
// The loop over elements, W at a time: gather displacements, inner forces, scatter. Included only by the two files that
// instantiate it, one per instruction set (kernels_portable.cpp, kernels_avx2.cpp).
#include "fem/kernel_table.hpp"
#include "fem/pack.hpp"

namespace fem {

template <class Element, class Law, int W>
struct Kernel {
  using T = Pack<W>;

  static void run(const KernelArguments& k) {
    const Law& law = *static_cast<const Law*>(k.law);
    for (int batch = k.first_batch; batch < k.last_batch; ++batch) {
      const int* nodes = k.nodes + static_cast<long>(batch) * Element::nodes * W;
      const double* geometry = k.geometry + static_cast<long>(batch) * Element::geometry_size * W;
      T u[Element::nodes][3], f[Element::nodes][3], g[Element::geometry_size];
      for (int a = 0; a < Element::nodes; ++a) {
        for (int c = 0; c < 3; ++c) {
          double lane[W];
          for (int l = 0; l < W; ++l) lane[l] = k.displacements[3 * static_cast<long>(nodes[a * W + l]) + c];
          u[a][c] = load<T>(lane);
        }
      }
      for (int i = 0; i < Element::geometry_size; ++i) g[i] = load<T>(geometry + i * W);
      Element::template forces<T, Law>(g, law, u, f);
      const int lanes = batch + 1 == k.batches ? k.elements - batch * W : W;  // the last batch may be part empty
      for (int a = 0; a < Element::nodes; ++a) {
        for (int l = 0; l < lanes; ++l) {
          double* to = k.forces + 3 * static_cast<long>(nodes[a * W + l]);
          for (int c = 0; c < 3; ++c) {
            double lane[W];
            __builtin_memcpy(lane, &f[a][c], sizeof lane);
            to[c] += lane[l];
          }
        }
      }
    }
  }
};

/// For W = 1: one element whose geometry is not in batches.
template <class Element, class Law>
struct Single {
  static void stress(const double* geometry, const void* law, const double (*u)[3], double* mean) {
    Element::template mean_stress<double, Law>(geometry, *static_cast<const Law*>(law), u, mean);
  }
  static void forces(const double* geometry, const void* law, const double (*u)[3], double (*f)[3]) {
    Element::template forces<double, Law>(geometry, *static_cast<const Law*>(law), u, f);
  }
};

}  // namespace fem
