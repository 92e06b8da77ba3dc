// Steps of settled beds on a GPU, or the same passes on the processor: milliseconds, rates, memory, and how near they
// come to what the memory could carry.
//   benchmark_dem_gpu [--backend omp|cuda] [--small]
//   benchmark_dem_gpu [--backend omp|cuda] --shape sphere|clump3|clump10 --grains N [--precision double|mixed]
// Without --shape: the beds of docs/gpu.md, one row of a table each; --small: a hundredth of them, to see that it
// works. Settings as in benchmark A (bed.hpp), without an energy ledger. On the processor contacts are taken one by
// one, as on a GPU (Setup::lanes = 1); the sweep, which is faster there, has benchmark_dem_spheres.
//
// Beds: grains poured into a cell that repeats itself along x and y, ten or twenty deep, until they rest; the bed is
// that cell over and over, with walls around, and has rested again for 1000 steps. Their mean number of neighbours in
// contact is in the table.
//
// Floor: what one step must move (step_bytes() in gpu_report.hpp), at the bandwidth that a copy reaches on the same
// device (the triad a = b + s c on the processor). Its share of the time measured is 100 % for a step that does nothing
// else; by kernel where the build has CUPTI. Memory of the device: how much less is free of it than before the
// simulation was made, with all that driver and pools take.
#include <omp.h>

#include <chrono>
#include <cstdlib>
#include <functional>
#include <optional>

#include "tests/benchmarks/bed.hpp"
#include "tests/benchmarks/gpu_report.hpp"
#if defined(TRACKBED_WITH_CUDA)
#include "tests/benchmarks/device.hpp"
#endif

