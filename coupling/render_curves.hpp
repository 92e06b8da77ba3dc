#pragma once
// curves.png: the probes of history.csv over time, one chart per unit, and the energy ledger.
#include <filesystem>
#include <vector>

#include "coupling/run_directory.hpp"

namespace coupling {

/// One chart: which columns go in, in which readable unit.
struct Chart {
  std::string title;
  ShownUnit unit;
  std::vector<const HistoryColumn*> columns;
};
/// Round numbers for an axis from low to high, about `count` of them.
std::vector<double> round_ticks(double low, double high, int count);

/// Loads, displacements, energies, energy error, accelerations, and the rest, in this order; columns that are zero
/// throughout are left out, and at most six charts made.
std::vector<Chart> charts_of(const HistoryTable&);

/// Draws the charts. Needs a display. Returns the file written; none without probes.
std::vector<std::filesystem::path> render_curves(const RunDirectory&, const std::filesystem::path& pictures);

}  // namespace coupling
