#pragma once
// What is measured of a set of grains: porosity and mean coordination inside a box. Host side, not for every step.
#include <functional>
#include <span>

#include "coupling/scene.hpp"
#include "dem/measure/region.hpp"

namespace coupling {

/// True where a point belongs to the measured region.
using PointFilter = std::function<bool(const Vec3&)>;

/// Porosity [-]: share of the points of a cubic lattice (cell centres, spacing about `lattice` [m], fitted to the box)
/// that lie in no grain. Overlaps count once, those of a clump's own spheres as well. `filter`, when given, restricts
/// the points; with no point left: 1. The error of one box is about lattice / grain diameter / sqrt(number of grains).
double porosity(std::span<const dem::GrainSphere>, const Box&, double lattice, const PointFilter& filter = {});
/// The same of a box or of a measurement sphere (Talebiahooie2021 3.2), by the points of the lattice that lie in it.
double porosity(std::span<const dem::GrainSphere>, const dem::Region&, double lattice);

/// Mean number of grains [-] that press on a grain whose centre lies in the box; those outside count, walls do not. 0
/// without grains.
double coordination(std::span<const dem::Grain>, std::span<const dem::GrainContact>, const Box&);

/// Volume [m3] of the part of the box where the filter holds, by the same lattice.
double volume(const Box&, double lattice, const PointFilter& filter);

/// Closed box: points on its faces are inside.
bool contains(const Box&, const Vec3& point);

}  // namespace coupling
