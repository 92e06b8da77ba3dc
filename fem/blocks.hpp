#pragma once
// Elements of one kind and one material, in batches that the kernels of this machine's vector width take.
#include <array>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "fem/fem.hpp"
#include "fem/kernel_table.hpp"

namespace fem {

struct BlockInput {
  std::string element;
  const MaterialRegion& material;
  std::span<const Vec3> nodes;        // [m] places of the local nodes
  std::span<const int> connectivity;  // element_nodes(element) local node numbers per element
  int lanes = 0;                      // elements at once: 2 or 4; 0: what suits this machine
};

/// Relative difference of eigenvalues up to which elements count as alike.
constexpr double alike = 1e-9;

class ElementBlock {
 public:
  static std::unique_ptr<ElementBlock> make(const BlockInput&);
  virtual ~ElementBlock() = default;

  int elements() const { return elements_; }
  int batches() const { return batches_; }
  /// Adds the inner forces [N] of the batches [first, last) at the displacements [m] of the local nodes.
  void add_inner_forces(const double* displacements, double* forces, int first, int last) const;
  /// Adds each element's lumped (row-sum) mass [kg] to its nodes.
  void add_lumped_mass(double* nodal_mass) const;

  /// Mean stress of every element [Pa]: xx, yy, zz, xy, yz, xz.
  virtual void stresses(const double* displacements, std::vector<std::array<double, 6>>& result) const = 0;
  /// Largest eigenvalue [1/s2] of each element on its own, free, with its own lumped mass, among those whose bound (the
  /// trace) exceeds `worth`; {0, -1} if there is none. The largest over all elements bounds the assembled one from
  /// above. Of elements that are alike the first in `order` (all elements, each once) is named.
  struct Largest {
    double eigenvalue = 0;
    int element = -1;
  };
  virtual Largest largest_element_eigenvalue(double worth, std::span<const int> order) const = 0;

 protected:
  int elements_ = 0, batches_ = 0, lanes_ = 1, element_nodes_ = 0;
  double density_ = 0;
  std::vector<int> nodes_;           // [batch][node][lane]
  std::vector<double> geometry_;     // [batch][number][lane]
  std::vector<double> node_volume_;  // [element][node]
  ForceKernel kernel_ = nullptr;
  const void* law_ = nullptr;
};

}  // namespace fem
