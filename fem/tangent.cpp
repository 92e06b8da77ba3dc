#include "fem/tangent.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "fem/communication.hpp"
#include "fem/rigid_motions.hpp"

namespace fem {
namespace {

constexpr int elements_at_once = 512;

/// Nodes of the owned nodes' elements: how many of them this rank owns, how many others do.
struct Neighbours {
  std::vector<PetscInt> near, far;
};

Neighbours count_neighbours(const std::vector<Mesh>& meshes, const Layout& layout) {
  std::vector<std::vector<int>> of(layout.owned);  // global numbers
  for (std::size_t b = 0; b < meshes.size(); ++b) {
    const Mesh& mesh = meshes[b];
    const int first = layout.first_node[b];
    for (int e = 0; e < mesh.element_count(); ++e) {
      const std::span nodes(mesh.element(e), static_cast<std::size_t>(mesh.element_nodes));
      for (const int node : nodes) {
        const int local = layout.owned_node(static_cast<int>(b), node);
        if (local < 0) continue;
        for (const int other : nodes) of[local].push_back(layout.unknown_of_global[first + other]);
      }
    }
  }
  Neighbours result;
  for (auto& list : of) {
    std::ranges::sort(list);
    list.erase(std::unique(list.begin(), list.end()), list.end());
    const auto near = std::ranges::count_if(list, [&](int node) {
      const int local = layout.local_of_global[node];
      return local >= 0 && local < layout.owned;
    });
    result.near.push_back(static_cast<PetscInt>(near));
    result.far.push_back(static_cast<PetscInt>(list.size()) - result.near.back());
  }
  return result;
}

/// Which local components supports hold, ghosts included.
std::vector<char> held_components(const Layout& layout, std::span<const double> inverse_mass) {
  NodalField free(layout);
  for (std::size_t i = 0; i < inverse_mass.size(); ++i) free.data()[i] = inverse_mass[i] > 0 ? 1 : 0;
  free.begin_to_ghosts();
  free.end_to_ghosts();
  std::vector<char> held(free.local_size());
  for (std::size_t i = 0; i < held.size(); ++i) held[i] = free.data()[i] == 0;
  return held;
}

}  // namespace

Tangent::Tangent(const std::vector<Mesh>& meshes, const Layout& layout, const Assembly& assembly,
                 std::span<const double> inverse_mass)
    : layout_(layout), held_(held_components(layout, inverse_mass)) {
  auto neighbours = count_neighbours(meshes, layout);
  near_nodes_ = std::move(neighbours.near);
  far_nodes_ = std::move(neighbours.far);
  places_.resize(layout.local_count());
  for (std::size_t b = 0; b < meshes.size(); ++b) {
    for (int i = 0; i < layout.local_count(); ++i) {
      const int own = layout.global_of_local[i] - layout.first_node[b];
      if (own >= 0 && own < static_cast<int>(meshes[b].nodes.size())) places_[i] = meshes[b].nodes[own];
    }
  }
  for (const auto& [body, block] : assembly.blocks()) {
    Part part{block, true, base::norm(places_[block->node(0, 1)] - places_[block->node(0, 0)])};
    part.linear = responds_linearly(part);
    parts_.push_back(part);
  }
  double nonlinear = std::ranges::all_of(parts_, &Part::linear) ? 0 : 1;
  sum(layout.comm, &nonlinear, 1);
  linear_ = nonlinear == 0;
}

Matrix Tangent::make() const {
  Matrix matrix;
  const PetscInt rows = 3 * layout_.owned;
  check_petsc(MatCreate(layout_.comm, matrix.place()));
  check_petsc(MatSetSizes(matrix, rows, rows, PETSC_DETERMINE, PETSC_DETERMINE));
  check_petsc(MatSetBlockSize(matrix, 3));
  check_petsc(MatSetType(matrix, MATAIJ));
  check_petsc(MatXAIJSetPreallocation(matrix, 3, near_nodes_.data(), far_nodes_.data(), nullptr, nullptr));
  check_petsc(MatSetOption(matrix, MAT_ROW_ORIENTED, PETSC_FALSE));  // the elements' matrices come by columns
  if (linear_) check_petsc(MatSetOption(matrix, MAT_SYMMETRIC, PETSC_TRUE));
  return matrix;
}

bool Tangent::responds_linearly(const Part& part) {
  const auto block = part.block->detached(0, 1);
  const int size = 3 * block->element_nodes(), all = size * block->lanes();
  const auto forces = [&](double factor) {
    std::vector<double> u(all), f(all, 0.0);
    for (int i = 0; i < all; ++i) u[i] = factor * part.size * std::sin(1.0 + 7 * (i % size));  // strains of order one
    block->add_inner_forces(u.data(), nullptr, f.data(), 0, 1);
    return f;
  };
  const auto once = forces(1), twice = forces(2), back = forces(-1);
  double largest = 0, difference = 0;
  for (int i = 0; i < size; ++i) {
    largest = std::max(largest, std::abs(once[i]));
    difference = std::max({difference, std::abs(twice[i] - 2 * once[i]), std::abs(back[i] + once[i])});
  }
  return difference <= 1e-12 * largest;
}

std::vector<double> Tangent::matrices(const Part& part, Batches batches, const State* state) const {
  const auto block = part.block->detached(batches.first, batches.second);
  const int n = block->element_nodes(), size = 3 * n, count = block->elements();
  const auto all = static_cast<std::size_t>(block->batches()) * block->lanes() * size;
  const bool at_start = state == nullptr || part.linear;
  std::vector<double> u(all), v(all), f(all), result(static_cast<std::size_t>(count) * size * size);
  if (!at_start) {
    for (std::size_t i = 0; i < static_cast<std::size_t>(count) * size; ++i) {
      const int e = batches.first * block->lanes() + static_cast<int>(i) / size;
      const std::size_t place = 3 * static_cast<std::size_t>(part.block->node(e, i / 3 % n)) + i % 3;
      u[i] = state->displacements[place];
      v[i] = state->velocities ? state->velocities[place] : 0;
    }
  }
  const double h = at_start ? 1 : 1e-7 * part.size, rate = state && state->velocities ? state->rate : 0;
  const auto add_column = [&](int column, double step, double weight) {
    auto moved = u, moving = v;
    for (int e = 0; e < count; ++e) {
      moved[static_cast<std::size_t>(e) * size + column] += step;
      moving[static_cast<std::size_t>(e) * size + column] += rate * step;
    }
    std::ranges::fill(f, 0.0);
    if (state == nullptr) {
      block->add_linear_forces(moved.data(), nullptr, f.data(), 0, block->batches());
    } else {
      block->add_inner_forces(moved.data(), moving.data(), f.data(), 0, block->batches());
    }
    for (int e = 0; e < count; ++e) {
      for (int row = 0; row < size; ++row)
        result[(static_cast<std::size_t>(e) * size + column) * size + row] +=
            weight * f[static_cast<std::size_t>(e) * size + row];
    }
  };
  for (int column = 0; column < size; ++column) {
    add_column(column, h, at_start ? 1 : 0.5 / h);
    if (!at_start) add_column(column, -h, -0.5 / h);
  }
  return result;
}

void Tangent::assemble(Mat matrix, const State* state) const {
  check_petsc(MatZeroEntries(matrix));
  for (const auto& part : parts_) {
    const ElementBlock& block = *part.block;
    const int n = block.element_nodes(), size = 3 * n, at_once = elements_at_once / block.lanes();
    std::vector<PetscInt> places(size);
    for (int first = 0; first < block.batches(); first += at_once) {
      const int last = std::min(block.batches(), first + at_once), start = first * block.lanes();
      const auto values = matrices(part, {first, last}, state);
      for (int e = start; e < std::min(block.elements(), last * block.lanes()); ++e) {
        const double* element = values.data() + static_cast<std::size_t>(e - start) * size * size;
        for (int i = 0; i < size; ++i) {
          const int node = block.node(e, i / 3);
          const PetscInt place = 3 * layout_.petsc_of_global[layout_.global_of_local[node]] + i % 3;
          const bool held = held_[3 * static_cast<std::size_t>(node) + i % 3];
          places[i] = held ? -1 : place;  // PETSc leaves negative ones out
          // a held row stands alone; it must have a number where a law has no stiffness left (an apex)
          const double alone = std::max(element[i * size + i], 1.0);
          if (held) check_petsc(MatSetValue(matrix, place, place, alone, ADD_VALUES));
        }
        check_petsc(MatSetValues(matrix, size, places.data(), size, places.data(), element, ADD_VALUES));
      }
    }
  }
  check_petsc(MatAssemblyBegin(matrix, MAT_FINAL_ASSEMBLY));
  check_petsc(MatAssemblyEnd(matrix, MAT_FINAL_ASSEMBLY));
}

void Tangent::add_rigid_motions(Mat matrix) const {
  Vec3 centre;
  for (int i = 0; i < layout_.owned; ++i) centre += places_[i];
  double sums[4] = {centre.x, centre.y, centre.z, static_cast<double>(layout_.owned)};
  sum(layout_.comm, sums, 4);
  centre = Vec3{sums[0], sums[1], sums[2]} * (1 / sums[3]);
  std::array<Vector, 6> motions;
  std::array<Vec, 6> vectors{};
  for (int k = 0; k < 6; ++k) {
    check_petsc(MatCreateVecs(matrix, motions[k].place(), nullptr));
    double* values = nullptr;
    check_petsc(VecGetArray(motions[k], &values));
    for (int i = 0; i < layout_.owned; ++i) {
      const Vec3 motion = rigid_motion(k, places_[i] - centre);
      for (int c = 0; c < 3; ++c) values[3 * i + c] = held_[3 * i + c] ? 0 : motion[c];
    }
    check_petsc(VecRestoreArray(motions[k], &values));
    // MatNullSpaceCreate wants them orthonormal
    for (int pass = 0; pass < 2; ++pass) {
      for (int other = 0; other < k; ++other) {
        PetscScalar product = 0;
        check_petsc(VecDot(motions[k], motions[other], &product));
        check_petsc(VecAXPY(motions[k], -product, motions[other]));
      }
    }
    PetscReal length = 0;
    check_petsc(VecNormalize(motions[k], &length));
    vectors[k] = motions[k];
  }
  MatNullSpace space = nullptr;
  check_petsc(MatNullSpaceCreate(layout_.comm, PETSC_FALSE, 6, vectors.data(), &space));
  check_petsc(MatSetNearNullSpace(matrix, space));
  check_petsc(MatNullSpaceDestroy(&space));
}

}  // namespace fem
