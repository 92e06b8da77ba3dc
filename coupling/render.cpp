#include "coupling/render.hpp"

#include <fstream>
#include <system_error>

#include "base/error.hpp"
#include "coupling/render_curves.hpp"
#include "coupling/render_page.hpp"
#include "coupling/render_scene.hpp"
#include "coupling/run_directory.hpp"
#include "coupling/virtual_display.hpp"

namespace coupling {

namespace fs = std::filesystem;

std::vector<fs::path> render(const fs::path& run_directory) {
  const RunDirectory run = open_run_directory(run_directory);
  const fs::path folder = run_directory / "pictures";
  std::error_code failure;
  fs::create_directories(folder, failure);
  if (failure) throw base::MachineError("cannot make the folder " + folder.string() + ": " + failure.message());

  std::vector<fs::path> files;
  {
    const VirtualDisplay display;
    files = render_scene(run, peak_moment(run), folder);
    for (const auto& file : render_curves(run, folder)) files.push_back(file);
  }
  const fs::path page = folder / "index.html";
  std::ofstream stream(page, std::ios::trunc);
  stream << results_page(run, files);
  stream.close();
  if (!stream) throw base::MachineError("cannot write " + page.string() + ": is the disk full or read-only?");
  files.push_back(page);
  return files;
}

}  // namespace coupling
