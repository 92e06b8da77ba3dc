#include "fem/stable_step.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "fem/communication.hpp"

namespace fem {
namespace {

double uniform(std::uint64_t seed) {  // (0, 1); SplitMix64 (Steele 2014)
  seed += 0x9e3779b97f4a7c15;
  seed = (seed ^ (seed >> 30)) * 0xbf58476d1ce4e5b9;
  seed = (seed ^ (seed >> 27)) * 0x94d049bb133111eb;
  return (static_cast<double>((seed ^ (seed >> 31)) >> 11) + 0.5) * 0x1p-53;
}

double normal(std::uint64_t seed) {  // Box & Muller 1958
  return std::sqrt(-2 * std::log(uniform(2 * seed))) * std::cos(2 * std::numbers::pi * uniform(2 * seed + 1));
}

double product(MPI_Comm comm, const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  double value = a.dot(b);
  sum(comm, &value, 1);
  return value;
}

double largest_of(const std::vector<double>& diagonal, const std::vector<double>& beside) {
  const auto size = static_cast<Eigen::Index>(diagonal.size());
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
  solver.computeFromTridiagonal(Eigen::Map<const Eigen::VectorXd>(diagonal.data(), size),
                                Eigen::Map<const Eigen::VectorXd>(beside.data(), size - 1), Eigen::EigenvaluesOnly);
  return solver.eigenvalues()[size - 1];
}

/// An upper bound of the largest eigenvalue of S (K + rate C) S, S = diag(scale).
double lanczos_bound(const Layout& layout, const Assembly& assembly, const Eigen::VectorXd& scale, double rate) {
  constexpr double margin = 0.04, failure = 1e-9;
  double unknowns = (scale.array() > 0).count();
  sum(layout.comm, &unknowns, 1);
  if (unknowns == 0) return 0;
  const int wanted =
      static_cast<int>(std::ceil(0.5 * (1 + std::log(1.648 * std::sqrt(unknowns) / failure) / std::sqrt(margin))));
  const int steps = std::min<int>(wanted, static_cast<int>(unknowns));

  NodalField u(layout), v(layout), f(layout);
  Eigen::VectorXd q(scale.size()), before = Eigen::VectorXd::Zero(scale.size());
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    const auto number = static_cast<std::uint64_t>(layout.global_of_local[i / 3]) * 3 + i % 3;
    q[i] = scale[i] > 0 ? normal(number) : 0;
  }
  q /= std::sqrt(product(layout.comm, q, q));
  std::vector<double> diagonal, beside;
  while (true) {
    Eigen::Map<Eigen::VectorXd>(u.data(), q.size()) = scale.cwiseProduct(q);
    Eigen::Map<Eigen::VectorXd>(v.data(), q.size()) = rate * Eigen::Map<Eigen::VectorXd>(u.data(), q.size());
    u.begin_to_ghosts();
    v.begin_to_ghosts();
    assembly.linear_forces(u, v, f);
    Eigen::VectorXd w = scale.cwiseProduct(Eigen::Map<Eigen::VectorXd>(f.data(), q.size()));
    if (!beside.empty()) w -= beside.back() * before;
    diagonal.push_back(product(layout.comm, w, q));
    w -= diagonal.back() * q;
    const double rest = std::sqrt(product(layout.comm, w, w));
    const double theta = largest_of(diagonal, beside);
    // nothing is left: the start's every component is resolved, theta is exact
    if (rest <= 1e-10 * theta) return theta * (1 + 1e-8);
    if (static_cast<int>(diagonal.size()) == steps) return theta / (1 - margin);
    beside.push_back(rest);
    before = q;
    q = w / rest;
  }
}

std::string describe(const Setup& setup, const std::vector<Mesh>& meshes, const Assembly::Limiter& limiter) {
  const Body& body = setup.bodies[limiter.body];
  const Mesh& mesh = meshes[limiter.body];
  const int* nodes = mesh.element(limiter.element);
  double size = INFINITY;
  for (int a = 0; a < cell_corners(mesh.element_nodes); ++a) {
    for (int b = 0; b < a; ++b) size = std::min(size, base::norm(mesh.nodes[nodes[a]] - mesh.nodes[nodes[b]]));
  }
  const auto& material = body.materials[mesh.regions[limiter.element]];
  const Vec3 centre = mesh.centre(limiter.element);
  return fmt::format(
      "body \"{}\", {} element {} at ({:.4g}, {:.4g}, {:.4g}) m, shortest edge {:.4g} m, {}E {:.4g} Pa, nu {:.4g}, rho "
      "{:.4g} kg/m3{}",
      body.name, body.element, limiter.element + 1, centre.x, centre.y, centre.z, size,
      material.group.empty() ? "" : "\"" + material.group + "\" ", material.young_modulus, material.poisson_ratio,
      material.density,
      material.shear_viscosity > 0 || material.bulk_viscosity > 0
          ? fmt::format(", viscosity {:.4g} (shear) {:.4g} (bulk) Pa s", material.shear_viscosity,
                        material.bulk_viscosity)
          : "");
}

}  // namespace

StableStep find_stable_step(const Setup& setup, const std::vector<Mesh>& meshes, const Layout& layout,
                            const Assembly& assembly, std::span<const double> inverse_mass) {
  Eigen::VectorXd scale(static_cast<Eigen::Index>(inverse_mass.size()));
  for (Eigen::Index i = 0; i < scale.size(); ++i) scale[i] = std::sqrt(inverse_mass[i]);
  Assembly::Limiter limiter;
  /// 2 / sqrt(Lambda) for an upper bound Lambda of the largest eigenvalue of M^-1 (K + rate C)
  const auto step_at = [&](double rate) {
    limiter = assembly.limiter(rate);
    double bound = limiter.eigenvalue * (1 + 1e-8);
    if (setup.solver.step_bound == StepBound::mesh)
      bound = std::min(bound, lanczos_bound(layout, assembly, scale, rate));
    return bound > 0 ? 2 / std::sqrt(bound) : INFINITY;
  };
  double step = step_at(0);
  if (assembly.viscous() && std::isfinite(step)) {
    // the wanted step t is where step_at(2 / t) = t; both sides in logarithms, where the left one has a slope in [0,
    // 1/2]
    double t = std::log(step), slope = 0, before = t, value_before = 0;
    for (int turn = 0; turn < 12; ++turn) {
      const double value = std::log(step_at(2 / std::exp(t)));
      if (turn > 0 && t != before) slope = std::clamp((value - value_before) / (t - before), 0.0, 0.5);
      before = t;
      value_before = value;
      t += (value - t) / (1 - slope);
      if (std::abs(t - before) < 2e-3) break;
    }
    // t was last tried as `before`: there lambda(dt^2 K + 2 dt C) <= 4 (t / value)^2, and s t is stable if that is 4 /
    // s
    const double share = std::min(1.0, std::exp(2 * (value_before - before)));
    step = share * std::exp(before);
  }
  return {step, describe(setup, meshes, limiter)};
}

}  // namespace fem
