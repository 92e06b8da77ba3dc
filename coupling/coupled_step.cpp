#include "coupling/coupled_step.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

namespace coupling {
namespace {

constexpr double tolerated = -0.1;  // damping ratio
constexpr int numbers = 9;
using Matrix = std::array<std::array<double, numbers>, numbers>;

/// One contact with stiffness 1 N/m between a grain and a node on its body's spring.
struct State {
  double x = 0, w = 0, pull = 0;       // grain: place, velocity, force on it
  double u = 0, v = 0, a = 0;          // node
  double skin = 0, skin_velocity = 0;  // where the grains see it
  double waiting = 0;                  // impulse of the window before
};
static_assert(sizeof(State) == numbers * sizeof(double));

class Map {
 public:
  Map(const Window& window, const CouplingSettings& settings, const SkinContacts& contacts)
      : window_(window), settings_(settings), contacts_(contacts) {}

  State operator()(State s) const {
    const double W = window_.length(), leaves = s.v;
    const bool predicted = window_.n_fem == 1 && !contacts_.implicit_body;
    double to = s.u + W * s.v, to_velocity = s.v;
    if (predicted) {
      predict(s);
      to = s.u;
      to_velocity = s.v + 0.5 * W * s.a;
    }
    const double impulse = move_grain(s, to, leaves, to_velocity);
    const double force = (settings_.scheme == Scheme::concurrent ? s.waiting : impulse) / W;
    s.waiting = impulse;
    for (int step = 0; step < window_.n_fem; ++step) {
      if (contacts_.implicit_body) {
        implicit_step(s, force);
        continue;
      }
      if (!predicted) predict(s);
      s.a = contacts_.node * force - contacts_.body * s.u;
      s.v += 0.5 * window_.dt_fem * s.a;
    }
    return s;
  }

 private:
  void predict(State& s) const {
    s.v += 0.5 * window_.dt_fem * s.a;
    s.u += window_.dt_fem * s.v;
  }
  void implicit_step(State& s, double force) const {
    const double dt = window_.dt_fem, reached = s.u + dt * s.v + 0.25 * dt * dt * s.a;
    const double next = (contacts_.node * force - contacts_.body * reached) / (1 + 0.25 * dt * dt * contacts_.body);
    s.u = reached + 0.25 * dt * dt * next;
    s.v += 0.5 * dt * (s.a + next);
    s.a = next;
  }
  /// Returns the impulse on the node.
  double move_grain(State& s, double to, double leaves, double to_velocity) const {
    const double W = window_.length(), dt = window_.dt_dem, way = to - s.skin;
    double from_velocity = s.skin_velocity, bow = 0, impulse = 0;
    if (settings_.skin_motion == SkinMotion::quadratic) {
      from_velocity = leaves;
      bow = W * leaves - way;
      to_velocity = leaves - 2 * bow / W;
    }
    for (int step = 1; step <= window_.n_dem; ++step) {
      const double share = static_cast<double>(step) / window_.n_dem, before = contacts_.grain * s.pull;
      s.w += 0.5 * dt * before;
      s.x += dt * s.w;
      const double skin = s.skin + share * way + share * (1 - share) * bow;
      const double skin_velocity = from_velocity + share * (to_velocity - from_velocity);
      s.pull = skin - s.x + contacts_.dashpot * (skin_velocity - (s.w + 0.5 * dt * before));
      s.w += 0.5 * dt * contacts_.grain * s.pull;
      impulse -= dt * s.pull;
    }
    s.skin = to;
    s.skin_velocity = to_velocity;
    return impulse;
  }

