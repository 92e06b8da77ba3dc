#include "dem/contact_step.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace dem {
namespace {

using Matrix6 = std::array<std::array<double, 6>, 6>;

Matrix6 square(const Matrix6& a) {
  Matrix6 b{};
  for (int i = 0; i < 6; ++i)
    for (int j = i; j < 6; ++j) {
      double sum = 0;
      for (int k = 0; k < 6; ++k) sum += a[i][k] * a[k][j];
      b[i][j] = b[j][i] = sum;
    }
  return b;
}

double trace(const Matrix6& a) {
  double sum = 0;
  for (int i = 0; i < 6; ++i) sum += a[i][i];
  return sum;
}

/// Upper bound of the largest eigenvalue of a positive semi-definite matrix: (trace A^64)^(1/64), scaled on the way.
double largest_eigenvalue(Matrix6 a) {
  double logarithm = 0;  // of the scale taken out so far
  double power = 1;
  for (int round = 0; round <= 6; ++round, power *= 2) {
    const double scale = trace(a);
    if (!(scale > 0)) return 0;
    logarithm += std::log(scale) / power;
    for (auto& row : a)
      for (double& x : row) x /= scale;
    if (round < 6) a = square(a);
  }
  return std::exp(logarithm);
}

/// Adds weight p p' for the directions of one contact; p acts on (sqrt(m) x, sqrt(I) rotation).
void add_spring(Matrix6& a, const GrainSpring& spring, const GrainInertia& grain, double normal, double shear,
                double bending = 0, double twist = 0) {
  const Vec3& n = spring.normal;
  const Vec3 aside = std::abs(n.x) < 0.7 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 t = cross(n, aside) * (1 / norm(cross(n, aside)));
  const Vec3 directions[3] = {n, t, cross(n, t)};
  const double weights[3] = {normal, shear, shear};
  const double turning[3] = {twist, bending, bending};
  const double mass_scale = 1 / std::sqrt(grain.mass);
  const double rotation_scale = grain.inertia > 0 ? 1 / std::sqrt(grain.inertia) : 0;
  for (int d = 0; d < 3; ++d) {
    const Vec3 lever = cross(spring.lever, directions[d]);
    double p[6];
    for (int k = 0; k < 3; ++k) {
      p[k] = mass_scale * directions[d][k];
      p[3 + k] = rotation_scale * lever[k];
    }
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 6; ++j) a[i][j] += weights[d] * p[i] * p[j];
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        a[3 + i][3 + j] += turning[d] * rotation_scale * rotation_scale * directions[d][i] * directions[d][j];
  }
}

}  // namespace

StableStep contact_step(const std::vector<GrainInertia>& grains, const std::vector<GrainSpring>& springs) {
  std::vector<Matrix6> stiffness(grains.size()), damping(grains.size());
  std::vector<int> contacts(grains.size()), bonds(grains.size());
  for (const GrainSpring& s : springs) {
    const double share = s.other_is_free ? 2 : 1;
    add_spring(stiffness[s.grain], s, grains[s.grain], share * s.normal_stiffness, share * s.shear_stiffness,
               share * s.bending_stiffness, share * s.twist_stiffness);
    add_spring(damping[s.grain], s, grains[s.grain], share * s.normal_damping, share * s.shear_damping);
    ++(s.bond ? bonds : contacts)[s.grain];
  }
  StableStep step{std::numeric_limits<double>::infinity(), "no contact"};
  std::size_t which = 0;
  for (std::size_t g = 0; g < grains.size(); ++g) {
    const double k = contacts[g] + bonds[g] == 0 ? 0 : largest_eigenvalue(stiffness[g]);
    if (!(k > 0)) continue;
    const double omega = std::sqrt(k), ratio = largest_eigenvalue(damping[g]) / (2 * omega);
    const double limit = 2 / omega * (std::sqrt(1 + ratio * ratio) - ratio);
    if (limit >= step.limit) continue;
    step.limit = limit;
    which = g;
  }
  if (!std::isfinite(step.limit)) return step;
  const auto counted = [](int count, const char* what) { return std::to_string(count) + what; };
  std::string of = "contacts", number = counted(contacts[which], " contacts");
  if (bonds[which] > 0) {
    of = contacts[which] > 0 ? "contacts and bonds" : "bonds";
    number = (contacts[which] > 0 ? number + ", " : "") + counted(bonds[which], " bonds");
  }
  const std::int64_t id = grains[which].id;
  step.limiter =
      of + (id < 0 ? " of a wall that moves as a body" : " of grain " + std::to_string(id)) + " (" + number + ")";
  return step;
}

}  // namespace dem
