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

/// Numbers that begin at a boundary of the widest vectors.
class AlignedNumbers {
 public:
  void resize(std::size_t size) { quads_.resize((size + 3) / 4); }
  double* data() { return quads_.empty() ? nullptr : quads_.front().lane; }
  const double* data() const { return quads_.empty() ? nullptr : quads_.front().lane; }
  double& operator[](std::size_t i) { return data()[i]; }
  double operator[](std::size_t i) const { return data()[i]; }

 private:
  struct alignas(8 * avx2_lanes) Quad {
    double lane[4];
  };
  std::vector<Quad> quads_;
};

/// What laws take out of the mechanics.
struct Losses {
  double viscous_power = 0;  // [W]
  double plastic_work = 0;   // [J] since the last step
};

/// Relative difference of eigenvalues up to which elements count as alike.
constexpr double alike = 1e-9;

class ElementBlock {
 public:
  static std::unique_ptr<ElementBlock> make(const BlockInput&);
  virtual ~ElementBlock() = default;

  int elements() const { return elements_; }
  int batches() const { return batches_; }
  int element_nodes() const { return element_nodes_; }
  /// Local number of node a of an element.
  int node(int element, int a) const {
    return nodes_[(static_cast<std::size_t>(element / lanes_) * element_nodes_ + a) * lanes_ + element % lanes_];
  }
  /// The elements of the batches [first, last) with what they remember, numbered so that none shares a node with
  /// another: node a of element e has the number e element_nodes() + a.
  virtual std::unique_ptr<ElementBlock> detached(int first, int last) const = 0;
  int lanes() const { return lanes_; }  // elements of a batch
  /// Adds the inner forces [N] of the batches [first, last) at the displacements [m] and velocities [m/s] (null: at
  /// rest) of the local nodes. What the law remembers stays as it is.
  void add_inner_forces(const double* displacements, const double* velocities, double* forces, int first,
                        int last) const;
  /// The same for small motions about the start: K u + C v. Velocities may be null.
  void add_linear_forces(const double* displacements, const double* velocities, double* forces, int first,
                         int last) const;
  /// Adds the inner forces of moving elements; the law remembers this state. The velocities are those of the middle of
  /// the step that led here.
  void advance(const double* displacements, const double* velocities, double* forces, Losses&, int first, int last);
  bool viscous() const { return viscous_; }              // forces depend on velocities
  bool keeps_history() const { return keeps_history_; }  // on what was before
  /// The energy stored is half of displacements times inner forces.
  bool has_simple_energy() const { return has_simple_energy_; }
  /// Elastic energy [J] of the block.
  virtual double stored(const double* displacements) const = 0;
  /// Largest accumulated plastic strain [-] of every element's points; 0 where the law knows none.
  virtual void plastic_strains(std::vector<double>& result) const = 0;
  /// Frees what only add_lumped_mass() and largest_element_eigenvalue() read; they may not be called after.
  void forget_masses() { node_volume_ = {}; }
  /// What the law remembers, element by element; the same count of numbers for each.
  int history_size() const;
  void read_history(std::vector<double>& result) const;
  void set_history(const double* values);
  /// Adds each element's lumped mass [kg] to its nodes.
  void add_lumped_mass(double* nodal_mass) const;

  /// Mean stress of every element [Pa]: xx, yy, zz, xy, yz, xz; velocities may be null: at rest.
  virtual void stresses(const double* displacements, const double* velocities,
                        std::vector<std::array<double, 6>>& result) const = 0;
  /// Largest eigenvalue [1/s2] of M^-1 (K + rate C) of each element on its own, free, with its own lumped mass M, among
  /// those whose bound (the trace) exceeds `worth`; {0, -1} if there is none. The largest over all elements bounds the
  /// assembled one from above. Of elements that are alike the first in `order` (all elements, each once) is named.
  struct Largest {
    double eigenvalue = 0;
    int element = -1;
  };
  virtual Largest largest_element_eigenvalue(double worth, std::span<const int> order, double rate) const = 0;

 protected:
  int elements_ = 0, batches_ = 0, lanes_ = 1, element_nodes_ = 0;
  double density_ = 0;
  bool viscous_ = false, keeps_history_ = false, has_simple_energy_ = false;
  std::vector<int> nodes_;           // [batch][node][lane]
  AlignedNumbers geometry_;          // [batch][number][lane]
  std::vector<double> node_volume_;  // [element][node]
  std::vector<double> history_;      // [batch][number][lane] of the law
  ForceKernel kernel_ = nullptr, linear_kernel_ = nullptr;
  const void *law_ = nullptr, *linear_law_ = nullptr;
};

}  // namespace fem
