#pragma once
// The elements of all bodies on this rank, and the matrix-free product "inner forces of displacements" over all ranks.
// Elements that touch ghosts are kept apart, so that both exchanges run while the others are worked on.
#include <memory>
#include <string>
#include <vector>

#include "fem/blocks.hpp"
#include "fem/layout.hpp"
#include "fem/nodal_field.hpp"

namespace fem {

class Assembly {
 public:
  Assembly(const Setup&, const std::vector<Mesh>&, const Layout&);

  /// Inner forces [N] of displacements [m] whose begin_to_ghosts() has been called. Collective.
  void inner_forces(NodalField& displacements, NodalField& forces) const;
  /// Lumped mass [kg], the same in the three components. Collective.
  void lumped_mass(NodalField& mass) const;
  /// Mean stress of this rank's elements of a body, in the order of `elements_of`. Ghosts must be up to date.
  std::vector<std::array<double, 6>> stresses(int body, const NodalField& displacements) const;
  std::vector<int> elements_of(int body) const;

  /// The element with the largest eigenvalue of its own, over all ranks. Collective.
  struct Limiter {
    double eigenvalue = 0;  // [1/s2] never below the largest of the assembled bodies
    int body = 0, element = 0;
  };
  Limiter limiter() const;

 private:
  struct Part {
    int body;
    std::vector<int> elements;
    std::unique_ptr<ElementBlock> block;
  };
  MPI_Comm comm_;
  std::vector<Part> interior_, border_;  // border_: touching ghosts
};

}  // namespace fem
