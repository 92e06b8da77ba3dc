// The slope that stones leave when a wall is taken away, here and in LAMMPS, from one start.
//   benchmark_dem_slope [--stone=FILE.csv] [--grains=N] [--seconds=T]
// N (500) clumps of one stone (stone 1 of meshes/ballast with ten spheres; its spheres' x,y,z,radius in m) are poured
// into a box of 0.36 x 0.36 m. Then the wall at the larger x is gone at once, in both codes at the same start of empty
// histories, and T (2) s later the slope is measured (dem/measure/heap.hpp). Friction 0.6 everywhere; material as in
// benchmark A (bed.hpp). Steps of 20 us. No assertion: grains that fall are chaotic, so that the codes agree within the
// scatter of such slopes (a degree or two), not to the digit. Their damping differs (dem_compare.cpp).
// What it is for: what stones without rolling resistance bear is a matter of their shape, not of this code.
// Takes five minutes. Debian package: apt-get install --no-install-recommends lammps.
#include <cstdio>
#include <iostream>
#include <numbers>

#include "dem/measure/heap.hpp"
#include "tests/benchmarks/other_codes.hpp"

namespace {
using namespace benchmarks;

constexpr double width = 0.36, far_away = 4.0;  // [m]
constexpr double slow_step = 4 * time_step;     // [s]

struct Options {
  std::string stone = TRACKBED_SOURCE_FOLDER "/meshes/ballast/stone1.clump10.csv";
  int grains = 500;
  double seconds = 2;
};

Options read(int argc, char** argv) {
  Options options;
  for (int k = 1; k < argc; ++k) {
    const std::string argument = argv[k], name = argument.substr(0, argument.find('='));
    const std::string value = argument.substr(std::min(argument.size(), name.size() + 1));
    if (name == "--stone")
      options.stone = value;
    else if (name == "--grains" && std::atoi(value.c_str()) > 0)
      options.grains = std::atoi(value.c_str());
    else if (name == "--seconds" && std::atof(value.c_str()) > 0)
      options.seconds = std::atof(value.c_str());
    else
      throw base::UserError(argument + ": not understood; see the head of tests/benchmarks/dem_slope.cpp");
  }
  return options;
}

void print(const char* code, const std::vector<dem::GrainSphere>& spheres, double seconds) {
  const dem::HeapAngle heap = dem::heap_angle(spheres, {dem::HeapView::x, base::Vec3{}, 0.0});
  const double degree = std::numbers::pi / 180;
  std::printf("%-9s slope %5.1f degrees, +- %.1f between lanes, height %.3f m; %.0f s\n", code, heap.angle / degree,
              heap.scatter / degree, heap.height, seconds);
}

std::vector<dem::GrainSphere> dumped(const std::filesystem::path& path, std::vector<dem::GrainSphere> spheres) {
  std::ifstream file(path);
  std::string line;
  std::size_t found = 0;
  for (int number = 1; std::getline(file, line); ++number) {
    unsigned long id = 0;
    base::Vec3 x;
    if (number < 10) continue;  // LAMMPS' head
    const bool reads = std::sscanf(line.c_str(), "%lu %lf %lf %lf", &id, &x.x, &x.y, &x.z) == 4;
    if (!reads || id < 1 || id > spheres.size())
      throw base::MachineError(path.string() + ":" + std::to_string(number) + ": " + line);
    spheres[id - 1].position = x;
    ++found;
  }
  if (found != spheres.size())
    throw base::MachineError("LAMMPS: " + std::to_string(found) + " of " + std::to_string(spheres.size()) +
                             " spheres are left");
  return spheres;
}

void run(const Options& options) {
  Bed bed = poured_clumps(dem::make_clump(dem::read_spheres(options.stone)), width, options.grains);
  std::printf("%zu clumps, %zu spheres at rest; the wall at x = %g m is taken away\n", bed.grains.size(),
              bed.spheres.size(), width);
  bed.high[0] = far_away;
  const int steps = static_cast<int>(std::lround(options.seconds / slow_step));
  dem::set_threads(1);
  const auto simulation = dem::Simulation::create(setup_of(false), dem::Backend::omp);
  put_into(*simulation, bed);
  const std::vector<dem::GrainSphere> start = simulation->spheres();
  double from = seconds(CLOCK_MONOTONIC);
  simulation->advance(steps, slow_step);
  print("Trackbed", simulation->spheres(), seconds(CLOCK_MONOTONIC) - from);

  if (!OtherCode::installed("lmp")) {
    std::printf("LAMMPS is missing, left out: apt-get install --no-install-recommends lammps\n");
    return;
  }
  const TemporaryFolder folder;
  write_lammps(folder.path, bed);
  OtherCode lammps("lmp", folder.path);
  lammps.run("include begin.in");
  from = seconds(CLOCK_MONOTONIC);
  lammps.run("timestep " + std::to_string(slow_step) + "\nrun " + std::to_string(steps));
  const double took = seconds(CLOCK_MONOTONIC) - from;
  lammps.run("write_dump all custom end.txt id x y z modify sort id format float %.9g");
  print("LAMMPS", dumped(folder.path / "end.txt", start), took);
}

}  // namespace

int main(int argc, char** argv) try {
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  run(read(argc, argv));
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
