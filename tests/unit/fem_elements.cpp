// Elements and laws, one row per element: patch test (Irons 1966: a linear displacement gives exactly its constant
// strain on any mesh), rigid motions, lumped mass, and both vector widths.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "fem/blocks.hpp"
#include "fem/families.hpp"

namespace {

using base::Vec3;

constexpr int cells = 3;
constexpr int kuhn[6][4] = {{0, 1, 2, 6}, {0, 2, 3, 6}, {0, 3, 7, 6}, {0, 7, 4, 6}, {0, 4, 5, 6}, {0, 5, 1, 6}};

struct Patch {
  std::vector<Vec3> nodes;
  std::vector<bool> inside;
  std::vector<int> connectivity;
};

/// A cube of 1 m in 3 x 3 x 3 cells whose inner nodes are moved out of line.
Patch make_patch(int element_nodes) {
  Patch patch;
  const auto number = [](int i, int j, int k) { return i + (cells + 1) * (j + (cells + 1) * k); };
  for (int k = 0; k <= cells; ++k) {
    for (int j = 0; j <= cells; ++j) {
      for (int i = 0; i <= cells; ++i) {
        const bool inner = i % cells != 0 && j % cells != 0 && k % cells != 0;
        const double n = number(i, j, k), shift = inner ? 0.06 : 0.0;
        patch.nodes.push_back({i / 3.0 + shift * std::sin(7 * n), j / 3.0 + shift * std::sin(5 * n + 1),
                               k / 3.0 + shift * std::sin(3 * n + 2)});
        patch.inside.push_back(inner);
      }
    }
  }
  for (int k = 0; k < cells; ++k) {
    for (int j = 0; j < cells; ++j) {
      for (int i = 0; i < cells; ++i) {
        const int corners[8] = {
            number(i, j, k),     number(i + 1, j, k),     number(i + 1, j + 1, k),     number(i, j + 1, k),
            number(i, j, k + 1), number(i + 1, j, k + 1), number(i + 1, j + 1, k + 1), number(i, j + 1, k + 1)};
        if (element_nodes == 8) patch.connectivity.insert(patch.connectivity.end(), corners, corners + 8);
        if (element_nodes == 4) {
          for (const auto& tetrahedron : kuhn) {
            for (const int a : tetrahedron) patch.connectivity.push_back(corners[a]);
          }
        }
      }
    }
  }
  return patch;
}

const fem::MaterialRegion material{"", "linear_elastic", 45e9, 0.167, 2350, ""};

struct ElementCase : testing::TestWithParam<std::string> {
  Patch patch = make_patch(fem::element_nodes(GetParam()));
  std::unique_ptr<fem::ElementBlock> block =
      fem::ElementBlock::make({GetParam(), material, patch.nodes, patch.connectivity});

  std::vector<double> forces(const std::vector<double>& u) const {
    std::vector<double> f(u.size(), 0.0);
    block->add_inner_forces(u.data(), f.data(), 0, block->batches());
    return f;
  }
  template <class Field>
  std::vector<double> displacements(Field&& field) const {
    std::vector<double> u;
    for (const auto& x : patch.nodes) {
      const Vec3 value = field(x);
      u.insert(u.end(), {value.x, value.y, value.z});
    }
    return u;
  }
};

// sigma = lambda tr(eps) I + 2 mu eps, the same in every element, and no force on inner nodes. A gradient that is not
// exact for linear fields (a wrong Jacobian, a weight that does not match) shows here.
TEST_P(ElementCase, PatchTest) {
  const double a[3][3] = {{1.0e-4, 2.0e-4, -0.7e-4}, {0.4e-4, -0.5e-4, 1.1e-4}, {0.9e-4, -0.3e-4, 0.8e-4}};
  const auto u = displacements([&](const Vec3& x) {
    Vec3 value{1e-5, 2e-5, 3e-5};
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) value[i] += a[i][j] * x[j];
    }
    return value;
  });
  const double nu = material.poisson_ratio, e = material.young_modulus;
  const double lambda = e * nu / ((1 + nu) * (1 - 2 * nu)), mu = e / (2 * (1 + nu));
  const double trace = lambda * (a[0][0] + a[1][1] + a[2][2]);
  const double expected[6] = {trace + 2 * mu * a[0][0], trace + 2 * mu * a[1][1], trace + 2 * mu * a[2][2],
                              mu * (a[0][1] + a[1][0]), mu * (a[1][2] + a[2][1]), mu * (a[0][2] + a[2][0])};
  std::vector<std::array<double, 6>> stresses;
  block->stresses(u.data(), stresses);
  ASSERT_EQ(stresses.size(), patch.connectivity.size() / fem::element_nodes(GetParam()));
  for (const auto& stress : stresses) {
    for (int i = 0; i < 6; ++i) EXPECT_NEAR(stress[i], expected[i], 1e-12 * e * 2e-4);
  }
  const auto f = forces(u);
  double largest = 0;
  for (const double value : f) largest = std::max(largest, std::abs(value));
  for (std::size_t n = 0; n < patch.nodes.size(); ++n) {
    for (int c = 0; c < 3; ++c) {
      if (patch.inside[n]) {
        EXPECT_NEAR(f[3 * n + c], 0, 1e-12 * largest);
      }
    }
  }
}

