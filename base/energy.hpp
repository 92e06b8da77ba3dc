#pragma once
// One side's ledger. Stored energies are values at the instant; works, losses and impulses are sums since the last
// reset. Sign: a work is positive when it puts energy into the side; a loss is positive when energy leaves the
// mechanics.
#include <initializer_list>

#include "base/vec3.hpp"

namespace base {

struct Energy {
  double kinetic = 0;         // [J] stored: translation and rotation
  double elastic_normal = 0;  // [J] stored in contacts, normal (DEM)
  double elastic_shear = 0;   // [J] stored in contacts, tangential (DEM)
  double elastic_bonds = 0;   // [J] stored in bonds (DEM)
  double strain = 0;          // [J] stored in elements (FEM)
  double work_gravity = 0;    // [J] work of gravity since reset
  double work_loads = 0;      // [J] work of external loads and prescribed motion since reset (FEM)
  double work_walls = 0;      // [J] work of moving rigid walls on the grains since reset (DEM)
  double work_interface = 0;  // [J] work received through the grain-skin interface since reset, as this side sees it
  double loss_friction = 0;   // [J] Coulomb slip and the elastic shear energy that the Mindlin rescaling gives up (DEM)
  double loss_contact_damping = 0;  // [J] contact dashpots, normal and tangential (DEM)
  double loss_rolling = 0;          // [J] rolling resistance (DEM)
  double loss_breakage = 0;         // [J] what bonds had stored when they broke (DEM)
  double loss_damping = 0;          // [J] mass-proportional damping, of grains or of bodies; absorbing boundaries
  double loss_viscous = 0;          // [J] viscosity of bodies (FEM)
  double loss_plastic = 0;          // [J] plastic flow of bodies (FEM)
  // Received through the grain-skin interface since reset, as this side sees it: sums over steps of the force at a
  // step's end times the step, and of its moment about the origin. (Rolling resistance brakes grains only.)
  Vec3 interface_impulse;          // [N s]
  Vec3 interface_angular_impulse;  // [N m s]

  double stored() const { return kinetic + elastic_normal + elastic_shear + elastic_bonds + strain; }
  double works() const { return work_gravity + work_loads + work_walls + work_interface; }
  double losses() const {
    return loss_friction + loss_contact_damping + loss_rolling + loss_breakage + loss_damping + loss_viscous +
           loss_plastic;
  }
  Energy& operator+=(const Energy& other) {
    for (const auto term :
         {&Energy::kinetic, &Energy::elastic_normal, &Energy::elastic_shear, &Energy::elastic_bonds, &Energy::strain,
          &Energy::work_gravity, &Energy::work_loads, &Energy::work_walls, &Energy::work_interface,
          &Energy::loss_friction, &Energy::loss_contact_damping, &Energy::loss_rolling, &Energy::loss_breakage,
          &Energy::loss_damping, &Energy::loss_viscous, &Energy::loss_plastic})
      this->*term += other.*term;
    interface_impulse += other.interface_impulse;
    interface_angular_impulse += other.interface_angular_impulse;
    return *this;
  }
};

}  // namespace base
