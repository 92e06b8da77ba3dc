#pragma once
// A load or motion over time: a dimensionless or dimensional factor f(t). Immutable after construction.
#include <memory>

namespace base {

class History {
 public:
  virtual ~History() = default;
  /// Value at time t [s]. Before its first and after its last instant a history keeps the value it has there.
  virtual double value(double time) const = 0;
};
using HistoryPtr = std::shared_ptr<const History>;

}  // namespace base
