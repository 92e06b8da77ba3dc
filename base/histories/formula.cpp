#include "base/histories/formula.hpp"

#include <fmt/format.h>
#include <muParser.h>

#include <algorithm>
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

void Formula::require_bounded(double from, double to) const {
  constexpr int samples = 10000, closer = 8, rounds = 11, judged = 7;
  constexpr double growth = 3e4;  // over the judged rounds: 8^7 = 2e6 at a simple pole, 8^3.5 = 1400 at 1 / sqrt(t)
  if (!(to > from)) return;
  const double spacing = (to - from) / samples;
  const auto size = [&](double time) { return std::abs(value(std::clamp(time, from, to))); };
  double before = 0, here = size(from);
  for (int i = 0; i <= samples; ++i) {
    const double after = i < samples ? size(from + (i + 1) * spacing) : 0;
    if (here > before && here >= after) {
      double middle = from + i * spacing, reach = spacing, largest = here, earlier = here;
      // Before the judged rounds, 1 / 4096 of the spacing: peaks that are wider than that are bounded below it.
      for (int round = 0; round < rounds; ++round) {
        if (round == rounds - judged) earlier = largest;
        reach /= closer;
        const double around = middle;
        for (int k = -closer; k <= closer; ++k) {
          const double time = around + k * reach, found = size(time);
          if (found > largest) largest = found, middle = time;
        }
      }
      if (largest > growth * earlier)
        fail(text_, fmt::format("grows without bound at t = {:.6g} s", middle),
             "keep its pole out of the run's time, or bound it: \"min(..., 1)\"");
    }
    before = here;
    here = after;
  }
}

}  // namespace base::histories
