// Element-steps per second of the solid side on one core, per element and law: the force loop alone, and whole
// central-difference steps. Bytes and flops per element-step are counts of what the kernels read, write and compute,
// not measurements; `fem_triad` is what this machine's memory gives for comparison. Reference points on other hardware:
// FrontISTR 0.76 M element-steps/s per core (tet4, explicit, double).
#include <benchmark/benchmark.h>

#include "fem/blocks.hpp"
#include "fem/families.hpp"
#include "tests/fem_helper.hpp"
#include "tests/fem_mesh.hpp"

namespace {

struct Cost {
  double bytes, flops;  // per element-step of the force loop
};

/// Geometry, connectivity and history are read (history written too); of the nodes that each element adds to the mesh,
/// displacements (and velocities) and forces are read, and forces written.
template <class Element, class Law>
Cost cost() {
  const double new_nodes = Element::nodes == 4 ? 1.0 / 6 : Element::nodes == 8 ? 1 : Element::nodes == 10 ? 8.0 / 6 : 4;
  const double fields = Law::viscous ? 2 : 1;
  const double bytes = 8 * Element::geometry_size + 4 * Element::nodes + 24 * (fields + 2) * new_nodes +
                       16 * Element::points * Law::history;
  // slopes at a point: 4 per edge interpolated in hex8, 18 per node elsewhere; then 45 to space, and the same way back
  const double slopes = Element::points == 8 && Element::nodes == 8 ? 9 * 28 / 8.0 : 18 * Element::nodes;
  const double law = Law::finite ? 190 : Law::history > 0 ? (Law::viscous ? 110 : 80) : Law::viscous ? 60 : 20;
  return {bytes, Element::points * ((fields + 1) * (slopes + 45) + law + 9)};
}

Cost cost_of(const std::string& element, const fem::MaterialRegion& material) {
  Cost found{0, 0};
  const auto take = [&]<class Element, class Law>(const Element*, const Law*) {
    if (element == Element::name && Law::serves(material)) found = cost<Element, Law>();
  };
  [&]<class... Element>(const std::tuple<Element...>*) {
    const auto laws = [&]<class One, class... Law>(const One* one, const std::tuple<Law...>*) {
      (take(one, static_cast<const Law*>(nullptr)), ...);
    };
    (laws(static_cast<const Element*>(nullptr), static_cast<const fem::Laws*>(nullptr)), ...);
  }(static_cast<const fem::Elements*>(nullptr));
  return found;
}

fem::MaterialRegion material_of(const std::string& law) {
  fem::MaterialRegion material{"", law, 45e9, 0.167, 2350, ""};
  if (law != "linear_elastic" && law != "drucker_prager") material.shear_viscosity = material.bulk_viscosity = 1e4;
  material.cohesion = 3e6;
  material.friction_angle = 0.5;
  return material;
}

void count(benchmark::State& state, const std::string& element, const fem::MaterialRegion& material, double elements) {
  const auto cost = cost_of(element, material);
  state.counters["element_steps/s"] = benchmark::Counter(elements, benchmark::Counter::kIsIterationInvariantRate);
  state.counters["bytes/element_step"] = cost.bytes;
  state.counters["flops/element_step"] = cost.flops;
}

void step(benchmark::State& state, const std::string& element, const std::string& law) {
  auto body = fem_test::box(element, {2, 1, 1, 40, 20, 20});
  body.materials = {material_of(law)};
  const auto model = fem::Model::create(MPI_COMM_SELF, {{body}, {}});
  const double dt = 0.9 * model->stable_step().limit;
  for (auto _ : state) fem_test::step(*model, dt);
  count(state, element, body.materials[0], static_cast<double>(model->counts()[0].elements));
}

/// Few elements over and over: the arithmetic without the memory.
void forces_in_cache(benchmark::State& state, const std::string& element, const std::string& law) {
  const auto material = material_of(law);
  const auto mesh = fem_test::block_mesh(element, {1, 1, 1}, [](int i, int j, int k) { return base::Vec3(i, j, k); });
  const int per_element = fem::element_nodes(element), elements = 64;
  std::vector<int> connectivity;
  for (int e = 0; e < elements; ++e)
    connectivity.insert(connectivity.end(), mesh.connectivity.begin(), mesh.connectivity.begin() + per_element);
  const auto block =
      fem::ElementBlock::make({element, material, mesh.nodes, connectivity, static_cast<int>(state.range(0))});
  std::vector<double> u(3 * mesh.nodes.size(), 1e-6), f(u.size(), 0.0);
  fem::Losses losses;
  for (auto _ : state) {
    block->advance(u.data(), u.data(), f.data(), losses, 0, block->batches());
    benchmark::ClobberMemory();
  }
  count(state, element, material, elements);
}

/// a = b + c x on arrays far larger than the cache: bytes per second that one core moves.
void triad(benchmark::State& state) {
  std::vector<double> a(1 << 23), b(a.size(), 1.0), c(a.size(), 2.0);
  for (auto _ : state) {
    for (std::size_t i = 0; i < a.size(); ++i) a[i] = b[i] + 3.0 * c[i];
    benchmark::ClobberMemory();
  }
  state.counters["bytes/s"] =
      benchmark::Counter(24.0 * static_cast<double>(a.size()), benchmark::Counter::kIsIterationInvariantRate);
}

}  // namespace

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  {
    const fem::Library library(MPI_COMM_SELF);
    benchmark::RegisterBenchmark("fem_triad", triad);
    for (const auto& element : fem::element_names()) {
      for (const char* law : {"linear_elastic", "kelvin_voigt", "left_cauchy_green", "drucker_prager"}) {
        const std::string name = element + "/" + law;
        benchmark::RegisterBenchmark(("fem_step/" + name).c_str(), step, element, law)->Unit(benchmark::kMillisecond);
        auto* in_cache =
            benchmark::RegisterBenchmark(("fem_forces_in_cache/" + name).c_str(), forces_in_cache, element, law);
        in_cache->ArgName("lanes")->Arg(2);
        if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) in_cache->Arg(4);
      }
    }
    benchmark::Initialize(&argc, argv);
    benchmark::RunSpecifiedBenchmarks();
  }
  MPI_Finalize();
}