namespace {
using namespace benchmarks;

struct Shape {
  std::string name, text;
  int across, layers;  // grains of the cell
};
const std::vector<Shape> shapes{
    {"sphere", "spheres", 10, 20}, {"clump3", "three-sphere clumps", 10, 10}, {"clump10", "ten-sphere clumps", 10, 10}};

struct Case {
  const Shape* shape;
  int grains;
  dem::Precision precision;
};

const Shape& shape_of(const std::string& name) {
  for (const Shape& shape : shapes)
    if (shape.name == name) return shape;
  throw base::UserError("--shape " + name + ": must be sphere, clump3 or clump10");
}

std::optional<dem::Clump> clump_of(const Shape& shape) {
  if (shape.name == "sphere") return {};
  if (shape.name == "clump10")
    return dem::make_clump(dem::read_spheres(TRACKBED_SOURCE_FOLDER "/meshes/ballast/stone1.clump10.csv"));
  const double side = 0.014, half = side / 2, up = side * std::sqrt(3.0) / 2;
  return dem::make_clump(std::vector<dem::Sphere>{{{-half, 0, 0}, 0.012}, {{half, 0, 0}, 0.012}, {{0, up, 0}, 0.012}});
}

/// A cell of settled grains, periodic along x and y.
Bed settled_cell(const Shape& shape, bool small) {
  const auto clump = clump_of(shape);
  const double reach = clump ? clump->reach : 0.022;
  const int across = small ? 6 : shape.across, layers = small ? 5 : shape.layers;
  Bed cell = box(2.2 * reach * across);
  if (clump) cell.shapes = {*clump};
  std::uniform_real_distribution<double> radius(0.018, reach);
  std::normal_distribution<double> part;
  fill_loosely(cell, across * across * layers, reach, [&](auto& random) {
    if (!clump) return dem::Grain{.radius = radius(random)};
    const dem::kernels::Quaternion q{part(random), part(random), part(random), part(random)};
    return dem::Grain{.radius = reach, .shape = 0, .orientation = dem::kernels::normalised(q)};
  });
  dem::Setup setup = setup_of(false);
  setup.periods[0] = setup.periods[1] = {0, cell.high[0]};
  const auto simulation = dem::Simulation::create(setup, dem::Backend::omp);
  for (const dem::Clump& is : cell.shapes) simulation->add_shape(is);
  simulation->add_grains(cell.grains);
  simulation->add_plane({{0, 0, 0}, {0, 0, 1}}, 0);
  simulation->set_grain_damping(2);
  simulation->advance(small ? 10000 : 16000, 8 * time_step);
  simulation->set_grain_damping(50);
  simulation->advance(small ? 2000 : 6000, 8 * time_step);
  cell.grains = simulation->grains();
  return cell;
}

/// Whole cells side by side, at least this many grains; walls stand clear of those that lie across the faces.
Bed repeat(const Bed& cell, int grains) {
  const double width = cell.high[0];
  const int cells = (grains + static_cast<int>(cell.grains.size()) - 1) / static_cast<int>(cell.grains.size());
  int along_y = 1;
  for (int k = 1; k * k <= cells; ++k)
    if (cells % k == 0) along_y = k;
  const int along_x = cells / along_y;
  double reach = 0;
  for (const dem::Grain& g : cell.grains) reach = std::max(reach, g.radius);
  Bed bed;
  bed.shapes = cell.shapes;
  for (int i = 0; i < along_x; ++i)
    for (int j = 0; j < along_y; ++j)
      for (dem::Grain g : cell.grains) {
        g.id = static_cast<std::int64_t>(bed.grains.size());
        g.position += Vec3{width * i, width * j, 0};
        g.velocity = g.angular_velocity = {};
        bed.grains.push_back(g);
      }
  bed.low = {-reach, -reach};
  bed.high = {width * along_x + reach, width * along_y + reach};
  return bed;
}

StepContents contents_of(const dem::Counts& counts, const Case& c, bool clumps) {
  return {.grains = static_cast<double>(counts.grains),
          .spheres = static_cast<double>(counts.spheres),
          .pairs = static_cast<double>(counts.candidate_pairs),
          .contacts = static_cast<double>(counts.contacts),
          .wall_candidates = static_cast<double>(counts.wall_candidates),
          .wall_contacts = static_cast<double>(counts.wall_contacts),
          .clumps = clumps,
          .mixed = c.precision == dem::Precision::mixed};
}

double seconds_of(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// [B/s] of a = b + s c, two reads and one write, the best of ten.
double triad_bandwidth() {
  const std::size_t n = 8 << 20;
  std::vector<double> a(n, 0.0), b(n, 1.0), c(n, 2.0);
  double best = HUGE_VAL;
  for (int turn = 0; turn < 10; ++turn)
    best = std::min(best, seconds_of([&] {
#pragma omp parallel for schedule(static)
                      for (std::size_t k = 0; k < n; ++k) a[k] = b[k] + 3 * c[k];
                    }));
  base::require_internal(a[n / 2] == 7, "the triad was not computed");
  return 3 * sizeof(double) * static_cast<double>(n) / best;
}

struct Options {
  dem::Backend backend = dem::Backend::omp;
  bool small = false;
  std::optional<Case> only;
};

/// [B] of the device's memory that is taken; none on the processor.
std::optional<double> memory_in_use([[maybe_unused]] const Options& options) {
#if defined(TRACKBED_WITH_CUDA)
  if (options.backend == dem::Backend::cuda) return device_memory_in_use();
#endif
  return {};
}

/// Of all kernels while this is done; none on the processor.
std::vector<KernelTime> times_of_kernels([[maybe_unused]] const Options& options,
                                         [[maybe_unused]] const std::function<void()>& work) {
#if defined(TRACKBED_WITH_CUDA)
  if (options.backend == dem::Backend::cuda) return kernel_times(work);
#endif
  return {};
}

/// What is said when all beds are done.
struct Report {
  std::vector<Measured> beds;
  std::string kernels;
};

void print_row(const Case& c, const Bed& bed, const Options& options, double bandwidth, Report& report) {
  dem::Setup setup = setup_of(false);
  setup.precision = c.precision;
  setup.lanes = 1;
#if defined(TRACKBED_WITH_CUDA)
  if (options.backend == dem::Backend::cuda) give_back_pooled_memory();
#endif
  const std::optional<double> memory_before = memory_in_use(options);
  const auto simulation = dem::Simulation::create(setup, options.backend);
  put_into(*simulation, bed);
  simulation->set_grain_damping(50);
  simulation->advance(options.small ? 100 : 1000, time_step);
  simulation->set_grain_damping(0);
  const auto time_of = [&](int steps) { return seconds_of([&] { simulation->advance(steps, time_step); }) / steps; };
  const int steps = std::clamp(static_cast<int>(0.5 / time_of(20)), 5, 5000);
  std::vector<double> turns;
  for (int turn = 0; turn < 3; ++turn) turns.push_back(time_of(steps));
  std::sort(turns.begin(), turns.end());
  const double step = turns[1];
  const std::optional<double> memory_after = memory_in_use(options);
  constexpr int profiled_steps = 100;
  const auto times = times_of_kernels(options, [&] { simulation->advance(profiled_steps, time_step); });
  const dem::Counts counts = simulation->counts();
  const StepContents contents = contents_of(counts, c, !bed.shapes.empty());
  const StepBytes bytes = step_bytes(contents);
  const double spheres = contents.spheres, grains = contents.grains;
  Measured measured{text("%d %s, %s", c.grains, c.shape->text.c_str(), contents.mixed ? "mixed" : "double"),
                    step,
                    grains,
                    spheres,
                    {}};
  if (memory_before) measured.memory = *memory_after - *memory_before;
  std::printf("| %s | %.4g | %.4g | %.4g | %.3f | %s | %.1f | %.2f | %.0f | %.0f %% |\n", measured.bed.c_str(),
              1e3 * step, 1e-6 * grains / step, 1e-6 * spheres / step,
              1e-3 * static_cast<double>(counts.bytes) / spheres,
              measured.memory ? text("%.3f", 1e-3 * *measured.memory / spheres).c_str() : "–",
              2 * static_cast<double>(counts.contacts) / grains, contents.pairs / spheres, bytes.total() / spheres,
              100 * bytes.total() / bandwidth / step);
  std::fflush(stdout);
  report.kernels += kernel_rows(measured.bed, bytes, spheres, bandwidth, times, profiled_steps);
  report.beds.push_back(std::move(measured));
}

void print_machine([[maybe_unused]] const Options& options, double bandwidth) {
#if defined(TRACKBED_WITH_CUDA)
  if (options.backend == dem::Backend::cuda) {
    const Device device = this_device();
    std::printf("%s, %d multiprocessors, %.0f GB; driver for CUDA %d.%d, runtime %d.%d; copy %.0f GB/s\n\n",
                device.name.c_str(), device.multiprocessors, 1e-9 * device.memory, device.driver / 1000,
                device.driver % 1000 / 10, device.runtime / 1000, device.runtime % 1000 / 10, 1e-9 * bandwidth);
    return;
  }
#endif
  std::printf("processor, %d threads; triad %.1f GB/s\n\n", omp_get_max_threads(), 1e-9 * bandwidth);
}

double bandwidth_of([[maybe_unused]] const Options& options) {
#if defined(TRACKBED_WITH_CUDA)
  if (options.backend == dem::Backend::cuda) return device_copy_bandwidth();
#endif
  return triad_bandwidth();
}

void run(const Options& options) {
  std::string why_not;
  const bool usable = options.backend == dem::Backend::omp || dem::cuda_available(&why_not);
  base::require_user(usable, "--backend cuda cannot be used: " + why_not);
  using dem::Precision;
  const Shape &sphere = shapes[0], &clump3 = shapes[1], &clump10 = shapes[2];
  std::vector<Case> cases{{&sphere, 1000000, Precision::full},
                          {&sphere, 1000000, Precision::mixed},
                          {&sphere, 10000, Precision::full},
                          {&clump3, 1000000, Precision::mixed},
                          {&clump10, 31000, Precision::full}};
  if (options.only) cases = {*options.only};
  const double bandwidth = bandwidth_of(options);
  print_machine(options, bandwidth);
  std::printf(
      "| bed | ms/step | M grain-steps/s | M sphere-steps/s | GB per M spheres, counted | GB per M spheres, of the "
      "device "
      "| contacts per grain | candidates per sphere | B per sphere and step | share of the floor |\n"
      "|---|---|---|---|---|---|---|---|---|---|\n");
  Report report;
  const Shape* made = nullptr;
  Bed cell;
  for (const Case& c : cases) {
    if (c.shape != made) cell = settled_cell(*c.shape, options.small);
    made = c.shape;
    Case sized = c;
    if (options.small && !options.only) sized.grains /= 100;
    print_row(sized, repeat(cell, sized.grains), options, bandwidth, report);
  }
  std::printf("\n### Kernels\n\n%s%s", kernel_head(), report.kernels.c_str());
  const bool on_device = options.backend == dem::Backend::cuda && !options.small;
  if (!options.only)
    std::printf("\n### Targets, of an H100\n\n%s", verdicts(on_device ? report.beds : std::vector<Measured>()).c_str());
}

Options options_of(int argc, char** argv) {
  Options options;
  Case only{&shapes[0], 0, dem::Precision::full};
  for (int k = 1; k < argc; ++k) {
    const std::string name = argv[k];
    if (name == "--small") {
      options.small = true;
      continue;
    }
    base::require_user(k + 1 < argc, name + ": must be followed by a value; see the head of dem_gpu.cpp");
    const std::string value = argv[++k];
    const auto among = [&](const char* one, const char* other) {
      base::require_user(value == one || value == other, name + " " + value + ": must be " + one + " or " + other);
      return value == other;
    };
    if (name == "--backend") {
      options.backend = among("omp", "cuda") ? dem::Backend::cuda : dem::Backend::omp;
    } else if (name == "--precision") {
      only.precision = among("double", "mixed") ? dem::Precision::mixed : dem::Precision::full;
    } else if (name == "--shape") {
      only.shape = &shape_of(value);
    } else if (name == "--grains") {
      only.grains = std::atoi(value.c_str());
      base::require_user(only.grains > 0, "--grains " + value + ": must be a number above 0");
    } else {
      throw base::UserError(name + ": no such option; --backend, --small, --shape, --grains, --precision");
    }
  }
  if (only.grains > 0) options.only = only;
  return options;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    run(options_of(argc, argv));
  } catch (const base::UserError& error) {
    std::fprintf(stderr, "benchmark_dem_gpu: %s\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "benchmark_dem_gpu: %s\n", error.what());
    return 1;
  }
}
