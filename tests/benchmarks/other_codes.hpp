#pragma once
// LIGGGHTS and LAMMPS on a benchmark's bed: inputs written from our own start state, and the program held at the end of
// a pipe, so that its steps can be timed in turns with ours. Debian packages liggghts and lammps.
#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <sstream>

#include "tests/benchmarks/bed.hpp"

namespace benchmarks {

struct Clocks {
  double wall = 0, processor = 0;  // [s]
};
/// What a run has done after its last step.
struct State {
  double translation = 0, rotation = 0;  // [J] kinetic energy
  double touching = 0;                   // contacts per grain, each counted on both sides; walls not counted
};

inline double seconds(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// A folder of its own, gone with this object.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "trackbed_benchmark.XXXXXX").string();
    if (!mkdtemp(pattern.data())) throw base::MachineError(pattern + ": cannot be made");
    path = pattern;
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder() { std::filesystem::remove_all(path); }
  std::filesystem::path path;
};

/// A code that reads commands from its standard input. Closing it ends the program.
class OtherCode {
 public:
  /// False when the program is not on the path.
  static bool installed(const std::string& program) {
    return std::system(("command -v " + program + " stdbuf > /dev/null").c_str()) == 0;  // NOLINT
  }

  /// Runs in `folder`, which holds `begin.in`; throws base::MachineError with the last lines said when it stops.
  OtherCode(const std::string& program, const std::filesystem::path& folder) : program_(program) {
    int in[2], out[2];
    // Closed in children: a later code that held an earlier one's pipe open would keep it from ending.
    if (pipe2(in, O_CLOEXEC) != 0 || pipe2(out, O_CLOEXEC) != 0) throw base::MachineError("no pipe to " + program);
    child_ = fork();
    if (child_ < 0) throw base::MachineError("cannot start " + program);
    if (child_ == 0) {
      dup2(in[0], STDIN_FILENO);
      dup2(out[1], STDOUT_FILENO);
      dup2(out[1], STDERR_FILENO);
      setenv("OMP_NUM_THREADS", "1", 1);
      if (chdir(folder.c_str()) == 0)
        execlp("stdbuf", "stdbuf", "-oL", program.c_str(), "-log", "none", static_cast<char*>(nullptr));
      _exit(127);
    }
    close(in[0]);
    close(out[1]);
    commands_ = fdopen(in[1], "w");
    answers_ = fdopen(out[0], "r");
    std::signal(SIGPIPE, SIG_IGN);
  }
  OtherCode(const OtherCode&) = delete;
  OtherCode& operator=(const OtherCode&) = delete;
  ~OtherCode() {
    std::fclose(commands_);
    std::fclose(answers_);
    waitpid(child_, nullptr, 0);
  }

  /// Gives the commands and waits until they are done; returns what they took.
  Clocks run(const std::string& commands) {
    ask("print \"benchmark: begin\"\n");
    const Clocks before = clocks();
    ask(commands + "\nprint \"benchmark: end\"\n");
    const Clocks after = clocks();
    return {after.wall - before.wall, after.processor - before.processor};
  }

  /// `touching` is printed as a sum over spheres.
  State state(std::size_t grains) {
    run("thermo_style custom step c_translation c_rotation c_touching\nrun 0\n"
        "variable a equal c_translation\nvariable b equal c_rotation\nvariable c equal c_touching");
    ask("print \"benchmark: $a $b $c\"\n");
    State s;
    std::sscanf(said_.c_str(), "benchmark: %lf %lf %lf", &s.translation, &s.rotation, &s.touching);
    s.touching /= static_cast<double>(grains);
    return s;
  }

 private:
  Clocks clocks() const {
    clockid_t clock{};
    clock_getcpuclockid(child_, &clock);
    return {seconds(CLOCK_MONOTONIC), seconds(clock)};
  }
  void ask(const std::string& commands) {
    std::fputs(commands.c_str(), commands_);
    std::fflush(commands_);
    std::string before;
    char line[4096];
    while (std::fgets(line, sizeof line, answers_)) {
      said_ = line;
      if (said_.starts_with("benchmark:")) return;
      if (said_.starts_with("ERROR")) before = said_;
    }
    throw base::MachineError(program_ + " stopped: " + (before.empty() ? said_ : before));
  }

