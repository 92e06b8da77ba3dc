#pragma once
// f(t) = value, at all times.
#include "base/history.hpp"
#include "base/parameter.hpp"

namespace base::histories {

class Constant final : public History {
 public:
  static Table declaration(const std::string& unit) {
    return {"constant", "the same value at all times", {real("value", unit, "the value")}};
  }
  explicit Constant(const Value& checked) : value_(checked.at("value").real()) {}
  double value(double) const override { return value_; }

 private:
  double value_;
};

}  // namespace base::histories