  const Window& window_;
  const CouplingSettings& settings_;
  const SkinContacts& contacts_;
};

/// |A^n|^(1/n) with n = 2^20; the entries' sizes cannot overflow, as they are taken out on the way.
double spectral_radius(Matrix a) {
  constexpr int rounds = 20;
  double logarithm = 0, power = 1;
  for (int round = 0; round <= rounds; ++round, power *= 2) {
    double size = 0;
    for (const auto& row : a)
      for (const double x : row) size = std::fmax(size, std::abs(x));
    if (!(size > 0)) return 0;
    logarithm += std::log(size) / power;
    Matrix next{};
    for (int i = 0; i < numbers; ++i)
      for (int k = 0; k < numbers; ++k)
        for (int j = 0; j < numbers; ++j) next[i][j] += a[i][k] / size * (a[k][j] / size);
    a = next;
  }
  return std::exp(logarithm);
}

/// The window with another length.
Window scaled(Window window, double factor) {
  window.dt_dem *= factor;
  window.dt_fem *= factor;
  return window;
}

}  // namespace

bool is_one_step_of_the_whole(const Window& window, const CouplingSettings& settings, const SkinContacts& contacts) {
  return window.n_dem == 1 && window.n_fem == 1 && settings.scheme == Scheme::sequential && !contacts.implicit_body;
}

double growth(const Window& window, const CouplingSettings& settings, const SkinContacts& contacts) {
  // Lengths in units of one window's way make all entries of about one size.
  const double W = window.length();
  Window unit = scaled(window, 1 / W);
  SkinContacts of_unit = contacts;
  of_unit.grain *= W * W;
  of_unit.node *= W * W;
  of_unit.body *= W * W;
  of_unit.dashpot /= W;
  const Map map(unit, settings, of_unit);
  // Places and velocities of grain and skin from the node on: where its body does not hold it, all may move on
  // together, which is neither growth nor damping.
  constexpr int place = 3, velocity = 4;
  const auto left_out = [&](int k) { return contacts.body == 0 && (k == place || k == velocity); };
  Matrix matrix{};
  for (int j = 0; j < numbers; ++j) {
    if (left_out(j)) continue;
    std::array<double, numbers> in{};
    in[static_cast<std::size_t>(j)] = 1;
    const double u = in[place], v = in[velocity];
    const State out = map({in[0] + u, in[1] + v, in[2], u, v, in[5], in[6] + u, in[7] + v, in[8]});
    const double column[numbers] = {out.x - out.u, out.w - out.v, out.pull,         out.u,
                                    out.v,         out.a,         out.skin - out.u, out.skin_velocity - out.v,
                                    out.waiting};
    for (int i = 0; i < numbers; ++i)
      if (!left_out(i)) matrix[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] = column[i];
  }
  return spectral_radius(matrix);
}

double damping_ratio(const Window& window, const CouplingSettings& settings, const SkinContacts& contacts) {
  const double omega = std::sqrt(contacts.grain + contacts.node);
  return omega > 0 ? -std::log(growth(window, settings, contacts)) / (omega * window.length()) : 0;
}

double longest_window(const Window& window, const CouplingSettings& settings, const SkinContacts& contacts) {
  if (!(contacts.node > 0)) return std::numeric_limits<double>::infinity();
  if (is_one_step_of_the_whole(window, settings, contacts)) {
    const double sum = contacts.grain + contacts.node + contacts.body;
    const double omega = std::sqrt(0.5 * (sum + std::sqrt(sum * sum - 4 * contacts.grain * contacts.body)));
    const double xi = contacts.dashpot * contacts.node / (2 * omega);
    return 2 / omega * (std::sqrt(1 + xi * xi) - xi);
  }
  const double alone = 2 / std::sqrt(contacts.node);
  double longest = alone;
  for (const double share : {0.0, 0.003, 0.03, 0.1, 0.3, 1.0}) {
    SkinContacts mode = contacts;
    mode.body *= share;
    mode.grain = 0;
    const auto holds = [&](double length) {
      const Window tried = scaled(window, length / window.length());
      // Bodies without contacts have a limit of their own, which is not looked for here.
      if (!mode.implicit_body && tried.dt_fem * std::sqrt(mode.body) >= 2) return false;
      return damping_ratio(tried, settings, mode) >= tolerated;
    };
    // From short windows up: between two lengths that hold there may be one that a grain's own period upsets.
    const double last = longest;
    double low = 0.02 * alone, high = low;
    while (high < last && holds(high)) low = std::exchange(high, std::min(last, 1.15 * high));
    if (holds(high)) {
      longest = high;
      continue;
    }
    for (int round = 0; round < 12; ++round) {
      const double middle = 0.5 * (low + high);
      (holds(middle) ? low : high) = middle;
    }
    longest = low;
  }
  return longest;
}

}  // namespace coupling
