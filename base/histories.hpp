#pragma once
// The family of load histories.
// To add one: a header in base/histories/ (a class with `declaration(unit)` and a constructor from the checked table),
// one row in the table of histories.cpp, one row in tests/unit/base_histories.cpp.
#include "base/history.hpp"
#include "base/parameter.hpp"

namespace base {

/// Declarations of all histories whose value carries this unit; `kind` tells them apart. A history that gives a force
/// only (axles) is left out for other units. Every one may name the stage at whose start its time zero lies.
const Family& history_family(const std::string& unit);

/// From a table checked against history_family(unit). `time_zero` [s]: simulated time at which the history's own time
/// is zero.
HistoryPtr make_history(const Value& checked, double time_zero);

}  // namespace base
