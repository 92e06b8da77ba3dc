// What the live contacts allow: the step of the grains, and the window where they press on a body's skin.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "coupling/run_loop.hpp"

namespace coupling {

/// The Rayleigh limit knows the grains, not how hard they are pressed, nor how light the nodes are that they press on:
/// where the live contacts ask for less, step and window are shortened for the rest of the stage.
void RunLoop::obey_contacts() {
  if (!setup_.scene.has_grains()) return;
  samples_since_bound_ = 0;
  constexpr double safety = 0.9;       // the bounds are taken now and have to hold until the next sample
  std::array<double, 2> bounds{0, 0};  // [s] step, window; 0: none
  if (setup_.grains) {
    const auto limit = setup_.grains->contact_stable_step();
    bounds[0] = limit.limit;
    if (bounds[0] > 0 && std::isfinite(bounds[0]) &&
        (smallest_contact_step_ == 0 || bounds[0] < smallest_contact_step_)) {
      smallest_contact_step_ = bounds[0];
      summary_.coupling_limiter = fmt::format("{:.4g} s: {}", bounds[0], limit.limiter);
    }
    if (setup_.exchange) bounds[1] = judge_window(limit.limit);
  }
  if (setup_.roles->size > 1) MPI_Bcast(bounds.data(), 2, MPI_DOUBLE, setup_.roles->dem_rank, setup_.roles->world);
  if (setup_.scene.time.force_step) return;
  // What is shortened goes down by a tenth more than needed, so that a slowly rising load does not shorten it at every
  // sample; what is not shortened stays.
  const auto keeps = [&](double now, double bound) { return !(bound > 0) || now <= safety * bound; };
  const double step = setup_.window.dt_dem, window = setup_.window.length();
  if (keeps(step, bounds[0]) && keeps(window, bounds[1])) return;
  setup_.choose_window(keeps(step, bounds[0]) ? step : 0.9 * safety * bounds[0],
                       keeps(window, bounds[1]) ? window : 0.9 * safety * bounds[1]);
  if (!keeps(step, bounds[0]))
    spdlog::info("t = {:.4g} s: DEM step shortened to {:.3g} s by the live contacts", time_, setup_.window.dt_dem);
  if (!keeps(window, bounds[1]))
    spdlog::info(
        "t = {:.4g} s: window shortened to {:.3g} s by the live contacts, which allow {:.4g} s; least so far: {}",
        time_, setup_.window.length(), bounds[1], summary_.window_limiter);
}

/// The longest window [s] for the contacts on the skins, 0: none. It is found anew where they are pressed harder or
/// less than when it was found last, or the window has other steps; the shortest of all is reported. grain_limit: step
/// [s] that the grains' contacts allow.
double RunLoop::judge_window(double grain_limit) {
  SkinContacts now;
  base::Vec3 place;
  std::string body;
  double shortest = std::numeric_limits<double>::infinity();  // of a node by itself
  for (std::size_t s = 0; s < setup_.skins.size(); ++s) {
    const auto springs = setup_.grains->node_springs(setup_.skin_walls[s]);
    const auto& mobility = setup_.exchange->mobility(s);
    for (std::size_t k = 0; k < springs.size(); ++k) {
      const double rate = springs[k].stiffness * mobility[k], omega = std::sqrt(rate);
      if (!(rate > 0)) continue;
      const double xi = springs[k].damping * mobility[k] / (2 * omega);
      const double limit = 2 / omega * (std::sqrt(1 + xi * xi) - xi);
      if (limit >= shortest) continue;
      shortest = limit;
      now.node = rate;
      now.dashpot = springs[k].damping / springs[k].stiffness;
      place = setup_.skins[s].nodes[k];
      body = setup_.skins[s].body;
    }
  }
  const Window& window = setup_.window;
  if (now.node > 0) {
    now.grain = 4 / (grain_limit * grain_limit);
    now.implicit_body = !setup_.scene.is_explicit();
    const double bodies = setup_.fem_limit.limit;
    now.body = std::isfinite(bodies) && bodies > 0 ? 4 / (bodies * bodies) : 0;
    constexpr double harder = 1.05, easier = 0.7;
    const double ratio = (now.grain + now.node) / (judged_.contacts.grain + judged_.contacts.node);
    const bool same = judged_.n_dem == window.n_dem && judged_.n_fem == window.n_fem;
    if (!same || !(ratio <= harder && ratio >= easier && shortest >= judged_.shortest / harder)) {
      const auto& settings = setup_.scene.coupling;
      const bool whole = is_one_step_of_the_whole(window, settings, now);
      SkinContacts against_wall = now;
      against_wall.grain = 0;
      judged_ = {.contacts = now,
                 .n_dem = window.n_dem,
                 .n_fem = window.n_fem,
                 .longest = longest_window(window, settings, now),
                 .damping_ratio = whole ? 0 : damping_ratio(window, settings, against_wall),
                 .shortest = shortest};
      if (smallest_window_ > 0 && judged_.longest >= smallest_window_) return judged_.longest;
      smallest_window_ = judged_.longest;
      summary_.window_limiter =
          fmt::format("{:.4g} s, a window of {} : {}: contacts at the node of {} at ({:.4g}, {:.4g}, {:.4g}) m",
                      judged_.longest, window.n_dem, window.n_fem, body, place.x, place.y, place.z);
      if (!whole)
        summary_.window_limiter += fmt::format("; damping ratio of the contacts {:.2g} with a window of {:.3g} s",
                                               judged_.damping_ratio, window.length());
      constexpr double to_speak_of = -0.01, worse = 1.5;
      if (judged_.damping_ratio < std::min(to_speak_of, worse * warned_)) {
        warned_ = judged_.damping_ratio;
        spdlog::warn("t = {:.4g} s: contacts gain energy from the coupling: {}; a shorter window does less of it",
                     time_, summary_.window_limiter);
      }
    }
  }
  return judged_.longest;
}

/// What would make an unstable run stable, for its message.
std::string RunLoop::remedy() const {
  if (!(judged_.longest > 0) || setup_.window.length() <= judged_.longest) return "";
  const Window& window = setup_.window;
  const std::string first = setup_.scene.time.force_step                       ? "remove time.force_step"
                            : window.n_dem > 1 && window.n_dem >= window.n_fem ? "set coupling.n_dem lower"
                                                                               : "set time.dem_step lower";
  return fmt::format(
      "; its window of {:.4g} s is above the coupled limit of {}; {}, or make the skin's facets larger "
      "(heavier nodes)",
      window.length(), summary_.window_limiter, first);
}

}  // namespace coupling
