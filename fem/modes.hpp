#pragma once
// Free vibrations of one body, undamped, about its unloaded state: K phi = omega^2 M phi, M lumped, by SLEPc
// (Krylov-Schur, shift-invert). The shift is a little below zero, so that the shifted stiffness is positive definite
// also for a body that supports do not hold; its rigid motions are known beforehand and deflated: what is found are the
// elastic modes, lowest first. phi^T M phi = 1.
// Effective mass along an axis d: (phi^T M e_d)^2 [kg]; over all modes, rigid ones included, it sums to the mass of the
// components that are free along d. Source: Hughes, The Finite Element Method (2000), 10.5.
#include <span>
#include <vector>

#include "fem/rigid_motions.hpp"
#include "fem/tangent.hpp"

namespace fem {

struct ModesInput {
  const Setup& setup;
  const std::vector<Mesh>& meshes;
  const Layout& layout;
  Mat stiffness;
  std::span<const double> mass, inverse_mass;  // [kg] [1/kg] of the owned components
};

struct FoundModes {
  std::vector<Mode> modes;
  std::vector<std::vector<double>> shapes;  // [1/sqrt(kg)] per mode: the body's owned components
};

/// The `count` lowest elastic modes of a body, fewer where it has fewer. Collective.
FoundModes find_modes(const ModesInput&, int body, int count, const Mechanisms&);

}  // namespace fem
