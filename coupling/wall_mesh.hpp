#pragma once
// Rigid walls from files: triangles and quadrilaterals of a .stl, .msh or .geo, read through gmsh's API.
#include "base/skin.hpp"
#include "coupling/scene.hpp"

namespace coupling {

/// The faces of a solid look outwards; other surfaces stay as their file has them.
/// Throws base::UserError (file unreadable, no facets, unknown mesh parameter).
base::Skin read_wall_mesh(const WallScene&);

}  // namespace coupling
