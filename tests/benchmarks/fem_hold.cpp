// Nishiura2017 3.1 at full size: the cantilever of 204 x 20 x 20 cells, 489 600 tetrahedra, loaded with 200 N, damped
// until it rests under the load by explicit steps, and the von Mises stress of every element against the static answer
// on the same mesh. Elements at the clamp's edges, where stress grows with the mesh, are counted apart. A quarter of an
// hour of one core; `benchmark_fem_hold 48 4` takes the coarser 48 x 4 x 4.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <numbers>

#include "fem/mesh.hpp"
#include "tests/fem_helper.hpp"

namespace {

constexpr double length = 2.4, width = 0.25, height = 0.22;                // [m] Nishiura2017 3.1
constexpr double load = 200, ramp = 0.02, rest = 0.09, first_mode = 27.0;  // [N], [s], [s], [Hz]

/// Critical for the first mode: it comes to rest like (1 + w t) exp(-w t), 6e-6 of the load's deflection at t = rest -
/// ramp.
const double damping = 2 * 2 * std::numbers::pi * first_mode;  // [1/s]

fem::Body cantilever(int cells, int across, const base::HistoryPtr& history) {
  auto body = fem_test::box("tet4", {length, width, height, cells, across, across});
  body.supports = {{"x_min", {true, true, true}, ""}};
  body.loads = {{"tip", "x_max", fem::LoadKind::nodal_total, {0, 0, -1}, history, ""}};
  return body;
}

/// Distance of a place from the nearest edge of the clamped face [m].
double from_clamp_edge(const base::Vec3& x) {
  const double side = std::min(0.5 * width - std::abs(x.y), 0.5 * height - std::abs(x.z));
  return std::hypot(x.x, side);
}

void compare(int cells, int across) {
  fem::Setup still_setup{{cantilever(cells, across, fem_test::history([](double) { return load; }))}, {}};
  still_setup.solver.kind = fem::Solver::statics;
  const auto still = fem::Model::create(MPI_COMM_SELF, still_setup);
  fem_test::step(*still, 1);
  const auto expected = still->element_stresses("box");

  auto body = cantilever(cells, across, fem_test::history([](double t) { return load * std::min(1.0, t / ramp); }));
  body.damping = damping;
  const auto held = fem::Model::create(MPI_COMM_SELF, {{body}, {}});
  const double dt = 0.98 * held->stable_step().limit;
  long steps = 0;
  for (; held->time() < rest; ++steps) fem_test::step(*held, dt);
  const auto found = held->element_stresses("box");

  const auto mesh = fem::read_mesh(MPI_COMM_SELF, body);
  double away = 0, at_edge = 0;
  int near = 0;
  for (std::size_t e = 0; e < found.size(); ++e) {
    const double error = std::abs(fem::von_mises(found[e]) / fem::von_mises(expected[e]) - 1);
    const bool edge = from_clamp_edge(mesh.centre(static_cast<int>(e))) < 2 * length / cells;
    near += edge;
    double& largest = edge ? at_edge : away;
    largest = std::max(largest, error);
  }
  std::cout << found.size() << " tetrahedra, " << steps << " steps to " << held->time()
            << " s; von Mises, hold against static: largest difference " << 100 * away << " %, in the " << near
            << " elements within two cells of the clamp's edges " << 100 * at_edge << " %\n";
}

}  // namespace

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  {
    const fem::Library library(MPI_COMM_SELF);
    compare(argc > 2 ? std::atoi(argv[1]) : 204, argc > 2 ? std::atoi(argv[2]) : 20);
  }
  MPI_Finalize();
}
