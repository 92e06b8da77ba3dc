#pragma once
// Tables that a run writes of its grains: sieve_curve.csv, contact_forces.csv. Text only; run_files.hpp writes it.
#include <span>
#include <string>
#include <vector>

#include "coupling/shapes.hpp"
#include "dem/grading.hpp"

namespace coupling {

struct Scene;

/// Mass share of these grains that passes each of the sieves [m].
dem::SieveCurve sieve_grains(std::span<const dem::Grain>, std::span<const GrainShape>, std::span<const double> sizes);

/// sieve_curve.csv: every sieve of [output] sieves, or else of the packing's grading, with the share that passes and,
/// with a packing, the share that was asked for. Empty when the scene asks for no sieves.
std::string sieve_curve_text(const Scene&, std::span<const dem::Grain>);

/// contact_forces.csv: probability density of normal and shear force over their means, of the contacts between grains
/// and with walls.
std::string contact_forces_text(std::span<const dem::GrainContact>, std::span<const dem::WallContact>);

}  // namespace coupling