  std::string program_, said_;
  pid_t child_ = 0;
  std::FILE *commands_ = nullptr, *answers_ = nullptr;
};

// ---- inputs: begin.in, and what it reads

/// What both codes are told alike; they came from one.
inline void write_common(std::ostream& file) {
  file << "units si\natom_modify map array\nboundary f f f\nnewton off\n";
}
/// 1.1 mm of skin: thick enough for the whole benchmark, thin enough for few neighbours.
inline void write_neighbours(std::ostream& file) { file << "neighbor 0.0011 bin\nneigh_modify delay 0\n"; }

inline void write_box(std::ostream& file, const Bed& bed) {
  double top = 0;
  for (const dem::Sphere& s : bed.spheres) top = std::max(top, s.position.z + s.radius);
  const char* names[] = {"xlo xhi", "ylo yhi"};
  for (int axis : {0, 1}) file << bed.low[axis] << ' ' << bed.high[axis] << ' ' << names[axis] << '\n';
  file << "-0.1 " << top + 0.1 << " zlo zhi\n";
}

/// Spheres: number, type, diameter, density, place. Of clumps, the body of each as well.
inline void write_spheres(const std::filesystem::path& path, const Bed& bed) {
  std::ofstream file(path);
  file.precision(17);
  file << "start state\n\n" << bed.spheres.size() << " atoms\n1 atom types\n";
  write_box(file, bed);
  file << "\nAtoms\n\n";
  for (std::size_t k = 0; k < bed.spheres.size(); ++k) {
    const dem::Sphere& s = bed.spheres[k];
    file << k + 1 << " 1 " << 2 * s.radius << ' ' << density << ' ' << s.position.x << ' ' << s.position.y << ' '
         << s.position.z << '\n';
  }
  if (bed.shapes.empty()) return;
  file << "\nMolecules\n\n";
  for (std::size_t k = 0; k < bed.spheres.size(); ++k)
    file << k + 1 << ' ' << k / bed.shapes[0].spheres.size() + 1 << '\n';
}

/// Mass, centre and inertia of each clump's union, for LAMMPS, which would take the sum over spheres.
inline void write_bodies(const std::filesystem::path& path, const Bed& bed) {
  std::ofstream file(path);
  file.precision(17);
  file << bed.grains.size() << '\n';
  const double mass = density * bed.shapes[0].volume;
  for (std::size_t k = 0; k < bed.grains.size(); ++k) {
    const dem::Grain& g = bed.grains[k];
    Vec3 axes[3];
    for (int axis : {0, 1, 2}) {
      Vec3 unit;
      unit[axis] = 1;
      axes[axis] = to_space(g.orientation, unit);
    }
    const auto inertia = [&](int a, int b) {
      double sum = 0;
      for (int axis : {0, 1, 2}) sum += mass * bed.shapes[0].inertia[axis] * axes[axis][a] * axes[axis][b];
      return sum;
    };
    file << k + 1 << ' ' << mass << ' ' << g.position.x << ' ' << g.position.y << ' ' << g.position.z << ' '
         << inertia(0, 0) << ' ' << inertia(1, 1) << ' ' << inertia(2, 2) << ' ' << inertia(0, 1) << ' '
         << inertia(0, 2) << ' ' << inertia(1, 2) << " 0 0 0 0 0 0 0 0 0\n";
  }
}

/// pair_style granular: Hertz with material constants, tsuji damping, Mindlin with history. Clumps by fix rigid/small.
inline void write_lammps(const std::filesystem::path& folder, const Bed& bed) {
  const bool clumps = !bed.shapes.empty();
  write_spheres(folder / "start.data", bed);
  if (clumps) write_bodies(folder / "bodies", bed);
  std::ostringstream law;
  law << "hertz/material " << young_modulus << ' ' << restitution << ' ' << poisson_ratio
      << " tangential mindlin NULL 1.0 " << friction << " damping tsuji";
  std::ofstream file(folder / "begin.in");
  file.precision(17);
  file << "atom_style sphere\n";
  write_common(file);
  file << "comm_modify vel yes\n";
  if (clumps) file << "fix molecule all property/atom mol ghost yes\n";
  file << "read_data start.data" << (clumps ? " fix molecule NULL Molecules\n" : "\n");
  write_neighbours(file);
  if (clumps) file << "neigh_modify exclude molecule/intra all\n";
  file << "pair_style granular\npair_coeff * * " << law.str() << "\ntimestep " << time_step
       << "\nfix gravity all gravity " << gravity << " vector 0 0 -1" << (clumps ? " disable" : "")
       << "\nfix z all wall/gran granular " << law.str() << " zplane 0 NULL\nfix x all wall/gran granular " << law.str()
       << " xplane " << bed.low[0] << ' ' << bed.high[0] << "\nfix y all wall/gran granular " << law.str() << " yplane "
       << bed.low[1] << ' ' << bed.high[1]
       << (clumps ? "\nfix motion all rigid/small molecule infile bodies gravity gravity\n"
                    "compute translation all ke/rigid motion\ncompute rotation all erotate/rigid motion\n"
                  : "\nfix motion all nve/sphere\ncompute translation all ke\ncompute rotation all erotate/sphere\n")
       << "compute contacts all contact/atom\ncompute touching all reduce sum c_contacts\n"
          "thermo_style custom step atoms\nthermo 1000000000\n";
}

/// Clumps enter LIGGGHTS one by one: each by its own insertion into a region of 0.1 micrometres. Spheres and inertia in
/// the body frame, so that nothing is left to its Monte Carlo integration.
inline void write_insertions(std::ostream& file, const Bed& bed) {
  const dem::Clump& shape = bed.shapes[0];
  const double mass = density * shape.volume;
  file << "fix stone all particletemplate/multisphere 15485863 atom_type 1 density constant " << density
       << " volume_limit 1e-30 nspheres " << shape.spheres.size() << " ntry 1000 spheres";
  for (const dem::Sphere& s : shape.spheres)
    file << ' ' << s.position.x << ' ' << s.position.y << ' ' << s.position.z << ' ' << s.radius;
  file << " type 1 mass " << mass << " inertia_tensor " << mass * shape.inertia.x << " 0 0 " << mass * shape.inertia.y
       << " 0 " << mass * shape.inertia.z
       << " use_density\nfix mix all particledistribution/discrete 15485867 1 stone 1\n";
  for (std::size_t k = 0; k < bed.grains.size(); ++k) {
    const dem::Grain& g = bed.grains[k];
    const auto& q = g.orientation;
    file << "region r" << k << " sphere " << g.position.x << ' ' << g.position.y << ' ' << g.position.z
         << " 1e-7 volume_limit 1e-30 units box\nfix i" << k
         << " all insert/pack seed 32452843 distributiontemplate mix insert_every once overlapcheck no verbose no "
            "orientation constant "
         << q.w << ' ' << q.x << ' ' << q.y << ' ' << q.z << " region r" << k
         << " particles_in_region 1 ntry_mc 1001\n";
  }
  file << "fix motion all multisphere\nrun 1\n";
  for (std::size_t k = 0; k < bed.grains.size(); ++k) file << "unfix i" << k << '\n';
}

/// pair_style gran, model hertz tangential history. Clumps by fix multisphere.
inline void write_liggghts(const std::filesystem::path& folder, const Bed& bed) {
  const bool clumps = !bed.shapes.empty();
  const std::string model = " model hertz tangential history";
  std::ofstream file(folder / "begin.in");
  file.precision(17);
  file << "atom_style granular\n";
  write_common(file);
  file << "communicate single vel yes\n";
  if (clumps) {
    file << "region box block " << bed.low[0] << ' ' << bed.high[0] << ' ' << bed.low[1] << ' ' << bed.high[1]
         << " -0.1 3 units box\ncreate_box 1 box\n";
  } else {
    write_spheres(folder / "start.data", bed);
    file << "read_data start.data\n";
  }
  write_neighbours(file);
  file << "fix e all property/global youngsModulus peratomtype " << young_modulus
       << "\nfix nu all property/global poissonsRatio peratomtype " << poisson_ratio
       << "\nfix cor all property/global coefficientRestitution peratomtypepair 1 " << restitution
       << "\nfix mu all property/global coefficientFriction peratomtypepair 1 " << friction << "\npair_style gran"
       << model << "\npair_coeff * *\ntimestep " << time_step << "\nfix gravity all gravity " << gravity
       << " vector 0.0 0.0 -1.0\nfix z all wall/gran" << model << " primitive type 1 zplane 0.0\n";
  for (int axis : {0, 1})
    for (int upper : {0, 1})
      file << "fix "
           << "xy"[axis] << upper << " all wall/gran" << model << " primitive type 1 "
           << "xy"[axis] << "plane " << (upper ? bed.high : bed.low)[axis] << '\n';
  file << "thermo_style custom step atoms\nthermo 1000000000\n";
  if (clumps) {
    write_insertions(file, bed);
    file << "compute translation all ke/multisphere\ncompute rotation all erotate/multisphere\n";
  } else {
    file << "fix motion all nve/sphere\ncompute translation all ke\ncompute rotation all erotate/sphere\n";
  }
  file << "compute contacts all contact/atom\ncompute touching all reduce sum c_contacts\n";
}

}  // namespace benchmarks
