#pragma once
// `trackbed check`: what a scene is, switches on and will cost, before anything is started.
#include <string>

#include "coupling/run.hpp"

namespace coupling {

/// Reads the scene, meshes its bodies, sizes both sides, on the calling rank alone. Throws every base::UserError that
/// run() would throw before its first step, apart from those about the run directory and of an equilibrium that is not
/// found. Packs nothing, solves nothing, writes nothing.
std::string check(const RunOptions&);

}  // namespace coupling
