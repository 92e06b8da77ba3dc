#pragma once
// Probes and energy ledgers of both sides, sampled at an instant and brought to the root rank.
#include <map>
#include <span>
#include <string>
#include <vector>

#include "base/columns.hpp"
#include "coupling/exchange.hpp"
#include "coupling/grain_probes.hpp"
#include "coupling/ledger.hpp"
#include "coupling/roles.hpp"
#include "coupling/scene.hpp"

namespace coupling {

/// A sum, quotient or angle of probes that have been taken already.
double combined(const Probe&, std::span<const double> taken);

class Sampler {
 public:
  /// `grains` is null off the DEM rank, `bodies` off the FEM ranks; `walls[s]` is the DEM's number of skin s,
  /// `named_walls` that of each scene wall.
  Sampler(const Roles&, const Scene&, dem::Simulation* grains, fem::Model* bodies, const std::vector<base::Skin>& skins,
          std::vector<int> walls, std::vector<int> named_walls);

  struct Sample {
    std::vector<double> probes;  // in the scene's order, SI
    Sides energy;
  };
  /// The measuring starts: the grains nearest to points are chosen, displacements count from here.
  void zero();
  /// Collective over the world; the answer is whole on the root only. Slow probes (is_slow()) are taken afresh only if
  /// `thorough`, and keep their last value otherwise. `time` [s] is that of the run.
  Sample sample(double time, bool thorough);
  /// A scene wall that has been taken away: no force any more, its last place.
  void forget_wall(std::size_t wall) { named_walls_[wall] = -1; }

  /// Zeros, chosen grains and last values, for a checkpoint (on the root).
  base::Columns save() const;
  void restore(const base::Columns&);

 private:
  template <class Self, class Walk>
  static void walk(Self&, Walk&&);
  double grain_probe(const Probe&) const;
  double body_probe(const Probe&) const;
  double contact_force(const Probe&) const;
  double wall_probe(const Probe&, double last) const;
  int wall_number(const std::string& name) const;
  const dem::Grain& grain(std::int64_t id) const;

  const Roles& roles_;
  const Scene& scene_;
  dem::Simulation* grains_;
  fem::Model* bodies_;
  const std::vector<base::Skin>& skins_;
  std::vector<int> walls_, named_walls_;
  std::map<std::string, Vec3> wall_zero_;  // [m] displacement of walls when the measuring started
  std::vector<double> kept_;               // last values
  // copies made once per sample and only when a probe asks for them
  mutable GrainCopies copies_;
  mutable std::map<std::string, GrainMark> marks_;  // by the probe's name
};

}  // namespace coupling
