#pragma once
// Boxes of elements of any kind without gmsh, and statics on one block of elements by conjugate gradients.
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "fem/blocks.hpp"
#include "fem/elements/hex20.hpp"
#include "fem/elements/tet10.hpp"
#include "fem/families.hpp"
#include "fem/gmsh_reader.hpp"

namespace fem_test {

using base::Vec3;

struct BlockMesh {
  std::vector<Vec3> nodes;
  std::vector<std::array<int, 3>> places;  // twice the cell numbers: even at corners of cells
  std::vector<int> connectivity;
};

/// A box of cells (nx, ny, nz), each a hexahedron or six tetrahedra round its diagonal 0-6; `place` maps corners given
/// in units of cells to space, middle nodes lie halfway between.
inline BlockMesh block_mesh(const std::string& element, const std::array<int, 3>& cells,
                            const std::function<Vec3(int, int, int)>& place) {
  constexpr int kuhn[6][4] = {{0, 1, 2, 6}, {0, 2, 3, 6}, {0, 3, 7, 6}, {0, 7, 4, 6}, {0, 4, 5, 6}, {0, 5, 1, 6}};
  constexpr int corner[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  const int count = fem::element_nodes(element), corners = fem::cell_corners(count);
  BlockMesh mesh;
  std::map<std::array<int, 3>, int> numbers;
  const auto number = [&](const std::array<int, 3>& twice, const Vec3& x) {
    const auto [known, fresh] = numbers.try_emplace(twice, static_cast<int>(mesh.nodes.size()));
    if (fresh) {
      mesh.nodes.push_back(x);
      mesh.places.push_back(twice);
    }
    return known->second;
  };
  const auto add_cell = [&](const std::vector<std::array<int, 3>>& at) {
    const auto in_space = [&](int a) { return place(at[a][0], at[a][1], at[a][2]); };
    for (int a = 0; a < corners; ++a)
      mesh.connectivity.push_back(number({2 * at[a][0], 2 * at[a][1], 2 * at[a][2]}, in_space(a)));
    for (int m = 0; m < count - corners; ++m) {
      const int* ends = corners == 4 ? fem::Tet10Shape::middles[m] : fem::Hex20Shape<2>::middles[m];
      const auto &a = at[ends[0]], &b = at[ends[1]];
      mesh.connectivity.push_back(
          number({a[0] + b[0], a[1] + b[1], a[2] + b[2]}, (in_space(ends[0]) + in_space(ends[1])) * 0.5));
    }
  };
  for (int k = 0; k < cells[2]; ++k) {
    for (int j = 0; j < cells[1]; ++j) {
      for (int i = 0; i < cells[0]; ++i) {
        std::vector<std::array<int, 3>> at;
        for (const auto& c : corner) at.push_back({i + c[0], j + c[1], k + c[2]});
        if (corners == 8) {
          add_cell(at);
        } else {
          for (const auto& t : kuhn) add_cell({at[t[0]], at[t[1]], at[t[2]], at[t[3]]});
        }
      }
    }
  }
  return mesh;
}

/// Inner forces at rest.
inline std::vector<double> forces_of(const fem::ElementBlock& block, const std::vector<double>& u) {
  std::vector<double> f(u.size(), 0.0);
  block.add_inner_forces(u.data(), nullptr, f.data(), 0, block.batches());
  return f;
}

inline double product(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

/// Displacements of a linear block under `load`, starting from u, whose components with `held` stay as they are.
/// Conjugate gradients scaled by the diagonal, until the rest is 1e-10 of the first.
inline void solve(const fem::ElementBlock& block, const std::vector<bool>& held, const std::vector<double>& load,
                  std::vector<double>& u) {
  const std::size_t n = u.size();
  std::vector<double> mass(n / 3, 0.0), r = load, z(n), scale(n);
  block.add_lumped_mass(mass.data());
  const auto f = forces_of(block, u);
  for (std::size_t i = 0; i < n; ++i) {
    r[i] = held[i] ? 0 : load[i] - f[i];
    scale[i] = 1 / std::cbrt(mass[i / 3]);  // stiffness goes with length, mass with its cube
    z[i] = scale[i] * r[i];
  }
  auto p = z;
  double rz = product(r, z);
  const double first = product(r, r);
  for (int turn = 0; turn < 20000 && product(r, r) > 1e-20 * first; ++turn) {
    auto q = forces_of(block, p);
    for (std::size_t i = 0; i < n; ++i) {
      if (held[i]) q[i] = 0;
    }
    const double step = rz / product(p, q);
    for (std::size_t i = 0; i < n; ++i) {
      u[i] += step * p[i];
      r[i] -= step * q[i];
      z[i] = scale[i] * r[i];
    }
    const double next = product(r, z);
    for (std::size_t i = 0; i < n; ++i) p[i] = z[i] + next / rz * p[i];
    rz = next;
  }
}

}  // namespace fem_test
