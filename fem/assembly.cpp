#include "fem/assembly.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "fem/communication.hpp"

namespace fem {

Assembly::Assembly(const Setup& setup, const std::vector<Mesh>& meshes, const Layout& layout) : comm_(layout.comm) {
  for (int b = 0; b < static_cast<int>(meshes.size()); ++b) {
    const Mesh& mesh = meshes[b];
    const Body& body = setup.bodies[b];
    std::vector<Vec3> places;
    for (const int node : layout.global_of_local) {
      const int own = node - layout.first_node[b];
      places.push_back(own >= 0 && own < static_cast<int>(mesh.nodes.size()) ? mesh.nodes[own] : Vec3{});
    }
    const auto local = [&](int node) { return layout.local_of_global[layout.first_node[b] + node]; };
    for (int region = 0; region < static_cast<int>(body.materials.size()); ++region) {
      for (const bool border : {false, true}) {
        Part part{b, {}, nullptr};
        std::vector<int> connectivity;
        for (const int e : layout.elements[b]) {
          const int *first = mesh.element(e), *last = first + mesh.element_nodes;
          const bool touches = std::any_of(first, last, [&](int node) { return local(node) >= layout.owned; });
          if (mesh.regions[e] != region || touches != border) continue;
          part.elements.push_back(e);
          for (const int* node = first; node != last; ++node) connectivity.push_back(local(*node));
        }
        if (part.elements.empty()) continue;
        part.elements.shrink_to_fit();
        part.block = ElementBlock::make({body.element, body.materials[region], places, connectivity});
        viscous_ = viscous_ || part.block->viscous();
        keeps_history_ = keeps_history_ || part.block->keeps_history();
        (border ? border_ : interior_).push_back(std::move(part));
      }
    }
  }
  int any[] = {viscous_, keeps_history_};
  MPI_Allreduce(MPI_IN_PLACE, any, 2, MPI_INT, MPI_MAX, comm_);
  viscous_ = any[0] != 0;
  keeps_history_ = any[1] != 0;
}

template <class Parts, class Work>
void Assembly::overlapped(Parts& interior, Parts& border, const std::vector<NodalField*>& motion, NodalField& forces,
                          Work&& work) {
  std::fill(forces.data(), forces.data() + forces.local_size(), 0.0);
  for (auto& part : interior) work(*part.block, 0, part.block->batches() / 2);
  for (auto* field : motion) field->end_to_ghosts();
  for (auto& part : border) work(*part.block, 0, part.block->batches());
  forces.begin_add_from_ghosts();
  for (auto& part : interior) work(*part.block, part.block->batches() / 2, part.block->batches());
  forces.end_add_from_ghosts();
}

void Assembly::inner_forces(NodalField& displacements, NodalField* velocities, NodalField& forces) const {
  std::vector<NodalField*> motion{&displacements};
  if (viscous_ && velocities) motion.push_back(velocities);
  overlapped(interior_, border_, motion, forces, [&](const ElementBlock& block, int first, int last) {
    block.add_inner_forces(displacements.data(), velocities ? velocities->data() : nullptr, forces.data(), first, last);
  });
}

void Assembly::linear_forces(NodalField& displacements, NodalField& velocities, NodalField& forces) const {
  overlapped(interior_, border_, {&displacements, &velocities}, forces,
             [&](const ElementBlock& block, int first, int last) {
               block.add_linear_forces(displacements.data(), velocities.data(), forces.data(), first, last);
             });
}

Losses Assembly::advance(NodalField& displacements, NodalField& velocities, NodalField& forces) {
  Losses losses;
  std::vector<NodalField*> motion{&displacements};
  if (viscous_) motion.push_back(&velocities);
  overlapped(interior_, border_, motion, forces, [&](ElementBlock& block, int first, int last) {
    block.advance(displacements.data(), velocities.data(), forces.data(), losses, first, last);
  });
  return losses;
}

std::vector<Assembly::BlockOfBody> Assembly::blocks() const {
  std::vector<BlockOfBody> all;
  for (const auto* parts : {&interior_, &border_}) {
    for (const auto& part : *parts) all.push_back({part.body, part.block.get()});
  }
  return all;
}

void Assembly::forget_masses() {
  for (auto* parts : {&interior_, &border_}) {
    for (auto& part : *parts) part.block->forget_masses();
  }
}

void Assembly::lumped_mass(NodalField& mass) const {
  std::vector<double> nodal(mass.local_size() / 3, 0.0);
  for (const auto* parts : {&interior_, &border_}) {
    for (const auto& part : *parts) part.block->add_lumped_mass(nodal.data());
  }
  for (int i = 0; i < mass.local_size(); ++i) mass.data()[i] = nodal[i / 3];
  mass.begin_add_from_ghosts();
  mass.end_add_from_ghosts();
}

std::vector<std::array<double, 6>> Assembly::stresses(int body, const NodalField& displacements,
                                                      const NodalField* velocities) const {
  std::vector<std::array<double, 6>> result;
  for (const auto* parts : {&interior_, &border_}) {
    for (const auto& part : *parts) {
      if (part.body == body)
        part.block->stresses(displacements.data(), velocities ? velocities->data() : nullptr, result);
    }
  }
  return result;
}

std::vector<double> Assembly::plastic_strains(int body) const {
  std::vector<double> result;
  for (const auto* parts : {&interior_, &border_}) {
    for (const auto& part : *parts) {
      if (part.body == body) part.block->plastic_strains(result);
    }
  }
  return result;
}

bool Assembly::has_simple_energy(int body) const {
  bool simple = true;
  for (const auto* parts : {&interior_, &border_}) {
    for (const auto& part : *parts) simple = simple && (part.body != body || part.block->has_simple_energy());
  }
  return simple;
}

double Assembly::stored(int body, const NodalField& displacements) const {
  double energy = 0;
  for (const auto* parts : {&interior_, &border_}) {
    for (const auto& part : *parts) {
      if (part.body == body) energy += part.block->stored(displacements.data());
    }
  }
  return energy;
}

std::vector<int> Assembly::elements_of(int body) const {
  std::vector<int> result;
  for (const auto* parts : {&interior_, &border_}) {
    for (const auto& part : *parts) {
      if (part.body == body) result.insert(result.end(), part.elements.begin(), part.elements.end());
    }
  }
  return result;
}

Assembly::Histories Assembly::histories(int body) const {
  Histories all;
  for (const auto* parts : {&interior_, &border_}) {
    for (const auto& part : *parts) {
      if (part.body != body) continue;
      all.sizes.insert(all.sizes.end(), part.elements.size(), part.block->history_size());
      part.block->read_history(all.values);
    }
  }
  return all;
}

void Assembly::set_histories(int body, const std::vector<double>& values) {
  std::size_t next = 0;
  for (auto* parts : {&interior_, &border_}) {
    for (auto& part : *parts) {
      if (part.body != body) continue;
      const std::size_t size = part.elements.size() * part.block->history_size();
      base::require_internal(next + size <= values.size(), "histories of other elements");
      part.block->set_history(values.data() + next);
      next += size;
    }
  }
}

Assembly::Limiter Assembly::limiter(double rate) const {
  Limiter limiter;
  // among elements that are alike the first in the mesh, so that the answer is the same on any number of ranks
  const auto take = [&](const Limiter& other) {
    const bool tie = std::abs(other.eigenvalue - limiter.eigenvalue) <= alike * limiter.eigenvalue;
    const bool first = std::tie(other.body, other.element) < std::tie(limiter.body, limiter.element);
    const double bound = std::max(limiter.eigenvalue, other.eigenvalue);
    if (tie ? first : other.eigenvalue > limiter.eigenvalue) limiter = other;
    limiter.eigenvalue = bound;
  };
  for (const auto* parts : {&interior_, &border_}) {
    for (const auto& part : *parts) {
      std::vector<int> order(part.elements.size());
      std::iota(order.begin(), order.end(), 0);
      std::ranges::sort(order, {}, [&](int i) { return part.elements[i]; });
      const auto largest = part.block->largest_element_eigenvalue(limiter.eigenvalue * (1 - alike), order, rate);
      if (largest.element >= 0) take({largest.eigenvalue, part.body, part.elements[largest.element]});
    }
  }
  int ranks = 1;
  MPI_Comm_size(comm_, &ranks);
  std::vector<Limiter> all(ranks);
  MPI_Allgather(&limiter, sizeof limiter, MPI_BYTE, all.data(), sizeof limiter, MPI_BYTE, comm_);
  limiter = all[0];
  for (const auto& other : all) take(other);
  return limiter;
}

}  // namespace fem
