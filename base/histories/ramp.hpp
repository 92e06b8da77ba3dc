#pragma once
// f(t) = value * clamp((t - start) / duration, 0, 1).
#include <algorithm>

#include "base/history.hpp"
#include "base/parameter.hpp"

namespace base::histories {

class Ramp final : public History {
 public:
  static Table declaration(const std::string& unit) {
    return {"ramp",
            "zero, then a straight rise to the value, then the value",
            {real("value", unit, "the value after the ramp"), real("start", "s", "when the rise begins").otherwise(0.0),
             real("duration", "s", "how long the rise takes").above(0)}};
  }
  explicit Ramp(const Value& checked)
      : value_(checked.at("value").real()),
        start_(checked.at("start").real()),
        duration_(checked.at("duration").real()) {}
  double value(double time) const override { return value_ * std::clamp((time - start_) / duration_, 0.0, 1.0); }

 private:
  double value_, start_, duration_;  // [unit of the load] [s] [s]
};

}  // namespace base::histories
