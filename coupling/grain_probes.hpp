#pragma once
// Probes of grains in a region: porosity, contacts, contact forces, stress, heaps, sieves. Their parameters, how they
// are read from a scene, and what they measure. A further one: its kind as for every probe (CONTRIBUTING.md), here
// its parameters and its line in measure_grains().
#include <vector>

#include "base/parameter.hpp"
#include "coupling/scene.hpp"
#include "coupling/scene_tables.hpp"

namespace coupling {

/// Parameters of such a probe beside name, kind and scale; `box`: the table of a box.
std::vector<base::Parameter> grain_probe_parameters(ProbeRow::Where, const base::Table& box);

/// Throws base::UserError when the region is missing, or given twice.
GrainProbe read_grain_probe(const base::Value& row, ProbeRow::Where);

/// Host copies of what a simulation holds, made once and only when asked for.
class GrainCopies {
 public:
  explicit GrainCopies(const dem::Simulation* simulation) : simulation_(simulation) {}
  void forget() { *this = GrainCopies(simulation_); }  // the grains have moved on
  const std::vector<dem::Grain>& grains();             // sorted by id
  const std::vector<dem::GrainSphere>& spheres();
  const std::vector<dem::GrainContact>& contacts();
  const std::vector<dem::WallContact>& wall_contacts();

 private:
  const dem::Simulation* simulation_;
  std::optional<std::vector<dem::Grain>> grains_;
  std::optional<std::vector<dem::GrainSphere>> spheres_;
  std::optional<std::vector<dem::GrainContact>> contacts_;
  std::optional<std::vector<dem::WallContact>> wall_contacts_;
};

/// True for kinds that measure_grains() knows.
bool measures_grains(ProbeKind);
/// True for kinds that cost more than some steps: taken with every picture, not with every row of history.csv.
bool is_slow(ProbeKind);
/// Value of the probe [SI], without its scale.
double measure_grains(const Probe&, GrainCopies&, const GrainsScene&);

/// The grain that a probe follows, and where that stood when it was chosen.
struct GrainMark {
  std::int64_t id = 0;
  Vec3 start;  // [m]
};
/// Of a probe of one grain: by its number, or the one whose centre is nearest to the probe's point. `grains`: sorted by
/// id, one or more.
GrainMark mark_grain(const Probe&, std::span<const dem::Grain> grains);

}  // namespace coupling
