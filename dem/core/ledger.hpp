#pragma once
// Sums of what grains, pairs and wall candidates have noted down.
#include "dem/core/wall_list.hpp"

namespace dem::TRACKBED_DEM_SYSTEM {

struct SumPairs {  // loss_friction, loss_damping, elastic_normal, elastic_shear, loss_rolling
  const ContactLedger* ledger;
  TRACKBED_HD void operator()(int k, Sums<5>& s) const {
    const ContactLedger& l = ledger[k];
    s.value[0] += l.loss_friction;
    s.value[1] += l.loss_damping;
    s.value[2] += l.elastic_normal;
    s.value[3] += l.elastic_shear;
    s.value[4] += l.loss_rolling;
  }
};
struct ClearPairLosses {
  ContactLedger* ledger;
  TRACKBED_HD void operator()(int k) const {
    ledger[k].loss_friction = ledger[k].loss_damping = ledger[k].loss_rolling = 0;
  }
};

struct SumWalls {  // as SumPairs, then work of rigid walls, work of coupled meshes
  const WallLedger* ledger;
  const int* candidate;
  const Facet* facet;
  const WallRow* wall;
  TRACKBED_HD void operator()(int c, Sums<7>& s) const {
    const WallLedger& l = ledger[c];
    s.value[0] += l.loss_friction;
    s.value[1] += l.loss_damping;
    s.value[2] += l.elastic_normal;
    s.value[3] += l.elastic_shear;
    s.value[4] += l.loss_rolling;
    const WallRow& row = wall[facet[candidate[c]].wall];
    if (!row.body) s.value[row.interface ? 6 : 5] += l.work;
  }
};
struct ClearWallLosses {
  WallLedger* ledger;
  TRACKBED_HD void operator()(int c) const {
    WallLedger& l = ledger[c];
    l.loss_friction = l.loss_damping = l.loss_rolling = l.work = 0;
  }
};

/// What grains received from coupled meshes: impulse, and its moment about the origin.
struct SumPassed {
  const Passed* passed;
  TRACKBED_HD void operator()(int c, Sums<6>& s) const {
    for (int k = 0; k < 3; ++k) {
      s.value[k] += passed[c].impulse[k];
      s.value[3 + k] += passed[c].angular[k];
    }
  }
};

struct SumGrainLosses {  // loss_rolling, loss_damping
  const GrainLedger* ledger;
  TRACKBED_HD void operator()(int g, Sums<2>& s) const {
    s.value[0] += ledger[g].loss_rolling;
    s.value[1] += ledger[g].loss_damping;
  }
};
struct SumKinetic {
  Rows<const Quad> state;
  TRACKBED_HD void operator()(int g, Sums<1>& s) const {
    s.value[0] += 0.5 * norm2(state.translation(g).vector) / state.translation(g).number;
    if (state.parts == 2) s.value[0] += 0.5 * norm2(state.rotation(g).vector) / state.rotation(g).number;
  }
};
/// Work that a constant gravity could have done from the origin to here. Its change is gravity's work, exactly.
struct SumGravity {
  const Place* place;
  Rows<const Quad> state;
  Vec3 gravity;
  TRACKBED_HD void operator()(int g, Sums<1>& s) const {
    s.value[0] += dot(gravity, place[g].position) / state.translation(g).number;
  }
};

struct SumImpulse {
  const Vec3* impulse;
  const int* candidate;
  const Facet* facet;
  int wall;
  TRACKBED_HD void operator()(int c, Sums<3>& s) const {
    if (facet[candidate[c]].wall != wall) return;
    s.value[0] += impulse[c].x;
    s.value[1] += impulse[c].y;
    s.value[2] += impulse[c].z;
  }
};

/// The same for every wall at once, as Queue::launch_sums() wants it.
struct SumImpulses {
  SumImpulse sum;
  Vec3* total;  // of the walls
  TRACKBED_HD bool skip(int) const { return false; }
  TRACKBED_HD void operator()(int wall, int candidate, Sums<3>& sums) const {
    SumImpulse of_this = sum;
    of_this.wall = wall;
    of_this(candidate, sums);
  }
  TRACKBED_HD void finish(int wall, const Sums<3>& sums) const {
    total[wall] = {sums.value[0], sums.value[1], sums.value[2]};
  }
};

struct CountWallContacts {
  const WallState* state;
  TRACKBED_HD int operator()(int c) const { return state[c].overlap > 0 ? 1 : 0; }
};

}  // namespace dem::TRACKBED_DEM_SYSTEM
