// The order in which the energy of every element converges on a curved mesh.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/fem_mesh.hpp"

namespace {

using base::Vec3;

const fem::MaterialRegion concrete{"", "linear_elastic", 45e9, 0.167, 2350, ""};

// u = grad(e^(a x) cos(b y) cos(c z)), a^2 = b^2 + c^2, has neither divergence nor curl: it is in balance without
// forces for any elastic constants. Given on the boundary of a cube, the stored energy approaches mu integral |grad
// u|^2 (lambda drops out) with the order 2 p of the elements (Strang & Fix 1973, 1.6): 2 for linear ones, 4 for those
// of the second order. Corners inside lie on a wavy grid. Reduced or assumed strains that are not consistent lose the
// order.
double energy_error(const std::string& element, int n) {
  constexpr double b = 1.3, c = 0.9, scale = 1e-4;
  const double a = std::sqrt(b * b + c * c);
  const auto displacement = [&](const Vec3& x) {
    const double e = scale * std::exp(a * x.x), cy = std::cos(b * x.y), cz = std::cos(c * x.z);
    return Vec3{a * e * cy * cz, -b * e * std::sin(b * x.y) * cz, -c * e * cy * std::sin(c * x.z)};
  };
  const auto mesh = fem_test::block_mesh(element, {n, n, n}, [n](int i, int j, int k) {
    const double x = double(i) / n, y = double(j) / n, z = double(k) / n;
    const double bump = 0.3 * x * (1 - x) * y * (1 - y) * z * (1 - z) * 16;
    return Vec3{x + 0.5 * bump, y - 0.4 * bump, z + 0.3 * bump};
  });
  const auto block = fem::ElementBlock::make({element, concrete, mesh.nodes, mesh.connectivity});
  std::vector<double> u;
  std::vector<bool> held;
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
    const Vec3 value = displacement(mesh.nodes[i]);
    u.insert(u.end(), {value.x, value.y, value.z});
    bool outer = false;
    for (const int place : mesh.places[i]) outer = outer || place == 0 || place == 2 * n;
    held.insert(held.end(), 3, outer);
  }
  fem_test::solve(*block, held, std::vector<double>(u.size(), 0.0), u);
  // exact: E = mu integral H : H, H the Hessian of the potential, by 8 x 8 x 8 midpoints refined to 1e-10 by 40
  const double mu = concrete.young_modulus / (2 * (1 + concrete.poisson_ratio));
  constexpr double at[3] = {0.5 - 0.38729833462074168852, 0.5, 0.5 + 0.38729833462074168852};
  constexpr double share[3] = {5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};
  double exact = 0;
  constexpr int parts = 6;
  for (int p = 0; p < parts * parts * parts; ++p) {
    for (int q = 0; q < 27; ++q) {
      const double x = (p % parts + at[q % 3]) / parts, y = (p / parts % parts + at[q / 3 % 3]) / parts,
                   z = (p / parts / parts + at[q / 9]) / parts;
      const double cy = std::cos(b * y), cz = std::cos(c * z), sy = std::sin(b * y), sz = std::sin(c * z);
      const double xx = a * a * cy * cz, yy = -b * b * cy * cz, zz = -c * c * cy * cz;
      const double xy = -a * b * sy * cz, xz = -a * c * cy * sz, yz = b * c * sy * sz;
      const double e = scale * std::exp(a * x);
      exact += mu * e * e * (xx * xx + yy * yy + zz * zz + 2 * (xy * xy + xz * xz + yz * yz)) * share[q % 3] *
               share[q / 3 % 3] * share[q / 9] / (parts * parts * parts);
    }
  }
  return std::abs(0.5 * fem_test::product(u, fem_test::forces_of(*block, u)) / exact - 1);
}

struct Order : testing::TestWithParam<std::string> {};

TEST_P(Order, OfTheEnergy) {
  const bool second = fem::element_nodes(GetParam()) > 8;
  const int coarse = second ? 3 : 5;
  const double ratio = energy_error(GetParam(), coarse) / energy_error(GetParam(), 2 * coarse);
  RecordProperty("order", std::to_string(std::log2(ratio)));
  std::printf("%s: order %.3f\n", GetParam().c_str(), std::log2(ratio));
  EXPECT_NEAR(std::log2(ratio), second ? 4 : 2, 0.25);
}

INSTANTIATE_TEST_SUITE_P(Fem, Order, testing::ValuesIn(fem::element_names()),
                         [](const auto& info) { return info.param; });

}  // namespace
