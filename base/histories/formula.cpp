#include "base/histories/formula.hpp"

#include <fmt/format.h>
#include <muParser.h>

#include <cmath>
#include <numbers>

namespace base::histories {

struct Formula::Expression {
  double time = 0;
  mu::Parser parser;
};

Formula::Formula(const Value& checked)
    : expression_(std::make_unique<Expression>()), text_(checked.at("expression")), value_(checked.at("value").real()) {
  mu::Parser& parser = expression_->parser;
  try {
    parser.DefineConst("pi", std::numbers::pi);
    parser.DefineVar("t", &expression_->time);
    parser.SetExpr(text_.text());
    parser.Eval();
  } catch (const mu::ParserError& error) {
    fail(text_, "must be an expression of t: " + error.GetMsg(), "write it like \"sin(2 * pi * 8 * t)\"");
  }
}

Formula::~Formula() = default;

double Formula::value(double time) const {
  expression_->time = time;
  const double result = value_ * expression_->parser.Eval();
  if (!std::isfinite(result))
    fail(text_, fmt::format("is no finite number at t = {:.9g} s", time), "mend the expression");
  return result;
}

}  // namespace base::histories
