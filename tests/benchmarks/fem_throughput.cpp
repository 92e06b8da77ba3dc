// Element-steps per second of the solid side on one core, per element: the force loop alone, and whole
// central-difference steps. Bytes and flops per element-step are counts of what the kernels read, write and compute,
// not measurements. Reference points on other hardware: FrontISTR 0.76 M element-steps/s per core (tet4, explicit,
// double).
#include <benchmark/benchmark.h>

#include "fem/blocks.hpp"
#include "fem/families.hpp"
#include "tests/fem_helper.hpp"

namespace {

struct Cost {
  double bytes, flops;  // per element-step of the force loop
};

/// Geometry and connectivity are read; displacements and forces of the nodes that each element adds to the mesh (one
/// per hexahedron, one per six tetrahedra) are read, and forces written.
Cost cost_of(const std::string& element) {
  const bool tetrahedron = element == "tet4";
  const double nodes = tetrahedron ? 4 : 8, numbers = tetrahedron ? 10 : 80, new_nodes = tetrahedron ? 1.0 / 6 : 1;
  const double bytes = 8 * numbers + 4 * nodes + 72 * new_nodes;
  // per point: strain 45 + 6, law 14, weight 6, to reference coordinates 45, sum 9; hexahedra: edges and interpolation
  const double point = 125, edges = 9 * (4 + 24);
  double flops = tetrahedron ? point + 15 : 8 * point + 2 * edges + 9 * 8;
  if (element == "hex8_bbar") flops += 2 * 8 * 10;
  return {bytes, flops};
}

void count(benchmark::State& state, const std::string& element, double elements) {
  const auto cost = cost_of(element);
  state.counters["element_steps/s"] = benchmark::Counter(elements, benchmark::Counter::kIsIterationInvariantRate);
  state.counters["bytes/element_step"] = cost.bytes;
  state.counters["flops/element_step"] = cost.flops;
}

void step(benchmark::State& state, const std::string& element) {
  const auto model = fem::Model::create(MPI_COMM_SELF, {{fem_test::box(element, {2, 1, 1, 60, 30, 30})}, {}});
  const double dt = 0.9 * model->stable_step().limit;
  for (auto _ : state) fem_test::step(*model, dt);
  count(state, element, static_cast<double>(model->counts()[0].elements));
}

/// Few elements over and over: the arithmetic without the memory.
void forces_in_cache(benchmark::State& state, const std::string& element) {
  const auto body = fem_test::box(element, {});
  const std::vector<base::Vec3> nodes{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                      {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  const int per_element = fem::element_nodes(element), elements = 64;
  const std::vector<int> corners = per_element == 8 ? std::vector{0, 1, 2, 3, 4, 5, 6, 7} : std::vector{0, 1, 2, 6};
  std::vector<int> connectivity;
  for (int e = 0; e < elements; ++e) connectivity.insert(connectivity.end(), corners.begin(), corners.end());
  const auto block =
      fem::ElementBlock::make({element, body.materials[0], nodes, connectivity, static_cast<int>(state.range(0))});
  std::vector<double> u(24, 1e-6), f(24, 0.0);
  for (auto _ : state) {
    block->add_inner_forces(u.data(), f.data(), 0, block->batches());
    benchmark::ClobberMemory();
  }
  count(state, element, elements);
}

}  // namespace

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  {
    const fem::Library library(MPI_COMM_SELF);
    for (const auto& element : fem::element_names()) {
      benchmark::RegisterBenchmark(("fem_step/" + element).c_str(), step, element)->Unit(benchmark::kMillisecond);
      auto* in_cache =
          benchmark::RegisterBenchmark(("fem_forces_in_cache/" + element).c_str(), forces_in_cache, element);
      in_cache->ArgName("lanes")->Arg(2);
      if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) in_cache->Arg(4);
    }
    benchmark::Initialize(&argc, argv);
    benchmark::RunSpecifiedBenchmarks();
  }
  MPI_Finalize();
}
