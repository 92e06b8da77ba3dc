// Coupled runs with the grains on the pretended device, against the processor: stones of ten spheres and a ball fall
// onto a slab. In one process, with the bodies in another, with the grains in two, interrupted and gone on.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "coupling/run_directory.hpp"
#include "tests/regression/run_helper.hpp"

namespace {

using namespace regression;

const char* const slab = R"(title = "stones on a slab"

[time]
dem_step = "4 us"
fem_step = "4 us"

[grains]
material = { name = "stone", young_modulus = "0.5 GPa", poisson_ratio = 0.2, density = "2700 kg/m3" }
friction = 0.5
restitution = 0.6

[[grains.shape]]
name = "stone1"
file = "SOURCE/meshes/ballast/stone1.clump10.csv"

[[grain]]
position = [0.10, 0.01, 0.045]
shape = "stone1"
size = "50 mm"
velocity = [0.3, 0.1, -1.0]
angular_velocity = [3.0, 20.0, 5.0]
repeat = [4.0, 1.0, 1.0]
spacing = [0.12, 0.0, 0.0]

[[grain]]
position = [0.40, -0.05, 0.042]
radius = "26 mm"
velocity = [-0.5, 0.2, -1.0]

[[body]]
name = "slab"
mesh = "SOURCE/meshes/box.geo"
mesh_parameters = { length = 0.6, width = 0.3, height = 0.03, cells_x = 8, cells_y = 4, cells_z = 1 }
element = "hex8"
gravity = false
skin = ["z_max"]

[[body.material]]
young_modulus = "1 GPa"
poisson_ratio = 0.2
density = "2000 kg/m3"

[[body.support]]
group = "x_min"
fix = ["x", "y", "z"]

[[body.support]]
group = "x_max"
fix = ["x", "y", "z"]

[[stage]]
name = "fall"
duration = "8 ms"
measure = true

[[probe]]
name = "on_slab"
kind = "contact_force"
body = "slab"
component = "z"
scale = -1.0

[[probe]]
name = "kinetic_energy"
kind = "kinetic_energy"

[[probe]]
name = "ball"
kind = "grain_velocity"
grain = 4
component = "x"

[output]
interval = "2 ms"
probe_interval = "0.1 ms"
checkpoint_interval = "2 ms"
)";

fs::path run(const std::string& name, const std::string& more, int ranks = 0, const std::string& backend = "cuda") {
  const fs::path file = write_scene("slab", slab);
  const Finished done = trackbed("run '" + file.string() + "' --threads 1 --backend " + backend + " --out '" +
                                     (scratch() / name).string() + "' --overwrite " + more,
                                 ranks);
  EXPECT_EQ(done.status, 0) << done.output;
  EXPECT_EQ(summary(scratch() / name)["status"], "completed") << done.output;
  return scratch() / name;
}

std::vector<double> rows_of(const fs::path& run, const std::string& probe) {
  for (const coupling::HistoryColumn& column : coupling::read_history(run / "history.csv").columns)
    if (column.name == probe) return column.values;
  ADD_FAILURE() << "no column of " << probe;
  return {0};
}

constexpr const char* probes[] = {"on_slab", "kinetic_energy", "ball"};

/// To 1e-9 of the largest value.
void expect_alike(const fs::path& one, const fs::path& other) {
  for (const char* probe : probes) {
    const auto a = rows_of(one, probe), b = rows_of(other, probe);
    ASSERT_GT(a.size(), 50u);
    ASSERT_EQ(a.size(), b.size());
    double largest = 0;
    for (const double value : a) largest = std::max(largest, std::abs(value));
    EXPECT_GT(largest, 0);
    for (std::size_t k = 0; k < a.size(); ++k) EXPECT_NEAR(a[k], b[k], 1e-9 * largest) << probe << ", row " << k;
  }
}

TEST(CoupledOnPtx, AsOnTheProcessor) {
  const fs::path processor = run("processor", "", 0, "omp"), device = run("device", "");
  expect_alike(processor, device);
  EXPECT_EQ(summary(device)["backend"], "cuda");
  EXPECT_LT(summary(device)["momentum_error"].get<double>(), 1e-12);
}

TEST(CoupledOnPtx, BodiesAndGrainsOnRanks) {
  const fs::path alone = run("alone", "");
  expect_alike(alone, run("two", "", 2));
  expect_alike(alone, run("three", "--dem-ranks 2", 3));
}

TEST(CoupledOnPtx, GoesOnToTheLastBit) {
  const fs::path whole = run("whole", "");
  const fs::path half = run("half", "--until 0.004");
  const fs::path rest = run("rest", "--restart '" + half.string() + "'");
  for (const char* probe : probes) EXPECT_EQ(rows_of(whole, probe).back(), rows_of(rest, probe).back()) << probe;
}

}  // namespace
