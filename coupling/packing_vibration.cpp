// Vibration of a layer once it is calm: the whole container (walls, floor, bodies) moves as
//   x(t) = amplitude sin(2 pi frequency t) direction.
// In the container's frame its parts stand still and every grain feels gravity - x''(t), which is how it is computed:
// gravity is changed, walls are not moved. The two are the same for anything that all parts of a container do alike
// without turning. Between changes (32 in a period) the acceleration is its mean, so that impulses are exact. At the
// start the container's velocity does not jump: a steady drift, which grains do not feel, takes up the difference.
// The artificial damping of grains acts on their velocity relative to the container.
// Measured (the bed of packing_growth.cpp, poured; 1 mm at 30 Hz for 0.5 s, 3.6 times gravity): 0.384 becomes 0.374 at
// a packing friction of 0.1, 0.423 becomes 0.398 at 0.6. Limits: waves in the walls and a container that tilts are left
// out; a plate is not there while the layer is shaken.
#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include <cmath>
#include <numbers>

#include "base/error.hpp"
#include "coupling/packer.hpp"

namespace coupling {

void Packer::vibrate(std::size_t number) {
  constexpr int pieces = 32;     // of a period
  constexpr double fewest = 16;  // steps in a period
  const PackingLayer& layer = packing_.layers[number];
  const Vibration& shake = *layer.vibration;
  const double dt = asked_step();
  base::require_user(shake.frequency * fewest * dt <= 1,
                     fmt::format("{}: packing.layer.vibration.frequency = {:g} Hz; must be at most {:.4g} Hz, where a "
                                 "period is {:g} steps of {:.3g} s; lower it, or time.dem_fraction",
                                 shake.origin, shake.frequency, 1 / (fewest * dt), fewest, dt));
  const double omega = 2 * std::numbers::pi * shake.frequency;
  const double strength = shake.amplitude * omega * omega / norm(scene_.gravity);
  PackingStep done{"vibration", static_cast<int>(number + 1), 0, porosity_of(number), 0};
  const int count = std::max(1, static_cast<int>(std::ceil(shake.time * shake.frequency * pieces)));
  const double piece = shake.time / count;
  const auto velocity = [&](int i) { return -shake.amplitude * omega * std::cos(omega * i * piece); };
  try {
    for (int i = 0; i < count; ++i) {
      const double mean = (velocity(i + 1) - velocity(i)) / piece;
      simulation_->set_gravity(scene_.gravity + mean * shake.direction);
      advance(piece);
      show(0);
    }
  } catch (const base::UnstableError& error) {
    throw base::UserError(
        fmt::format("{}: packing.layer.vibration: {:.3g} times gravity is too much for the bed: {}; lower the "
                    "amplitude = {:g} m or the frequency",
                    shake.origin, strength, error.what(), shake.amplitude));
  }
  simulation_->set_gravity(scene_.gravity);
  settle(0, layer.settle);
  done.porosity_after = porosity_of(number);
  steps_.push_back(done);
  spdlog::info("layer {}: shaken for {:g} s at {:.3g} times gravity, porosity {:.3f} before, {:.3f} after", number + 1,
               shake.time, strength, done.porosity_before, done.porosity_after);
}

}  // namespace coupling
