#include "base/histories/table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <sstream>

namespace base::histories {

namespace {
void read_columns(const Value& file, std::vector<double>& times, std::vector<double>& values) {
  std::ifstream in(file.text());
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    line = line.substr(0, line.find('#'));
    std::replace_if(
        line.begin(), line.end(), [](char c) { return c == ',' || c == ';'; }, ' ');
    std::istringstream words(line);
    std::string rest;
    if (!(words >> rest)) continue;
    words.clear();
    words.seekg(0);
    double time = 0, value = 0;
    if (words >> time >> value && !(words >> rest)) {
      times.push_back(time);
      values.push_back(value);
    } else if (number > 1) {
      fail(file, fmt::format("line {} must hold two numbers: time and value", number), "mend the file");
    }
  }
}
}  // namespace

Points::Points(const Value& checked) {
  const Value* file = checked.find("file");
  const Value* times = checked.find("times");
  const Value* values = checked.find("values");
  if (file && (times || values)) fail(*file, "stands beside times or values", "give one or the other");
  if (!file && !(times && values)) fail(checked, "has no points", "give times and values, or file");
  if (file) {
    read_columns(*file, times_, values_);
  } else {
    times_ = times->reals();
    values_ = values->reals();
    if (times_.size() != values_.size()) {
      fail(*values, fmt::format("{} values for {} times", values_.size(), times_.size()), "give one value per time");
    }
  }
  const Value& where = file ? *file : *times;
  if (times_.empty()) fail(where, "holds no points", "give at least one");
  for (std::size_t i = 1; i < times_.size(); ++i) {
    if (!(times_[i] > times_[i - 1])) fail(where, fmt::format("time {} s must be above the one before", times_[i]));
  }
}

double Points::value(double time) const {
  const auto after = std::upper_bound(times_.begin(), times_.end(), time);
  if (after == times_.begin()) return values_.front();
  if (after == times_.end()) return values_.back();
  const auto i = static_cast<std::size_t>(after - times_.begin());
  const double share = (time - times_[i - 1]) / (times_[i] - times_[i - 1]);
  return values_[i - 1] + share * (values_[i] - values_[i - 1]);
}

}  // namespace base::histories
