// The command line. Exit status: 0 done, 1 a mistake of ours, 2 the user's input is wrong, 3 the run became unstable,
// 4 the machine failed it, 130 it was interrupted.
#include <fmt/format.h>
#include <mpi.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "base/quantity.hpp"
#include "base/text.hpp"
#include "base/version.hpp"
#include "coupling/agree.hpp"
#include "coupling/check.hpp"
#include "coupling/render.hpp"
#include "coupling/run.hpp"

namespace {

/// What the command line says; texts are turned into values when the command runs.
struct Arguments {
  coupling::RunOptions options;
  std::vector<std::string> settings;
  std::string out, until, folder, family;
};

/// OpenMP reads how long threads watch for work before they sleep, the C library whether to ask for large pages, when
/// the program starts (docs/performance.md has what both give). A run says it, unless the environment does
/// (OMP_WAIT_POLICY), and starts once more; where that is not possible it goes on as it is.
void start_with_environment(int argc, char** argv) {
  if (argc < 2 || std::string(argv[1]) != "run" || std::getenv("OMP_WAIT_POLICY")) return;
  std::error_code unknown;
  // By its own name, which others look for. Where the dynamic loader was called by hand, it is the loader's.
  const auto program = std::filesystem::read_symlink("/proc/self/exe", unknown);
  if (unknown || program.filename().string().starts_with("ld-")) return;
  setenv("OMP_WAIT_POLICY", "passive", 1);
  setenv("GOMP_SPINCOUNT", "4000", 0);
  setenv("GLIBC_TUNABLES", "glibc.malloc.hugetlb=1", 0);
  execv(program.c_str(), argv);
}

/// MPI lives as long as this object.
class MpiSession {
 public:
  MpiSession(int argc, char** argv) {
    int provided = 0;
    MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &provided);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  }
  ~MpiSession() { MPI_Finalize(); }
  MpiSession(const MpiSession&) = delete;
  MpiSession& operator=(const MpiSession&) = delete;
  int rank = 0;
};

coupling::RunOptions run_options(const Arguments& arguments) {
  coupling::RunOptions options = arguments.options;
  for (const auto& setting : arguments.settings) {
    const auto equals = setting.find('=');
    base::require_user(equals != std::string::npos && equals > 0,
                       fmt::format("--set {}: no value; write --set key=value", setting));
    options.overrides.push_back({setting.substr(0, equals), setting.substr(equals + 1)});
  }
  if (!arguments.out.empty()) options.out = arguments.out;
  if (!arguments.until.empty()) {
    try {
      options.until = base::parse_quantity(arguments.until, "s");
    } catch (const base::QuantityError& error) {
      throw base::UserError(fmt::format("--until {}: {}", arguments.until, error.what()));
    }
    base::require_user(*options.until > 0, fmt::format("--until {}: must be > 0 s", arguments.until));
  }
  return options;
}

int exit_status(const coupling::FailureText& failure, bool speak) {
  if (failure.kind == coupling::Failure::none) return 0;
  const char* word = failure.kind == coupling::Failure::internal      ? "internal error"
                     : failure.kind == coupling::Failure::interrupted ? "interrupted"
                                                                      : "error";
  if (speak) fmt::print(stderr, "trackbed: {}: {}\n", word, failure.text);
  return static_cast<int>(failure.kind);
}

void add_scene_arguments(CLI::App& command, Arguments& arguments) {
  command.add_option("SCENE", arguments.options.scene, "scene file (.toml)")->required();
  command
      .add_option(
          "--set", arguments.settings,
          "replace a value of the scene: table.key=value; rows by name or number (stage.load.duration=\"20 ms\")")
      ->type_name("KEY=VALUE")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command.add_option("--backend", arguments.options.backend, "where grains are computed")
      ->check(CLI::IsMember({"auto", "omp", "cuda"}))
      ->capture_default_str();
  command.add_option("--threads", arguments.options.threads, "threads for the grains; 0: chosen")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
}

/// Runs a command that needs MPI; only rank 0 speaks of an error, every rank returns its status.
int with_mpi(int argc, char** argv, const std::function<void(int rank)>& command) {
  MpiSession session(argc, argv);
  return exit_status(coupling::caught([&] { command(session.rank); }), session.rank == 0);
}

int run(int argc, char** argv, const Arguments& arguments) {
  return with_mpi(argc, argv, [&](int) { coupling::run(run_options(arguments)); });
}

int check(int argc, char** argv, const Arguments& arguments) {
  return with_mpi(argc, argv, [&](int rank) {
    coupling::agree(MPI_COMM_WORLD, [&] {
      if (rank == 0) fmt::print("{}", coupling::check(run_options(arguments)));
    });
  });
}

int render(const Arguments& arguments) {
  return exit_status(coupling::caught([&] {
                       for (const auto& file : coupling::render(arguments.folder)) fmt::print("{}\n", file.string());
                     }),
                     true);
}

