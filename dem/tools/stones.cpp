// trackbed_stones: makes the stones and clumps of meshes/ballast/, and clumps from the user's own surfaces.
//   trackbed_stones library meshes/ballast
//   trackbed_stones fill stone.stl --spheres 10 --output stone.csv
#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "base/error.hpp"
#include "dem/clump.hpp"
#include "dem/dimensions.hpp"
#include "dem/stone_library.hpp"

namespace {

void write(const std::filesystem::path& path, const std::string& text) {
  std::ofstream file(path);
  file << text;
  file.close();
  if (!file) throw base::MachineError(path.string() + ": cannot be written");
}

void print_dimensions(const char* name, const dem::Dimensions& d) {
  std::printf("| %s | %.1f | %.1f | %.1f | %.1f | %.1f | %.2f | %.2f | %.2f | %s | %s |", name, 1e3 * d.sieve,
              1e3 * d.longest, 1e3 * d.length, 1e3 * d.width, 1e3 * d.thickness, d.width / d.length,
              d.thickness / d.width, d.longest / d.thinnest, is_flaky(d) ? "yes" : "no",
              is_elongated(d) ? "yes" : "no");
}

void print_filling(const dem::Filling& filling) {
  const dem::Dimensions d = dem::dimensions(filling.spheres);
  std::printf(" %zu: %.1f %%, %.1f mm |", filling.spheres.size(), 100 * filling.error_volume, 1e3 * d.sieve);
}

/// Writes the library and prints the table of its README.
void make_library(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  std::printf(
      "| stone | sieve | longest | L | W | T | W/L | T/W | L/E | flaky | elongated | few spheres | many spheres |\n");
  std::printf("| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n");
  double volume = 0, flaky = 0, elongated = 0;
  int number = 0;
  for (const dem::AngularStone& recipe : dem::ballast_stones()) {
    const std::string name = "stone" + std::to_string(++number);
    const dem::Stone stone = dem::make_stone(recipe);
    const dem::Dimensions size = dem::dimensions(dem::corner_spheres(stone));
    const double own = dem::mass_properties(stone).volume;
    volume += own;
    flaky += is_flaky(size) ? own : 0;
    elongated += is_elongated(size) ? own : 0;
    write(folder / (name + ".stl"), dem::stl_text(stone, name));
    print_dimensions(name.c_str(), size);
    for (const int spheres : {dem::few_spheres, dem::many_spheres}) {
      const dem::Filling filling = dem::fill_with_spheres(stone, spheres);
      write(folder / (name + ".clump" + std::to_string(spheres) + ".csv"),
            dem::spheres_text(filling.spheres, dem::filling_origin(name + ".stl", filling)));
      print_filling(filling);
    }
    std::printf("\n");
  }
  write(folder / "two_sphere.csv",
        dem::spheres_text(dem::two_sphere_clump(),
                          "two spheres one radius apart, as large as a ball of 18.5 mm radius (Talebiahooie2021)"));
  std::printf("\nOf the stones' volume, %.1f %% is flaky and %.1f %% elongated.\n", 100 * flaky / volume,
              100 * elongated / volume);
}

struct FillOptions {
  std::filesystem::path surface, output;
  int spheres = dem::few_spheres;
  double unit = 1;
};

void fill(const FillOptions& options) {
  const dem::Stone stone = dem::read_stl(options.surface, options.unit);
  const dem::Filling filling = dem::fill_with_spheres(stone, options.spheres);
  const std::string origin = dem::filling_origin(options.surface.filename().string(), filling);
  write(options.output, dem::spheres_text(filling.spheres, origin));
  std::printf("%s\n| stone | sieve | longest | L | W | T | W/L | T/W | L/E | flaky | elongated | spheres |\n",
              origin.c_str());
  print_dimensions(options.surface.stem().string().c_str(), dem::dimensions(dem::corner_spheres(stone)));
  print_filling(filling);
  std::printf("\n");
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Stones and clumps of spheres for Trackbed"};
  app.require_subcommand(1);
  std::filesystem::path folder;
  CLI::App* library = app.add_subcommand("library", "make the stones of meshes/ballast/ and print their table");
  library->add_option("folder", folder, "where the files go")->required();
  FillOptions options;
  CLI::App* one = app.add_subcommand("fill", "fill a closed surface (STL) with spheres");
  one->add_option("surface", options.surface, "STL file, text or binary")->required();
  one->add_option("--output", options.output, "file of spheres to write (.csv)")->required();
  one->add_option("--spheres", options.spheres, "how many")->capture_default_str();
  one->add_option("--unit", options.unit, "metres per unit of the file: 0.001 for millimetres")->capture_default_str();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  try {
    if (library->parsed()) make_library(folder);
    if (one->parsed()) fill(options);
  } catch (const base::UserError& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return 2;
  } catch (const base::MachineError& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return 4;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "mistake in Trackbed: %s\n", error.what());
    return 1;
  }
  return 0;
}
