#include "coupling/sampler.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "base/error.hpp"
#include "coupling/agree.hpp"
#include "coupling/grain_probes.hpp"
#include "coupling/measure.hpp"

namespace coupling {

namespace {

constexpr int sample_tag = 21;
constexpr std::size_t energy_terms = sizeof(base::Energy) / sizeof(double);
static_assert(std::is_trivially_copyable_v<base::Energy> && sizeof(base::Energy) == energy_terms * sizeof(double));

bool is_body_probe(const Probe& probe) {
  return probe.kind == ProbeKind::displacement || probe.kind == ProbeKind::velocity ||
         probe.kind == ProbeKind::acceleration || probe.kind == ProbeKind::load || probe.kind == ProbeKind::reaction ||
         probe.kind == ProbeKind::body_stress || probe.kind == ProbeKind::body_plastic_strain;
}

bool follows_grain(const Probe& probe) {
  return probe.kind == ProbeKind::grain_position || probe.kind == ProbeKind::grain_velocity ||
         probe.kind == ProbeKind::grain_displacement || probe.kind == ProbeKind::grain_angular_velocity;
}

/// In the order of stress_components().
double stress_component(const std::array<double, 6>& stress, int component) {
  if (component < 6) return stress[static_cast<std::size_t>(component)];
  return component == 6 ? fem::von_mises(stress) : fem::principal(stress)[static_cast<std::size_t>(component - 7)];
}

}  // namespace

double combined(const Probe& probe, std::span<const double> taken) {
  if (probe.kind == ProbeKind::angle) return probe.scale * std::atan2(taken[probe.of[0]], taken[probe.of[1]]);
  if (probe.kind == ProbeKind::quotient)
    return taken[probe.of[1]] == 0 ? 0 : probe.scale * taken[probe.of[0]] / taken[probe.of[1]];
  double sum = probe.offset;
  for (std::size_t k = 0; k < probe.of.size(); ++k) sum += probe.factors[k] * taken[probe.of[k]];
  return probe.scale * sum;
}

Sampler::Sampler(const Roles& roles, const Scene& scene, dem::Simulation* grains, fem::Model* bodies,
                 const std::vector<base::Skin>& skins, std::vector<int> walls, std::vector<int> named_walls)
    : roles_(roles),
      scene_(scene),
      grains_(grains),
      bodies_(bodies),
      skins_(skins),
      walls_(std::move(walls)),
      named_walls_(std::move(named_walls)),
      kept_(scene.probes.size(), 0.0),
      copies_(grains) {}

void Sampler::zero() {
  if (!grains_) return;
  for (const Probe& probe : scene_.probes)
    if (probe.kind == ProbeKind::wall_displacement && wall_number(probe.wall) >= 0)
      wall_zero_[probe.wall] = grains_->wall_displacement(wall_number(probe.wall));
  copies_.forget();
  marks_.clear();
  for (const auto& probe : scene_.probes) {
    if (!follows_grain(probe) || copies_.grains().empty()) continue;
    const GrainMark& mark = marks_[probe.name] = mark_grain(probe, copies_.grains());
    if (probe.point)
      spdlog::info("probe {}: grain {} at ({:.4g}, {:.4g}, {:.4g}) m", probe.name, mark.id, mark.start.x, mark.start.y,
                   mark.start.z);
  }
}

Sampler::Sample Sampler::sample(double time, bool thorough) {
  copies_.forget();
  Sample result{kept_, {}};
  std::vector<double> from_bodies(energy_terms, 0.0);
  if (bodies_) {
    const base::Energy energy = bodies_->energy();
    std::copy_n(reinterpret_cast<const double*>(&energy), energy_terms, from_bodies.begin());
    for (const auto& probe : scene_.probes)
      if (is_body_probe(probe)) from_bodies.push_back(body_probe(probe));
  }
  if (roles_.fem_ranks > 0 && roles_.first_fem_rank != 0) {
    if (roles_.is_fem_root())
      MPI_Send(from_bodies.data(), static_cast<int>(from_bodies.size()), MPI_DOUBLE, 0, sample_tag, roles_.world);
    if (roles_.is_root()) {
      from_bodies.resize(energy_terms + static_cast<std::size_t>(
                                            std::count_if(scene_.probes.begin(), scene_.probes.end(), is_body_probe)));
      MPI_Request request;
      MPI_Irecv(from_bodies.data(), static_cast<int>(from_bodies.size()), MPI_DOUBLE, roles_.first_fem_rank, sample_tag,
                roles_.world, &request);
      wait_politely(request);
    }
  }
  if (!roles_.is_root()) return result;
  std::copy_n(from_bodies.begin(), energy_terms, reinterpret_cast<double*>(&result.energy.bodies));
  if (grains_) result.energy.grains = grains_->energy();
  std::size_t next = energy_terms;
  for (std::size_t p = 0; p < scene_.probes.size(); ++p) {
    const auto& probe = scene_.probes[p];
    const bool slow = is_slow(probe.kind);
    if (is_body_probe(probe))
      kept_[p] = from_bodies[next++];
    else if (!probe.of.empty())
      kept_[p] = combined(probe, kept_);
    else if (probe.kind == ProbeKind::time)
      kept_[p] = probe.scale * time;
    else if (probe.kind == ProbeKind::wall_displacement || probe.kind == ProbeKind::wall_velocity)
      kept_[p] = wall_probe(probe, kept_[p]);
    else if (!slow || thorough)
      kept_[p] = grain_probe(probe);
  }
  result.probes = kept_;
  return result;
}

double Sampler::body_probe(const Probe& probe) const {
  if (probe.kind == ProbeKind::load) return probe.scale * bodies_->load_value(probe.load);
  if (probe.kind == ProbeKind::body_stress)
    return probe.scale * stress_component(bodies_->stress_at(probe.body, {probe.point, probe.group}), probe.component);
  if (probe.kind == ProbeKind::body_plastic_strain)
    return probe.scale * bodies_->plastic_strain_at(probe.body, {probe.point, probe.group});
  if (probe.kind == ProbeKind::reaction)
    return probe.scale * bodies_->reaction(probe.body, probe.group)[probe.component];
  const auto quantity = probe.kind == ProbeKind::displacement ? fem::Quantity::displacement
                        : probe.kind == ProbeKind::velocity   ? fem::Quantity::velocity
                                                              : fem::Quantity::acceleration;
  const Vec3 value = probe.point ? bodies_->probe_point(probe.body, *probe.point, quantity)
                                 : bodies_->probe_group(probe.body, probe.group, quantity);
  return probe.scale * value[probe.component];
}

int Sampler::wall_number(const std::string& name) const {
  for (std::size_t w = 0; w < named_walls_.size(); ++w)
    if (scene_.grains->walls[w].name == name) return named_walls_[w];
  return -1;
}

double Sampler::wall_probe(const Probe& probe, double last) const {
  const int wall = wall_number(probe.wall);
  const bool moves = probe.kind == ProbeKind::wall_velocity;
  if (wall < 0) return moves ? 0 : last;
  const auto zero = wall_zero_.find(probe.wall);
  const Vec3 moved = grains_->wall_displacement(wall) - (zero == wall_zero_.end() ? Vec3{} : zero->second);
  return probe.scale * (moves ? grains_->wall_velocity(wall) : moved)[probe.component];
}

double Sampler::contact_force(const Probe& probe) const {
  int wall = -1;
  for (std::size_t s = 0; s < skins_.size(); ++s)
    if (!probe.body.empty() && skins_[s].body == probe.body) wall = walls_[s];
  if (!probe.wall.empty()) wall = wall_number(probe.wall);
  double force = 0;  // [N] of the grains on the surface
  for (const auto& contact : copies_.wall_contacts())
    if (contact.wall == wall && (!probe.box || contains(*probe.box, contact.point)))
      force -= contact.force[probe.component];
  return force;
}

const dem::Grain& Sampler::grain(std::int64_t id) const {
  const auto& list = copies_.grains();
  const auto found = std::lower_bound(list.begin(), list.end(), id,
                                      [](const dem::Grain& g, std::int64_t value) { return g.id < value; });
  base::require_internal(found != list.end() && found->id == id, "probe of a grain that does not exist");
  return *found;
}

double Sampler::grain_probe(const Probe& probe) const {
  if (probe.kind == ProbeKind::contact_force) return probe.scale * contact_force(probe);
  if (probe.kind == ProbeKind::contact_stress) return probe.scale * contact_force(probe) / probe.area;
  if (probe.kind == ProbeKind::kinetic_energy) return probe.scale * grains_->energy().kinetic;
  if (probe.kind == ProbeKind::broken_bonds) return probe.scale * static_cast<double>(grains_->broken_bonds());
  if (measures_grains(probe.kind)) return probe.scale * measure_grains(probe, copies_, *scene_.grains);
  // Before the measuring has started: what is nearest now.
  if (marks_.count(probe.name) == 0) marks_[probe.name] = mark_grain(probe, copies_.grains());
  const GrainMark& mark = marks_[probe.name];
  const dem::Grain& followed = grain(mark.id);
  switch (probe.kind) {
    case ProbeKind::grain_position:
      return probe.scale * followed.position[probe.component];
    case ProbeKind::grain_displacement:
      return probe.scale * nearest_image(followed.position - mark.start, scene_.grains->periods)[probe.component];
    case ProbeKind::grain_velocity:
      return probe.scale * followed.velocity[probe.component];
    default:
      return probe.scale * followed.angular_velocity[probe.component];
  }
}

template <class Self, class Walk>
void Sampler::walk(Self& self, Walk&& walk) {
  const std::size_t probes = self.kept_.size();
  std::vector<Vec3> starts(probes), zeros(probes);
  std::vector<std::int64_t> marked(probes, -1);
  std::vector<int> zeroed(probes, 0);
  for (std::size_t p = 0; p < probes; ++p) {
    const Probe& probe = self.scene_.probes[p];
    if (const auto mark = self.marks_.find(probe.name); mark != self.marks_.end()) {
      marked[p] = mark->second.id;
      starts[p] = mark->second.start;
    }
    if (const auto zero = self.wall_zero_.find(probe.wall); zero != self.wall_zero_.end()) {
      zeroed[p] = 1;
      zeros[p] = zero->second;
    }
  }
  walk.rows("kept", self.kept_);
  walk.rows("grain", marked);
  walk.rows("grain_start", starts);
  walk.rows("wall_zeroed", zeroed);
  walk.rows("wall_zero", zeros);
  if constexpr (std::remove_reference_t<Walk>::loads) {
    base::require_user(self.kept_.size() == probes && marked.size() == probes && zeroed.size() == probes,
                       "its probes are others");
    for (std::size_t p = 0; p < probes; ++p) {
      const Probe& probe = self.scene_.probes[p];
      if (marked[p] >= 0) self.marks_[probe.name] = {marked[p], starts[p]};
      if (zeroed[p]) self.wall_zero_[probe.wall] = zeros[p];
    }
  }
}

base::Columns Sampler::save() const {
  base::Columns columns;
  walk(*this, base::Saver(columns));
  return columns;
}

void Sampler::restore(const base::Columns& columns) { walk(*this, base::Loader(columns)); }

}  // namespace coupling
