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

/// Throws base::UserError where that history is seen to be no finite number, or to grow without bound, at some time
/// from 0 to `end` [s].
void require_bounded(const Value& checked, double time_zero, double end);

}  // namespace base
