#pragma once
// The parts of read_scene(): each turns checked tables into its part of the Scene, follows names to what they mean, and
// writes derived values back into the tables, so that the resolved scene shows them.
#include <string>
#include <vector>

#include "base/value.hpp"
#include "coupling/scene.hpp"

namespace coupling {

// ---- scene_names.cpp
/// `name` of every row of a list of tables.
std::vector<std::string> names_of(const base::Value::List&);
/// Throws when two rows have one name; noun: "stage".
void require_unique(const base::Value::List&, const std::string& noun);
/// Throws when the text is none of the known names; noun: "body", plural: "bodies".
void require_known(const base::Value& text, const std::vector<std::string>& known, const std::string& noun,
                   const std::string& plural);
/// Throws when the box has no volume.
Box read_box(const base::Value&);
/// Throws when the normal is zero.
dem::Plane read_plane(const base::Value&);
std::map<std::string, double> read_numbers(const base::Value&);
/// Throws when a .geo file does not hold one of the parameters.
void require_mesh_parameters(const base::Value& table_with_mesh);

// ---- scene_packing.cpp
/// Growth with its defaults where the layer's method is growth. Throws on a table that the method does not read.
void read_growth(base::Value& layer_row, PackingLayer&);
void read_vibration(const base::Value& layer_row, PackingLayer&);
void read_target(const base::Value& packing_table, Packing&);
/// Loosened and eroded regions; throws on one that no layer reaches.
void read_regions(const base::Value& packing_table, Packing&);

// ---- scene_contacts.cpp
/// Law, rolling and constants of a table. What a partner of the grains does not say is as in `grains`; null: `table` is
/// the grains' own. Throws on a constant that the law lacks, and on one that it does not read.
dem::Interaction read_contact(base::Value& table, const base::Value* grains);
bool reads_elastic_constants(const dem::Interaction&);
/// Throws when the contact's law reads no elastic constants; `value` states some.
void refuse_elastic_constants(const base::Value& value, const dem::Interaction&);

// ---- scene_bodies.cpp
/// From a checked table; refused where it grows without bound during the stages, which are built.
base::HistoryPtr read_history(const base::Value& checked, const Scene&);

// ---- scene_walls.cpp
/// How a wall moves; the stages are built.
void read_wall_motion(const base::Value& row, const Scene&, WallScene&);

// ---- one for each part of the file; `root` is the checked scene
void build_solver(base::Value& root, Scene&);
void build_coupling(base::Value& root, Scene&);
void build_stages(base::Value& root, Scene&);  // after the solver
void build_bodies(base::Value& root, Scene&);
void build_grains(base::Value& root, Scene&);
void build_bonds(base::Value& root, Scene&);  // after the grains
void build_probes(base::Value& root, Scene&);
void build_results(base::Value& root, Scene&);
void build_spectra(base::Value& root, Scene&);  // after the probes

/// FNV-1a over everything that decides the packing.
std::string packing_hash(const base::Value& root, const Scene&);

}  // namespace coupling
