#include "coupling/modal_run.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>

#include "coupling/agree.hpp"
#include "coupling/sampler.hpp"

namespace coupling {

namespace {

double frequency(const Probe& probe, std::span<const fem::BodyModes> bodies) {
  const auto body = std::ranges::find(bodies, probe.body, &fem::BodyModes::body);
  const auto mode = static_cast<std::size_t>(probe.mode);
  return mode <= body->modes.size() ? body->modes[mode - 1].frequency : std::nan("");
}

}  // namespace

std::string modes_table(std::span<const fem::BodyModes> bodies, std::span<const fem::BodyCounts> counts) {
  std::string text;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const auto& body = bodies[b];
    text += fmt::format("body {}: {} elastic modes, {} rigid motions; mass moving along x, y, z in per cent\n",
                        body.body, body.modes.size(), body.rigid_motions);
    for (std::size_t k = 0; k < body.modes.size(); ++k) {
      const auto& mode = body.modes[k];
      const base::Vec3 share = mode.effective_mass * (100 / counts[b].mass);
      text += fmt::format("{:>5} {:>12.5g} Hz {:>8.2f} {:>8.2f} {:>8.2f}\n", k + 1, mode.frequency, share.x, share.y,
                          share.z);
    }
  }
  return text;
}

void run_modal(Setup& setup, const std::filesystem::path& directory, Summary& summary, Series& series) {
  const auto start = std::chrono::steady_clock::now();
  const auto& roles = *setup.roles;
  agree(roles.world, [&] {
    summary.modes = setup.bodies->find_modes(setup.scene.modes);
    setup.bodies->write_modes(directory.string());
  });
  summary.scene = setup.scene.file.string();
  summary.title = setup.scene.title;
  summary.solver = solver_name(setup.scene.solver.kind);
  summary.ranks = roles.all_ranks;
  summary.fem_ranks = roles.fem_ranks;
  summary.backend = "none";
  for (const auto& body : setup.body_counts) summary.elements += body.elements;
  summary.seconds["fem"] = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  series.time = {0};
  std::vector<double> taken;
  for (const auto& probe : setup.scene.probes) {
    taken.push_back(probe.of.empty() ? probe.scale * frequency(probe, summary.modes) : combined(probe, taken));
    series.columns.push_back({taken.back()});
  }
  spdlog::info("\n{}", modes_table(summary.modes, setup.body_counts));
}

}  // namespace coupling
