#pragma once
// Pictures of the bodies for ParaView, written by the first rank: DIR/<body>.pvd and DIR/<body>/<body>_NNNN.vtu. Of
// nodes: displacement, velocity, acceleration, reaction (of supports and motions), nodal_stress (mean of the elements
// around the node) and the nodal_von_mises and nodal_principal_stress that follow from it. Of elements: mean stress,
// von_mises, principal_stress, plastic_strain where the law knows it, and region, the number of the material.
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "fem/assembly.hpp"

namespace fem {

struct Frame {
  double time;                                     // [s]
  std::span<const double> displacement;            // [m] shown; owned components
  const NodalField &strained, &velocity;           // [m] [m/s] that stresses follow from; ghosts up to date
  const NodalField* acceleration = nullptr;        // [m/s2] null: left out
  const std::vector<double>* reactions = nullptr;  // [N] owned components; null: left out
};

class Output {
 public:
  Output(const Setup&, const std::vector<Mesh>&, const Layout&, const Assembly&);
  ~Output();
  /// Collective; throws base::MachineError on every rank when the disk fails.
  void write(const std::string& directory, const Frame&);
  /// Collective: gathers the frame. On the first rank the function that is returned writes it, in any thread, and
  /// throws base::MachineError when the disk fails; on the others there is none.
  std::function<void()> picture(const std::string& directory, const Frame&);
  /// What has been asked for, for a checkpoint (not collective: whole on the first rank); restore() goes on after it.
  void save(base::Columns&) const;
  void restore(const base::Columns&);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace fem
