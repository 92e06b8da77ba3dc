#pragma once
// What a scene file may hold: every table with its parameters, declared once. Reading, checks, `trackbed list` and
// scene.resolved.toml all come from here. To add a parameter: one line in scene_tables.cpp, one line where the scene is
// built (scene_*.cpp).
#include "base/parameter.hpp"

namespace coupling {

const base::Table& scene_table();  // the whole file
const base::Table& time_table();
const base::Table& coupling_table();  // solver_tables.cpp
const base::Table& grains_table();
const base::Table& grain_material_table();
const base::Table& shape_table();
const base::Table& grain_table();
const base::Table& bonds_table();  // scene_bonds.cpp
const base::Table& bond_table();   // scene_bonds.cpp
const base::Table& wall_table();
const base::Table& wall_material_table();
const base::Table& packing_table();
const base::Table& layer_table();
const base::Table& box_table();
const base::Table& plane_table();
// ---- packing_tables.cpp
const base::Table& growth_table();
const base::Table& vibration_table();
const base::Table& loosen_table();
const base::Table& erode_table();
// ----
const base::Table& fem_table();  // solver_tables.cpp
const base::Table& body_table();
const base::Family& material_family();  // by law
const base::Table& support_table();
const base::Table& absorbing_table();
const base::Table& periodic_faces_table();
const base::Family& motion_family();
const base::Family& load_family();  // by kind
const base::Table& contact_table();
const base::Table& stage_table();
const base::Family& probe_family();  // by kind
const base::Table& result_table();
const base::Table& spectrum_table();  // scene_spectra.cpp
const base::Table& output_table();

/// Components of a body's stress that a probe can take, in the order of Probe::component.
const std::vector<std::string>& stress_components();

/// One row per probe kind, in the order of ProbeKind.
struct ProbeRow {
  const char* name;
  const char* unit;  // of its value; loads take their own
  const char* meaning;
  enum Where {
    body_motion,
    load,
    contact,
    contact_area,
    region,
    rattlers,
    forces,
    force_quantile,
    stress,
    heap,
    sieve,
    none,
    grain,
    wall,
    sum,
    pair,
    body_group,
    mode,
    body_stress,
    body_strain,
    clock
  } where;
};
const std::vector<ProbeRow>& probe_rows();

}  // namespace coupling
