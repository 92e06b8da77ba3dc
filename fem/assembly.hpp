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

  /// Inner forces [N] of displacements [m] and velocities [m/s] (null: at rest; read if viscous()), whose
  /// begin_to_ghosts() has been called. What laws remember stays as it is. Collective.
  void inner_forces(NodalField& displacements, NodalField* velocities, NodalField& forces) const;
  /// The same for small motions about the start: K u + C v. begin_to_ghosts() of both has been called. Collective.
  void linear_forces(NodalField& displacements, NodalField& velocities, NodalField& forces) const;
  /// Inner forces of the moving bodies; laws remember this state. The velocities are those of the middle of the step
  /// that led here; begin_to_ghosts() has been called of the displacements and, if viscous(), of the velocities.
  /// Returns this rank's losses. Collective.
  Losses advance(NodalField& displacements, NodalField& velocities, NodalField& forces);
  bool viscous() const { return viscous_; }
  bool keeps_history() const { return keeps_history_; }
  /// Frees what only lumped_mass() and limiter() read; they may not be called after.
  void forget_masses();
  struct BlockOfBody {
    int body;
    const ElementBlock* block;
  };
  std::vector<BlockOfBody> blocks() const;
  /// Lumped mass [kg], the same in the three components. Collective.
  void lumped_mass(NodalField& mass) const;
  /// Mean stress of this rank's elements of a body, in the order of `elements_of`; velocities may be null. Ghosts must
  /// be up to date.
  std::vector<std::array<double, 6>> stresses(int body, const NodalField& displacements,
                                              const NodalField* velocities = nullptr) const;
  /// Largest accumulated plastic strain [-] of each of this rank's elements of a body, in the same order.
  std::vector<double> plastic_strains(int body) const;
  /// Elastic energy [J] of this rank's elements of a body; with has_simple_energy() it is half of displacements times
  /// inner forces. Ghosts must be up to date.
  double stored(int body, const NodalField& displacements) const;
  bool has_simple_energy(int body) const;
  std::vector<int> elements_of(int body) const;

  /// What the laws of this rank's elements of a body remember, and how many numbers each element has, in that order.
  struct Histories {
    std::vector<int> sizes;
    std::vector<double> values;
  };
  Histories histories(int body) const;
  void set_histories(int body, const std::vector<double>& values);

  /// The element with the largest eigenvalue of M^-1 (K + rate C) of its own, over all ranks. Collective.
  struct Limiter {
    double eigenvalue = 0;  // [1/s2] never below the largest of the assembled bodies
    int body = 0, element = 0;
  };
  Limiter limiter(double rate = 0) const;

 private:
  struct Part {
    int body;
    std::vector<int> elements;
    std::unique_ptr<ElementBlock> block;
  };
  template <class Parts, class Work>
  static void overlapped(Parts& interior, Parts& border, const std::vector<NodalField*>& motion, NodalField& forces,
                         Work&& work);

  MPI_Comm comm_;
  bool viscous_ = false, keeps_history_ = false;  // on any rank
  std::vector<Part> interior_, border_;           // border_: touching ghosts
};

}  // namespace fem
