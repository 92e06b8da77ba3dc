#pragma once
// Lame's constants of a law's elastic part: what assumed strains and hourglass control are made with.

namespace fem {

struct Elastic {
  double lambda = 0, mu = 0;  // [Pa]

  /// result = lambda tr(h) I + 2 mu sym(h)
  template <class T>
  inline __attribute__((always_inline)) void stress(const T (*h)[3], T (*result)[3]) const {
    const T pressure = lambda * (h[0][0] + h[1][1] + h[2][2]);
    for (int c = 0; c < 3; ++c) {
      for (int d = 0; d < 3; ++d) result[c][d] = mu * (h[c][d] + h[d][c]);
      result[c][c] += pressure;
    }
  }
};

}  // namespace fem
