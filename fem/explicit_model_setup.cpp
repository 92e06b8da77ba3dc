// The start of a model: checks, supports, loads, skins.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "base/memory.hpp"
#include "fem/communication.hpp"
#include "fem/explicit_model.hpp"
#include "fem/faces.hpp"
#include "fem/families.hpp"
#include "fem/hinges.hpp"
#include "fem/newton.hpp"
#include "fem/periodic.hpp"
#include "fem/stable_step.hpp"

namespace fem {
namespace {

/// A brick of twenty nodes with eight points has six motions without strain besides the rigid ones. Neighbours along
/// two directions keep each other from them; cells in a row do not.
void refuse_rows_of_reduced_cells(const Mesh& mesh, const Body& body) {
  if (body.element != Hex20Reduced::name) return;
  constexpr int sides[3][2][4] = {
      {{0, 3, 7, 4}, {1, 2, 6, 5}}, {{0, 1, 5, 4}, {3, 2, 6, 7}}, {{0, 1, 2, 3}, {4, 5, 6, 7}}};
  const auto side = [&](int e, const int(&corners)[4]) {
    std::array<int, 4> nodes;
    for (int k = 0; k < 4; ++k) nodes[k] = mesh.unknown_of(mesh.element(e)[corners[k]]);
    std::ranges::sort(nodes);
    return nodes;
  };
  std::map<std::array<int, 4>, int> cells;  // at each side
  for (int e = 0; e < mesh.element_count(); ++e) {
    for (const auto& direction : sides) {
      for (const auto& corners : direction) ++cells[side(e, corners)];
    }
  }
  for (int e = 0; e < mesh.element_count(); ++e) {
    int held = 0;  // directions with a neighbour
    for (const auto& direction : sides) held += cells[side(e, direction[0])] > 1 || cells[side(e, direction[1])] > 1;
    const Vec3 centre = mesh.centre(e);
    base::require_user(
        held >= 2,
        fmt::format(
            "{}element = \"{}\": cell {} at ({:.4g}, {:.4g}, {:.4g}) m has neighbours along fewer than two of its "
            "directions; such cells can move without strain; mesh two cells across, or choose \"hex20\"",
            message_head(body.origin, body.name), body.element, e + 1, centre.x, centre.y, centre.z));
  }
}

std::vector<Mesh> read_meshes(MPI_Comm comm, const Setup& setup) {
  std::set<std::string> names;
  for (const auto& body : setup.bodies) {
    check_body(body);
    base::require_user(names.insert(body.name).second,
                       message_head(body.origin, body.name) + "there are two bodies of this name");
  }
  std::vector<Mesh> meshes;
  for (const auto& body : setup.bodies) {
    meshes.push_back(read_mesh(comm, body));
    meshes.back().nodes.shrink_to_fit();
    meshes.back().elements.shrink_to_fit();
    meshes.back().regions.shrink_to_fit();
    meshes.back().shared = tie_periodic_faces(meshes.back(), body);
    if (setup.solver.kind != Solver::explicit_steps || setup.solver.start_in_equilibrium)
      refuse_rows_of_reduced_cells(meshes.back(), body);
  }
  return meshes;
}

/// Force [N] of each node of the mesh when the load's history is 1.
std::map<int, Vec3> nodal_forces(const Mesh& mesh, const Body& body, const Load& load) {
  const std::string head = message_head(load.origin, body.name);
  const Group& group = find_group(mesh, body, load.origin, "load.group", load.group);
  std::map<int, Vec3> forces;
  if (load.kind == LoadKind::nodal_total) {
    for (const int node : group.nodes) forces[node] += load.direction * (1.0 / static_cast<double>(group.nodes.size()));
    return forces;
  }
  base::require_user(
      !group.facets.empty(),
      fmt::format("{}load.group = \"{}\" is not a surface; a load over an area needs a physical surface, or "
                  "use kind = \"nodal_total\"",
                  head, load.group));
  base::require_user(
      load.kind != LoadKind::pressure || group.outside,
      fmt::format("{}load.group = \"{}\" is no outer surface; a pressure needs the body on one side of it", head,
                  load.group));
  double total = 0;
  for (const auto& facet : group.facets) {
    for (const auto& node : integrate(mesh, facet)) {
      forces[node.node] += load.kind == LoadKind::pressure ? -node.normal : load.direction * node.area;
      total += node.area;
    }
  }
  if (load.kind == LoadKind::face_total) {
    for (auto& [node, force] : forces) force *= 1 / total;
  }
  return forces;
}

/// Stiffness-proportional damping is viscosity in proportion to the moduli.
Setup with_stiffness_damping(Setup setup) {
  for (auto& body : setup.bodies) {
    if (body.stiffness_damping == 0) continue;
    for (auto& material : body.materials) {
      if (material.law == LinearElastic::name) material.law = KelvinVoigt::name;
      const Elastic elastic = elastic_constants(material);
      material.shear_viscosity += body.stiffness_damping * elastic.mu;
      material.bulk_viscosity += body.stiffness_damping * (elastic.lambda + 2.0 / 3.0 * elastic.mu);
    }
  }
  return setup;
}

using Components = std::vector<std::array<bool, 3>>;

void mark(const Mesh& mesh, const Group& group, const std::array<bool, 3>& along, Components& marked) {
  for (const int node : group.nodes) {
    auto& of = marked[mesh.unknown_of(node)];
    for (int c = 0; c < 3; ++c) of[c] = of[c] || along[c];
  }
  for (int node = 0; node < static_cast<int>(marked.size()); ++node) marked[node] = marked[mesh.unknown_of(node)];
}

/// Per node of a body: which components its supports hold or its motions lead.
Components given_components(const Mesh& mesh, const Body& body) {
  auto given = held_components(mesh, body);
  for (const auto& motion : body.motions)
    mark(mesh, find_group(mesh, body, motion.origin, "motion.group", motion.group), motion.along, given);
  return given;
}

}  // namespace

Components held_components(const Mesh& mesh, const Body& body) {
  Components held(mesh.nodes.size(), {false, false, false});
  for (const auto& support : body.supports)
    mark(mesh, find_group(mesh, body, support.origin, "support.group", support.group), support.fixed, held);
  return held;
}

ExplicitModel::ExplicitModel(MPI_Comm comm, const Setup& setup)
    : setup_(with_stiffness_damping(setup)),
      meshes_(read_meshes(comm, setup)),
      layout_(comm, meshes_),
      assembly_(setup_, meshes_, layout_),
      displacement_(layout_),
      velocity_(layout_),
      acceleration_(layout_),
      inner_(layout_),
      mass_(layout_),
      external_(displacement_.owned_size(), 0.0),
      inverse_mass_(displacement_.owned_size(), 0.0) {
  for (const auto& body : setup_.bodies) states_.push_back({body.damping, false});
  for (int b = 0; b < static_cast<int>(meshes_.size()); ++b) {
    int simple = assembly_.has_simple_energy(b);  // a rank without its elements has its nodes
    MPI_Allreduce(MPI_IN_PLACE, &simple, 1, MPI_INT, MPI_MIN, comm);
    simple_energy_.push_back(simple != 0);
  }
  assembly_.lumped_mass(mass_);
  apply_supports();
  make_loads();
  make_motions();
  make_absorbers();
  make_skins();
  count_bodies();
  prepare_solver();
  output_ = std::make_unique<Output>(setup_, meshes_, layout_, assembly_);
  if (layout_.rank != 0) {
    for (auto& mesh : meshes_) mesh.elements = {};
  }
  assembly_.forget_masses();
  base::release_memory();
  if (setup_.solver.start_in_equilibrium && !setup_.solver.only_looked_at) start_in_equilibrium();
  start_accelerations();
  reset_energy();
}

/// What the chosen solver needs of the meshes' elements, which are dropped afterwards.
void ExplicitModel::prepare_solver() {
  const SolverSettings& solver = setup_.solver;
  const bool conditional = solver.kind == Solver::newmark && 2 * solver.beta < solver.gamma;
  if (solver.kind == Solver::explicit_steps || conditional)
    stable_step_ = find_stable_step(setup_, meshes_, layout_, assembly_, inverse_mass_);
  base::require_user(
      solver.kind != Solver::explicit_steps || std::isfinite(stable_step_.limit) || !driven_.empty(),
      fmt::format("{}supports hold every node; nothing can move, no step is too long; free some nodes, or set "
                  "fem.solver = \"static\"",
                  message_head(setup_.bodies.front().origin, setup_.bodies.front().name)));
  if (solver.kind == Solver::explicit_steps && !solver.start_in_equilibrium) return look_for_hinges();
  tangent_ = std::make_unique<Tangent>(meshes_, layout_, assembly_, inverse_mass_);
  for (std::size_t b = 0; b < meshes_.size(); ++b)
    mechanisms_.push_back(find_mechanisms(meshes_[b], given_components(meshes_[b], setup_.bodies[b])));
  if (solver.kind == Solver::statics || solver.start_in_equilibrium) refuse_mechanisms();
  look_for_hinges();
}

void ExplicitModel::refuse_mechanisms() const {
  for (std::size_t b = 0; b < meshes_.size(); ++b) {
    const auto& found = mechanisms_[b];
    if (found.free.empty()) continue;
    const int part = found.free.front().part;
    const int node = static_cast<int>(std::ranges::find(found.part_of_node, part) - found.part_of_node.begin());
    const Vec3& place = meshes_[b].nodes[node];
    const bool whole = *std::ranges::max_element(found.part_of_node) == 0;
    throw base::UserError(
        fmt::format("{}nothing holds {} against {}; there is no equilibrium, the static system is singular; add a "
                    "[[body.support]] that fixes it",
                    message_head(setup_.bodies[b].origin, setup_.bodies[b].name),
                    whole ? "it" : fmt::format("its part at ({:.4g}, {:.4g}, {:.4g}) m", place.x, place.y, place.z),
                    describe(found, part)));
  }
}

/// Motion is well posed with them: a word there, an error where stiffness alone has to answer.
void ExplicitModel::look_for_hinges() {
  const SolverSettings& solver = setup_.solver;
  const bool vibrates = solver.kind == Solver::modal;
  const bool refuse = vibrates || solver.kind == Solver::statics || solver.start_in_equilibrium;
  on_first_rank(layout_.comm, [&] {
    for (std::size_t b = 0; b < meshes_.size(); ++b) {
      const Body& body = setup_.bodies[b];
      if (meshes_[b].rigid_parts.empty()) continue;
      const auto found = find_hinges(meshes_[b], given_components(meshes_[b], body));
      if (found.motions == 0) continue;
      const char* result = vibrates ? "it would be a mode at 0 Hz"
                           : refuse ? "there is no equilibrium, the static system is singular"
                                    : "nothing resists it";
      warnings_.push_back(
          fmt::format("{}{}: {}; join the cells by whole faces in the mesh, or hold both sides by supports",
                      message_head(body.origin, body.name), describe(found), result));
      base::require_user(!refuse, warnings_.back());
    }
  });
}

std::vector<double> ExplicitModel::weights() const {
  std::vector<double> weights(inverse_mass_.size(), 0.0);
  for (std::size_t b = 0; b < meshes_.size(); ++b) {
    if (!setup_.bodies[b].gravity) continue;
    for (int i = 3 * layout_.first_owned[b]; i < 3 * layout_.first_owned[b + 1]; ++i) {
      if (inverse_mass_[i] > 0) weights[i] = mass_.data()[i] * setup_.gravity[i % 3];
    }
  }
  return weights;
}

void ExplicitModel::start_in_equilibrium() {
  gather_external_forces(time_);
  std::vector<double> given = weights();
  for (std::size_t i = 0; i < given.size(); ++i) given[i] += external_[i];
  Newton(setup_.solver, layout_, assembly_, *tangent_, inverse_mass_)
      .solve(displacement_, inner_, {{}, given, {}}, "at the start: ");
}

void ExplicitModel::apply_supports() {
  for (int b = 0; b < static_cast<int>(meshes_.size()); ++b) {
    const auto held = held_components(meshes_[b], setup_.bodies[b]);
    for (int node = layout_.first_owned[b]; node < layout_.first_owned[b + 1]; ++node) {
      const auto& fixed = held[layout_.global_of_local[node] - layout_.first_node[b]];
      for (int c = 0; c < 3; ++c) inverse_mass_[3 * node + c] = fixed[c] ? 0 : 1 / mass_.data()[3 * node + c];
    }
  }
}

void ExplicitModel::make_loads() {
  for (int b = 0; b < static_cast<int>(meshes_.size()); ++b) {
    const Body& body = setup_.bodies[b];
    const auto held = given_components(meshes_[b], body);
    for (const auto& load : body.loads) {
      base::require_internal(load.history != nullptr, "a load without a history");
      NodalLoad made{load, {}, 0};
      bool felt =
          load.kind != LoadKind::pressure && base::norm(load.direction) == 0;  // a load of nothing may act on nothing
      for (const auto& [node, force] : nodal_forces(meshes_[b], body, load)) {
        for (int c = 0; c < 3; ++c) felt = felt || (force[c] != 0 && !held[node][c]);
        if (const int local = layout_.owned_node(b, node); local >= 0) made.share.emplace_back(local, force);
      }
      base::require_user(felt,
                         fmt::format("{}load.group = \"{}\" is held by supports in the direction of the load; the load "
                                     "would do nothing",
                                     message_head(load.origin, body.name), load.group));
      loads_.push_back(std::move(made));
    }
  }
}

namespace {

struct SkinFace {
  Facet nodes;  // of the mesh
  Vec3 offset;  // [m] of its place from theirs
};

std::vector<SkinFace> skin_faces(const Mesh& mesh, const Body& body) {
  std::vector<SkinFace> faces;
  for (const auto& name : body.skin) {
    const Group& group = find_group(mesh, body, body.origin, "skin", name);
    base::require_user(
        !group.facets.empty() && group.outside,
        fmt::format("{}skin = \"{}\" is not an outer surface of the body; a skin needs physical surfaces "
                    "with the body on one side",
                    message_head(body.origin, body.name), name));
    for (const auto& facet : group.facets) faces.push_back({facet, {}});
  }
  // Beyond periodic faces the skin goes on by a face: grains that cross there keep it under them.
  for (const auto& pair : body.periodic) {
    const Vec3 shift = shift_of(mesh, body, pair);
    const std::size_t count = faces.size();
    for (const auto& [name, way] : {std::pair{pair.first, shift}, std::pair{pair.second, -shift}}) {
      const auto& seam = find_group(mesh, body, pair.origin, "periodic", name).nodes;  // rising
      for (std::size_t f = 0; f < count; ++f) {
        const SkinFace face = faces[f];
        if (std::ranges::any_of(face.nodes, [&](int node) { return std::ranges::binary_search(seam, node); }))
          faces.push_back({face.nodes, face.offset + way});
      }
    }
  }
  return faces;
}

/// Adds a face whose nodes have these numbers in the skin: a facet, or the parts of one.
void add_face(const Facet& face, base::Skin& skin) {
  const auto parts = plane_parts(face);
  skin.facets.insert(skin.facets.end(), parts.begin(), parts.end());
  if (!has_middles(face)) return;
  skin.face_of.resize(skin.facets.size() - parts.size(), -1);
  skin.face_of.resize(skin.facets.size(), static_cast<int>(skin.faces.size()));
  if (corners_of(face) == 3)
    skin.faces.push_back({face[0], face[1], face[2], face[4], face[5], face[6], -1, -1});
  else
    skin.faces.push_back(face);
}

}  // namespace

void ExplicitModel::make_skins() {
  for (int b = 0; b < static_cast<int>(meshes_.size()); ++b) {
    const Body& body = setup_.bodies[b];
    const Mesh& mesh = meshes_[b];
    if (body.skin.empty()) continue;
    base::Skin skin{body.name, {}, {}};
    Contact contact;
    std::map<int, std::vector<int>> numbers;  // unknown of the mesh: its nodes of the skin, one unless it is periodic
    for (const auto& face : skin_faces(mesh, body)) {
      Facet numbered = no_facet;
      const double near = 1e-3 * base::norm(mesh.nodes[face.nodes[1]] - mesh.nodes[face.nodes[0]]);
      for (int a = 0; a < 8; ++a) {
        const int node = face.nodes[a];
        if (node < 0) continue;
        const Vec3 place = mesh.nodes[node] + face.offset;
        auto& known = numbers[mesh.unknown_of(node)];
        const auto there =
            std::ranges::find_if(known, [&](int number) { return base::norm(skin.nodes[number] - place) <= near; });
        numbered[a] = there != known.end() ? *there : static_cast<int>(skin.nodes.size());
        if (there != known.end()) continue;
        known.push_back(numbered[a]);
        skin.nodes.push_back(place);
        if (const int local = layout_.owned_node(b, node); local >= 0) {
          contact.skin_nodes.push_back(numbered[a]);
          contact.nodes.push_back(local);
          contact.places.push_back(place);
        }
      }
      add_face(numbered, skin);
    }
    if (!skin.faces.empty()) skin.face_of.resize(skin.facets.size(), -1);
    contact.given.resize(contact.nodes.size());
    contact.used.resize(contact.nodes.size());
    skins_.push_back(std::move(skin));
    contacts_.push_back(std::move(contact));
  }
}

void ExplicitModel::count_bodies() {
  for (int b = 0; b < static_cast<int>(meshes_.size()); ++b) {
    const Mesh& mesh = meshes_[b];
    BodyCounts counts{setup_.bodies[b].name, static_cast<std::int64_t>(mesh.nodes.size()),
                      mesh.element_count(),  mesh.nodes.front(),
                      mesh.nodes.front(),    0};
    for (const auto& node : mesh.nodes) {
      for (int c = 0; c < 3; ++c) {
        counts.lower[c] = std::min(counts.lower[c], node[c]);
        counts.upper[c] = std::max(counts.upper[c], node[c]);
      }
    }
    for (int node = layout_.first_owned[b]; node < layout_.first_owned[b + 1]; ++node)
      counts.mass += mass_.data()[3 * node];
    sum(layout_.comm, &counts.mass, 1);
    counts_.push_back(counts);
  }
}

}  // namespace fem
