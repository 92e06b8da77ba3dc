#pragma once
// What the tests of fem share: PETSc for the whole test program, histories, and a box of concrete.
#include <gtest/gtest.h>
#include <mpi.h>

#include <cmath>
#include <functional>
#include <memory>
#include <string>

#include "fem/fem.hpp"

namespace fem_test {

/// PETSc from the first test to the last one of the program.
class PetscEnvironment : public testing::Environment {
 public:
  void SetUp() override { library_ = std::make_unique<fem::Library>(MPI_COMM_WORLD); }
  void TearDown() override { library_.reset(); }

 private:
  std::unique_ptr<fem::Library> library_;
};

class Given : public base::History {
 public:
  explicit Given(std::function<double(double)> value) : value_(std::move(value)) {}
  double value(double time) const override { return value_(time); }

 private:
  std::function<double(double)> value_;
};

inline base::HistoryPtr history(std::function<double(double)> value) {
  return std::make_shared<Given>(std::move(value));
}

struct BoxSize {
  double length = 1, width = 1, height = 1;  // [m]
  int cells_x = 1, cells_y = 1, cells_z = 1;
};

/// A box of concrete, free everywhere, without weight.
inline fem::Body box(const std::string& element, const BoxSize& size) {
  fem::Body body;
  body.name = "box";
  body.mesh_file = TRACKBED_SOURCE_FOLDER "/meshes/box.geo";
  body.mesh_parameters = {{"length", size.length},           {"width", size.width},
                          {"height", size.height},           {"cells_x", double(size.cells_x)},
                          {"cells_y", double(size.cells_y)}, {"cells_z", double(size.cells_z)}};
  body.element = element;
  body.gravity = false;
  body.materials = {{"", "linear_elastic", 45e9, 0.167, 2350, "scene.toml:7"}};
  body.origin = "scene.toml:3";
  return body;
}

inline double compression_wave_speed() {  // [m/s] sqrt((lambda + 2 mu) / rho) of that concrete
  const double e = 45e9, nu = 0.167, rho = 2350;
  return std::sqrt(e * (1 - nu) / ((1 + nu) * (1 - 2 * nu)) / rho);
}

inline void step(fem::Model& model, double dt) {
  model.predict(dt);
  model.inner_forces();
  model.correct(dt);
}

}  // namespace fem_test
