// Pictures of a small made-up run: they come out, on a machine without a screen too, and show something. What they
// should look like only the eye can judge.
#include <gtest/gtest.h>
#include <unistd.h>
#include <vtkDataArray.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGReader.h>
#include <vtkPointData.h>

#include <cmath>
#include <fstream>

#include "coupling/render.hpp"
#include "coupling/virtual_display.hpp"
#include "dem/output.hpp"

namespace {

namespace fs = std::filesystem;

/// Share of the pixels that are not white.
double ink(const fs::path& png, int (&size)[3]) {
  vtkNew<vtkPNGReader> reader;
  reader->SetFileName(png.c_str());
  reader->Update();
  reader->GetOutput()->GetDimensions(size);
  vtkDataArray* pixels = reader->GetOutput()->GetPointData()->GetScalars();
  vtkIdType coloured = 0;
  for (vtkIdType i = 0; i < pixels->GetNumberOfTuples(); ++i) coloured += pixels->GetComponent(i, 0) < 250 ? 1 : 0;
  return static_cast<double>(coloured) / static_cast<double>(pixels->GetNumberOfTuples());
}

/// A cube of grains, stacked, each pressing on the one below it.
void make_run(const fs::path& folder) {
  constexpr int side = 6;
  constexpr double radius = 0.02;
  std::vector<dem::Grain> grains;
  std::vector<dem::GrainContact> contacts;
  for (int i = 0; i < side * side * side; ++i) {
    dem::Grain grain;
    grain.id = i;
    grain.radius = radius;
    grain.position = {2 * radius * (i % side), 2 * radius * (i / side % side), 2 * radius * (i / side / side)};
    grains.push_back(grain);
  }
  dem::Writer writer(folder, grains);
  for (auto& grain : grains) {
    if (grain.position.z > 0) {
      const auto below = grain.position - base::Vec3{0, 0, 2 * radius};
      contacts.push_back({grain.id, grain.id - side * side, grain.position, below, {0, 0, 10 + grain.position.y}, 0});
    }
    grain.position.z *= 0.99;
  }
  writer.write(0.5, grains, contacts, {});
  writer.write_contacts(0.5, contacts, {});
  std::ofstream(folder / "history.csv") << "time [s],top_load [N]\n0,0\n0.5,100\n1,0\n";
}

TEST(Render, DrawsARunWithoutAScreen) {
  try {
    const coupling::VirtualDisplay display;
  } catch (const std::exception& error) {
    GTEST_SKIP() << error.what();
  }
  const fs::path folder = fs::temp_directory_path() / ("trackbed_pictures_" + std::to_string(getpid()));
  fs::create_directories(folder);
  make_run(folder);
  const auto files = coupling::render(folder);
  ASSERT_EQ(files.size(), 5U);
  EXPECT_EQ(files.back(), folder / "pictures/index.html");
  for (std::size_t i = 0; i + 1 < files.size(); ++i) {
    int size[3];
    const double share = ink(files[i], size);
    EXPECT_EQ(size[0], 1600);
    EXPECT_EQ(size[1], 1000);
    EXPECT_GT(share, i == 3 ? 0.01 : 0.15) << files[i];  // the last picture has curves, thin ones
    EXPECT_LT(share, 0.8) << files[i];
  }
  fs::remove_all(folder);
}

}  // namespace