int list(const Arguments& arguments) {
  return exit_status(coupling::caught([&] { fmt::print("{}", coupling::list_family(arguments.family)); }), true);
}

}  // namespace

int main(int argc, char** argv) {
  start_with_environment(argc, argv);
  // VTK's threads find 0 or -0 the smallest of a range by chance. (Its header of SetBackend is not C++20.)
  setenv("VTK_SMP_BACKEND_IN_USE", "Sequential", 1);
  spdlog::set_pattern("%v");  // until a run opens its own log
  Arguments arguments;
  CLI::App app("Ballasted railway track: grains (DEM) and solids (FEM), coupled.", "trackbed");
  app.set_version_flag("--version", "trackbed " + std::string(base::code_version()));
  app.require_subcommand(1);
  app.failure_message([](const CLI::App*, const CLI::Error& error) {
    return fmt::format("trackbed: error: {}; run with --help to see how\n", error.what());
  });
  app.footer(
      "Example: mpirun -n 2 trackbed run configs/one_sleeper.toml --out runs/first\n"
      "Exit status: 0 done, 2 wrong input, 3 unstable, 4 the machine failed, 130 interrupted, 1 a mistake in "
      "Trackbed.");

  CLI::App* run_command = app.add_subcommand("run", "run a scene");
  add_scene_arguments(*run_command, arguments);
  run_command->add_option("--out", arguments.out, "run directory (default: runs/<scene>)")->type_name("DIR");
  run_command->add_flag("--overwrite", arguments.options.overwrite, "replace the run directory if it exists");
  run_command
      ->add_option(
          "--restart", arguments.options.restart,
          "go on from a checkpoint: a file, a run directory (its newest), or auto (the run directory's, if it has "
          "one)")
      ->type_name("FILE");
  run_command
      ->add_option("--dem-ranks", arguments.options.ranks.dem_ranks,
                   "how many ranks of mpirun hold grains, a slab of the track each; the others hold the bodies "
                   "(default: 1; all in a scene without bodies)")
      ->check(CLI::Range(1, 1000000))
      ->type_name("D");
  run_command
      ->add_option("--role", arguments.options.ranks.role,
                   "what the ranks of this part of an mpirun line hold: grains (dem) or bodies (fem)")
      ->check(CLI::IsMember({"dem", "fem"}));
  run_command->add_option("--until", arguments.until, "stop early at this simulated time")->type_name("TIME");
  run_command->footer(
      "Example: trackbed run configs/cantilever_step.toml --out runs/beam --set body.hex8.element=tet4\n"
      "Ranks: mpirun -n 4 trackbed run SCENE --dem-ranks 2, or mpirun -n 2 trackbed run SCENE --role dem : -n 2 "
      "trackbed "
      "run SCENE --role fem\n"
      "Checkpoints: [output] checkpoint_interval, checkpoint_wall_time; SIGUSR1 asks for one; SIGINT and SIGTERM leave "
      "one and end the run.\nTo go on: trackbed run configs/cantilever_step.toml --restart runs/beam");

  CLI::App* check_command = app.add_subcommand("check", "read, mesh and size a scene; start nothing");
  add_scene_arguments(*check_command, arguments);
  check_command->footer("Example: trackbed check configs/one_sleeper.toml --set time.dem_fraction=0.2");

  CLI::App* render_command = app.add_subcommand("render", "pictures of a finished run");
  render_command->add_option("RUNDIR", arguments.folder, "run directory")->required();
  render_command->footer("Example: trackbed render runs/one_sleeper");

  CLI::App* list_command = app.add_subcommand("list", "what a scene can be made of, with units, ranges and defaults");
  list_command->add_option("FAMILY", arguments.family, base::join(coupling::families(), " | "))->required();
  list_command->footer("Example: trackbed list histories");

  try {
    const std::vector<std::string> commands{"run", "check", "render", "list"};
    const std::string first = argc > 1 ? argv[1] : "-";
    if (first[0] != '-' && std::find(commands.begin(), commands.end(), first) == commands.end()) {
      throw CLI::ParseError(fmt::format("no command \"{}\"; {}", first, base::suggest(first, commands, "commands")),
                            CLI::ExitCodes::ExtrasError);
    }
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    // Under mpirun all ranks come here; the launcher kills the others once one has left without MPI.
    const bool launched = std::getenv("OMPI_COMM_WORLD_SIZE") || std::getenv("PMI_SIZE");
    const bool wrong = error.get_exit_code() != 0;
    const auto session = launched ? std::make_unique<MpiSession>(argc, argv) : nullptr;
    if (!session || session->rank == 0) app.exit(error);
    return wrong ? 2 : 0;
  }
  if (*run_command) return run(argc, argv, arguments);
  if (*check_command) return check(argc, argv, arguments);
  if (*render_command) return render(arguments);
  return list(arguments);
}
