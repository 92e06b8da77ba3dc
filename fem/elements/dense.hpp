#pragma once
// Small dense symmetric matrices for the making of elements.

namespace fem {

/// Inverts a positive definite matrix in place (Gauss and Jordan).
template <int n>
void invert_definite(double (&m)[n][n]) {
  for (int p = 0; p < n; ++p) {
    const double pivot = 1 / m[p][p];
    m[p][p] = 1;
    for (int c = 0; c < n; ++c) m[p][c] *= pivot;
    for (int r = 0; r < n; ++r) {
      if (r == p) continue;
      const double factor = m[r][p];
      m[r][p] = 0;
      for (int c = 0; c < n; ++c) m[r][c] -= factor * m[p][c];
    }
  }
}

/// Place of (i, j) in a symmetric matrix of which the lower triangle is stored row by row.
constexpr int packed(int i, int j) { return i >= j ? i * (i + 1) / 2 + j : j * (j + 1) / 2 + i; }
constexpr int packed_size(int n) { return n * (n + 1) / 2; }

/// product = m x, m packed.
template <int n, class T>
inline __attribute__((always_inline)) void multiply(const T* m, const T* x, T* product) {
  for (int i = 0; i < n; ++i) {
    product[i] = T{};
    for (int j = 0; j < n; ++j) product[i] += m[packed(i, j)] * x[j];
  }
}

}  // namespace fem
