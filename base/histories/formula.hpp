#pragma once
// f(t) = value * expression(t), t in seconds from the history's zero: "sin(2 * pi * 8 * t)",
// "t < 0.5 ? 1 - cos(2 * pi * t) : 2". Operators, functions and constants are muParser's
// (github.com/beltoforion/muparser), and pi. An expression that is no finite number at some instant ends the run there,
// with that instant.
#include <memory>

#include "base/history.hpp"
#include "base/parameter.hpp"

namespace base::histories {

class Formula final : public History {
 public:
  static Table declaration(const std::string& unit) {
    return {"formula",
            "an expression of the time t in seconds",
            {text("expression", "of t: sin, cos, exp, sqrt, abs, min, max, ^, pi, a < b ? x : y, ..."),
             real("value", unit, "what the expression is multiplied with")}};
  }
  explicit Formula(const Value& checked);
  ~Formula() override;
  double value(double time) const override;

 private:
  struct Expression;
  std::unique_ptr<Expression> expression_;
  Value text_;    // for messages
  double value_;  // [unit of the load]
};

}  // namespace base::histories
