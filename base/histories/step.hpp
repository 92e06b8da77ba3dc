#pragma once
// f(t) = 0 before `start`, value from `start` on.
#include "base/history.hpp"
#include "base/parameter.hpp"

namespace base::histories {

class Step final : public History {
 public:
  static Table declaration(const std::string& unit) {
    return {"step",
            "zero, then suddenly the value",
            {real("value", unit, "the value after the step"), real("start", "s", "time of the step").otherwise(0.0)}};
  }
  explicit Step(const Value& checked) : value_(checked.at("value").real()), start_(checked.at("start").real()) {}
  double value(double time) const override { return time >= start_ ? value_ : 0; }

 private:
  double value_, start_;  // [unit of the load] [s]
};

}  // namespace base::histories
