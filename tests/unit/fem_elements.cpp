// Elements, one row per element: patch test (Irons 1966: a linear displacement gives exactly its constant strain on any
// mesh), rigid motions and no others without force, lumped mass, vector widths with every law.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "tests/fem_mesh.hpp"

namespace {

using base::Vec3;
using fem_test::BlockMesh;

constexpr int cells = 3;

/// A cube of 1 m in 3 x 3 x 3 cells whose inner corners are moved out of line.
BlockMesh make_patch(const std::string& element) {
  return fem_test::block_mesh(element, {cells, cells, cells}, [](int i, int j, int k) {
    const bool inner = i % cells != 0 && j % cells != 0 && k % cells != 0;
    const double n = i + (cells + 1) * (j + (cells + 1) * k), shift = inner ? 0.06 : 0.0;
    return Vec3{i / 3.0 + shift * std::sin(7 * n), j / 3.0 + shift * std::sin(5 * n + 1),
                k / 3.0 + shift * std::sin(3 * n + 2)};
  });
}

bool inside(const Vec3& x) {
  bool in = true;
  for (int c = 0; c < 3; ++c) in = in && x[c] > 1e-9 && x[c] < 1 - 1e-9;
  return in;
}

fem::MaterialRegion material_of(const std::string& law) {
  fem::MaterialRegion material{"", law, 45e9, 0.167, 2350, ""};
  material.cohesion = 3e6;
  material.friction_angle = 0.6;
  material.dilation_angle = 0.2;
  return material;
}
const fem::MaterialRegion material = material_of("linear_elastic");

struct ElementCase : testing::TestWithParam<std::string> {
  BlockMesh patch = make_patch(GetParam());
  std::unique_ptr<fem::ElementBlock> block =
      fem::ElementBlock::make({GetParam(), material, patch.nodes, patch.connectivity});

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
// exact for linear fields (a wrong Jacobian, a weight that does not match, modes that constant stress works on) shows.
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
  block->stresses(u.data(), nullptr, stresses);
  ASSERT_EQ(stresses.size(), patch.connectivity.size() / fem::element_nodes(GetParam()));
  for (const auto& stress : stresses) {
    for (int i = 0; i < 6; ++i) EXPECT_NEAR(stress[i], expected[i], 1e-12 * e * 2e-4);
  }
  const auto f = fem_test::forces_of(*block, u);
  double largest = 0;
  for (const double value : f) largest = std::max(largest, std::abs(value));
  for (std::size_t n = 0; n < patch.nodes.size(); ++n) {
    for (int c = 0; c < 3; ++c) {
      if (inside(patch.nodes[n])) {
        EXPECT_NEAR(f[3 * n + c], 0, 1e-12 * largest);
      }
    }
  }
}

// Translations and (small) rotations strain nothing: six motions without force.
TEST_P(ElementCase, RigidMotionsGiveNoForce) {
  const double scale = material.young_modulus * 1e-3 / 3;  // E times length times displacement
  for (int mode = 0; mode < 6; ++mode) {
    const auto u = displacements([&](const Vec3& x) {
      Vec3 axis;
      axis[mode % 3] = 1e-3;
      return mode < 3 ? axis : base::cross(axis, x);
    });
    for (const double value : fem_test::forces_of(*block, u)) EXPECT_NEAR(value, 0, 1e-12 * scale);
  }
}

/// Rank of a symmetric positive semidefinite matrix: pivots of Cholesky's method above 1e-10 of the first.
int rank_of(std::vector<std::vector<double>> m) {
  int rank = 0;
  double first = 0;
  std::vector<bool> done(m.size(), false);
  while (true) {
    std::size_t p = m.size();
    for (std::size_t i = 0; i < m.size(); ++i) {
      if (!done[i] && (p == m.size() || m[i][i] > m[p][p])) p = i;
    }
    if (p == m.size() || m[p][p] <= 1e-10 * first) return rank;
    first = std::max(first, m[p][p]);
    done[p] = true;
    ++rank;
    for (std::size_t i = 0; i < m.size(); ++i) {
      if (done[i]) continue;
      const double factor = m[i][p] / m[p][p];
      for (std::size_t j = 0; j < m.size(); ++j) m[i][j] -= factor * m[p][j];
    }
  }
}

// The stiffness of one distorted element is symmetric and has rank 3 n - 6: nothing but rigid motions is free. One
// point without hourglass control would have rank 6. hex20_reduced has six more free motions, which its 48 = 8 x 6
// strains cannot see (Hughes 2000, 4.6.2); they do not fit together in a mesh.
TEST_P(ElementCase, NothingElseIsFree) {
  const int nodes = fem::element_nodes(GetParam());
  const std::vector<int> first(patch.connectivity.begin(), patch.connectivity.begin() + nodes);
  const auto element = fem::ElementBlock::make({GetParam(), material, patch.nodes, first});
  std::vector<std::vector<double>> k;
  for (int i = 0; i < 3 * nodes; ++i) {
    std::vector<double> u(3 * patch.nodes.size(), 0.0);
    u[3 * first[i / 3] + i % 3] = 1e-9;
    const auto f = fem_test::forces_of(*element, u);
    k.emplace_back();
    for (int j = 0; j < 3 * nodes; ++j) k.back().push_back(f[3 * first[j / 3] + j % 3]);
  }
  for (int i = 0; i < 3 * nodes; ++i) {
    for (int j = 0; j < i; ++j) EXPECT_NEAR(k[i][j], k[j][i], 1e-12 * k[0][0]);
  }
  EXPECT_EQ(rank_of(k), 3 * nodes - (GetParam() == "hex20_reduced" ? 12 : 6));
}

// u . K . u > 0 for a motion that alternates from corner to corner.
TEST_P(ElementCase, EveryOtherMotionStrains) {
  std::vector<double> u;
  for (const auto& [i, j, k] : patch.places) {
    const bool corner = i % 2 == 0 && j % 2 == 0 && k % 2 == 0;
    u.insert(u.end(), {corner ? ((i + j + k) / 2 % 2 ? 1e-6 : -1e-6) : 0.0, 0, 0});
  }
  EXPECT_GT(0.5 * fem_test::product(u, fem_test::forces_of(*block, u)), 0.1 * material.young_modulus * 1e-12);
}

// Lumped masses add up to density times volume (1 m3), each is positive: with row sums the corners of tet10 and hex20
// would be negative.
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

/// Shares of the corners and of the middles in the mass of one straight-sided element.
void expect_shares(const std::string& element, double corner, double middle) {
  const auto mesh = fem_test::block_mesh(element, {1, 1, 1}, [](int i, int j, int k) { return Vec3(i, 2 * j, k); });
  const int nodes = fem::element_nodes(element);
  const std::vector<int> first(mesh.connectivity.begin(), mesh.connectivity.begin() + nodes);
  std::vector<double> mass(mesh.nodes.size(), 0.0);
  fem::ElementBlock::make({element, material, mesh.nodes, first})->add_lumped_mass(mass.data());
  const double total = material.density * (nodes == 20 ? 2.0 : 2.0 / 6.0);
  for (int a = 0; a < nodes; ++a)
    EXPECT_NEAR(mass[first[a]] / total, a < fem::cell_corners(nodes) ? corner : middle, 1e-12) << element << a;
}

// Diagonal scaling (Hinton, Rock, Zienkiewicz 1976): integral of N_a^2 over the sum of them. By hand for tet10, from
// integral L1^a L2^b = 6 V a! b! / (a + b + 3)!: corners V / 70, middles 4 V 4 / 210; for hex20 Cook (1989),
// table 13.3.
TEST(FemElements, MassSharesOfTheSecondOrder) {
  expect_shares("tet10", 1.0 / 36, 4.0 / 27);
  expect_shares("hex20", 7.0 / 248, 16.0 / 248);
  expect_shares("hex20_reduced", 7.0 / 248, 16.0 / 248);
}

// Two and four elements at once do the same arithmetic, with every law, and the same as one alone (from which stresses
// and stored energies come): a part-empty last batch or a swapped lane shows here.
TEST_P(ElementCase, VectorWidthsAgree) {
  if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma")) GTEST_SKIP() << "no AVX2 here";
  const auto u = displacements([](const Vec3& x) { return Vec3{x.x * x.y, std::sin(x.z), x.y * x.z * x.x} * 1e-4; });
  const auto v = displacements([](const Vec3& x) { return Vec3{x.y, -x.x, x.z * x.y} * 1e-1; });
  for (const std::string law : {"linear_elastic", "kelvin_voigt", "left_cauchy_green", "drucker_prager"}) {
    auto region = material_of(law);
    region.shear_viscosity = law == "linear_elastic" ? 0 : 4e6;
    region.bulk_viscosity = law == "linear_elastic" ? 0 : 1e6;
    std::vector<double> results[2];
    fem::Losses losses[2];
    for (const int lanes : {2, 4}) {
      const auto wide = fem::ElementBlock::make({GetParam(), region, patch.nodes, patch.connectivity, lanes});
      auto& f = results[lanes / 4];
      f.assign(u.size(), 0.0);
      wide->advance(u.data(), v.data(), f.data(), losses[lanes / 4], 0, wide->batches());
    }
    for (std::size_t i = 0; i < u.size(); ++i)
      EXPECT_NEAR(results[0][i], results[1][i], 1e-12 * material.young_modulus * 1e-4) << law;
    EXPECT_NEAR(losses[0].viscous_power, losses[1].viscous_power, 1e-12 * losses[0].viscous_power) << law;
    EXPECT_EQ(losses[0].viscous_power > 0, region.shear_viscosity > 0) << law;
    EXPECT_NEAR(losses[0].plastic_work, losses[1].plastic_work, 1e-12 * losses[0].plastic_work) << law;
    EXPECT_EQ(losses[0].plastic_work > 0, law == "drucker_prager") << law;
  }
}

// The stored energy is half of displacements times forces for Hooke's law, whichever way it is summed.
TEST_P(ElementCase, StoredEnergy) {
  const auto u = displacements([](const Vec3& x) { return Vec3{x.x * x.y, std::sin(x.z), x.y * x.z * x.x} * 1e-4; });
  const double expected = 0.5 * fem_test::product(u, fem_test::forces_of(*block, u));
  EXPECT_NEAR(block->stored(u.data()), expected, 1e-12 * expected);
}

// Carried round ten times and a bit as a rigid body, the rotation-proof form stays without stress to rounding, in every
// element: 1e-10 E. The small-strain form has stresses of the order of E.
TEST_P(ElementCase, RotationProofFormTurnsFreely) {
  const auto turning =
      fem::ElementBlock::make({GetParam(), material_of("left_cauchy_green"), patch.nodes, patch.connectivity});
  for (int eighth = 1; eighth <= 83; eighth += 2) {
    const double angle = eighth * 0.785398163397448;
    const Vec3 axis{2.0 / 3.0, -1.0 / 3.0, 2.0 / 3.0};
    const auto u = displacements([&](const Vec3& x) {  // Rodrigues
      return x * std::cos(angle) + base::cross(axis, x) * std::sin(angle) +
             axis * (base::dot(axis, x) * (1 - std::cos(angle))) - x;
    });
    std::vector<std::array<double, 6>> stresses;
    turning->stresses(u.data(), nullptr, stresses);
    for (const auto& stress : stresses) {
      for (const double value : stress) ASSERT_NEAR(value, 0, 1e-10 * material.young_modulus) << eighth;
    }
    for (const double value : fem_test::forces_of(*turning, u)) ASSERT_NEAR(value, 0, 1e-10 * material.young_modulus);
  }
}

// Stretched, then turned: forces and stresses are the stretched body's, turned. Rotating only part of an element's
// assumed strain or hourglass control shows.
TEST_P(ElementCase, RotationProofFormIsFrameIndifferent) {
  const auto turning =
      fem::ElementBlock::make({GetParam(), material_of("left_cauchy_green"), patch.nodes, patch.connectivity});
  const auto stretch = displacements([](const Vec3& x) {
    return Vec3{x.x * x.y, std::sin(x.z), x.y * x.z * x.x} * 1e-3;
  });
  const auto rotate = [](const Vec3& v) {  // by 1 rad about z
    return Vec3{std::cos(1.0) * v.x - std::sin(1.0) * v.y, std::sin(1.0) * v.x + std::cos(1.0) * v.y, v.z};
  };
  std::vector<double> turned;
  for (std::size_t n = 0; n < patch.nodes.size(); ++n) {
    const Vec3 x = patch.nodes[n] + Vec3{stretch[3 * n], stretch[3 * n + 1], stretch[3 * n + 2]};
    const Vec3 moved = rotate(x) - patch.nodes[n];
    turned.insert(turned.end(), {moved.x, moved.y, moved.z});
  }
  const auto straight = fem_test::forces_of(*turning, stretch), round = fem_test::forces_of(*turning, turned);
  for (std::size_t n = 0; n < patch.nodes.size(); ++n) {
    const Vec3 expected = rotate({straight[3 * n], straight[3 * n + 1], straight[3 * n + 2]});
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(round[3 * n + c], expected[c], 1e-12 * material.young_modulus);
  }
  EXPECT_NEAR(turning->stored(turned.data()), turning->stored(stretch.data()), 1e-9 * turning->stored(stretch.data()));
}

INSTANTIATE_TEST_SUITE_P(Fem, ElementCase, testing::ValuesIn(fem::element_names()),
                         [](const auto& info) { return info.param; });

// Bending near nu = 0.5 strains hardly any volume. Full integration asks every Gauss point to keep its volume, which
// the trilinear element cannot: it locks. B-bar asks it of the element's mean only, one point of the element only.
TEST(FemElements, SomeDoNotLockInVolume) {
  const auto patch = make_patch("hex8");
  auto near_half = material;
  near_half.poisson_ratio = 0.4999;
  std::vector<double> u;  // exact plane-strain bending at nu = 0.5: no change of volume anywhere
  for (const auto& x : patch.nodes) u.insert(u.end(), {1e-4 * x.x * x.z, 0.0, -0.5e-4 * (x.x * x.x + x.z * x.z)});
  const auto energy = [&](const std::string& element) {
    const auto block = fem::ElementBlock::make({element, near_half, patch.nodes, patch.connectivity});
    return block->stored(u.data());
  };
  EXPECT_LT(energy("hex8_bbar"), 0.1 * energy("hex8"));
}

// On parallelepipeds the one-point element with its hourglass control is the one with incompatible modes: both
// integrate the same field, one in closed form. A wrong factor in the hourglass stiffness shows.
TEST(FemElements, OnePointIsIncompatibleOnParallelepipeds) {
  const auto mesh = fem_test::block_mesh("hex8", {2, 2, 1}, [](int i, int j, int k) {
    return Vec3{0.3 * i + 0.1 * j, 0.2 * j + 0.05 * k, 0.25 * k - 0.04 * i};
  });
  std::vector<double> u;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    const double s = static_cast<double>(n);
    u.insert(u.end(), {1e-5 * std::sin(3 * s), 1e-5 * std::sin(5 * s + 1), 1e-5 * std::sin(7 * s + 2)});
  }
  const auto one =
      fem_test::forces_of(*fem::ElementBlock::make({"hex8_one_point", material, mesh.nodes, mesh.connectivity}), u);
  const auto eight =
      fem_test::forces_of(*fem::ElementBlock::make({"hex8_incompatible", material, mesh.nodes, mesh.connectivity}), u);
  for (std::size_t i = 0; i < u.size(); ++i) EXPECT_NEAR(one[i], eight[i], 1e-12 * material.young_modulus * 1e-5);
}

}  // namespace
