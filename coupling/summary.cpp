#include "coupling/summary.hpp"

#include <unistd.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "base/quantity.hpp"
#include "base/version.hpp"

namespace coupling {

namespace {

using Json = nlohmann::ordered_json;

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json energy_json(const Ledger& ledger) {
  const auto& grains = ledger.last().grains;
  const auto& bodies = ledger.last().bodies;
  Json json;
  json["kinetic"] = number(grains.kinetic + bodies.kinetic);
  json["elastic_normal"] = number(grains.elastic_normal);
  json["elastic_shear"] = number(grains.elastic_shear);
  json["elastic_bonds"] = number(grains.elastic_bonds);
  json["strain"] = number(bodies.strain);
  json["work_gravity"] = number(grains.work_gravity + bodies.work_gravity);
  json["work_loads"] = number(bodies.work_loads);
  json["work_walls"] = number(grains.work_walls);
  json["interface_seen_by_grains"] = number(grains.work_interface);
  json["interface_seen_by_bodies"] = number(bodies.work_interface);
  json["loss_friction"] = number(grains.loss_friction);
  json["loss_contact_damping"] = number(grains.loss_contact_damping);
  json["loss_rolling"] = number(grains.loss_rolling);
  json["loss_breakage"] = number(grains.loss_breakage);
  json["loss_damping"] = number(grains.loss_damping + bodies.loss_damping);
  json["loss_viscous"] = number(bodies.loss_viscous);
  json["loss_plastic"] = number(bodies.loss_plastic);
  json["residual"] = number(ledger.residual());
  json["external_work"] = number(ledger.external_work());
  json["relative_error"] = number(ledger.relative_error());
  return json;
}

Json results_json(std::span<const Outcome> outcomes) {
  Json json = Json::object();
  for (const auto& outcome : outcomes) {
    const auto& result = *outcome.result;
    const double factor = base::parse_unit(result.unit).to_si(1);
    Json entry{{"value", number(outcome.value)}, {"unit", result.unit}};
    if (result.expected) entry["expected"] = *result.expected / factor;
    if (result.expected_range)
      entry["expected_range"] = {(*result.expected_range)[0] / factor, (*result.expected_range)[1] / factor};
    if (!result.source.empty()) entry["source"] = result.source;
    if (outcome.relative_error) entry["relative_error"] = number(*outcome.relative_error);
    if (outcome.within) entry["within"] = *outcome.within;
    json[result.name] = entry;
  }
  return json;
}

Json modes_json(std::span<const fem::BodyModes> bodies) {
  Json json = Json::object();
  for (const auto& body : bodies) {
    Json modes = Json::array();
    for (const auto& mode : body.modes) {
      const auto& mass = mode.effective_mass;
      modes.push_back({{"frequency_hz", number(mode.frequency)}, {"effective_mass_kg", {mass.x, mass.y, mass.z}}});
    }
    json[body.body] = {{"rigid_motions", body.rigid_motions}, {"modes", modes}};
  }
  return json;
}

std::string host() {
  char name[256] = "";
  gethostname(name, sizeof name - 1);
  return name;
}

Json steps_json(std::span<const PackingStep> steps) {
  Json list = Json::array();
  for (const PackingStep& step : steps)
    list.push_back({{"what", step.what},
                    {"number", step.number},
                    {"grains_taken", step.taken},
                    {"porosity_before", number(step.porosity_before)},
                    {"porosity_after", number(step.porosity_after)}});
  return list;
}

/// The nodes that each pair of ranks shares at the end, and what has passed between the two.
Json exchange_json(const Summary& run) {
  Json pairs = Json::array();
  for (std::size_t part = 0; part < run.traffic.size(); ++part)
    for (std::size_t rank = 0; rank < run.traffic[part].nodes.size(); ++rank)
      pairs.push_back({{"dem_rank", part},
                       {"fem_rank", rank},
                       {"nodes", run.traffic[part].nodes[rank]},
                       {"bytes", run.traffic[part].bytes[rank]}});
  return {{"skin_nodes", run.skin_nodes}, {"pairs", pairs}};
}

}  // namespace

std::string to_json(const Summary& run, std::span<const Outcome> outcomes) {
  Json json;
  json["scene"] = run.scene;
  json["title"] = run.title;
  json["code_version"] = std::string(base::code_version());
  json["host"] = host();
  json["status"] = run.status;
  if (!run.message.empty()) json["message"] = run.message;
  json["time_simulated_s"] = run.time_simulated;
  json["wall_s"] = run.wall;
  if (!run.restarted_from.empty()) json["restarted_from"] = run.restarted_from;
  json["ranks"] = run.ranks;
  json["dem_ranks"] = run.dem_ranks;
  json["fem_ranks"] = run.fem_ranks;
  json["threads"] = run.threads;
  json["backend"] = run.backend;
  if (!run.device.empty()) json["device"] = run.device;
  json["precision"] = run.precision;
  if (!run.solver.empty()) json["solver"] = run.solver;
  json["grains"] = run.grains;
  json["spheres"] = run.spheres;
  json["elements"] = run.elements;
  json["steps"] = {{"dem", run.dem_steps}, {"fem", run.fem_steps}, {"windows", run.windows}};
  json["dt_s"] = {{"dem", run.dem_dt}, {"fem", run.fem_dt}};
  const std::string both = run.coupling_limiter.empty() || run.window_limiter.empty() ? "" : "; ";
  json["dt_limiter"] = {{"dem", run.dem_limiter},
                        {"fem", run.fem_limiter},
                        {"coupling", run.coupling_limiter + both + run.window_limiter}};
  const auto rate = [&](double amount, const char* side) {
    const auto spent = run.seconds.find(side);
    return spent != run.seconds.end() && spent->second > 0 ? amount / spent->second : 0.0;
  };
  json["throughput"] = {
      {"sphere_steps_per_s", rate(static_cast<double>(run.spheres) * static_cast<double>(run.dem_steps), "dem")},
      {"element_steps_per_s", rate(static_cast<double>(run.elements) * static_cast<double>(run.fem_steps), "fem")}};
  Json share = Json::object();
  for (const auto& [name, seconds] : run.seconds) share[name] = run.wall > 0 ? seconds / run.wall : 0.0;
  json["wall_share"] = share;
  if (run.packed)
    json["packing"] = {{"wall_s", run.packing_wall},
                       {"from_cache", run.packing_from_cache},
                       {"porosity", run.porosity},
                       {"porosity_asked", run.porosity_asked},
                       {"friction", run.packing_friction},
                       {"coordination", run.coordination},
                       {"steps", steps_json(run.packing_steps)}};
  if (run.dem_bytes > 0) json["dem_bytes"] = run.dem_bytes;
  if (run.measured) json["energy"] = energy_json(run.ledger);
  json["momentum_error"] = number(run.momentum_error);
  if (!run.traffic.empty()) json["exchange"] = exchange_json(run);
  if (!run.modes.empty()) json["modes"] = modes_json(run.modes);
  json["results"] = results_json(outcomes);
  return json.dump(2) + "\n";
}

}  // namespace coupling
