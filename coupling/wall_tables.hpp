#pragma once
// What a scene file may say of the motion of a rigid wall: by stages, or as a rigid body under loads. Part of
// scene_tables.hpp.
#include "base/parameter.hpp"

namespace coupling {

const base::Table& wall_body_table();
const base::Family& wall_load_family();  // by kind
const base::Table& wall_motion_table();

/// Their keys in [[wall]].
std::vector<base::Parameter> wall_motion_parameters();

}  // namespace coupling
