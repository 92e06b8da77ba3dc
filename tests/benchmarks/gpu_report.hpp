#pragma once
// What benchmark_dem_gpu counts, compares and prints, apart from the measuring: bytes that the kernels of a step must
// move (derived in docs/performance.md), floors, targets and the rows of docs/gpu.md.
//
// A row comes from memory once per kernel, and goes there once if it changes; one that is written in part is read too.
// What neighbours read again is taken to come from the cache. Grains near walls: as many as their candidates (most have
// one).
#include <array>
#include <cstdio>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace benchmarks {

/// [B] of the rows that the backend keeps (dem/core/rows.hpp, wall_pass.hpp, contact_pass.hpp).
struct RowBytes {
  double place = 32, quad = 32, vector = 24, quaternion = 32, index = 4;
  double pair_force = 8, history = 4;  // numbers of a pair: double, or float in mixed precision
  double wall_sum = 64, wall_state = 88, wall_found = 64, wall_history = 32, facet = 24, nodal = 96;
  double sector = 32;  // the least that a GPU reads or writes
};

/// Of what a step has how many; hertz_mindlin with its history, without energy ledger, bonds and rolling.
struct StepContents {
  double grains = 0, spheres = 0, pairs = 0, contacts = 0, wall_candidates = 0, wall_contacts = 0;
  bool clumps = false, mixed = false;
};

/// [B] by kernel.
struct StepBytes {
  double motion = 0, contacts = 0, walls = 0;
  double total() const { return motion + contacts + walls; }
};

inline StepBytes step_bytes(const StepContents& n) {
  const RowBytes row;
  const double real = n.mixed ? 4 : 8, quads = 2 * row.quad;
  const double result = row.pair_force * real, history = row.history * real;
  StepBytes bytes;
  // Motion: places, velocities, velocities that contacts see; places listed; starts of two lists and place near walls.
  const double seen = 2 * row.place + 2 * quads + row.vector + 3 * row.index;
  bytes.motion = n.clumps ? n.grains * (2 * row.place + 2 * quads + 2 * row.quaternion + row.vector + row.index) +
                                n.spheres * (seen + row.vector)
                          : n.spheres * (seen + 2 * quads);
  bytes.motion += n.pairs * (result + row.index) + n.wall_candidates * row.wall_sum;
  // Contacts: those that touch have history there and back and a result; of the others a sector of the result is read.
  bytes.contacts = n.spheres * (row.place + quads) + n.pairs * 2 * row.index + (n.pairs - n.contacts) * row.sector +
                   n.contacts * (2 * history + result);
  // Walls: a grain's rows and its sum; a candidate's facet, what is found, and where it touches state, history,
  // impulse.
  bytes.walls = n.wall_candidates * (2 * row.index + row.place + quads + row.wall_sum + row.index + row.facet) +
                (n.wall_candidates - n.wall_contacts) * 2 * row.sector +
                n.wall_contacts * (row.wall_found + 2 * row.wall_state + 2 * row.wall_history + 2 * row.vector);
  return bytes;
}

// ---- kernels
struct KernelTime {
  std::string name;    // as the compiler calls it
  double seconds = 0;  // of all launches
};

enum Kernel { motion, contacts, walls, others, kernels };
constexpr std::array<std::string_view, kernels> kernel_texts{"motion (`MoveAll`)", "contacts (`ContactPass`)",
                                                             "walls (`WallPass`, beside contacts)", "all others"};

inline Kernel kernel_of(std::string_view name) {
  const auto has = [&](std::string_view part) { return name.find(part) != std::string_view::npos; };
  return has("MoveAll") ? motion : has("ContactPass") ? contacts : has("WallPass") ? walls : others;
}

template <class... T>
std::string text(const char* format, T... values) {
  char line[400];
  std::snprintf(line, sizeof line, format, values...);
  return line;
}

inline const char* kernel_head() {
  return "| bed | kernel | B per sphere and step | floor, ms | measured, ms | share of the floor |\n"
         "|---|---|---|---|---|---|\n";
}

