#pragma once
// Starts the built program as a user would and reads what it leaves behind.
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

namespace regression {

namespace fs = std::filesystem;

struct Finished {
  int status = -1;
  std::string output;  // standard output and error together
};

/// A folder of its own for each test program, with a packing cache that all its runs share.
inline fs::path scratch() {
  static const fs::path folder = [] {
    fs::path made = fs::temp_directory_path() / ("trackbed_regression_" + std::to_string(getpid()));
    fs::create_directories(made);
    setenv("TRACKBED_CACHE", (made / "cache").c_str(), 1);
    setenv("OMPI_ALLOW_RUN_AS_ROOT", "1", 1);
    setenv("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1", 1);
    return made;
  }();
  return folder;
}

inline std::string slurp(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

/// Runs `trackbed ARGUMENTS`; ranks > 0: under mpirun.
inline Finished trackbed(const std::string& arguments, int ranks = 0) {
  const fs::path log = scratch() / "output.txt";
  const std::string launcher = ranks > 0 ? std::string(TRACKBED_MPIRUN) + " -n " + std::to_string(ranks) + " " : "";
  const std::string command = "cd '" + scratch().string() + "' && " + launcher + "'" + TRACKBED_PROGRAM + "' " +
                              arguments + " > '" + log.string() + "' 2>&1";
  const int status = std::system(command.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, slurp(log)};
}

inline std::string scene(const std::string& name) {
  return "'" + std::string(TRACKBED_SOURCE_FOLDER) + "/configs/" + name + "'";
}

/// A scene file; SOURCE in its text stands for the source folder.
inline fs::path write_scene(const std::string& name, std::string text) {
  const std::string word = "SOURCE";
  for (auto at = text.find(word); at != std::string::npos; at = text.find(word))
    text.replace(at, word.size(), TRACKBED_SOURCE_FOLDER);
  const fs::path file = scratch() / (name + ".toml");
  std::ofstream(file) << text;
  return file;
}

inline nlohmann::json summary(const fs::path& run) { return nlohmann::json::parse(slurp(run / "summary.json")); }

}  // namespace regression
