#include "base/histories.hpp"

#include <map>

#include "base/error.hpp"
#include "base/histories/axles.hpp"
#include "base/histories/constant.hpp"
#include "base/histories/formula.hpp"
#include "base/histories/ramp.hpp"
#include "base/histories/step.hpp"
#include "base/histories/table.hpp"

namespace base {

namespace {

struct Row {
  Table (*declaration)(const std::string& unit);
  HistoryPtr (*make)(const Value&);
  const char* only_unit;  // null: any unit
};

template <class H>
HistoryPtr make(const Value& checked) {
  return std::make_shared<H>(checked);
}

template <class H>
constexpr Row row(const char* only_unit = nullptr) {
  return {&H::declaration, &make<H>, only_unit};
}

// One row per history; its header explains it.
const Row rows[] = {
    row<histories::Constant>(),  //
    row<histories::Step>(),      //
    row<histories::Ramp>(),      //
    row<histories::Points>(),    //
    row<histories::Formula>(),   //
    row<histories::Axles>("N"),
};

class Shifted final : public History {
 public:
  Shifted(HistoryPtr inner, double zero) : inner_(std::move(inner)), zero_(zero) {}
  double value(double time) const override { return inner_->value(time - zero_); }

 private:
  HistoryPtr inner_;
  double zero_;  // [s]
};

}  // namespace

const Family& history_family(const std::string& unit) {
  static std::map<std::string, Family> families;
  const auto known = families.find(unit);
  if (known != families.end()) return known->second;
  Family family{"kind", "histories", {}};
  for (const auto& r : rows) {
    if (r.only_unit && unit != r.only_unit) continue;
    Table table = r.declaration(unit);
    table.parameters.insert(table.parameters.begin(), text("kind", "which history").among({table.name}));
    table.parameters.push_back(
        text("start_stage", "stage at whose start the history's time is zero").optional("start of the first stage"));
    family.rows.push_back(std::move(table));
  }
  return families.emplace(unit, std::move(family)).first->second;
}

HistoryPtr make_history(const Value& checked, double time_zero) {
  const std::string& kind = checked.at("kind").text();
  for (const auto& r : rows) {
    if (r.declaration("").name != kind) continue;
    HistoryPtr history = r.make(checked);
    return time_zero == 0 ? history : std::make_shared<Shifted>(history, time_zero);
  }
  throw InternalError("no history " + kind);
}

void require_bounded(const Value& checked, double time_zero, double end) {
  if (checked.at("kind").text() == histories::Formula::declaration("").name)
    histories::Formula(checked).require_bounded(0 - time_zero, end - time_zero);  // no minus zero
}

}  // namespace base
