#pragma once
// f(t) = value * expression(t), t in seconds from the history's zero: "sin(2 * pi * 8 * t)",
// "t < 0.5 ? 1 - cos(2 * pi * t) : 2". Operators, functions and constants are muParser's
// (github.com/beltoforion/muparser), and pi. An expression that is no finite number at some instant ends the run there,
// with that instant. Poles, which no step may meet exactly, are looked for before: at every local maximum of |f| among
// ten thousand samples, closer and closer around the largest value. At a pole of order m it grows with the inverse of
// the distance to the power m all the way down, at a peak or a jump it does not. Limits: a pole so weak that no sample
// beside it stands out is not seen; one of an order below about 0.7 passes, for the impulse through it is finite.
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
  /// Throws base::UserError where there is a pole between these times [s].
  void require_bounded(double from, double to) const;

 private:
  struct Expression;
  std::unique_ptr<Expression> expression_;
  Value text_;    // for messages
  double value_;  // [unit of the load]
};

}  // namespace base::histories
