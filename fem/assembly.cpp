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
        part.block = ElementBlock::make({body.element, body.materials[region], places, connectivity});
        (border ? border_ : interior_).push_back(std::move(part));
      }
    }
  }
}

void Assembly::inner_forces(NodalField& displacements, NodalField& forces) const {
  const double* u = displacements.data();
  double* f = forces.data();
  std::fill(f, f + forces.local_size(), 0.0);
  for (const auto& part : interior_) part.block->add_inner_forces(u, f, 0, part.block->batches() / 2);
  displacements.end_to_ghosts();
  for (const auto& part : border_) part.block->add_inner_forces(u, f, 0, part.block->batches());
  forces.begin_add_from_ghosts();
  for (const auto& part : interior_)
    part.block->add_inner_forces(u, f, part.block->batches() / 2, part.block->batches());
  forces.end_add_from_ghosts();
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

std::vector<std::array<double, 6>> Assembly::stresses(int body, const NodalField& displacements) const {
  std::vector<std::array<double, 6>> result;
  for (const auto* parts : {&interior_, &border_}) {
    for (const auto& part : *parts) {
      if (part.body == body) part.block->stresses(displacements.data(), result);
    }
  }
  return result;
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

Assembly::Limiter Assembly::limiter() const {
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
      const auto largest = part.block->largest_element_eigenvalue(limiter.eigenvalue * (1 - alike), order);
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
