// The DEM core against LIGGGHTS and LAMMPS on the same start state, steps timed in turns.
//   benchmark_dem_compare [--spheres=FILE.csv] [--clumps=FILE.csv --stone=FILE.csv] [--only=A|B] [--steps=N]
//                         [--rounds=N] [--mine] [--alike]
// A: spheres in a box; without a file poured ones, which takes two minutes. B: clumps of one stone (x,y,z,radius of its
// spheres); without files clumps of stone 1 of meshes/ballast, poured. --mine: no other code. --alike: large pages for
// all. Every run starts from rest with empty histories and warms up for 1000 steps; then the runs take turns of N (300)
// steps for some (3) rounds. Rates are medians; a ratio is the median of the rounds' ratios. Another program on the
// machine changes all rates, ratios less. Debian packages: apt-get install liggghts lammps.
// Kinetic energies after the same number of steps say that all solved the same problem. In A they agree within 2 %. In
// B, so early, they follow the damping, which differs by law: LAMMPS' tsuji damps less, ours, which returns e without
// attraction, damps more than LIGGGHTS'. The undamped forces of the first step are those of LIGGGHTS; against walls
// this LAMMPS pushes 1.2 times as hard (1 + nu).
// Threads that wait do so asleep, after some 80 us of watching (OMP_WAIT_POLICY=passive, GOMP_SPINCOUNT=4000,
// unless set), as with ./trackbed: waiting in a loop on a machine that others use as well makes two threads ten times
// as slow, sleeping at once a tenth slower on a machine of their own. Likewise its memory comes in large pages where
// the system gives them to who asks (GLIBC_TUNABLES=glibc.malloc.hugetlb=1). The other codes start as their users start
// them, which is without, unless the system gives such pages to all.
#include <functional>
#include <iostream>
#include <memory>
#include <numbers>

#include "tests/benchmarks/other_codes.hpp"

