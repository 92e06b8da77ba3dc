// Speed of the DEM core: a bed of spheres at rest, and one grain on a plane.
//   benchmark_dem_spheres [--csv=FILE] [Google Benchmark's options]
// FILE: a settled packing (x_m,y_m,z_m,radius_m, header line) in a box of 1.2 × 1.2 m; without it a bed of 20 000
// spheres is made: a slightly compressed face-centred lattice of mixed radii, about 4 contacts per sphere. Counters:
// sphere-steps per second of processor time (all threads) and of wall time.
#include <benchmark/benchmark.h>

#include <chrono>
#include <cstring>
#include <ctime>
#include <string>

#include "tests/benchmarks/bed.hpp"

namespace {

std::string csv;

void settled_bed(benchmark::State& state) {
  dem::set_threads(static_cast<int>(state.range(0)));
  const auto sim = dem::Simulation::create(benchmarks::setup_of(state.range(1)), dem::Backend::omp);
  const benchmarks::Bed bed = benchmarks::sphere_bed(csv);
  benchmarks::put_into(*sim, bed);
  sim->advance(1000, benchmarks::time_step);
  const int steps = 20;
  std::clock_t processor = 0;
  double wall = 0;
  for (auto _ : state) {
    const auto start = std::chrono::steady_clock::now();
    const std::clock_t before = std::clock();
    sim->advance(steps, benchmarks::time_step);
    processor += std::clock() - before;
    wall += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }
  const double sphere_steps = static_cast<double>(state.iterations()) * steps * static_cast<double>(bed.grains.size());
  state.counters["per_cpu_second"] = sphere_steps * CLOCKS_PER_SEC / static_cast<double>(processor);
  state.counters["per_wall_second"] = sphere_steps / wall;
  state.counters["contacts_per_sphere"] =
      2.0 * static_cast<double>(sim->counts().contacts) / static_cast<double>(bed.grains.size());
}
BENCHMARK(settled_bed)->ArgNames({"threads", "energy"})->Args({1, 0})->Args({1, 1})->Args({2, 0})->MinTime(5);

void one_grain_on_a_plane(benchmark::State& state) {
  const auto sim = dem::Simulation::create(benchmarks::setup_of(true), dem::Backend::omp);
  sim->add_plane({{0, 0, 0}, {0, 0, 1}}, 0);
  sim->add_grains(std::vector<dem::Grain>{{.position = {0, 0, 0.02}, .radius = 0.02, .id = 1}});
  for (auto _ : state) sim->advance(1000, 1e-5);
  state.counters["seconds_per_step"] = benchmark::Counter(1e3 * static_cast<double>(state.iterations()),
                                                          benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
BENCHMARK(one_grain_on_a_plane);

}  // namespace

int main(int argc, char** argv) {
  for (int k = 1; k < argc; ++k)
    if (std::strncmp(argv[k], "--csv=", 6) == 0) csv = argv[k] + 6;
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
}
