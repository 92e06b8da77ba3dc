#pragma once
// Where along x the spheres of this part are and may come, for those who tell it of the walls near them only.
// Between two makings of the lists no sphere moves farther than the skin, so what is noted and looked at then holds
// until the next.
#include "dem/core/system.hpp"

namespace dem::TRACKBED_DEM_SYSTEM {

struct SpeedOf {
  Rows<const Quad> motion;
  TRACKBED_HD double operator()(int g) const { return norm2(motion.translation(g).vector); }
};

/// `own`: around the centres of the spheres here. Throws on all parts where those of any have come beyond its limits.
inline void System::note_reach(const Box& own) {
  const int n = grains_.size();
  const double far = radii_.largest + skin_;
  reach_ = {.low = own.low.x - far, .high = own.high.x + far, .grain = radii_.largest};
  if (bodies_.any())
    reach_.grain = reduce(bodies_.size(), RadiiOf{pointer(bodies_.place)}, Radii{}, JoinRadii{}).largest;
  reach_.speed = std::sqrt(reduce(n, SpeedOf{std::as_const(grains_).motions()}, 0.0, thrust::maximum<double>()));
  const bool beyond = n > 0 && (reach_.low < limits_[0] || reach_.high > limits_[1]);
  double all[2] = {beyond ? 1.0 : 0.0, reach_.grain};
  if (in_company()) setup_.company->largest(all);
  reach_.grain = all[1];
  if (!(all[0] > 0)) return;
  if (!beyond) throw base::UnstableError("stopped with another part of the grains");
  char message[300];
  std::snprintf(
      message, sizeof message,
      "grains reach from x = %.4g m to %.4g m, beyond the walls known here for this window (%.4g m ... %.4g m), "
      "at up to %.3g m/s: they or the body under them move too far within one window; take shorter windows",
      reach_.low, reach_.high, limits_[0], limits_[1], reach_.speed);
  throw base::UnstableError(message);
}

inline Reach System::reach() const {
  Reach all = reach_;
  const double far = reach_.grain + skin_;
  const auto include = [&](double x) {
    all.low = std::fmin(all.low, x - far);
    all.high = std::fmax(all.high, x + far);
  };
  if (periods_.length.x > 0)
    for (const double face : {0.0, periods_.length.x}) include(periods_.lower.x + face);
  if (!in_company()) return all;
  const int part = setup_.company->part(), last = setup_.company->parts() - 1;
  for (const auto* cuts : {&ghosts_.cuts, &ghosts_.next_cuts}) {
    if (cuts->empty()) continue;
    if (part > 0) include((*cuts)[static_cast<std::size_t>(part - 1)]);
    if (part < last) include((*cuts)[static_cast<std::size_t>(part)]);
    if (ring_.any() && part == 0) include(ring_.lower.x);
    if (ring_.any() && part == last) include(ring_.lower.x + ring_.length.x);
  }
  return all;
}

}  // namespace dem::TRACKBED_DEM_SYSTEM
