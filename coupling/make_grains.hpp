#pragma once
// How a simulation is made: one that holds all grains, or one whose grains are shared out over the DEM ranks.
#include <functional>
#include <memory>

#include "dem/dem.hpp"

namespace coupling {

using MakeGrains = std::function<std::unique_ptr<dem::Simulation>(const dem::Setup&, dem::Backend)>;

}  // namespace coupling