// Translations and (small) rotations strain nothing: six motions without force. An element with hourglass
// modes passes here and fails in EveryOtherMotionStrains.
TEST_P(ElementCase, RigidMotionsGiveNoForce) {
  const double scale = material.young_modulus * 1e-3 / 3;  // E times length times displacement
  for (int mode = 0; mode < 6; ++mode) {
    const auto u = displacements([&](const Vec3& x) {
      Vec3 axis;
      axis[mode % 3] = 1e-3;
      return mode < 3 ? axis : base::cross(axis, x);
    });
    for (const double value : forces(u)) EXPECT_NEAR(value, 0, 1e-12 * scale);
  }
}

// u . K . u > 0 for a motion that alternates from node to node: the 2 x 2 x 2 rule has no hourglass modes; one point
// has.
TEST_P(ElementCase, EveryOtherMotionStrains) {
  int n = 0;
  const auto u = displacements([&](const Vec3&) {
    const int i = n % 4, j = n / 4 % 4, k = n++ / 16;
    return Vec3{(i + j + k) % 2 ? 1e-6 : -1e-6, 0, 0};
  });
  const auto f = forces(u);
  double energy = 0;
  for (std::size_t i = 0; i < u.size(); ++i) energy += 0.5 * u[i] * f[i];
  EXPECT_GT(energy, 0.1 * material.young_modulus * 1e-12);
}

// Row sums of the mass matrix: they add up to density times volume (1 m3), each is positive.
TEST_P(ElementCase, LumpedMass) {
  std::vector<double> mass(patch.nodes.size(), 0.0);
  block->add_lumped_mass(mass.data());
  double total = 0;
  for (const double m : mass) {
    EXPECT_GT(m, 0);
    total += m;
  }
  EXPECT_NEAR(total, material.density, 1e-12 * material.density);
}

// Two and four elements at once do the same arithmetic: a part-empty last batch or a swapped lane shows here.
TEST_P(ElementCase, VectorWidthsAgree) {
  if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma")) GTEST_SKIP() << "no AVX2 here";
  const auto u = displacements([](const Vec3& x) { return Vec3{x.x * x.y, std::sin(x.z), x.y * x.z * x.x} * 1e-4; });
  std::vector<double> results[2];
  for (const int lanes : {2, 4}) {
    const auto wide = fem::ElementBlock::make({GetParam(), material, patch.nodes, patch.connectivity, lanes});
    auto& f = results[lanes / 4];
    f.assign(u.size(), 0.0);
    wide->add_inner_forces(u.data(), f.data(), 0, wide->batches());
  }
  for (std::size_t i = 0; i < u.size(); ++i)
    EXPECT_NEAR(results[0][i], results[1][i], 1e-12 * material.young_modulus * 1e-4);
}

INSTANTIATE_TEST_SUITE_P(Fem, ElementCase, testing::ValuesIn(fem::element_names()),
                         [](const auto& info) { return info.param; });

// Bending near nu = 0.5 strains hardly any volume. Full integration asks every Gauss point to keep its volume, which
// the trilinear element cannot: it locks. B-bar asks it of the element's mean only.
TEST(FemBbar, DoesNotLockInVolume) {
  const auto patch = make_patch(8);
  auto material_near_half = material;
  material_near_half.poisson_ratio = 0.4999;
  std::vector<double> u;  // exact plane-strain bending at nu = 0.5: no change of volume anywhere
  for (const auto& x : patch.nodes) u.insert(u.end(), {1e-4 * x.x * x.z, 0.0, -0.5e-4 * (x.x * x.x + x.z * x.z)});
  double energy[2];
  for (const bool bbar : {false, true}) {
    const auto block =
        fem::ElementBlock::make({bbar ? "hex8_bbar" : "hex8", material_near_half, patch.nodes, patch.connectivity});
    std::vector<double> f(u.size(), 0.0);
    block->add_inner_forces(u.data(), f.data(), 0, block->batches());
    energy[bbar] = 0;
    for (std::size_t i = 0; i < u.size(); ++i) energy[bbar] += 0.5 * u[i] * f[i];
  }
  EXPECT_LT(energy[1], 0.1 * energy[0]);
}

}  // namespace