/// A row for every kernel of a step: what it must move, how long that takes at this bandwidth [B/s], how long it takes.
/// `times`: of so many steps; empty: not measured.
inline std::string kernel_rows(const std::string& bed, const StepBytes& bytes, double spheres, double bandwidth,
                               const std::vector<KernelTime>& times, double steps) {
  std::array<double, kernels> seconds{};
  for (const KernelTime& one : times) seconds[kernel_of(one.name)] += one.seconds / steps;
  const std::array<double, kernels> moved{bytes.motion, bytes.contacts, bytes.walls, 0};
  std::string rows;
  for (int k = 0; k < kernels; ++k) {
    const double floor = moved[static_cast<std::size_t>(k)] / bandwidth, took = seconds[static_cast<std::size_t>(k)];
    if (times.empty() && k == others) continue;
    rows += text("| %s | %.*s | ", bed.c_str(), static_cast<int>(kernel_texts[static_cast<std::size_t>(k)].size()),
                 kernel_texts[static_cast<std::size_t>(k)].data());
    rows +=
        k == others ? "– | – | " : text("%.0f | %.4g | ", moved[static_cast<std::size_t>(k)] / spheres, 1e3 * floor);
    rows += times.empty()              ? std::string("not measured | – |\n")
            : k == others || took <= 0 ? text("%.4g | – |\n", 1e3 * took)
                                       : text("%.4g | %.0f %% |\n", 1e3 * took, 100 * floor / took);
  }
  return rows;
}

// ---- targets
struct Target {
  std::string bed, what, unit;
  double limit;
  bool at_least;  // otherwise: at most
};

/// The beds of docs/gpu.md by the names that their rows have, and what they are to reach on an H100.
inline const std::vector<Target>& targets() {
  static const std::vector<Target> all{{"1000000 spheres, double", "rate", "G sphere-steps/s", 1, true},
                                       {"1000000 spheres, mixed", "rate", "G sphere-steps/s", 2, true},
                                       {"1000000 spheres, double", "memory", "GB per million spheres", 0.7, false},
                                       {"1000000 spheres, mixed", "memory", "GB per million spheres", 0.7, false},
                                       {"1000000 three-sphere clumps, mixed", "grains", "G clump-steps/s", 0.4, true},
                                       {"31000 ten-sphere clumps, double", "step", "ms/step", 0.25, false},
                                       {"10000 spheres, double", "step", "ms/step", 0.05, false}};
  return all;
}

struct Measured {
  std::string bed;
  double step = 0, grains = 0, spheres = 0;  // [s], numbers
  std::optional<double> memory;              // [B] that the device has less than before; none: a processor
};

inline std::optional<double> value_of(const Target& target, const std::vector<Measured>& all) {
  for (const Measured& one : all) {
    if (one.bed != target.bed) continue;
    if (target.what == "step") return 1e3 * one.step;
    if (target.what == "rate") return 1e-9 * one.spheres / one.step;
    if (target.what == "grains") return 1e-9 * one.grains / one.step;
    if (one.memory) return 1e-3 * *one.memory / one.spheres;
  }
  return {};
}

/// True: held. A figure that is no number holds nothing.
inline bool holds(const Target& target, double value) {
  return target.at_least ? value >= target.limit : value <= target.limit;
}

inline std::string verdict_head() { return "| bed | target | measured | verdict |\n|---|---|---|---|\n"; }

inline std::string verdict_row(const Target& target, std::optional<double> value) {
  return "| " + target.bed + " | " + (target.at_least ? "≥ " : "≤ ") + text("%.3g ", target.limit) + target.unit +
         " | " + (value ? text("%.3g", *value) : "–") + " | " +
         (!value                  ? "not measured"
          : holds(target, *value) ? "held"
                                  : "**not held**") +
         " |\n";
}

inline std::string verdicts(const std::vector<Measured>& all) {
  std::string rows = verdict_head();
  for (const Target& target : targets()) rows += verdict_row(target, value_of(target, all));
  return rows;
}

}  // namespace benchmarks
