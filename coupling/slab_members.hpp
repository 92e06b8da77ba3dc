#pragma once
// Members of the structs that orders to DEM parts take and give, for bytes.hpp. Structured bindings name all of
// them: one that is added to a struct and forgotten here does not compile.
#include "coupling/bytes.hpp"
#include "coupling/grain_end.hpp"
#include "dem/dem.hpp"

namespace coupling {

template <>
struct Members<dem::Material> {
  static auto tie(auto& value) {
    auto& [name, young_modulus, poisson_ratio, density] = value;
    return std::tie(name, young_modulus, poisson_ratio, density);
  }
};

template <>
struct Members<dem::Interaction> {
  static auto tie(auto& value) {
    auto& [friction, restitution, rolling_friction, law, rolling, normal_stiffness, shear_stiffness, normal_viscosity,
           shear_viscosity, dissipative_coefficient, damping_mode, critical_stress, friction_exponent,
           rolling_damping] = value;
    return std::tie(friction, restitution, rolling_friction, law, rolling, normal_stiffness, shear_stiffness,
                    normal_viscosity, shear_viscosity, dissipative_coefficient, damping_mode, critical_stress,
                    friction_exponent, rolling_damping);
  }
};

template <>
struct Members<dem::Clump> {
  static auto tie(auto& value) {
    auto& [spheres, volume, inertia, reach, bounding, centroid, orientation] = value;
    return std::tie(spheres, volume, inertia, reach, bounding, centroid, orientation);
  }
};

template <>
struct Members<base::Skin> {
  static auto tie(auto& value) {
    auto& [body, nodes, facets, faces, face_of] = value;
    return std::tie(body, nodes, facets, faces, face_of);
  }
};

template <>
struct Members<Interface> {
  static auto tie(auto& value) {
    auto& [skins, owned, settings] = value;
    return std::tie(skins, owned, settings);
  }
};

template <>
struct Members<PairTraffic> {
  static auto tie(auto& value) {
    auto& [nodes, bytes] = value;
    return std::tie(nodes, bytes);
  }
};

template <>
struct Members<dem::StableStep> {
  static auto tie(auto& value) {
    auto& [limit, limiter] = value;
    return std::tie(limit, limiter);
  }
};

/// All but the company, which is each part's own.
template <>
struct Members<dem::Setup> {
  static auto tie(auto& value) {
    auto& [materials, interactions, gravity, skin, maximum_overlap, track_energy, rotations, time_scheme,
           rotation_scheme, lanes, precision, periods, company] = value;
    return std::tie(materials, interactions, gravity, skin, maximum_overlap, track_energy, rotations, time_scheme,
                    rotation_scheme, lanes, precision, periods);
  }
};

}  // namespace coupling