namespace {
using namespace benchmarks;

struct Options {
  std::string spheres, clumps, stone = TRACKBED_SOURCE_FOLDER "/meshes/ballast/stone1.clump10.csv", only;
  int steps = 300, rounds = 3;
  bool mine = false, alike = false;
};
constexpr int warm_up = 1000;

/// One code, or one way of running ours, in the middle of its run.
struct Run {
  std::string name;
  std::function<Clocks(int steps)> advance;
  std::function<State()> state;
  std::vector<Clocks> turns;
};

State state_of(const dem::Simulation& simulation, const Bed& bed) {
  State state;
  const auto grains = simulation.grains();
  for (const dem::Grain& g : grains) {
    const double ball = 4.0 / 3.0 * std::numbers::pi * g.radius * g.radius * g.radius;
    const double mass = density * (g.shape < 0 ? ball : bed.shapes[g.shape].volume);
    const double round = 0.4 * g.radius * g.radius;
    const Vec3 inertia = g.shape < 0 ? Vec3{round, round, round} : bed.shapes[g.shape].inertia;
    state.translation += 0.5 * mass * norm2(g.velocity);
    state.rotation += dem::kernels::rotational_energy({g.orientation, g.angular_velocity}, mass * inertia);
  }
  state.touching = 2.0 * static_cast<double>(simulation.counts().contacts) / static_cast<double>(grains.size());
  return state;
}

/// How far the spheres of the simulation lie from where the file wants them.
double misplaced(const dem::Simulation& simulation, const Bed& bed) {
  double most = 0;
  const auto spheres = simulation.spheres();
  for (std::size_t k = 0; k < spheres.size(); ++k)
    most = std::max(most, norm(spheres[k].position - bed.spheres[k].position));
  return most;
}

struct Way {
  int lanes, threads;
  bool energy, mixed = false;
};

Run ours(const Bed& bed, const Way& way) {
  dem::Setup setup = setup_of(way.energy);
  setup.lanes = way.lanes;
  if (way.mixed) setup.precision = dem::Precision::mixed;
  dem::set_threads(way.threads);
  std::shared_ptr<dem::Simulation> simulation = dem::Simulation::create(setup, dem::Backend::omp);
  put_into(*simulation, bed);
  const bool wide = way.lanes == 0 && __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  const std::string name = "Trackbed, " + std::string(wide ? "AVX2" : "portable") + ", " +
                           (way.threads == 1 ? "1 thread" : std::to_string(way.threads) + " threads") +
                           (way.energy ? ", ledger" : "") + (way.mixed ? ", mixed" : "");
  const double off = misplaced(*simulation, bed);
  simulation->advance(warm_up, time_step);
  const dem::Counts counts = simulation->counts();
  std::printf("  %-36s %.0f B per sphere, %.0f per grain; %.3f candidates per sphere; start off by %.1e m\n",
              name.c_str(), static_cast<double>(counts.bytes) / static_cast<double>(counts.spheres),
              static_cast<double>(counts.bytes) / static_cast<double>(counts.grains),
              static_cast<double>(counts.candidate_pairs) / static_cast<double>(counts.spheres), off);
  const auto advance = [simulation, threads = way.threads](int steps) {
    dem::set_threads(threads);
    const Clocks before{seconds(CLOCK_MONOTONIC), seconds(CLOCK_PROCESS_CPUTIME_ID)};
    simulation->advance(steps, time_step);
    return Clocks{seconds(CLOCK_MONOTONIC) - before.wall, seconds(CLOCK_PROCESS_CPUTIME_ID) - before.processor};
  };
  return {name, advance, [simulation, &bed] { return state_of(*simulation, bed); }, {}};
}

using Writer = void (*)(const std::filesystem::path&, const Bed&);

Run other(const std::string& name, const std::string& program, Writer write, const Bed& bed,
          const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  write(folder, bed);
  const auto code = std::make_shared<OtherCode>(program, folder);
  const Clocks start = code->run("include begin.in");
  const Clocks warm = code->run("run " + std::to_string(warm_up));
  std::printf("  %-36s input read in %.1f s, warm after another %.1f s\n", name.c_str(), start.wall, warm.wall);
  const auto advance = [code](int steps) { return code->run("run " + std::to_string(steps) + " pre no post no"); };
  return {name, advance, [code, grains = bed.grains.size()] { return code->state(grains); }, {}};
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<long>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

/// Median over rounds of (that run's time) / (this run's time).
double ratio(const Run& run, const Run& to, double Clocks::*clock) {
  std::vector<double> ratios;
  for (std::size_t k = 0; k < run.turns.size(); ++k) ratios.push_back(to.turns[k].*clock / (run.turns[k].*clock));
  return median(ratios);
}

void print_table(const std::vector<Run>& runs, double grain_steps, const std::string& unit, std::size_t others) {
  std::printf("\n%-36s %25s", "", ("M " + unit + "-steps per").c_str());
  for (std::size_t k = runs.size() - others; k < runs.size(); ++k) std::printf("   x %-15s", runs[k].name.c_str());
  std::printf("   %-25s %s\n%-36s %12s %12s", "kinetic energy [J]", "contacts", "", "CPU s", "wall s");
  for (std::size_t k = 0; k < others; ++k) std::printf("   %8s %8s", "CPU", "wall");
  std::printf("   %12s %12s per %s\n", "translation", "rotation", unit.c_str());
  for (const Run& run : runs) {
    std::vector<double> wall, processor;
    for (const Clocks& turn : run.turns) {
      wall.push_back(turn.wall);
      processor.push_back(turn.processor);
    }
    std::printf("%-36s %12.3f %12.3f", run.name.c_str(), 1e-6 * grain_steps / median(processor),
                1e-6 * grain_steps / median(wall));
    for (std::size_t k = runs.size() - others; k < runs.size(); ++k)
      std::printf("   %8.2f %8.2f", ratio(run, runs[k], &Clocks::processor), ratio(run, runs[k], &Clocks::wall));
    const State state = run.state();
    std::printf("   %12.5g %12.5g %9.4f\n", state.translation, state.rotation, state.touching);
  }
  std::printf("\n");
}

void compare(const std::string& title, const std::string& unit, const Bed& bed, const std::vector<Way>& ways,
             const Options& options) {
  std::printf("%s: %zu grains, %zu spheres\n", title.c_str(), bed.grains.size(), bed.spheres.size());
  const TemporaryFolder folder;
  std::vector<Run> runs;
  for (const Way& way : ways) runs.push_back(ours(bed, way));
  const std::size_t mine = runs.size();
  struct Code {
    const char *name, *program, *package;
    Writer write;
  };
  for (const Code& code :
       {Code{"LIGGGHTS", "liggghts", "liggghts", write_liggghts}, Code{"LAMMPS", "lmp", "lammps", write_lammps}}) {
    if (options.mine) continue;
    if (!OtherCode::installed(code.program)) {
      std::printf("  %s is missing, left out: apt-get install --no-install-recommends %s\n", code.name, code.package);
      continue;
    }
    try {
      runs.push_back(other(code.name, code.program, code.write, bed, folder.path / code.program));
    } catch (const base::MachineError& error) {
      std::printf("  %s left out: %s\n", code.name, error.what());
    }
  }
  const double grain_steps = static_cast<double>(bed.grains.size()) * options.steps;
  for (int round = 1; round <= options.rounds; ++round)
    for (Run& run : runs) {
      run.turns.push_back(run.advance(options.steps));
      std::printf("  round %d  %-36s %8.3f M %s-steps per CPU second, %8.3f per wall second\n", round, run.name.c_str(),
                  1e-6 * grain_steps / run.turns.back().processor, unit.c_str(),
                  1e-6 * grain_steps / run.turns.back().wall);
    }
  print_table(runs, grain_steps, unit, runs.size() - mine);
}

Options read(int argc, char** argv) {
  Options options;
  for (int k = 1; k < argc; ++k) {
    const std::string argument = argv[k], name = argument.substr(0, argument.find('='));
    const std::string value = argument.substr(std::min(argument.size(), name.size() + 1));
    if (name == "--spheres")
      options.spheres = value;
    else if (name == "--clumps")
      options.clumps = value;
    else if (name == "--stone")
      options.stone = value;
    else if (name == "--only" && (value == "A" || value == "B"))
      options.only = value;
    else if (name == "--steps" && std::atoi(value.c_str()) > 0)
      options.steps = std::atoi(value.c_str());
    else if (name == "--rounds" && std::atoi(value.c_str()) > 0)
      options.rounds = std::atoi(value.c_str());
    else if (argument == "--mine")
      options.mine = true;
    else if (argument == "--alike")
      options.alike = true;
    else
      throw base::UserError(argument + ": not understood; see the head of tests/benchmarks/dem_compare.cpp");
  }
  return options;
}

}  // namespace

int main(int argc, char** argv) try {
  const Options options = read(argc, argv);
  if (!std::getenv("OMP_WAIT_POLICY")) {  // the library reads it when a program starts
    setenv("OMP_WAIT_POLICY", "passive", 1);
    setenv("GOMP_SPINCOUNT", "4000", 0);
    setenv("GLIBC_TUNABLES", "glibc.malloc.hugetlb=1", 0);
    execv("/proc/self/exe", argv);
  }
  if (!options.alike) unsetenv("GLIBC_TUNABLES");  // this program has read it, the others have not
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  if (options.only != "B")
    compare("benchmark A", "sphere", sphere_bed(options.spheres),
            {{0, 1, false},
             {0, 1, true},
             {0, 1, false, true},
             {0, 1, true, true},
             {0, 2, false},
             {0, 2, true},
             {0, 2, false, true},
             {2, 1, false},
             {2, 1, true},
             {2, 1, false, true},
             {2, 2, false},
             {2, 2, true}},
            options);
  if (options.only != "A") {
    compare("benchmark B", "clump", clump_bed(options.clumps, dem::read_spheres(options.stone)),
            {{0, 1, false},
             {0, 1, true},
             {0, 1, false, true},
             {0, 2, false},
             {0, 2, true},
             {2, 1, false},
             {2, 1, false, true},
             {2, 2, false}},
            options);
  }
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
