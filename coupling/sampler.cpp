#include "coupling/sampler.hpp"

#include <algorithm>
#include <type_traits>

#include "base/error.hpp"
#include "coupling/agree.hpp"
#include "coupling/measure.hpp"

namespace coupling {

namespace {

constexpr int sample_tag = 21;
constexpr std::size_t energy_terms = sizeof(base::Energy) / sizeof(double);
static_assert(std::is_trivially_copyable_v<base::Energy> && sizeof(base::Energy) == energy_terms * sizeof(double));

bool is_body_probe(const Probe& probe) {
  return probe.kind == ProbeKind::displacement || probe.kind == ProbeKind::velocity ||
         probe.kind == ProbeKind::acceleration || probe.kind == ProbeKind::load;
}

constexpr double porosity_lattice = 0.005;  // [m] a fifth of the smallest ballast grain

}  // namespace

Sampler::Sampler(const Roles& roles, const Scene& scene, dem::Simulation* grains, fem::Model* bodies,
                 const std::vector<base::Skin>& skins, std::vector<int> walls, std::vector<int> named_walls)
    : roles_(roles),
      scene_(scene),
      grains_(grains),
      bodies_(bodies),
      skins_(skins),
      walls_(std::move(walls)),
      named_walls_(std::move(named_walls)),
      kept_(scene.probes.size(), 0.0) {}

Sampler::Sample Sampler::sample(bool thorough) {
  have_grains_ = have_wall_contacts_ = false;
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
    const bool slow = probe.kind == ProbeKind::porosity || probe.kind == ProbeKind::coordination;
    if (is_body_probe(probe))
      kept_[p] = from_bodies[next++];
    else if (!slow || thorough)
      kept_[p] = grain_probe(probe);
  }
  result.probes = kept_;
  return result;
}

double Sampler::body_probe(const Probe& probe) const {
  if (probe.kind == ProbeKind::load) return probe.scale * bodies_->load_value(probe.load);
  const auto quantity = probe.kind == ProbeKind::displacement ? fem::Quantity::displacement
                        : probe.kind == ProbeKind::velocity   ? fem::Quantity::velocity
                                                              : fem::Quantity::acceleration;
  const Vec3 value = probe.point ? bodies_->probe_point(probe.body, *probe.point, quantity)
                                 : bodies_->probe_group(probe.body, probe.group, quantity);
  return probe.scale * value[probe.component];
}

double Sampler::contact_force(const Probe& probe) const {
  if (!have_wall_contacts_) wall_contacts_ = grains_->wall_contacts();
  have_wall_contacts_ = true;
  int wall = -1;
  for (std::size_t s = 0; s < skins_.size(); ++s)
    if (!probe.body.empty() && skins_[s].body == probe.body) wall = walls_[s];
  for (std::size_t w = 0; w < named_walls_.size(); ++w)
    if (!probe.wall.empty() && scene_.grains->walls[w].name == probe.wall) wall = named_walls_[w];
  double force = 0;  // [N] of the grains on the surface
  for (const auto& contact : wall_contacts_)
    if (contact.wall == wall && (!probe.box || contains(*probe.box, contact.point)))
      force -= contact.force[probe.component];
  return force;
}

const dem::Grain& Sampler::grain(std::int64_t id) const {
  const auto found = std::lower_bound(grain_list_.begin(), grain_list_.end(), id,
                                      [](const dem::Grain& g, std::int64_t value) { return g.id < value; });
  base::require_internal(found != grain_list_.end() && found->id == id, "probe of a grain that does not exist");
  return *found;
}

double Sampler::grain_probe(const Probe& probe) const {
  if (probe.kind == ProbeKind::contact_force) return probe.scale * contact_force(probe);
  if (probe.kind == ProbeKind::contact_stress) return probe.scale * contact_force(probe) / probe.area;
  if (probe.kind == ProbeKind::kinetic_energy) return probe.scale * grains_->energy().kinetic;
  if (probe.kind == ProbeKind::broken_bonds) return probe.scale * static_cast<double>(grains_->broken_bonds());
  if (!have_grains_) grain_list_ = grains_->grains();
  have_grains_ = true;
  switch (probe.kind) {
    case ProbeKind::porosity:
      return probe.scale * porosity(grains_->spheres(), *probe.box, porosity_lattice);
    case ProbeKind::coordination:
      return probe.scale * coordination(grain_list_, grains_->grain_contacts(), *probe.box);
    case ProbeKind::grain_position:
      return probe.scale * grain(probe.grain).position[probe.component];
    case ProbeKind::grain_velocity:
      return probe.scale * grain(probe.grain).velocity[probe.component];
    default:
      return probe.scale * grain(probe.grain).angular_velocity[probe.component];
  }
}

}  // namespace coupling
