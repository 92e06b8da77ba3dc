// What dem::Writer puts on the disk, read back with VTK, and the stress of one grain.
#include <gtest/gtest.h>
#include <unistd.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <vtkXMLPolyDataReader.h>

#include <fstream>
#include <functional>
#include <iterator>
#include <numbers>

#include "base/error.hpp"
#include "dem/output.hpp"

namespace {

using base::Vec3;
namespace fs = std::filesystem;

/// A folder of its own per test, removed at the end.
struct DemOutput : testing::Test {
  fs::path folder = fs::temp_directory_path() / ("trackbed_dem_output_" + std::to_string(getpid()));
  void SetUp() override { fs::create_directories(folder); }
  void TearDown() override { fs::remove_all(folder); }
};

vtkSmartPointer<vtkPolyData> read(const fs::path& file) {
  vtkNew<vtkXMLPolyDataReader> reader;
  reader->SetFileName(file.c_str());
  reader->Update();
  return reader->GetOutput();
}

constexpr double radius = 0.02, force = 150.0;
const double volume = 4.0 / 3.0 * std::numbers::pi * radius * radius * radius;

dem::Grain grain(std::int64_t id, Vec3 position) {
  dem::Grain made;
  made.position = position;
  made.radius = radius;
  made.id = id;
  return made;
}

// Two opposite contacts F at ±R e_z: sigma_zz = (R·(-F) + (-R)·F) / V = -2 R F / V, nothing else. A code with the sign
// of tension turned, with each contact counted on one of its grains alone, or with 1/(2V) on the diagonal fails here.
TEST(GrainStress, SqueezedGrainCarriesForceTimesDiameterOverVolume) {
  const std::vector<dem::Grain> grains = {grain(7, {1, 2, 3}), grain(8, {1, 2, 3 + 2 * radius})};
  const std::vector<dem::GrainContact> pair = {{7, 8, grains[0].position, grains[1].position, {0, 0, -force}, 0}};
  const std::vector<dem::WallContact> wall = {{7, 0, grains[0].position, {1, 2, 3 - radius}, {0, 0, force}, 0}};
  const auto stress = dem::grain_stress(grains, pair, wall);
  EXPECT_NEAR(stress[0][2], -force * 2 * radius / volume, 1e-12 * force / (radius * radius));
  for (int component : {0, 1, 3, 4, 5}) EXPECT_EQ(stress[0][component], 0.0);
  EXPECT_NEAR(stress[1][2], -force * radius / volume, 1e-12 * force / (radius * radius));
}

// Levers of a pair add up to the distance of the centres, whatever the overlap (else the mean stress would depend on
// how the overlap is shared): V1 s1 + V2 s2 = branch ⊗ f.
TEST(GrainStress, LeversOfAPairAddUpToTheirBranch) {
  const double overlap = 0.003;
  const std::vector<dem::Grain> grains = {grain(0, {0, 0, 0}), grain(1, {2 * radius - overlap, 0, 0})};
  const std::vector<dem::GrainContact> pair = {{0, 1, grains[0].position, grains[1].position, {-3, 4, 0}, overlap}};
  const auto stress = dem::grain_stress(grains, pair, {});
  const double branch = 2 * radius - overlap;
  EXPECT_NEAR((stress[0][0] + stress[1][0]) * volume, branch * -3, 1e-15);
  EXPECT_NEAR((stress[0][3] + stress[1][3]) * volume, branch * 4 / 2, 1e-15);
}

// Everything the header promises is in the file, in the right place and unit.
TEST_F(DemOutput, GrainsReadBack) {
  std::vector<dem::Grain> grains = {grain(3, {0.1, 0.2, 0.3}), grain(5, {0.1, 0.2, 0.34})};
  dem::Writer writer(folder, grains);
  grains[0].position.z -= 1e-6;
  grains[0].velocity = {1, 2, 3};
  grains[0].angular_velocity = {4, 5, 6};
  const std::vector<dem::GrainContact> pair = {{3, 5, grains[0].position, grains[1].position, {0, 0, -force}, 0}};
  const std::vector<dem::WallContact> wall = {{3, 2, grains[0].position, {0.1, 0.2, 0.28}, {0, 0, force}, 0}};
  writer.write(0.0, grains, pair, wall);
  writer.write(0.25, grains, pair, wall);

  const auto data = read(folder / "grains/grains_0001.vtp");
  ASSERT_EQ(data->GetNumberOfPoints(), 2);
  ASSERT_EQ(data->GetNumberOfVerts(), 2);
  const auto value = [&](const char* name, int item, int component) {
    return data->GetPointData()->GetArray(name)->GetComponent(item, component);
  };
  EXPECT_EQ(value("id", 1, 0), 5);
  EXPECT_EQ(value("radius", 0, 0), radius);
  EXPECT_EQ(value("velocity", 0, 1), 2);
  EXPECT_EQ(value("angular_velocity", 0, 2), 6);
  EXPECT_NEAR(value("displacement", 0, 2), -1e-6, 1e-15);
  EXPECT_EQ(value("displacement", 1, 2), 0);
  EXPECT_EQ(value("coordination", 0, 0), 2);
  EXPECT_EQ(value("coordination", 1, 0), 1);
  EXPECT_NEAR(value("vertical_stress", 0, 0), -force * 2 * radius / volume, 1e-3 * force / volume * radius);
  EXPECT_EQ(value("vertical_stress", 0, 0), value("stress", 0, 2));

  std::ifstream collection(folder / "grains.pvd");
  const std::string text(std::istreambuf_iterator<char>(collection), {});
  EXPECT_NE(text.find("timestep=\"0.25\""), std::string::npos);
  EXPECT_NE(text.find("file=\"grains/grains_0001.vtp\""), std::string::npos);
}

// Normal force: the component along the segment, positive in compression; force: the whole.
TEST_F(DemOutput, ContactsReadBack) {
  dem::Writer writer(folder, {});
  const std::vector<dem::GrainContact> pair = {{0, 1, {0, 0, 0}, {0.04, 0, 0}, {-3, 4, 0}, 0}};
  const std::vector<dem::WallContact> wall = {{0, 2, {0, 0, 0}, {0, 0, -0.02}, {0, 0, 7}, 0}};
  writer.write_contacts(0.5, pair, wall);
  const auto data = read(folder / "contacts/contacts_0000.vtp");
  ASSERT_EQ(data->GetNumberOfLines(), 2);
  const auto value = [&](const char* name, int item) {
    return data->GetCellData()->GetArray(name)->GetComponent(item, 0);
  };
  EXPECT_EQ(value("force", 0), 5);
  EXPECT_EQ(value("normal_force", 0), 3);
  EXPECT_EQ(value("wall", 0), -1);
  EXPECT_EQ(value("normal_force", 1), 7);
  EXPECT_EQ(value("wall", 1), 2);
  EXPECT_TRUE(fs::exists(folder / "contacts.pvd"));
}

TEST_F(DemOutput, NoGrainsIsAnEmptyFileNotAnError) {
  dem::Writer writer(folder, {});
  writer.write(0, {}, {}, {});
  writer.write_contacts(0, {}, {});
  EXPECT_EQ(read(folder / "grains/grains_0000.vtp")->GetNumberOfPoints(), 0);
}

std::string machine_error(const std::function<void()>& act) {
  try {
    act();
  } catch (const base::MachineError& error) {
    return error.what();
  }
  return "";
}

// A disk without room (/dev/full takes no byte) and a folder that cannot be made: exit 4, with the name of the file.
// What had this name before, as in a run that is gone on from, is still whole.
TEST_F(DemOutput, DiskFailureNamesTheFile) {
  const std::vector<dem::Grain> grains = {grain(0, {})};
  dem::Writer writer(folder, grains);
  std::ofstream(folder / "grains/grains_0000.vtp") << "of an earlier life";
  fs::create_symlink("/dev/full", folder / "grains/grains_0000.vtp.part");
  EXPECT_NE(machine_error([&] { writer.write(0, grains, {}, {}); }).find("grains_0000.vtp"), std::string::npos);
  EXPECT_EQ(fs::file_size(folder / "grains/grains_0000.vtp"), 18u);

  std::ofstream(folder / "contacts") << "a file where the folder should be";
  EXPECT_NE(machine_error([&] { writer.write_contacts(0, {}, {}); }).find("contacts"), std::string::npos);
}

}  // namespace
