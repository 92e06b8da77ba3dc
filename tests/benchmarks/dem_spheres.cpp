// Speed of the DEM core: a bed of spheres at rest, and one grain on a plane.
//   benchmark_dem_spheres [--csv=FILE] [Google Benchmark's options]
// FILE: a settled packing (x_m,y_m,z_m,radius_m, header line) in a box of 1.2 × 1.2 m; without it a bed of 20 000
// spheres is made: a slightly compressed face-centred lattice of mixed radii, about 4 contacts per sphere. Counters:
// sphere-steps per second of processor time (all threads) and of wall time.
#include <benchmark/benchmark.h>

#include <chrono>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <fstream>
#include <iostream>
#include <random>
#include <string>

#include "dem/dem.hpp"

namespace {

std::string csv;

struct Bed {
  std::vector<dem::Grain> grains;
  double low = 0, high = 1.2;  // [m] of the side walls, in x and y
};

Bed make_bed() {
  Bed bed;
  auto& grains = bed.grains;
  if (!csv.empty()) {
    std::ifstream file(csv);
    std::string line;
    std::getline(file, line);
    while (std::getline(file, line)) {
      dem::Grain g;
      if (std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf", &g.position.x, &g.position.y, &g.position.z, &g.radius) != 4)
        continue;
      g.id = static_cast<std::int64_t>(grains.size());
      grains.push_back(g);
    }
    return bed;
  }
  std::mt19937 random(1);
  std::uniform_real_distribution<double> smaller(0, 0.0004);
  const int across = 28;
  const double spacing = 1.2 / across;  // of the square layers; neighbours are spacing / sqrt(2) apart between layers
  const double radius = 0.5 * spacing / std::sqrt(2.0) + 0.00018;
  bed.low = 0.25 * spacing - radius;
  bed.high = (across - 0.25) * spacing + radius;
  for (int layer = 0; grains.size() < 20000; ++layer)
    for (int k = 0; k < 2 * across * across && grains.size() < 20000; ++k) {
      const int row = k / across, column = k % across;
      const double x = (column + 0.5 * ((row + layer) % 2) + 0.25) * spacing, y = (0.5 * row + 0.25) * spacing;
      grains.push_back({.position = {x, y, 0.5 * layer * spacing + radius},
                        .radius = radius - smaller(random),
                        .id = static_cast<std::int64_t>(grains.size())});
    }
  return bed;
}

dem::Setup setup_of(bool energy) {
  dem::Setup setup;
  setup.materials = {{"stone", 2.4e8, 0.2, 2700}};
  setup.interactions = {{0.6, 0.4, 0}};
  setup.gravity = {0, 0, -9.81};
  setup.track_energy = energy;
  return setup;
}

void settled_bed(benchmark::State& state) {
  dem::set_threads(static_cast<int>(state.range(0)));
  const auto sim = dem::Simulation::create(setup_of(state.range(1)), dem::Backend::omp);
  const Bed bed = make_bed();
  const auto& grains = bed.grains;
  sim->add_grains(grains);
  sim->add_plane({{0, 0, 0}, {0, 0, 1}}, 0);
  for (const double x : {bed.low, bed.high}) {
    sim->add_plane({{x, 0, 0}, {x > bed.low ? -1.0 : 1.0, 0, 0}}, 0);
    sim->add_plane({{0, x, 0}, {0, x > bed.low ? -1.0 : 1.0, 0}}, 0);
  }
  sim->advance(1000, 5e-6);
  const int steps = 20;
  std::clock_t processor = 0;
  double wall = 0;
  for (auto _ : state) {
    const auto start = std::chrono::steady_clock::now();
    const std::clock_t before = std::clock();
    sim->advance(steps, 5e-6);
    processor += std::clock() - before;
    wall += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }
  const double sphere_steps = static_cast<double>(state.iterations()) * steps * static_cast<double>(grains.size());
  state.counters["per_cpu_second"] = sphere_steps * CLOCKS_PER_SEC / static_cast<double>(processor);
  state.counters["per_wall_second"] = sphere_steps / wall;
  state.counters["contacts_per_sphere"] =
      2.0 * static_cast<double>(sim->counts().contacts) / static_cast<double>(grains.size());
}
BENCHMARK(settled_bed)->ArgNames({"threads", "energy"})->Args({1, 0})->Args({1, 1})->Args({2, 0})->MinTime(5);

void one_grain_on_a_plane(benchmark::State& state) {
  const auto sim = dem::Simulation::create(setup_of(true), dem::Backend::omp);
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
