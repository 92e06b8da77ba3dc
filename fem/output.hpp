#pragma once
// Pictures of the bodies for ParaView, written by the first rank: DIR/<body>.pvd and DIR/<body>/<body>_NNNN.vtu.
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "fem/assembly.hpp"

namespace fem {

struct Frame {
  double time;                            // [s]
  std::span<const double> displacement;   // [m] shown; owned components
  const NodalField &strained, &velocity;  // [m] [m/s] that stresses follow from; ghosts up to date
};

class Output {
 public:
  Output(const Setup&, const std::vector<Mesh>&, const Layout&, const Assembly&);
  ~Output();
  /// Collective; throws base::MachineError on every rank when the disk fails.
  void write(const std::string& directory, const Frame&);
  /// What has been written, for a checkpoint (not collective: whole on the first rank); restore() goes on after it.
  void save(base::Columns&) const;
  void restore(const base::Columns&);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace fem
