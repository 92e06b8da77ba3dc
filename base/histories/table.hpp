#pragma once
// f(t) through given points, straight lines between them; before the first and after the last the value there.
// The points stand in the scene (`times`, `values`) or in a text file of two columns (time [s], value in SI; separated
// by comma, semicolon or blanks; a first line that holds no number is a heading; # begins a comment).
#include <vector>

#include "base/history.hpp"
#include "base/parameter.hpp"

namespace base::histories {

class Points final : public History {
 public:
  static Table declaration(const std::string& unit) {
    return {
        "table",
        "given points with straight lines between them",
        {reals("times", "s", "instants, rising").optional("taken from `file`"),
         reals("values", unit, "value at each instant").optional("taken from `file`"),
         path("file", "text file of two columns: time in s, value in SI").optional("`times` and `values` instead")}};
  }
  explicit Points(const Value& checked);
  double value(double time) const override;

 private:
  std::vector<double> times_, values_;  // [s] [unit of the load]
};

}  // namespace base::histories
